"""Sections of the report: the context of each template, or None where a result has nothing to show."""

from sprung.report.page.sections.drops import motions, recordings
from sprung.report.page.sections.geometry import geometry
from sprung.report.page.sections.numbers import characteristics, correlation, curves, known, parameters
from sprung.report.page.sections.provenance import literature, next_step, settings, trace
from sprung.report.page.sections.riding import riding
from sprung.report.page.sections.vibrations import amplitude, modes, spectra, stabilisation

__all__ = [
    "amplitude",
    "characteristics",
    "correlation",
    "curves",
    "geometry",
    "known",
    "literature",
    "modes",
    "motions",
    "next_step",
    "parameters",
    "recordings",
    "riding",
    "settings",
    "spectra",
    "stabilisation",
    "trace",
]
