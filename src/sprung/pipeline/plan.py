"""From a vehicle, or a campaign that is done, to the table of what could be measured next."""

from __future__ import annotations

import math
import os
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from sprung.errors import InputError, Problems
from sprung.pipeline.choice import choose_model
from sprung.pipeline.fitted import fit_campaign
from sprung.pipeline.identify import result_of
from sprung.pipeline.planned import as_test
from sprung.planning import Plan, PlannedDrop, PlannedTest, Subject, draw_up, draw_up_rejected
from sprung.progress import Progress, Step, silent
from sprung.recording import Campaign, Drop, ModelChoice, read, read_vehicle
from sprung.simulation import DEFAULT_HEIGHT, Given, Setup
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import Load, Sensor, Vehicle

RATE, NOISE = 500.0, 0.02
"""Samples per second and m/s² root-mean-square where nobody says."""


def plan(
    vehicle: Vehicle,
    *,
    wanted: float = 1.0,
    sensors: Sequence[Sensor | Mapping[str, Any]] | None = None,
    loads: Sequence[Load | Mapping[str, Any]] | None = None,
    drops: Sequence[Drop | Mapping[str, Any]] | None = None,
    rate: float = RATE,
    noise: float | Mapping[str, float] = NOISE,
    duration: float = 3.2,
    known: Mapping[str, Given] | None = None,
    model: ModelChoice | Mapping[str, Any] | None = None,
) -> Plan:
    """Say what a planned test of a vehicle would tell, what its alternatives would, and which of them is enough.

    Parameters
    ----------
    vehicle
        As it is thought to be.
    wanted
        Percent that the standard uncertainty of no parameter is to exceed.
    sensors, loads, drops, rate, noise, duration, known, model
        Of the planned test, as for `sprung.simulate`.

    Returns
    -------
    Plan

    Raises
    ------
    InputError
        If something does not fit together, or the vehicle cannot be dropped so; all faults at once.

    Examples
    --------
    >>> from sprung.vehicle import TABLE_1_CAR
    >>> plan(TABLE_1_CAR).next_step.labels
    ('total mass',)
    """
    problems = Problems()
    _check_wanted(wanted, problems)
    setup = Setup.of(
        vehicle,
        sensors=sensors,
        loads=loads,
        drops=drops,
        rate=rate,
        noise=noise,
        offset=0.0,
        gravity=STANDARD_GRAVITY,
        known=known,
        model=model,
        problems=problems,
    )
    levels = setup.sensing.noise
    if not (levels > 0).all() and not any("noise" in problem.where for problem in problems):
        do = "Without noise everything that can be told is told exactly: give that of your sensors."
        problems.add("plan: noise", f"{float(levels.min())} m/s^2", "more than 0", do)
    if not (math.isfinite(duration) and duration > 0):
        problems.add("plan: duration", f"{duration} s", "a positive number", "Correct it.")
    if setup.model.tracks == "shared" and vehicle.tracks == "separate":
        found = "half-distances of springs and dampers apart"
        problems.add("plan: vehicle", f'{found} with tracks = "shared"', "one half-distance per axle", "Remove one.")
    _raise_as_plan(problems)

    statement = Campaign(
        name=vehicle.name,
        sensors=setup.sensing.sensors,
        drops=(),
        recordings=(),
        loads=setup.loads,
        wheelbase=setup.known["wheelbase"],
        cg_height=vehicle.cg_height,
        wheel_height=vehicle.wheel_height,
        roll_axis_height=vehicle.roll_axis_height,
        known={name: quantity for name, quantity in setup.known.items() if name != "wheelbase"},
        model=setup.model,
    )
    own = vehicle.extras
    choice = choose_model(
        statement,
        setup.model.tracks or ("separate" if vehicle.tracks == "separate" else None),
        own if setup.model.extras is None else None,
    )
    subject = Subject(
        vehicle, choice.tracks, choice.extras, choice.known, setup.sensing.sensors, levels, rate, duration
    )
    loaded = {load.name: load for load in setup.loads}
    planned = tuple(PlannedDrop(loaded[drop.load], drop.wheels, drop.height or DEFAULT_HEIGHT) for drop in setup.drops)
    return draw_up(PlannedTest(subject, planned), wanted)


