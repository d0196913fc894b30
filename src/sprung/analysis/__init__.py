"""The analysis of a campaign: a list of stages through which one frozen record goes, from recordings to a result."""

from sprung.analysis.analysis import Analysis, AnalysisOptions
from sprung.analysis.design import to_design
from sprung.analysis.identify import identify, identify_campaign, result_of, with_amplitudes
from sprung.analysis.stages import STAGES, analyse

__all__ = [
    "STAGES",
    "Analysis",
    "AnalysisOptions",
    "analyse",
    "identify",
    "identify_campaign",
    "result_of",
    "to_design",
    "with_amplitudes",
]
