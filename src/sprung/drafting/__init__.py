"""Drafting of a campaign file from recordings: drops are detected, sensors and loads recognised, gaps left to fill in."""

from sprung.drafting.detected_drop import DetectedDrop, wheel_score
from sprung.drafting.detection import Detection, detect_drops
from sprung.drafting.draft import draft, draft_campaigns
from sprung.drafting.draft_campaign import DraftCampaign
from sprung.drafting.records import DraftDrop, DraftFile, DraftSensor

__all__ = [
    "DetectedDrop",
    "Detection",
    "DraftCampaign",
    "DraftDrop",
    "DraftFile",
    "DraftSensor",
    "detect_drops",
    "draft",
    "draft_campaigns",
    "wheel_score",
]
