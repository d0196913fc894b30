"""The joint fit beside what others would write, beside the least it could cost, and with ever more samples.

Run with `nox -s bench`. Every result is a ratio, in the ``extra_info`` of benchmarks/result.json.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest

import sprung
from measure import Run, Turns, peak_memory
from plain import PlainFit
from plain_stepped import PlainSteppedFit
from sprung.simulation import PadMotion
from sprung.vehicle import TABLE_1_CAR
from ten_drops import RATE, SAMPLES, Task, ten_drops, ten_rubbing_drops

TIMES = (1, 2, 4, 8, 16)
"""How many times as many samples."""

PADS = 60.0
"""s of a record on pads."""

SAME = 1e-4
"""Standard errors within which two fits have the same answer."""


@pytest.fixture(scope="module")
def task() -> Task:
    return ten_drops()


def exponentials(task: Task) -> np.ndarray[tuple[int, ...], np.dtype[np.complex128]]:
    """Return the fourteen exponentials of the empty vehicle, shape (time, 14)."""
    poles = np.linalg.eigvals(TABLE_1_CAR.matrices().state)
    return np.exp(np.arange(task.decays[0].samples)[:, None] / task.decays[0].rate * poles)


def test_beside_others(benchmark: Any, task: Task) -> None:
    """SciPy and lmfit are given a start and our noise levels, so that all three have the same sum to minimise."""
    ours = task.fit(starts=1)
    plain = PlainFit(task, TABLE_1_CAR.wheelbase, ours.noise)
    found: dict[str, np.ndarray[tuple[int, ...], np.dtype[np.float64]]] = {}
    turns = Turns(
        {
            "one start": (lambda: task.fit(starts=1), 15),
            "SciPy": (lambda: found.update(scipy=plain.by_scipy()), 1),
            "three starts": (lambda: task.fit(starts=3), 15),
            "lmfit": (lambda: found.update(lmfit=plain.by_lmfit()), 1),
            "identify": (lambda: sprung.identify(task.campaign), 5),
            "identify, no terms": (lambda: sprung.identify(task.campaign, extras=[]), 5),
        }
    )
    benchmark.pedantic(turns, rounds=7)

    # The same sum once more, from our end on, with central differences and no tolerance: where its least really is.
    finest = plain.by_scipy(ours.values, jac="3-point", xtol=1e-15, ftol=1e-15, gtol=1e-15)
    std = np.sqrt(np.diag(ours.covariance))

    def apart(one: Any, other: Any) -> float:
        return float(np.abs((one - other) / std).max())

    benchmark.extra_info["ratios"] = {
        "plain SciPy fit / whole fit from its own start": turns.ratio("SciPy", "one start", least=100),
        "plain SciPy fit / whole fit from three starts": turns.ratio("SciPy", "three starts"),
        "plain SciPy fit / sprung.identify": turns.ratio("SciPy", "identify", least=40),
        "plain SciPy fit / sprung.identify without model terms": turns.ratio("SciPy", "identify, no terms", least=80),
        "lmfit / whole fit from its own start": turns.ratio("lmfit", "one start"),
        "whole fit from three starts / from one": turns.ratio("three starts", "one start"),
        "sprung.identify / whole fit from its own start": turns.ratio("identify", "one start"),
    }
    benchmark.extra_info["seconds"] = {name: float(np.median(times)) for name, times in turns.seconds.items()}
    benchmark.extra_info["standard_errors"] = distances = {
        "SciPy, as timed": apart(found["scipy"], ours.values),
        "lmfit, as timed": apart(found["lmfit"], ours.values),
        "SciPy, polished": apart(finest, ours.values),
        "SciPy, as timed, from SciPy, polished": apart(found["scipy"], finest),
        "lmfit, as timed, from SciPy, polished": apart(found["lmfit"], finest),
    }
    assert distances["SciPy, as timed"] < SAME
    assert distances["SciPy, polished"] < SAME


def test_with_friction_beside_a_general_solver(benchmark: Any) -> None:
    """SciPy is given a start two percent beside our end, initial states at it, and our noise levels; we the linear fit."""
    task = ten_rubbing_drops()
    ours = task.found
    plain = PlainSteppedFit(task, ours.noise)
    found: dict[str, Any] = {}
    turns = Turns({"with friction": (task.fit, 1), "solve_ivp": (lambda: found.update(scipy=plain.fit()), 1)})
    benchmark.pedantic(turns, rounds=1)
    count = len(task.names)
    jacobian = found["scipy"].jac
    std = np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian))[:count])  # of the parameters' logarithms
    apart = np.abs(found["scipy"].x[:count] - np.log(ours.values)) / std
    benchmark.extra_info["ratios"] = {
        "solve_ivp and differences / whole fit with friction": turns.ratio("solve_ivp", "with friction", least=20),
    }
    benchmark.extra_info["standard_errors"] = {"solve_ivp, with friction": float(apart.max())}
    benchmark.extra_info["seconds"] = {name: float(np.median(times)) for name, times in turns.seconds.items()}


def test_on_pads_beside_drops(benchmark: Any) -> None:
    """A minute on four pads, each with displacement and force, beside ten drops of as many samples of the same sensors."""
    noise = {"acceleration": 0.02, "displacement": 5e-5, "force": 8.0}
    motion = PadMotion("random", duration=PADS)
    on_pads = sprung.simulate(TABLE_1_CAR, drops=[{"excitation": "pads"}], pads=motion, noise=noise, seed=1, rate=RATE)
    drops = [{"wheels": wheels} for wheels in (("fl", "fr"), ("rl", "rr"), ("fl", "rl"), ("fr", "rr"), ("fl",))]
    dropped = sprung.simulate(TABLE_1_CAR, drops=2 * drops, noise=0.02, seed=1, rate=RATE, duration=PADS / 10)
    turns = Turns(
        {
            "pads": (lambda: sprung.identify(on_pads), 1),
            "drops": (lambda: sprung.identify(dropped), 5),
            "pads, no terms": (lambda: sprung.identify(on_pads, extras=[]), 1),
            "drops, no terms": (lambda: sprung.identify(dropped, extras=[]), 5),
        }
    )
    benchmark.pedantic(turns, rounds=5, warmup_rounds=1)
    benchmark.extra_info["ratios"] = {
        "sprung.identify on pads / drops of as many samples": turns.ratio("pads", "drops", most=10),
        "the same without model terms": turns.ratio("pads, no terms", "drops, no terms", most=10),
    }


def test_beside_the_floor(benchmark: Any, task: Task) -> None:
    """No fit that looks at all samples is cheaper than one product of the records with the exponentials."""
    records, waves = task.stacked, exponentials(task)
    halves = waves.view(float)
    assert (records.shape, waves.shape) == ((80, SAMPLES), (SAMPLES, 14))
    turns = Turns(
        {
            "floor": (lambda: records @ waves, 60),
            "ours": (lambda: task.fit(starts=1), 5),
            "real floor": (lambda: records @ halves, 60),
        }
    )
    benchmark.pedantic(turns, rounds=25, warmup_rounds=1)
    benchmark.extra_info["ratios"] = {
        "whole fit from its own start / floor": turns.ratio("ours", "floor", most=60),
        "whole fit from its own start / floor in real arithmetic": turns.ratio("ours", "real floor"),
    }


def test_with_more_samples(benchmark: Any) -> None:
    """The same three seconds, sampled more often."""
    tasks = {times: ten_drops(times) for times in TIMES}
    floors = {times: (tasks[times].stacked, exponentials(tasks[times])) for times in TIMES}
    fits: dict[int, Run] = {times: partial(task.fit, 1) for times, task in tasks.items()}
    contestants: dict[str, tuple[Run, int]] = {}
    for times in TIMES:
        contestants[f"ours {times}"] = fits[times], 3
        contestants[f"floor {times}"] = partial(np.matmul, *floors[times]), 15
    turns = Turns(contestants)
    benchmark.pedantic(turns, rounds=9, warmup_rounds=1)

    best = np.array([turns.best(f"ours {times}") for times in TIMES])
    slopes = np.diff(np.log(best)) / np.diff(np.log(TIMES))
    benchmark.extra_info["samples"] = {
        str(times * SAMPLES): {
            "rate": times * RATE,
            "time": turns.ratio(f"ours {times}", "ours 1")["ratio"],
            "floors": turns.ratio(f"ours {times}", f"floor {times}")["ratio"],
            "memory": peak_memory(fits[times]) / tasks[times].nbytes,
        }
        for times in TIMES
    }
    slope = float(slopes[-1])
    memory = benchmark.extra_info["samples"][str(TIMES[-1] * SAMPLES)]["memory"]
    benchmark.extra_info["ratios"] = {
        "growth of time with samples, as a power, at the longest": {"ratio": slope, "most": 1.1},
        "memory of a fit / records, the longest": {"ratio": memory, "most": 3},
    }
    assert slope < 1.3  # on a busy machine, where 1.1 is what is wanted
