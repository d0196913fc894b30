"""The summit of the likelihood: where the joint fit ends, from starts of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.closed_form import Likelihood, LikelihoodAt
from sprung.estimation.modulating_functions import modulating_function_estimate
from sprung.estimation.overdispersion import birge_ratio, corrections
from sprung.estimation.priors import Coordinates, PriorsAndConstraints
from sprung.estimation.problem import CLOSE_BY, CONVERGED, FAR, NEARER, EstimationProblem, Iterate, least_information
from sprung.estimation.starts import VehicleSize, start_grid
from sprung.estimation.time_stepping import SteppedLikelihoodAt
from sprung.preprocess import FreeDecay
from sprung.progress import Progress, Step, silent
from sprung.uncertainty import KnownValue
from sprung.vehicle import LOAD_MASS, LinearModel, Rows, Sensor, separate_track_names

Real = NDArray[np.float64]

NEAR = 0.01
"""Expected gain in log-likelihood that is near enough while the decays may still change: a tenth of a standard error."""

_WELL_KNOWN = 1e4
"""Information of a logarithm from which a direction needs no looking around: one percent of uncertainty."""

_AROUND, _FARTHEST, _PROBED = (4.0, 8.0), 0.5, 2
"""How far to look, in standard errors and in logarithms, and along how many directions."""

_SHALLOW = 0.5
"""Part of the fall that the curvature says, below which the likelihood is worth another climb."""

STARTS = 3
"""How many starts are usually refined: enough to see whether they agree."""


@dataclass(frozen=True, eq=False)
class FitResult:
    """Where the fit of some decays ends.

    Attributes
    ----------
    climb
        The likelihood and what is known.
    point
        The place.
    steps
        Steps taken from the winning start.
    starts, starts_agreeing
        How many starts were refined, and how many of them ended here.
    """

    problem: EstimationProblem
    point: Iterate
    steps: int
    starts: int
    starts_agreeing: int

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters."""
        return self.problem.priors.coordinates.names

    @cached_property
    def values(self) -> Real:
        """Parameter values, SI, shape (parameter,)."""
        return self.problem.priors.coordinates.values(self.point.u)

    @property
    def parameters(self) -> dict[str, float]:
        """Parameter values, SI, by name."""
        return dict(zip(self.names, self.values.tolist(), strict=True))

    @property
    def converged(self) -> bool:
        """Whether the last step promised no further gain."""
        return self.point.converged

    @property
    def decays(self) -> Sequence[FreeDecay]:
        """What was fitted."""
        return self.problem.likelihood.decays

    @property
    def weights(self) -> Real:
        """1/σ² of each channel with which the states and the derivatives were computed, s⁴/m², shape (channel,)."""
        return self.point.weights

    @property
    def residual_sums(self) -> Real:
        """Residual sums of squares, (m/s²)², shape (drop, channel); 0 for channels that are left out."""
        return self.point.evaluation.residual

    @cached_property
    def fitted(self) -> tuple[Real, ...]:
        """Modelled records, their means subtracted, m/s²; one array of shape (channel, time) per drop."""
        return tuple(self.point.place.fitted(self.point.weights))

    @cached_property
    def residuals(self) -> tuple[Real, ...]:
        """Measured minus modelled, m/s²: one array of shape (channel, time) per drop, NaN for channels that are left out."""
        return tuple(_centred(decay.values - record) for decay, record in zip(self.decays, self.fitted, strict=True))

    @cached_property
    def noise(self) -> Real:
        """Noise level of each channel, m/s², shape (channel,)."""
        evaluation = self.point.evaluation
        noise: Real = np.sqrt(self.problem.variance(evaluation.residual, evaluation.leverage))
        return noise

    @property
    def loglikelihood(self) -> float:
        """Up to a constant."""
        return -0.5 * self.problem.cost(self.point)

    @property
    def absolute_loglikelihood(self) -> float:
        """Natural logarithm of the likelihood, with its constant: -½ Σ (ln 2πσ² + r²/σ²), and what is known uncertainly."""
        observations = self.problem.likelihood.observations.sum(axis=0)
        squares = self.point.evaluation.residual.sum(axis=0) / self.noise**2
        return self.loglikelihood - 0.5 * float(
            observations.sum() * np.log(2 * np.pi) + squares[observations > 0].sum()
        )

    @property
    def unknowns(self) -> int:
        """How many numbers the samples had to determine: parameters, noise levels, initial states, offsets and clocks."""
        observations = self.problem.likelihood.observations > 0
        free = self.problem.priors.free(self.point.u).shape[1]
        eliminated = round(float(self.point.evaluation.leverage.sum()))
        counted: int = free + int(observations.any(axis=0).sum()) + int(observations.sum()) + eliminated
        return counted

    @cached_property
    def disagreement(self) -> float:
        """By how much the drops contradict each other, as a factor on every variance; 1 where not significantly."""
        return birge_ratio(*self.problem.by_drop(self.point))

    @cached_property
    def states(self) -> Real:
        """{X, Ẋ} of each drop at the start of its decay, SI, shape (drop, state)."""
        return self.point.place.states(self.point.weights)

    def motion(self, drop: int, before: int, after: int) -> Real:
        """Return the motion of a drop around the start of its decay.

        Parameters
        ----------
        drop
            Its position.
        before, after
            How many samples before the first one, and how many from it on.

        Returns
        -------
        ndarray
            {X, Ẋ}, with forces that have a memory their memories too, SI, shape (state, time).
        """
        return self.point.place.motion(self.point.weights, drop, before, after)

    def residual_sums_of(self, decays: Sequence[FreeDecay]) -> Real:
        """Residual sums of squares of this vehicle on other decays, their initial states eliminated; as `residual_sums`."""
        return self._of(decays).misfit(self.point.weights)[0]

    def states_of(self, decays: Sequence[FreeDecay]) -> Real:
        """{X, Ẋ} of this vehicle at the start of other decays, SI, shape (drop, state)."""
        return self._of(decays).states(self.point.weights)

    def _of(self, decays: Sequence[FreeDecay]) -> LikelihoodAt | SteppedLikelihoodAt:
        return self.problem.likelihood.with_decays(decays).at(self.values)

    def clock_delays(self, covariance: Real) -> dict[int, tuple[Real, Real]]:
        """Return the estimated delays of the loggers' clocks.

        Parameters
        ----------
        covariance
            Of the parameters, SI, shape (parameter, parameter).

        Returns
        -------
        dict
            By the position of the drop the delays, s, shape (logger,), and their covariance; drops of one logger are not
            in it.
        """
        return self.point.place.delays(self.point.weights, covariance)

    @property
    def drop_corrections(self) -> tuple[Real, NDArray[np.int64]]:
        """Each drop's own correction to the joint estimate.

        In units of its standard errors, squared and summed, shape (drop,); and in how many directions it has information.
        """
        return corrections(*self.problem.by_drop(self.point))

    def after(self, before: FitResult) -> FitResult:
        """Give this summit with the history of the one before, from which it was reached."""
        steps = before.steps + self.steps
        return replace(self, steps=steps, starts=before.starts, starts_agreeing=before.starts_agreeing)


