"""Maximisation of likelihoods: one method for every fit of the program."""

from sprung.optimisation.levenberg_marquardt import (
    NONE_ELIMINATED,
    Maximisable,
    Maximum,
    NormalEquations,
    maximise,
)

__all__ = [
    "NONE_ELIMINATED",
    "Maximisable",
    "Maximum",
    "NormalEquations",
    "maximise",
]
