"""A campaign drafted from its recordings: what they tell is written down, what they do not is marked as a gap."""

from sprung.drafting.draft import draft
from sprung.drafting.records import Draft, DraftDrop, DraftFile, DraftSensor

__all__ = [
    "Draft",
    "DraftDrop",
    "DraftFile",
    "DraftSensor",
    "draft",
]
