"""What each part of the report shows: the context of its template, or None where a result has nothing for it."""

from sprung.report.sections.drops import motions, recordings
from sprung.report.sections.geometry import geometry
from sprung.report.sections.numbers import characteristics, correlation, known, parameters
from sprung.report.sections.provenance import literature, next_step, settings, trace
from sprung.report.sections.vibrations import amplitude, modes, spectra, stabilisation

__all__ = [
    "amplitude",
    "characteristics",
    "correlation",
    "geometry",
    "known",
    "literature",
    "modes",
    "motions",
    "next_step",
    "parameters",
    "recordings",
    "settings",
    "spectra",
    "stabilisation",
    "trace",
]
