"""Planning of a test of a vehicle, or of the next measurement after a campaign."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from sprung.analysis import AnalysisOptions, analyse, result_of, to_design
from sprung.campaign import (
    Campaign,
    CampaignSource,
    Drop,
    KnownValueLike,
    ModelChoice,
    is_vehicle_file,
    read_vehicle,
    resolve_campaign,
)
from sprung.errors import InputError, Problems
from sprung.planning import (
    MeasurementSetup,
    Plan,
    PlannedDrop,
    PlannedTest,
    TermCandidate,
    TermDetectability,
    detect_terms,
    tabulate_alternatives,
    tabulate_rejected,
)
from sprung.progress import Progress, Step, silent
from sprung.selection import TERMS, choose_structure, required_gain
from sprung.simulation import Acting, SimulationSetup
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import Load, Sensor, Vehicle

RATE, NOISE, DURATION = 500.0, 0.02, 3.2
"""Default sampling rate, Hz, noise, m/s² root-mean-square, and duration after the release, s."""


def plan(
    source: Vehicle | CampaignSource,
    *,
    wanted: float = 1.0,
    sensors: Sequence[Sensor | Mapping[str, Any]] | None = None,
    loads: Sequence[Load | Mapping[str, Any]] | None = None,
    drops: Sequence[Drop | Mapping[str, Any]] | None = None,
    rate: float | None = None,
    noise: float | Mapping[str, float] | None = None,
    duration: float | None = None,
    known: Mapping[str, KnownValueLike] | None = None,
    model: ModelChoice | Mapping[str, Any] | None = None,
    terms: bool = False,
    progress: Progress = silent,
) -> Plan:
    """Return the expected uncertainties of a test and of its alternatives, and the smallest sufficient one.

    Parameters
    ----------
    source
        An assumed vehicle, or the path of its vehicle file: a test of it is planned. Or a campaign, or its path: it is
        identified, and the plan says what to measure next; its first row is the campaign itself.
    wanted
        Largest acceptable standard uncertainty of any parameter, %.
    sensors, loads, drops, rate, noise, duration, known, model
        Of the planned test of a vehicle, as for `sprung.simulate`; by default those of the vehicle file, else 500 Hz,
        0.02 m/s² and 3.2 s. Not for a campaign, which has its own. Sensors that are stated are known to
        their standard uncertainties, as `identify` knows them; those by default are exact.
    terms
        Whether the plan says what the test, and the same with blocks twice as high, would show of each usual model term.
    progress
        Called with each step that begins.

    Returns
    -------
    Plan

    Raises
    ------
    InputError
        If a file is not usable, arguments are inconsistent, or the vehicle cannot be dropped so; with all faults.

    Examples
    --------
    >>> from sprung.vehicle import TABLE_1_CAR
    >>> plan(TABLE_1_CAR).next_step.labels
    ('total mass',)
    """
    problems = Problems()
    _check_wanted(wanted, problems)
    test: dict[str, object] = {"sensors": sensors, "loads": loads, "drops": drops, "rate": rate, "noise": noise}
    test |= {"duration": duration, "known": known, "model": model}
    if isinstance(source, Campaign) or not (isinstance(source, Vehicle) or is_vehicle_file(source)):
        for name, value in test.items():
            if value is not None:
                found = f"{value:g}" if isinstance(value, float | int) else type(value).__name__
                do = f"Leave {name} out, or plan from a vehicle."
                problems.add(f"plan: {name}", found, "nothing, because a campaign has its own", do)
        problems.raise_if_any()
        return _plan_further(resolve_campaign(source, progress), wanted, terms, progress)
    acting = Acting()
    if isinstance(source, Vehicle):
        vehicle = source
    else:
        file = read_vehicle(source)
        vehicle = file.vehicle
        sensors = file.sensors or None if sensors is None else sensors
        loads = file.loads if loads is None else loads
        drops = file.drops or None if drops is None else drops
        known = file.all_known if known is None else known
        model = file.model if model is None else model
        acting = Acting(file.push, file.bump)
    rate = RATE if rate is None else rate
    noise = NOISE if noise is None else noise
    duration = DURATION if duration is None else duration
    setup = SimulationSetup.of(
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
        sensor_errors=sensors is not None,
    )
    if any(drop.excitation == "pads" for drop in setup.drops):
        do = "Leave these drops out; simulate them and identify the vehicle for what they tell."
        problems.add("plan: drops", 'excitation = "pads"', "drops, pushes or passes", do)
    levels = setup.sensing.noise
    if not (levels > 0).all() and not any("noise" in problem.where for problem in problems):
        do = "Without noise every uncertainty is zero: give the noise of your sensors."
        problems.add("plan: noise", f"{float(levels.min())} m/s^2", "more than 0", do)
    if not (math.isfinite(duration) and duration > 0):
        problems.add("plan: duration", f"{duration} s", "a positive number", "Correct it.")
    if setup.model.tracks == "shared" and vehicle.tracks == "separate":
        found = "separate half-distances of springs and dampers"
        problems.add("plan: vehicle", f'{found} with tracks = "shared"', "one half-distance per axle", "Remove one.")
    _raise_as_plan(problems)

    statement = Campaign(
        name=vehicle.name,
        sensors=setup.sensing.sensors,
        drops=(),
        loads=setup.loads,
        vehicle_model=vehicle.model,
        wheelbase=setup.known.get("wheelbase"),
        cg_height=vehicle.cg_height,
        wheel_height=vehicle.wheel_height,
        roll_axis_height=vehicle.roll_axis_height,
        known={name: quantity for name, quantity in setup.known.items() if name != "wheelbase"},
        model=setup.model,
    )
    own = vehicle.extras
    choice = choose_structure(
        statement,
        setup.model.tracks or ("separate" if vehicle.tracks == "separate" else None),
        own if setup.model.extras is None else None,
    )
    measurement = MeasurementSetup(
        vehicle,
        choice.tracks,
        choice.terms,
        choice.known,
        choice.sensors,
        levels,
        rate,
        duration,
        acting=acting,
    )
    loaded = {load.name: load for load in setup.loads}
    planned = tuple(PlannedDrop.of(drop, loaded[drop.load]) for drop in setup.drops)
    return _tabulated(PlannedTest(measurement, planned), wanted, terms, progress)


def _plan_further(campaign: Campaign, wanted: float, terms: bool, progress: Progress) -> Plan:
    """Identify a vehicle, and return the plan of the next measurement."""
    run = analyse(campaign, AnalysisOptions(), progress)
    result = result_of(run)
    if result.verdict.state == "reject":
        rate = float(np.median([decay.rate for decay in run.decays]))
        return tabulate_rejected(campaign.name, wanted, result.fit.noise, rate, result.verdict.reasons)
    progress(Step("computing the bounds of the alternatives"))
    return _tabulated(to_design(run), wanted, terms, progress)


def _tabulated(test: PlannedTest, wanted: float, terms: bool, progress: Progress) -> Plan:
    """Return the plan of a test, with what it would show of model terms where that is wanted."""
    plan = tabulate_alternatives(test, wanted)
    if not terms:
        return plan
    progress(Step("simulating the drops with each usual model term"))
    higher = tuple(drop._replace(height=2 * drop.height) for drop in test.drops)
    found = {plan.rows[0].label: _terms_of(test.setup, test.drops)}
    if not any(drop.excitation == "drop" for drop in test.drops):
        return replace(plan, terms=found)
    try:
        found["blocks twice as high"] = _terms_of(test.setup, higher)
    except InputError as error:  # the recording ends before a vehicle that falls so far has come to rest
        progress(Step(f"blocks twice as high: {error.problems[0].found}"))
    return replace(plan, terms=found)


def _terms_of(setup: MeasurementSetup, drops: Sequence[PlannedDrop]) -> tuple[TermDetectability, ...]:
    """Return what drops would show of every term that most vehicles have and that the planned model has not."""
    own, samples = setup.vehicle.parameters, setup.duration * setup.rate * len(drops) * len(setup.sensors)
    model, layout = setup.vehicle.model, setup.vehicle.layout
    structure = choose_structure(
        Campaign(name=setup.vehicle.name, sensors=setup.sensors, drops=(), vehicle_model=model)
    )
    candidates = []
    for name, term in TERMS.items():
        if term.usual is None or term.refines or name in setup.extras or not term.parameters(setup.tracks, layout):
            continue
        values = {} if term.undefined is None else dict(term.undefined(own, structure))
        values |= term.usual(own, structure)
        values = {one: values[one] for one in term.parameters(setup.tracks, layout) if one in values}
        required = required_gain(len(values), len(TERMS), samples)
        candidates.append(TermCandidate(name, values, term.size({**own, **values}), required))
    return detect_terms(setup, drops, candidates)


def _check_wanted(wanted: float, problems: Problems) -> None:
    if not (math.isfinite(wanted) and wanted > 0):
        problems.add("plan: wanted", f"{wanted:g} %", "a positive percentage", "Give one, such as 1.")


def _raise_as_plan(problems: Problems) -> None:
    """Raise the problems, with the arguments of `simulate` named as those of `plan`."""
    if problems:
        raise InputError(replace(problem, where=re.sub(r"^simulate:", "plan:", problem.where)) for problem in problems)
