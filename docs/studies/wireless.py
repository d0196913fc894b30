"""Campaigns that several loggers recorded, each with a clock, a rate and a start of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import sprung
from sprung.campaign import Campaign, Recording, merge_loggers
from sprung.simulation import default_sensors, drop_from_blocks
from sprung.uncertainty import KnownValue
from sprung.vehicle import TABLE_1_CAR, Load, Vehicle, parse_record, sensor_rows

Real = NDArray[np.float64]

REST, AFTER = 0.6, 2.9
"""s that a logger records before and after the release, if it starts when it should."""

BAGS = parse_record(
    Load,
    {
        "name": "bags",
        "items": [{"mass": 80, "position": (-1.0, 0.4, 0.5)}, {"mass": 60, "position": (-2.0, -0.4, 0.5)}],
    },
)


class Wireless(NamedTuple):
    """A campaign of eight loggers, and how their clocks truly stood.

    Attributes
    ----------
    campaign
        Its recordings have parts.
    ahead
        What each logger's clock shows at the release, less that time on a true clock that shows zero then; s, shape (drop,
        logger).
    together
        The same drops as one logger would have recorded them, with the same information in every channel.
    """

    campaign: Campaign
    ahead: Real
    together: Campaign


def wireless(
    vehicle: Vehicle = TABLE_1_CAR,
    *,
    rates: Sequence[float] = (500.0,) * 8,
    apart: float = 0.5,
    drift: float = 50e-6,
    noise: float = 0.02,
    seed: int = 1,
    loads: Sequence[Load] = (BAGS,),
) -> Wireless:
    """Simulate a campaign in which every sensor is a logger of its own.

    Parameters
    ----------
    vehicle
        The vehicle.
    rates
        Samples per second of each logger on its own clock.
    apart
        s within which the loggers are started.
    drift
        Largest part by which a logger's clock is fast or slow.
    noise
        m/s² rms.
    seed
        Of the noise and the clocks.
    loads
        The loads.
    """
    known = {"total_mass": vehicle.total_mass}
    # Fewer samples tell as much as more of them with more noise.
    fastest = max(rates)
    levels = {
        sensor.channel: noise * (fastest / rate) ** 0.5
        for sensor, rate in zip(default_sensors(vehicle), rates, strict=True)
    }
    together = sprung.simulate(
        vehicle, noise=levels, seed=seed, rate=fastest, rest=REST, duration=AFTER, loads=loads, known=known
    )
    random = np.random.default_rng(seed)
    parameters = vehicle.parameters
    S = sensor_rows(together.sensors, tuple(parameters)).at(np.array(list(parameters.values())))
    fast = 1 + drift * random.uniform(-1, 1, len(S))
    drops, ahead = [], []
    for drop in together.drops:
        one = drop.recording
        height = drop.height or 0.05
        fall = drop_from_blocks(vehicle, together.load(drop.load), drop.wheels, height, duration=AFTER + apart)
        begins = -REST + apart * random.uniform(-0.5, 0.5, len(S))
        shown = random.uniform(-1000, 1000, len(S))
        parts = []
        for channel, row in enumerate(S):
            step, samples = 1 / rates[channel] / fast[channel], int(rates[channel] * (REST + AFTER - apart / 2))
            first = int(np.ceil(-begins[channel] / step))
            moving = row @ fall.motion(step, samples - first, begins[channel] + first * step).acceleration
            values = 9.80665 + np.concatenate([np.zeros(first), moving]) + noise * random.standard_normal(samples)
            name = f"{drop.label}_{one.channels[channel]}.csv"
            parts.append(Recording(name, (one.channels[channel],), values[None], float(shown[channel]), rates[channel]))
        ahead.append(shown - begins * fast)
        whole = Recording(f"{drop.label}*", one.channels, np.empty((len(S), 0)), 0.0, 1.0, parts=tuple(parts))
        recording = merge_loggers(whole, [part.start for part in parts])
        drops.append(replace(drop, file=None, files=tuple(part.name for part in parts), recording=recording))
    campaign = replace(together, drops=tuple(drops), known={"total_mass": KnownValue(vehicle.total_mass)})
    return Wireless(campaign, np.array(ahead), together)
