"""Fixtures of this folder."""

from campaign_folder import folder, text, vehicle_file

__all__ = ["folder", "text", "vehicle_file"]
