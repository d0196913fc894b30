"""Modes of campaigns, recordings and arrays, without a vehicle model."""

from sprung.modal_survey.load_modes import IdentifiedMode, LoadModes
from sprung.modal_survey.modes import ModesByLoad, modes
from sprung.modal_survey.recordings import is_recordings

__all__ = [
    "IdentifiedMode",
    "LoadModes",
    "ModesByLoad",
    "is_recordings",
    "modes",
]
