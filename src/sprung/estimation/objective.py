"""What is maximised: the likelihood of free decays under equations of motion, whichever way these are solved.

There are two: the closed form for linear vehicles, time stepping for those with nonlinear forces. What needs modal coordinates
asks for `ObjectiveAt.modal`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.starts import VehicleSize
from sprung.preprocess import FreeDecay
from sprung.vehicle import LinearModel, Readout, Sensor

if TYPE_CHECKING:
    from sprung.estimation.closed_form_likelihood import ClosedFormAt

Real = NDArray[np.float64]


class NoiseCoupling(NamedTuple):
    """How the noise of several channels mixes in their residuals, where unknowns are eliminated sample by sample.

    Attributes
    ----------
    expected
        Expected residual sums of squares of each channel by what noise of each adds, in units of 1/weight; (channel, channel).
    least
        Noise variance that a channel has at least, SI, shape (channel,): what is faster than all motions shows it.
    reference
        Noise variance of each channel with which likelihoods of several models are compared, SI, shape (channel,).
    restriction
        What the eliminated unknowns add to minus twice the log-likelihood at the present weights, beside the reference.
    """

    expected: Real
    least: Real
    reference: Real
    restriction: float


class Objective(Protocol):
    """The likelihood of some decays as a function of the parameters."""

    @property
    def decays(self) -> Sequence[FreeDecay]:
        """What is fitted."""

    @property
    def observations(self) -> Real:
        """Samples by drop and channel, 0 where a channel is left out; shape (drop, channel)."""

    @property
    def energy(self) -> Real:
        """Sum of squares of all centred records of each channel, (m/s²)², shape (channel,)."""

    def at(self, values: Real, weights: Real) -> ObjectiveAt:
        """Evaluate at parameter values, SI, shape (parameter,), with 1/σ² of each channel, s⁴/m², shape (channel,)."""

    def with_decays(self, decays: Sequence[FreeDecay]) -> Objective:
        """Return the objective of other decays with the same models and sensors."""


class LinearObjective(Objective, Protocol):
    """The likelihood of decays of a linear vehicle, or of records of one that is driven."""

    @property
    def sensors(self) -> Readout:
        """The sensors over the fit's parameters."""

    def with_decays(self, decays: Sequence[FreeDecay]) -> LinearObjective:
        """Return the objective of other records with the same models and sensors."""

    def with_models(self, models: Mapping[str, LinearModel], sensors: Readout) -> LinearObjective:
        """Return the objective of other models of the same records."""

    def of_fewer_lines(self) -> LinearObjective | None:
        """Return the objective of part of the records that leads fits from usual vehicles near their ends; None for none.

        It is to cost far less. Where the objective itself costs little, there is none.
        """

    def unexplained(self, vehicles: Real, weights: Real) -> Real:
        """Return what vehicles leave of some of the records, to rank them as starts.

        Parameters
        ----------
        vehicles
            Parameters, SI, shape (vehicle, parameter).
        weights
            1/σ² of each channel, SI, shape (channel,).

        Returns
        -------
        ndarray
            Residual sums of squares over their energy, dimensionless, shape (vehicle, channel).
        """

    def estimate_start(
        self, sensors: Sequence[Sensor], size: VehicleSize, given: Mapping[str, float]
    ) -> dict[str, float] | None:
        """Return the parameters of a vehicle near the one that is sought, SI by name, without any guess.

        Parameters
        ----------
        sensors
            As stated.
        size
            Size of the vehicle.
        given
            Parameters that are held at a value, SI, by name.

        Returns
        -------
        dict or None
            None where the records do not show it.
        """


class ObjectiveAt(Protocol):
    """A likelihood at parameter values and noise levels, initial states and offsets of all drops eliminated."""

    @property
    def values(self) -> Real:
        """Parameters, SI, shape (parameter,)."""

    @property
    def weights(self) -> Real:
        """1/σ² of each channel, s⁴/m², shape (channel,)."""

    @property
    def residual_sums(self) -> Real:
        """Residual sums of squares, (m/s²)², shape (drop, channel); infinite where the motion has no bounds."""

    @property
    def penalty(self) -> float:
        """Twice the negative log-likelihood of eliminated unknowns that have a prior."""

    @property
    def leverage(self) -> Real:
        """Number of eliminated unknowns that each channel determines, shape (channel,)."""

    @property
    def coupling(self) -> NoiseCoupling | None:
        """How the noise of channels mixes in their residuals; None where eliminated unknowns are few beside the samples."""

    @property
    def gradient(self) -> Real:
        """Of the log-likelihood by the parameters, per SI unit, shape (parameter,)."""

    @property
    def information(self) -> Real:
        """Fisher information of the parameters, shape (parameter, parameter)."""

    @property
    def by_drop(self) -> tuple[Real, Real]:
        """Gradient and information of each drop; shapes (drop, parameter) and (drop, parameter, parameter)."""

    @property
    def by_window(self) -> tuple[Real, Real] | None:
        """Gradient and information of each window of time, shapes (window, parameter) and (window, parameter, parameter).

        None where drops are not cut into windows.
        """

    @property
    def modal(self) -> ClosedFormAt | None:
        """The likelihood itself where it has modal coordinates, in which changes of the response are sums of exponentials."""

    @property
    def fitted(self) -> tuple[Real, ...]:
        """Modelled records, their means subtracted, m/s²; one array of shape (channel, time) per drop."""

    @property
    def states(self) -> Real:
        """{X, Ẋ} of each drop at its first sample, and memories of forces that have one, SI, shape (drop, state)."""

    @property
    def is_reversible(self) -> bool:
        """Whether the motion can be followed backward in time: friction cannot."""

    def reweighted(self, weights: Real) -> Self:
        """Return the likelihood with other weights; what does not depend on them is not computed again."""

    def damped(self, damping: float, /) -> tuple[Real, Real, float]:
        """Return information and gradient of the parameters for a step, and what eliminated unknowns gain by theirs.

        Where initial states are not eliminated exactly, they follow the parameters and step towards their maximum with so much
        damping.
        """

    def moved(self, values: Real, damping: float = 0.0, /) -> ObjectiveAt:
        """Return the likelihood at other parameter values.

        Where initial states are not eliminated exactly they are predicted, with so much damping.
        """

    def with_larger_model(
        self, models: Mapping[str, LinearModel], sensors: Readout, ways: Sequence[tuple[Real, Real]], /
    ) -> tuple[Real, Real] | None:
        """Return gradient and information of the parameters and of changes of a larger model behind them.

        Of coordinates that the fitted model has not, only the motion is considered that the others force on them.

        Parameters
        ----------
        models
            Equations of motion of the larger model by load name.
        sensors
            The sensors over its parameters.
        ways
            Several ways in which it equals the fitted one, or nearly so: its parameters, SI, shape (parameter,), and how much
            of each a change adds, shape (change, parameter).

        Returns
        -------
        gradient, information
            SI, the changes of all ways one after the other; shapes (parameter + change,) and its square. None where changes of
            the response have no closed form.
        """

    def with_optimal_states(self) -> ObjectiveAt:
        """Return the likelihood with the initial states that maximise it at these parameters."""

    def of_drop(self, drop: int) -> ObjectiveAt:
        """Return the likelihood of one drop alone, by its position."""

    def motion(self, drop: int, before: int, after: int) -> Real:
        """Motion of a drop from so many samples before its first to so many from it on, shape (state, time).

        {X, Ẋ}, and memories of forces that have one, SI; NaN before the first sample where motion cannot be followed backward.
        """
