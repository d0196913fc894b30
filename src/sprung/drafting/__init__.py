"""A campaign drafted from its recordings: what they tell is written down, what they do not is marked as a gap."""

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
