"""The one composition, its result, and the other walks: checking recordings, modes alone, what to measure next."""

from sprung.analysis.fitted import fit_campaign
from sprung.analysis.identify import Identification, identify, identify_campaign, result_of, with_amplitudes
from sprung.analysis.planned import to_design
from sprung.analysis.stand import Fitted

__all__ = [
    "Fitted",
    "Identification",
    "fit_campaign",
    "identify",
    "identify_campaign",
    "result_of",
    "to_design",
    "with_amplitudes",
]
