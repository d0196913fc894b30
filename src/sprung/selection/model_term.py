"""What the search needs to know of one model term: its practical effect, its usual size, and where a fit begins."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import numpy as np

from sprung.selection.description import TermDescription, Values
from sprung.selection.structure import ModelStructure
from sprung.vehicle import (
    COORDINATES,
    FULL,
    LINEAR_EXTRAS,
    NEUTRAL,
    PARAMETERS,
    REFINED,
    Layout,
    Tracks,
    coordinates,
    half_distances,
    layout_of,
    parameters_of_term,
)

StartValues = Callable[[Values, ModelStructure], Values]
"""From the fitted vehicle and the structure to fit, values of some parameters."""


@dataclass(frozen=True)
class ModelTerm:
    """One term that the model may have.

    Attributes
    ----------
    name
        As in campaign.toml and results.json.
    size
        Practical effect, dimensionless, from the parameters of a vehicle that has it; a sign means a direction only.
    typical, spread
        Usual size where the term is present, and the factor by which one standard deviation lies above or below it.
    description
        How a sentence states it.
    negligible
        Size, dimensionless, below which it changes nothing in practice: it is left out, however significant.
    explains_all
        Whether it resembles many a fault of sensors and loads, so that it has to explain the whole misfit.
    is_stationary
        Whether it does nothing to first order where it is neutral: its score says nothing there.
    resembles_others
        Whether records of a vehicle with it resemble those of every other term, so that it is tried first.
    usual
        Values that its parameters usually have, of a term that most vehicles have.
    held
        First letters of parameters that mean little where the term is small: a search that may find it small holds them close
        to their usual values.
    undefined
        Values of those parameters that have none where the term is absent.
    first
        Values with which a fit begins instead of the neutral ones.
    of_refined
        Values of the term that it refines from which a fit begins as well: without it that one was led astray.
    separates_tracks
        Whether it is that dampers and springs have half-distances of their own: where it is absent they are equal.
    character
        What tells it from other things that move alike: a natural frequency, Hz, relaxation times, s, velocities of knees, m/s,
        or by what part of it both sides differ; None where nothing does.
    band
        Lowest and highest value that its character has.
    counterpart
        Term that takes its place where its character is none of its kind: both move alike.
    part
        Part of the vehicle that has one of several laws, of which it is one: scores do not tell them apart.
    accompanies
        Term beside which most vehicles have this one as well, a tyre that stiffens its damping; empty where there is none.
    on_request
        Whether so few vehicles have it that it is in the model only where the campaign states it.
    """

    name: str
    size: Callable[[Values], float]
    typical: float
    spread: float
    negligible: float
    description: TermDescription
    explains_all: bool = False
    is_stationary: bool = False
    resembles_others: bool = False
    usual: StartValues | None = None
    held: str = ""
    undefined: StartValues | None = None
    first: StartValues | None = None
    of_refined: StartValues | None = None
    separates_tracks: bool = False
    character: Callable[[Values], Sequence[float]] | None = None
    band: tuple[float, float] = (0.0, np.inf)
    counterpart: str = ""
    part: str = ""
    accompanies: str = ""
    on_request: bool = False

    @property
    def is_linear(self) -> bool:
        """Whether mass, damping and stiffness matrices carry it."""
        return self.name in LINEAR_EXTRAS or self.separates_tracks

    @property
    def refines(self) -> str:
        """Term without which it is nothing, and whose law it changes; empty where there is none."""
        return REFINED.get(self.name, "")

    def is_usual_beside(self, terms: Collection[str]) -> bool:
        """Whether most vehicles with these terms have it as well, as a mount has its damping, and a tyre that stiffens.

        Parameters
        ----------
        terms
            Of the model.

        Returns
        -------
        bool
        """
        return self.usual is not None and bool({self.refines, self.accompanies} & {*terms})

    @property
    def adds_coordinates(self) -> bool:
        """Whether a vehicle with it moves in more coordinates than the paper's."""
        return len(coordinates(self.parameters("shared"))) > len(COORDINATES)

    @property
    def vibrates_by_itself(self) -> bool:
        """Whether it is a part with a natural frequency of its own, at a place that no score shows while it is nothing."""
        return self.explains_all and self.adds_coordinates

    def parameters(self, tracks: Tracks, layout: Layout = FULL) -> tuple[str, ...]:
        """Return the parameters that a model with the term has and one without it has not, or not free.

        Parameters
        ----------
        tracks
            Whether springs and dampers share their half-distance.
        layout
            Of the vehicle.
        """
        if self.separates_tracks:
            return tuple(damper for damper, _ in _tracks_apart(layout))
        return parameters_of_term(self.name, tracks, layout)

    def neutral(self, tracks: Tracks, layout: Layout = FULL) -> list[tuple[str, str | float]]:
        """Return what each parameter is where the term is absent: a value, or another parameter.

        Parameters
        ----------
        tracks, layout
            As for `parameters`.
        """
        if self.separates_tracks:
            return list(_tracks_apart(layout))
        return [(name, NEUTRAL[name]) for name in self.parameters(tracks, layout) if name in NEUTRAL]

    def not_negative(self, tracks: Tracks, layout: Layout = FULL) -> tuple[str, ...]:
        """Return the parameters that physics does not allow to be negative, though the fit does.

        Parameters
        ----------
        tracks, layout
            As for `parameters`.
        """
        about = {name: PARAMETERS[name] for name in self.parameters(tracks, layout)}
        return tuple(name for name, one in about.items() if not (one.positive or one.signed))

    def is_something_else(self, values: Values) -> bool:
        """Whether a part vibrates, relaxes or has its knee as none of its kind does.

        Parameters
        ----------
        values
            Of the vehicle that has it, SI.
        """
        if self.character is None:
            return False
        lowest, highest = self.band
        return not all(lowest <= one <= highest for one in self.character(values))

    def implausibility(self, size: float) -> float:
        """Minus twice the logarithm of the prior density of a size, 0 at the usual one.

        Log-normal with `typical` and `spread`; a size that is negligible is as implausible as the smallest that is not.
        """
        ratio = max(abs(size), self.negligible) / self.typical
        return float((np.log(ratio) / np.log(self.spread)) ** 2)


def of_axles(ratio: Callable[[Values, str], float]) -> Callable[[Values], float]:
    """Return the largest of the sizes of all axles."""
    return lambda values: max(abs(ratio(values, axle)) for axle in axles_of(values))


def axles_of(values: Values) -> tuple[str, ...]:
    """Return the indices of the axles of a vehicle, from its parameters."""
    return layout_of(values).axles


def _tracks_apart(layout: Layout) -> list[tuple[str, str]]:
    """Return the half-distances of dampers and springs of each axle."""
    names = half_distances("separate")
    return [(names[axle, "damper"], names[axle, "spring"]) for axle in layout.axles] if layout.rolls else []
