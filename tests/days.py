"""Whole days at a test track, as one logger would have recorded them: drops, and everything that is none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, lfilter

from sprung.simulation import simulate
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import Load, Sensor, Vehicle, Wheel

Real = NDArray[np.float64]
Disturbance = Literal["knock", "kick", "shaking", "slam", "jacking", "idling", "sitting down", "cable"]
DISTURBANCES: tuple[Disturbance, ...] = (
    "knock", "kick", "shaking", "slam", "jacking", "idling", "sitting down", "cable",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Day:
    """What was recorded, m/s², positive up, shape (channel, time), and when which wheels were let go, s."""

    values: Real
    rate: float
    sensors: tuple[Sensor, ...]
    releases: tuple[float, ...]
    wheels: tuple[tuple[Wheel, ...], ...]


def day(
    vehicle: Vehicle,
    wheels: tuple[tuple[Wheel, ...], ...],
    random: np.random.Generator,
    *,
    rate: float = 500.0,
    noise: float = 0.02,
    heights: tuple[float, float] = (0.03, 0.08),
    load: Load | None = None,
    high_pass: float | None = None,
    disturbances: int = 3,
    pause: tuple[float, float] = (4.0, 9.0),
) -> Day:
    """Record drops with pauses between them in which other things happen.

    Parameters
    ----------
    vehicle, wheels
        What is dropped, and on which wheels each time.
    random
        Where everything that is left to chance comes from.
    rate, noise
        Samples per second; m/s² rms.
    heights
        Of the blocks, from and to, m.
    load
        On the vehicle all day.
    high_pass
        Corner frequency of the sensors, Hz; None for sensors that feel gravity.
    disturbances
        How many before each drop and after the last.
    pause
        How long each takes with the quiet around it, from and to, s.
    """
    loads = [] if load is None else [load]
    drops = [
        {"wheels": each, "height": float(random.uniform(*heights)), "load": "empty" if load is None else load.name,
         "file": f"{i}.csv"}
        for i, each in enumerate(wheels)
    ]  # fmt: skip
    campaign = simulate(
        vehicle, loads=loads, drops=drops, rate=rate, noise=0, rest=0.5, duration=5.0, gravity=STANDARD_GRAVITY
    )
    stretches: list[Real] = []
    releases: list[float] = []
    sensors = campaign.sensors
    on_wheels = np.array([sensor.on != "body" for sensor in sensors])
    for recording in campaign.recordings:
        for _ in range(disturbances):
            stretches.append(anything(random, rate, on_wheels, pause))
        begun = sum(stretch.shape[1] for stretch in stretches)
        releases.append((begun + 0.5 * rate) / rate)
        stretches.append(recording.values - STANDARD_GRAVITY)
    for _ in range(disturbances):
        stretches.append(anything(random, rate, on_wheels, pause))
    moved = np.concatenate(stretches, axis=1)
    moved += noise * random.standard_normal(moved.shape)
    if high_pass is None:
        values = moved + STANDARD_GRAVITY * random.uniform(0.97, 1.03, (len(moved), 1))
    else:
        numerator, denominator = butter(1, high_pass, "highpass", fs=rate)
        values = np.asarray(lfilter(numerator, denominator, moved))
    return Day(values, rate, sensors, tuple(releases), wheels)


def anything(
    random: np.random.Generator, rate: float, on_wheels: NDArray[np.bool_], pause: tuple[float, float]
) -> Real:
    """Return some seconds in which anything happens but a drop, as `disturbed` does."""
    return disturbed(DISTURBANCES[int(random.integers(len(DISTURBANCES)))], random, rate, on_wheels, pause)


def disturbed(
    what: Disturbance,
    random: np.random.Generator,
    rate: float,
    on_wheels: NDArray[np.bool_],
    pause: tuple[float, float],
) -> Real:
    """Return some seconds of quiet with one disturbance in the middle, m/s², shape (channel, time)."""
    samples = int(random.uniform(*pause) * rate)
    time = np.arange(samples) / rate
    channels = on_wheels.size
    middle = 0.4 * time[-1]
    after = np.clip(time - middle, 0, None)
    one = np.zeros((channels, 1))
    one[int(random.integers(channels))] = 1.0
    share = random.uniform(0.3, 1.0, (channels, 1)) * random.choice([-1.0, 1.0], (channels, 1))
    match what:
        case "knock":  # a hammer on the frame: sharp, everywhere a little, and no more than 0.1 m/s
            frequency = random.uniform(0.2, 0.4) * rate
            ring = np.exp(-after * 60) * np.sin(2 * np.pi * frequency * after)
            moved = min(random.uniform(2, 40), 0.1 * 2 * np.pi * frequency) * share * ring
        case "kick":  # a foot against a wheel: a half-sine that gives it 0.1 to 0.3 m/s, and its hop
            width = random.uniform(0.005, 0.02)
            push = (
                np.where(after < width, np.sin(np.pi * after / width), 0.0)
                * random.uniform(0.1, 0.3)
                * np.pi
                / (2 * width)
            )
            hop = np.exp(-after * 20) * np.sin(2 * np.pi * 11 * after) * 6 * (after > 0)
            moved = one * random.choice([-1.0, 1.0]) * (push - hop) + 0.02 * share * hop
        case "shaking":  # somebody rocks the body at its own frequency
            rise = np.sin(np.pi * time / time[-1]) ** 2
            sway = rise * np.sin(2 * np.pi * random.uniform(1, 2) * time) * random.uniform(0.5, 4)
            moved = np.where(on_wheels[:, None], 0.05, 1.0) * share * sway
        case "slam":  # a door: the panels ring, the body rocks a little
            ring = np.exp(-after * 15) * np.sin(2 * np.pi * random.uniform(20, 45) * after)
            rock = np.exp(-after * 2) * np.sin(2 * np.pi * 1.5 * after) * (after > 0)
            moved = np.where(on_wheels[:, None], 0.1, 1.0) * share * (random.uniform(1, 8) * ring + 0.08 * rock)
        case "jacking":  # up in steps of half a second, with clicks
            step = 0.05 * np.sin(2 * np.pi * 2 * time) * np.sin(np.pi * time / time[-1])
            clicks = np.zeros(samples)
            clicks[:: max(int(0.5 * rate), 1)] = random.uniform(0.5, 5)
            moved = share * (step + clicks * random.uniform(0, 1, samples))
        case "idling":
            moved = share * random.uniform(0.1, 1.5) * np.sin(2 * np.pi * random.uniform(15, 30) * time)
            moved *= np.sin(np.pi * time / time[-1])
        case "sitting down":  # the body is pushed down, and swings
            width = 0.3
            push = np.where(after < width, -np.sin(np.pi * after / width), 0.0) * random.uniform(0.3, 1.5)
            swing = np.exp(-after * 3) * np.sin(2 * np.pi * 1.3 * after) * random.uniform(0.1, 0.4)
            moved = np.where(on_wheels[:, None], 0.05, 1.0) * np.abs(share) * (push + swing)
        case "cable":  # one sensor's cable is stepped on
            moved = one * random.uniform(5, 200) * np.where(after < 0.004, after > 0, 0.0) * random.choice([-1.0, 1.0])
    return np.asarray(moved, dtype=np.float64)
