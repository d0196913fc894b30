"""Modes of vibration, their names, and sums of decaying exponentials: what estimation and modal analysis share."""

from sprung.vibration.exponential_sums import (
    BLOCK_LENGTH,
    correlate_with_exponentials,
    exponential_gram,
    exponential_moments,
    exponentials,
    real_product,
    split_into_blocks,
)
from sprung.vibration.modes import (
    EQUAL_ENTRIES,
    UNRESOLVED_FROM,
    Mode,
    ModeUncertainty,
    is_vibration,
    largest_entry,
    make_modes,
    modal_assurance_criterion,
    sort_modes,
)
from sprung.vibration.naming import (
    MODE_NAMES,
    compute_modes,
    expand_to_coordinates,
    name_modes,
    name_modes_at_sensors,
    paper_name,
)

__all__ = [
    "BLOCK_LENGTH",
    "EQUAL_ENTRIES",
    "MODE_NAMES",
    "UNRESOLVED_FROM",
    "Mode",
    "ModeUncertainty",
    "compute_modes",
    "correlate_with_exponentials",
    "expand_to_coordinates",
    "exponential_gram",
    "exponential_moments",
    "exponentials",
    "is_vibration",
    "largest_entry",
    "make_modes",
    "modal_assurance_criterion",
    "name_modes",
    "name_modes_at_sensors",
    "paper_name",
    "real_product",
    "sort_modes",
    "split_into_blocks",
]