def _centred(record: Real) -> Real:
    centred: Real = record - record.mean(axis=1, keepdims=True)
    return centred


def fit_linear(
    decays: Sequence[FreeDecay],
    models: Mapping[str, LinearModel],
    sensors: Sequence[Sensor],
    known: Mapping[str, KnownValue],
    *,
    start: Mapping[str, float] | None = None,
    guess: Mapping[str, float] = MappingProxyType({}),
    starts: int = STARTS,
    enough: float = CONVERGED,
    progress: Progress = silent,
) -> FitResult:
    """Maximise the likelihood of all decays.

    Parameters
    ----------
    decays
        The decays, their channels in the order of `sensors`.
    models
        Equations of motion by load name, all over the same parameters.
    sensors
        The sensors.
    known
        Quantities measured beforehand: parameters, or derived ones as ``total_mass`` and ``wheelbase``.
    start
        Parameter values, SI, to start from; where it is left out, a direct start and the catalogue of usual vehicles.
    guess
        Values of some parameters, SI, where `start` is left out: the vehicle with them competes with those of the catalogue.
    starts
        How many are refined: the direct one where there is one, and those of the catalogue that explain the records best
        as they are. The best end wins.
    enough
        Expected gain in log-likelihood at which to stop.
    progress
        Called with each step that begins.

    Returns
    -------
    Summit
    """
    if start is None and any(decay.clocks for decay in decays):
        # As far as the release has told, all clocks are one: near enough for a start.
        together = [replace(decay, clocks=()) for decay in decays]
        first = fit_linear(together, models, sensors, known, guess=guess, starts=starts, enough=NEAR, progress=progress)
        progress(Step("setting the loggers' clocks"))
        apart = fit_linear(decays, models, sensors, known, start=first.parameters, enough=enough, progress=progress)
        return apart.after(first)
    outline = VehicleSize.of(known, sensors)
    engine = "m_e" in next(iter(models.values())).names
    masses = {name: one.value for name, one in known.items() if name.startswith(LOAD_MASS)}
    usual = (
        [masses | dict(start)] if start is not None else [one | masses for one in start_grid(outline, known, engine)]
    )
    problem = _climb(decays, models, sensors, known, usual[0])
    at = problem.priors.coordinates.by_name
    if start is not None:
        return _best(problem, [problem.maximise(problem.priors.bind(at(usual[0])), None, enough, CLOSE_BY)], enough)
    likelihood = problem.likelihood
    assert isinstance(likelihood, Likelihood)  # noqa: S101 (made above; for the type checker)
    nominal = [model.with_known(masses) for model in likelihood.model_of] if masses else likelihood.model_of
    direct = modulating_function_estimate(likelihood.records.runs, nominal, sensors, outline)
    tried = [] if direct is None else [(at(direct | masses), NEARER)]
    places = [at(values) for values in usual]
    if guess:
        places.insert(0, at(_completed(guess, {**usual[0], **(direct or {})})))
    if len(tried) < starts:
        progress(Step(f"rating {len(usual)} usual vehicles as starts"))
        order = np.argsort(problem.first_costs(likelihood, places), kind="stable")
        tried += [(places[i], FAR) for i in order[: starts - len(tried)]]
    ends: list[Iterate] = []
    for number, (u, damping) in enumerate(tried, start=1):
        progress(Step("fitting from a start", number, len(tried)))
        optimum = min(ends, key=problem.cost, default=None)
        ends.append(problem.maximise(problem.priors.bind(u), optimum, enough, damping))
    return _best(problem, ends, enough)


