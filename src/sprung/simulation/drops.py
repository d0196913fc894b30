"""Drops from blocks, pushes and passes over a bump, as they would have been recorded."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from sprung.campaign import (
    DEFAULT_HEIGHT,
    Bump,
    Campaign,
    Drop,
    KnownValueLike,
    ModelChoice,
    Push,
    check_excitation,
    read_vehicle,
)
from sprung.errors import Problems
from sprung.progress import Progress, Step, counted, silent
from sprung.simulation.acting import Acting
from sprung.simulation.arguments import has_pads, record
from sprung.simulation.nonlinear_motion import simulate_nonlinear_drops
from sprung.simulation.pads import PadMotion, drive_on_pads
from sprung.simulation.setup import SimulationSetup, check_not_negative
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import Load, Motion, Sensor, Vehicle, after_rest, nonlinear_elements


def simulate(
    vehicle: Vehicle | str | os.PathLike[str],
    *,
    sensors: Sequence[Sensor | Mapping[str, Any]] | None = None,
    loads: Sequence[Load | Mapping[str, Any]] | None = None,
    drops: Sequence[Drop | Mapping[str, Any]] | None = None,
    rate: float = 500.0,
    noise: float | Mapping[str, float] = 0.02,
    seed: int | None = None,
    duration: float = 3.2,
    rest: float = 0.4,
    offset: float = 0.0,
    known: Mapping[str, KnownValueLike] | None = None,
    model: ModelChoice | Mapping[str, Any] | None = None,
    gravity: float = STANDARD_GRAVITY,
    sensor_errors: bool = False,
    push: Push | Mapping[str, Any] | None = None,
    bump: Bump | Mapping[str, Any] | None = None,
    pads: PadMotion | None = None,
    progress: Progress = silent,
) -> Campaign:
    """Simulate the drop tests of a vehicle, as they would have been recorded.

    The vehicle rests on its blocks, is released, loses and regains contact with the ground, and vibrates freely: all of
    it exact (`drop_from_blocks`), and only then measured with noise. So are a push (`push_body`) and a pass
    (`drive_over_bump`).

    Parameters
    ----------
    vehicle
        The vehicle; or the path of a vehicle file (``[vehicle]``, ``[parameters]`` in SI, ``[[sensor]]``, ``[[load]]`` and
        ``[[drop]]`` without files), whose sensors, loads, drops, known quantities and model hold where none are given here.
    sensors, loads, drops
        Records, or mappings as they stand in a campaign file. Defaults: eight sensors, four at the body's corners and
        one on each wheel; the empty vehicle; with each load a drop of all, front, rear, left and right wheels. A drop
        without a height is one from 0.05 m. The wheels of a push are those between which the body is pushed, those of a pass
        run over the bump, at 5 m/s where it has no speed.
    push, bump
        How the body is pushed in every push, and what is driven over in every pass; by hand and a half sine unless given
        or stated in the file.
    rate
        Samples per second.
    noise
        White noise, m/s² rms per sample: one number, or one for each channel by name. With 0 the records are exact.
    seed
        Of the noise; None gives other noise each time.
    duration, rest
        Seconds recorded after and before the release; of a push or a pass after the vehicle is let go or its last wheel has
        left the bump, and before it is first moved.
    offset
        Standard deviation of the zero-g offset that each channel draws in every drop, m/s².
    known
        Quantities known beforehand, SI, as in a campaign file. The wheelbase is always known, exactly where not given here.
    model
        What is said about the model to identify.
    gravity
        m/s².
    sensor_errors
        Whether gain, tilt, place and delay of each sensor deviate from what is stated, drawn from its ``gain_std``,
        ``tilt_std``, ``position_std`` and ``delay_std``. Without, all sensors are exact, and the campaign says so.
    pads
        How the pads under the wheels of a drop move whose excitation is ``pads``; a random motion of half a minute by default.
        Its duration holds instead of `duration` and `rest`.
    progress
        Called with each drop that is begun.

    Returns
    -------
    Campaign
        Every recording begins at time 0 and is released at ``rest``.

    Raises
    ------
    InputError
        If the file cannot be used, or something does not fit together; all faults at once.

    Examples
    --------
    >>> from sprung.vehicle import TABLE_1_CAR
    >>> campaign = simulate(TABLE_1_CAR, loads=[{"name": "sandbags", "added": {"mass": 140}}], seed=1)
    >>> [drop.label for drop in campaign.drops][4:6], campaign.recordings[0].values.shape
    (['empty_roll_right', 'sandbags_bounce'], (8, 1800))
    """
    file = None
    if not isinstance(vehicle, Vehicle):
        file = read_vehicle(vehicle)
        vehicle = file.vehicle
        sensors = file.sensors or None if sensors is None else sensors
        loads = file.loads if loads is None else loads
        drops = file.drops or None if drops is None else drops
        known = file.all_known if known is None else known
        model = file.model if model is None else model
        push = file.push if push is None else push
        bump = file.bump if bump is None else bump
    problems = Problems()
    setup = SimulationSetup.of(
        vehicle,
        sensors=sensors,
        loads=loads,
        drops=drops,
        rate=rate,
        noise=noise,
        offset=offset,
        gravity=gravity,
        known=known,
        model=model,
        problems=problems,
        sensor_errors=sensor_errors,
    )
    check_not_negative(problems, duration=duration, rest=rest)
    acting = Acting(
        record(Push, "push", push or {}, problems) or Push(),
        record(Bump, "bump", bump or {}, problems) or Bump(),
        gravity,
    )
    for excitation in (acting.push, acting.bump):
        check_excitation(excitation, "simulate", problems)
    pads = pads or PadMotion()
    pads.check(problems)
    is_linear = not nonlinear_elements(vehicle.tracks, vehicle.extras)
    if has_pads(setup.drops) and not is_linear:
        found = f"a vehicle with {', '.join(vehicle.extras)}"
        problems.add("simulate: drops", found, "a linear vehicle on pads that move", "Leave out its nonlinear terms.")
    problems.raise_if_any()

    before = math.ceil(rest * rate - 1e-9)
    first = max(before / rate - rest, 0.0)
    loaded = {load.name: load for load in setup.loads}
    driven = {
        i: drive_on_pads(
            vehicle, loaded[drop.load], drop.wheels, pads.displacements(drop.wheels, i), rate, pads.samples(rate)
        )
        for i, drop in enumerate(setup.drops)
        if drop.excitation == "pads"
    }
    released, motions = [], []
    for drop in counted(progress, "simulating the drops", [drop for drop in setup.drops if drop.excitation != "pads"]):
        height = DEFAULT_HEIGHT if drop.height is None and drop.excitation == "drop" else drop.height
        released.append(replace(drop, height=height))
        with problems.collect():
            motion = acting.motion(vehicle, loaded[drop.load], released[-1], duration + 1 / rate)
            after = round((rest + motion.driven_until + duration) * rate) - before
            motions.append(motion.motion(1 / rate, after, first))
    problems.raise_if_any()
    if released and not is_linear:
        progress(Step(f"simulating the drops with {', '.join(vehicle.extras)}"))
        lengths = [motion.displacement.shape[1] for motion in motions]
        starts = [acting.beginning(vehicle, loaded[drop.load], drop) for drop in released]
        whole = simulate_nonlinear_drops(vehicle, starts, 1 / rate, max(lengths), first, gravity)
        motions = [
            Motion(*(part[:, :length] for part in motion)) for motion, length in zip(whole, lengths, strict=True)
        ]
    free = ((drop, after_rest(motion, before)) for drop, motion in zip(released, motions, strict=True))
    recorded = [(drop, driven[i]) if i in driven else next(free) for i, drop in enumerate(setup.drops)]
    drops_in_order, motions_in_order = zip(*recorded, strict=True)
    campaign = setup.campaign(
        drops_in_order, motions_in_order, "drop from blocks", np.random.default_rng(seed), sensor_errors
    )
    return (
        campaign
        if file is None
        else replace(campaign, identification=file.identification, test=file.test, motion_ratio=file.motion_ratio)
    )