def plan_campaign(campaign: Campaign, *, wanted: float = 1.0, progress: Progress = silent) -> Plan:
    """Identify a vehicle, and say what to measure next.

    Parameters
    ----------
    campaign
        From `sprung.read` or `sprung.simulate`.
    wanted
        Percent that the standard uncertainty of no parameter is to exceed.
    progress
        Called with each step that begins.

    Returns
    -------
    Plan
        Its first row is what the campaign has told; vehicle, noise and drops are those that were found in it. Of a rejected
        campaign the reasons alone.

    Raises
    ------
    InputError
        If no drop can be used, or what is known contradicts the model that is wanted.
    """
    problems = Problems()
    _check_wanted(wanted, problems)
    problems.raise_if_any()
    campaign.require_complete()
    fitted = fit_campaign(campaign, progress=progress)
    result = result_of(fitted, progress=progress)
    if result.verdict.state == "reject":
        rate = float(np.median([decay.rate for decay in fitted.prepared.decays]))
        return draw_up_rejected(campaign.name, wanted, result.fit.noise, rate, result.verdict.reasons)
    progress(Step("computing the bounds of the alternatives"))
    return draw_up(as_test(fitted), wanted)


def plan_file(
    path: str | os.PathLike[str],
    *,
    wanted: float = 1.0,
    rate: float | None = None,
    noise: float | None = None,
    progress: Progress = silent,
) -> Plan:
    """Say what to measure, from a vehicle file or a campaign.

    Parameters
    ----------
    path
        A vehicle file, a campaign file, or the folder of one.
    wanted
        Percent that the standard uncertainty of no parameter is to exceed.
    rate, noise
        Samples per second, and m/s² root-mean-square of every channel: for a vehicle file alone, 500 and 0.02 unless
        given; a campaign has its own.
    progress
        Called with each step that begins.

    Returns
    -------
    Plan

    Raises
    ------
    InputError
        If the file cannot be used; all faults at once.
    """
    path = Path(path)
    if not _describes_vehicle(path):
        problems = Problems()
        _check_wanted(wanted, problems)
        for name, value in (("rate", rate), ("noise", noise)):
            if value is not None:
                do = f"Leave {name} out, or plan from a vehicle file."
                problems.add(f"plan: {name}", f"{value:g}", "nothing: a campaign brings its own along", do)
        problems.raise_if_any()
        return plan_campaign(read(path, progress=progress), wanted=wanted, progress=progress)
    file = read_vehicle(path)
    known = dict(file.known) if file.wheelbase is None else {**file.known, "wheelbase": file.wheelbase}
    return plan(
        file.vehicle,
        wanted=wanted,
        sensors=file.sensors or None,
        loads=file.loads,
        drops=file.drops or None,
        rate=RATE if rate is None else rate,
        noise=NOISE if noise is None else noise,
        known=known,
        model=file.model,
    )


def _describes_vehicle(path: Path) -> bool:
    """Tell a vehicle file, which has the section ``[parameters]``; what cannot be read is left to who reads it."""
    try:
        return "parameters" in tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    except (OSError, ValueError):
        return False


def _check_wanted(wanted: float, problems: Problems) -> None:
    if not (math.isfinite(wanted) and wanted > 0):
        problems.add("plan: wanted", f"{wanted:g} %", "a positive percentage", "Give one, such as 1.")


def _raise_as_plan(problems: Problems) -> None:
    """Raise what was found, naming the arguments of `simulate` as those of `plan`."""
    if problems:
        raise InputError(replace(one, where=re.sub(r"^simulate:", "plan:", one.where)) for one in problems)