def _completed(guess: Mapping[str, float], usual: Mapping[str, float]) -> dict[str, float]:
    """Complete a guess by a usual vehicle's values; half-distances that it shares hold for springs and dampers apart too."""
    shared = {own: value for name, value in guess.items() for own in separate_track_names(name)}
    apart = {name: guess[f"{name}2"] for name in ("t_f", "t_r", "n_f", "n_r") if f"{name}2" in guess}
    return {**usual, **shared, **apart, **guess}


def escape_local_optimum(optimum: FitResult) -> FitResult:
    """Climb once more from both sides of a summit, along the directions that are known least.

    Where the records say little of a direction, the likelihood may have two summits a few standard errors apart, and every
    start may have ended on the lower one. It shows in a likelihood that falls less on that side than its curvature says.

    Parameters
    ----------
    summit
        Where the fit has ended.

    Returns
    -------
    Summit
        The highest that was found.
    """
    problem, best = optimum.problem, optimum.point
    information, _, free = problem.system(best)
    eigenvalues, vectors = np.linalg.eigh(information)
    weak = np.flatnonzero((eigenvalues > least_information(eigenvalues)) & (eigenvalues < _WELL_KNOWN))[:_PROBED]
    for which in weak:
        direction = free @ vectors[:, which]
        for distance in _AROUND:
            step = min(distance / eigenvalues[which] ** 0.5, _FARTHEST / np.abs(direction).max())
            for side in (-step, step):
                u = problem.priors.bind(optimum.point.u + side * direction)
                fall = problem.cost(problem.at(u)) - problem.cost(optimum.point)
                if fall < _SHALLOW * eigenvalues[which] * step**2:
                    best = min(best, problem.maximise(u, None, CONVERGED, NEARER), key=problem.cost)
    return optimum if best is optimum.point else replace(optimum, point=best, steps=optimum.steps + best.steps)


def score_linear_term(
    decays: Sequence[FreeDecay],
    models: Mapping[str, LinearModel],
    sensors: Sequence[Sensor],
    known: Mapping[str, KnownValue],
    values: Mapping[str, float],
) -> float:
    """Give what a model with more parameters would gain over one that is fitted already, without fitting it.

    Parameters
    ----------
    decays, models, sensors, known
        As for `fit_linear`, of the larger model.
    values
        Its parameters, SI, where it equals the fitted smaller one.

    Returns
    -------
    float
        In twice the log-likelihood, to second order: the score test (Rao, Proc. Camb. Phil. Soc. 44 (1948) 50).
    """
    problem = _climb(decays, models, sensors, known, values)
    point = problem.at(problem.priors.bind(problem.priors.coordinates.by_name(values)))
    return problem.slope(point).newton[1]


def _climb(
    decays: Sequence[FreeDecay],
    models: Mapping[str, LinearModel],
    sensors: Sequence[Sensor],
    known: Mapping[str, KnownValue],
    typical: Mapping[str, float],
) -> EstimationProblem:
    names = next(iter(models.values())).names
    likelihood = Likelihood(tuple(decays), models, Rows.of([sensor.row for sensor in sensors], names))
    return EstimationProblem(likelihood, PriorsAndConstraints(Coordinates.beside(names, typical), known))


def _best(problem: EstimationProblem, ends: Sequence[Iterate], enough: float) -> FitResult:
    best = min(ends, key=problem.cost)
    agreeing = sum(problem.cost(end) - problem.cost(best) < max(1e-3, 4 * enough) for end in ends)
    return FitResult(problem, best, best.steps, len(ends), agreeing)
