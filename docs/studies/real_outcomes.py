"""What came of a campaign of which the truth is known: a real car's, or a rig's."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from types import FrameType
from typing import Any, NamedTuple

import numpy as np
from real_campaigns import Truth, record
from real_kinds import draw_test
from real_vehicle import PLAIN, Real

import sprung

SLOWEST = 0.05
"""m/s: the damper curve is judged from here on."""

WIDE = 4.0
"""Standard errors beyond which an error is named on a page."""


class Outcome(NamedTuple):
    """What came of one campaign.

    Attributes
    ----------
    kind, seed, type
        What it was drawn from, and the type of the vehicle.
    verdict, reason
        Of the result; ``failed`` and the exception where there is none.
    model
        Terms of the selected model.
    faults
        Code and place of each fault.
    errors
        Of each true parameter that was estimated: relative error, error in standard errors, and whether the 95 % interval
        holds the truth.
    missing
        True parameters without an estimate.
    curve
        Largest relative error of the damper curves between 0.05 m/s and the largest rate in the decays, and the largest in
        standard errors; NaN without curves.
    seconds
        Processor time.
    """

    kind: str
    seed: int
    type: str
    verdict: str
    reason: str
    model: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()
    errors: dict[str, tuple[float, float, bool]] = {}  # noqa: RUF012 (a named tuple's default, never changed)
    missing: tuple[str, ...] = ()
    curve: tuple[float, float] = (np.nan, np.nan)
    seconds: float = np.nan

    @property
    def worst(self) -> tuple[float, str]:
        """Largest relative error of a plain parameter, and its name."""
        plain = {name: abs(error[0]) for name, error in self.errors.items() if name in PLAIN}
        name = max(plain, key=lambda one: plain[one], default="")
        return plain.get(name, np.nan), name

    @property
    def worst_scaled(self) -> tuple[float, str]:
        """Largest error of any parameter in standard errors, and its name."""
        name = max(self.errors, key=lambda one: abs(self.errors[one][1]), default="")
        return (abs(self.errors[name][1]), name) if name else (np.nan, "")

    @property
    def is_right(self) -> bool:
        """Whether the vehicle was accepted, no fault was reported, and no error is wide."""
        return self.verdict == "accept" and not self.faults and self.worst_scaled[0] < WIDE


class TimeIsUpError(BaseException):
    """The limit of processor time is reached; no handler of ordinary errors stops it."""


@contextmanager
def limit_of(seconds: float) -> Iterator[None]:
    """Raise an error after so much processor time."""

    def stop(_signal: int, _frame: FrameType | None) -> None:
        raise TimeIsUpError(f"more than {seconds:g} s of processor time")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def examine(campaign: sprung.Campaign, truth: Truth, limit: float, **options: Any) -> Outcome:
    """Identify a car and hold the result against the truth; whatever fails is an outcome, too.

    Parameters
    ----------
    campaign, truth
        As recorded.
    limit
        Of processor time, s.
    options
        Of `sprung.identify`.
    """
    test = truth.test
    outcome, result = judge((test.kind, test.seed, test.car.name), campaign, truth.parameters, limit, **options)
    return outcome if result is None else outcome._replace(curve=_curve(result, truth))


def judge(
    drawn: tuple[str, int, str],
    campaign: sprung.Campaign,
    parameters: Mapping[str, float],
    limit: float,
    **options: Any,
) -> tuple[Outcome, sprung.Result | None]:
    """Identify a vehicle and hold the result against its parameters; return the result as well, None where it failed.

    Parameters
    ----------
    drawn
        Kind, seed and type.
    campaign
        As recorded.
    parameters
        True ones by their names in results, SI.
    limit, options
        As for `examine`.
    """
    started = time.process_time()
    try:
        with limit_of(limit):
            result = sprung.identify(campaign, **options)
    except TimeIsUpError as error:
        reason = str(error)
    except Exception as error:  # noqa: BLE001 (a crash is a row of the table)
        reason = f"{type(error).__name__}: {error}"
    else:
        errors, missing = _errors(result, parameters)
        outcome = Outcome(
            *drawn,
            result.verdict.state,
            result.verdict.reasons[0] if result.verdict.reasons else "",
            tuple(result.fit.model),
            tuple(f"{one.code} ({one.where})" for one in result.faults),
            errors,
            missing,
            seconds=time.process_time() - started,
        )
        return outcome, result
    return Outcome(*drawn, "failed", reason, seconds=time.process_time() - started), None


def examine_seeds(kind: str, seeds: Sequence[int], limit: float) -> list[Outcome]:
    """Record and identify several campaigns of a kind."""
    return [examine(*one, limit) for one in record([draw_test(kind, seed) for seed in seeds])]


def _errors(
    result: sprung.Result, parameters: Mapping[str, float]
) -> tuple[dict[str, tuple[float, float, bool]], tuple[str, ...]]:
    errors, missing = {}, []
    for name, true in parameters.items():
        found = result.parameters.get(name)
        if found is None or found.value is None or not found.std or found.interval95 is None:
            missing.append(name)
            continue
        low, high = found.interval95
        holds = (low is None or low <= true) and (high is None or true <= high)
        errors[name] = ((found.value - true) / true, (found.value - true) / found.std, holds)
    return errors, tuple(missing)


def _curve(result: sprung.Result, truth: Truth) -> tuple[float, float]:
    """Return the largest error of the damper curves, relative and in standard errors."""
    worst = [np.nan, np.nan]
    for axle, name in enumerate(("damper_front", "damper_rear")):
        out, back = truth.fastest[axle]
        rates: Real = np.concatenate([-np.geomspace(SLOWEST, back, 40), np.geomspace(SLOWEST, out, 40)])
        true = truth.test.car.damper_force(rates, axle)
        found = _damper(result, name, "fr"[axle], rates)
        if found is None:
            return np.nan, np.nan
        force, std = found
        worst[0] = np.fmax(worst[0], np.abs(force / true - 1).max())
        if np.all(std > 0):
            worst[1] = np.fmax(worst[1], np.abs((force - true) / std).max())
    return float(worst[0]), float(worst[1])


def _damper(result: sprung.Result, name: str, axle: str, rates: Real) -> tuple[Real, Real] | None:
    """Return the force of a damper and its standard error: its curve, or the line of a linear one."""
    curve = getattr(result, "curves", {}).get(name)
    if curve is not None:
        point = curve.at(rates)
        return np.asarray(point.force), np.asarray(point.std)
    linear = result.parameters.get(f"c_s{axle}")
    if linear is None or linear.value is None or f"r_{axle}" in result.parameters:
        return None
    return linear.value * rates, (linear.std or 0.0) * np.abs(rates)
