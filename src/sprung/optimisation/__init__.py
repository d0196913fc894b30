"""Maximisation of likelihoods: one method for every fit of the program."""

from sprung.optimisation.levenberg_marquardt import (
    Maximisable,
    Maximum,
    NormalEquations,
    maximise,
)

__all__ = [
    "Maximisable",
    "Maximum",
    "NormalEquations",
    "maximise",
]
