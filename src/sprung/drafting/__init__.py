"""Drafting of a campaign file from recordings: drops are detected, sensors and loads recognised, gaps left to fill in."""

from sprung.drafting.detected_drop import DetectedDrop, wheel_score
from sprung.drafting.detection import Detection, detect_drops
from sprung.drafting.draft import draft
from sprung.drafting.records import DraftCampaign, DraftDrop, DraftFile, DraftSensor

__all__ = [
    "DetectedDrop",
    "Detection",
    "DraftCampaign",
    "DraftDrop",
    "DraftFile",
    "DraftSensor",
    "detect_drops",
    "draft",
    "wheel_score",
]
