"""What goes wrong with a sensor, done to a campaign that was sound."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from campaigns import Real
from fleet import VehicleTest
from scipy.signal import bilinear, butter, lfilter, lfilter_zi

import sprung
from sprung.units import STANDARD_GRAVITY as G

Lines = list[list[str]]
"""A text table: the head, and a line for each sample; cells without their separators."""


@dataclass(frozen=True, eq=False)
class Injured:
    """A campaign with something wrong.

    Attributes
    ----------
    campaign
        As far as it is wrong in memory.
    names
        Channels, recordings and loads that whoever names the fault has to name, all of them.
    file, rewrite
        The recording whose file is changed before the campaign is read back, and how; None where nothing is.
    """

    campaign: sprung.Campaign
    names: tuple[str, ...]
    file: str | None = None
    rewrite: Callable[[Lines], Lines] | None = None


Act = Callable[[VehicleTest, sprung.Campaign, np.random.Generator], Injured | None]
"""Spoil a campaign of a test; None where the test has nothing that could be spoilt so."""


@dataclass(frozen=True)
class Injury:
    """One way of going wrong.

    Attributes
    ----------
    name
        Short.
    codes
        The fault's code, and others that say the same.
    what
        What is done, in words.
    act
        Does it; a random generator chooses where, and how much.
    refused
        What the refusal of such a campaign has to say, where it is to be refused.
    """

    name: str
    codes: tuple[str, ...]
    what: str
    act: Act
    refused: str | None = None


Change = Callable[[Real], Real]


def changed(
    campaign: sprung.Campaign, channels: Iterable[int], how: Change, only: int | None = None
) -> sprung.Campaign:
    """Change what some channels read, shape (time,) each, in every recording or in only one."""
    recordings = []
    for i, one in enumerate(campaign.recordings):
        values = one.values.copy()
        for channel in channels if only in (None, i) else ():
            values[channel] = how(values[channel])
        recordings.append(replace(one, values=values))
    return campaign.with_recordings(recordings)


def of_kind(campaign: sprung.Campaign, kind: str) -> list[int]:
    """Return the channels on ``body`` or ``wheel``, or with ``DC`` or ``AC`` coupling."""
    tests: dict[str, Callable[[sprung.Sensor], bool]] = {
        "any": lambda _: True,
        "body": lambda one: one.on == "body",
        "wheel": lambda one: one.on != "body",
        "DC": lambda one: one.high_pass is None,
        "AC": lambda one: one.high_pass is not None,
    }
    return [i for i, one in enumerate(campaign.sensors) if tests[kind](one)]


def everywhere(kind: str, how: Callable[[np.random.Generator, float], Change]) -> Act:
    """Make an injury of one channel of a kind in all drops; `how` receives the samples per second."""

    def act(test: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured | None:
        channels = of_kind(campaign, kind)
        if not channels:
            return None
        channel = int(random.choice(channels))
        changes = changed(campaign, [channel], how(random, test.rate))
        return Injured(changes, (campaign.sensors[channel].channel,))

    return act


def once(how: Callable[[np.random.Generator, VehicleTest], Change]) -> Act:
    """Make an injury of any one channel in any one drop."""

    def act(test: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured:
        drop, channel = int(random.integers(len(campaign.drops))), int(random.integers(len(campaign.sensors)))
        changes = changed(campaign, [channel], how(random, test), drop)
        return Injured(changes, (campaign.sensors[channel].channel, campaign.recordings[drop].name))

    return act


def clipped(kind: str) -> Act:
    """Reduce the range of a sensor so that it clips at the landing and after it."""

    def act(test: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured:
        channel = int(random.choice(of_kind(campaign, kind)))
        rest, decay = 0.0 if campaign.sensors[channel].high_pass else G, int((test.rest + 0.25) * test.rate)
        peak = max(float((one.values[channel, decay:] - rest).max()) for one in campaign.recordings)
        limit = rest + peak * random.uniform(0.4, 0.8)
        changes = changed(campaign, [channel], lambda values: np.clip(values, -limit, limit))
        return Injured(changes, (campaign.sensors[channel].channel,))

    return act


def exchanged(first: str, second: str, in_one: bool = False) -> Act:
    """Exchange two channels of two kinds, in all drops or in one."""

    def act(_: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured:
        one = int(random.choice(of_kind(campaign, first)))
        other = int(random.choice([i for i in of_kind(campaign, second) if i != one]))
        drop = int(random.integers(len(campaign.drops)))
        order = np.arange(len(campaign.sensors))
        order[[one, other]] = other, one
        recordings = tuple(
            replace(each, values=each.values[order]) if not in_one or i == drop else each
            for i, each in enumerate(campaign.recordings)
        )
        names = tuple(campaign.sensors[i].channel for i in (one, other))
        where = (*names, campaign.recordings[drop].name) if in_one else names
        return Injured(campaign.with_recordings(recordings), where)

    return act


def copied(_: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured:
    """Record a channel from the sensor of another one, in all drops."""
    one, other = random.choice(len(campaign.sensors), 2, replace=False).tolist()
    order = np.arange(len(campaign.sensors))
    order[one] = other
    recordings = tuple(replace(each, values=each.values[order]) for each in campaign.recordings)
    return Injured(campaign.with_recordings(recordings), (campaign.sensors[one].channel,))


def through(values: Real, corner: float, test: VehicleTest) -> Real:
    """Send what a sensor reads through a first-order high-pass that settled long before the release, corner in Hz."""
    numerator, denominator = butter(1, corner, "highpass", fs=test.rate)
    level = values[: int(0.9 * test.rest * test.rate)].mean()
    return np.asarray(lfilter(numerator, denominator, values - level), dtype=np.float64)


def corner_unstated(kind: str, every: bool = False) -> Act:
    """Remove the stated high-pass of one or all AC-coupled sensors, or filter DC-coupled ones at 0.05 to 2 Hz."""

    def act(test: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured | None:
        chosen = of_kind(campaign, kind)
        if not chosen:
            return None
        chosen = chosen if every else [int(random.choice(chosen))]
        names = tuple(campaign.sensors[i].channel for i in chosen)
        if kind == "DC":
            corner = float(np.exp(random.uniform(np.log(0.05), np.log(2.0))))
            return Injured(changed(campaign, chosen, lambda values: through(values, corner, test)), names)
        sensors = [replace(one, high_pass=None) if i in chosen else one for i, one in enumerate(campaign.sensors)]
        return Injured(replace(campaign, sensors=tuple(sensors)), names)

    return act


def corner_misstated(_: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured | None:
    """State twice or half the corner of a sensor's high-pass."""
    chosen = of_kind(campaign, "AC")
    if not chosen:
        return None
    i = int(random.choice(chosen))
    stated = (campaign.sensors[i].high_pass or 0.0) * float(random.choice([0.5, 2.0]))
    sensors = [replace(one, high_pass=stated) if one is campaign.sensors[i] else one for one in campaign.sensors]
    return Injured(replace(campaign, sensors=tuple(sensors)), (campaign.sensors[i].channel,))


def late(random: np.random.Generator, rate: float) -> Change:
    """Delay by 3 to 10 ms, whole samples."""
    by = max(round(random.uniform(0.003, 0.010) * rate), 1)
    return lambda values: np.concatenate([values[:by], values[:-by]])


def low_pass(random: np.random.Generator, rate: float) -> Change:
    """Pass a low-pass of first or second order at 30 to 50 Hz, four times as fast as the samples."""
    numerator, denominator = butter(int(random.integers(1, 3)), random.uniform(30, 50), fs=4 * rate)

    def how(values: Real) -> Real:
        finer = np.interp(np.arange(4 * values.size) / 4, np.arange(values.size), values)
        begin = lfilter_zi(numerator, denominator) * finer[0]
        return np.asarray(lfilter(numerator, denominator, finer, zi=begin)[0][::4])

    return how


def walk(random: np.random.Generator, rate: float) -> Change:
    """Wander slowly: 0.1 m/s² in a second."""
    step = 0.1 / np.sqrt(rate)
    return lambda values: values + step * np.cumsum(random.standard_normal(values.size))


def ramp(random: np.random.Generator, _: float) -> Change:
    """Drift by 0.1 m/s² over the record, up or down."""
    end = 0.1 * random.choice([-1.0, 1.0])
    return lambda values: values + np.linspace(0.0, end, values.size)


def spikes(random: np.random.Generator, test: VehicleTest) -> Change:
    """Put one to three spikes of a sample each on the motion, 30 to 300 m/s² high."""
    first, count = int((test.rest + 0.3) * test.rate), int(random.integers(1, 4))

    def how(values: Real) -> Real:
        values = values.copy()
        at = random.choice(np.arange(first, values.size), count, replace=False)
        values[at] += random.choice([-1.0, 1.0], count) * np.exp(random.uniform(np.log(30), np.log(300), count))
        return values

    return how


def dead(random: np.random.Generator, test: VehicleTest) -> Change:
    """Let a channel read nothing but noise about its rest."""
    return lambda values: values[0] + test.noise * random.standard_normal(values.size)


def twist(test: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured:
    """Let the body twist at 9 to 15 Hz, driven by the wheels' diagonals, to a tenth of what it does else."""
    omega, damping = 2 * np.pi * random.uniform(9, 15), random.uniform(0.02, 0.05)
    filters = bilinear([1, 0, 0], [1, 2 * damping * omega, omega**2], test.rate)
    signs = {"fl": 1.0, "fr": -1.0, "rl": -1.0, "rr": 1.0}
    drive = np.array([signs.get(one.on or "body", 0.0) for one in campaign.sensors])
    places = np.array([one.position or (0.0, 0.0, 0.0) for one in campaign.sensors])
    shape = (2 * places[:, 0] / test.vehicle.wheelbase + 1) * places[:, 1] * (drive == 0)
    twists = []
    for one in test.exact.recordings:
        motion = one.values - one.values[:, :1]
        twists.append(np.outer(shape, np.asarray(lfilter(*filters, drive @ motion))))
    body = np.concatenate([one.values - one.values[:, :1] for one in test.exact.recordings], axis=1)[drive == 0]
    size = 0.1 * body.std() / np.concatenate(twists, axis=1)[drive == 0].std()
    recordings = tuple(
        replace(one, values=one.values + size * more) for one, more in zip(campaign.recordings, twists, strict=True)
    )
    return Injured(campaign.with_recordings(recordings), ())


def units(factor: float) -> Callable[[np.random.Generator, float], Change]:
    """Take one unit for another."""
    return lambda *_: lambda values: factor * values


def tilted(random: np.random.Generator, _: float) -> Change:
    """Tilt a sensor by 15 to 25 degrees."""
    left = np.cos(np.deg2rad(random.uniform(15, 25)))
    return lambda values: left * values


def flat(random: np.random.Generator, _: float) -> Change:
    """Show one value throughout."""
    value = random.normal()
    return lambda values: np.full_like(values, value)


def reads_more(random: np.random.Generator, _: float) -> Change:
    """Read five percent too much, or too little."""
    factor = 1 + 0.05 * random.choice([-1.0, 1.0])
    return lambda values: factor * values


OF_SENSORS: Sequence[Injury] = (
    Injury("clipped, wheel", ("clipped",),
           "a wheel sensor clips at 40 to 80 % of the peak of the free decays", clipped("wheel")),
    Injury("clipped, body", ("clipped",), "a body sensor clips at 40 to 80 % of the peak of the free decays", clipped("body")),
    Injury("flat", ("flat",), "a channel is constant in all drops", everywhere("any", flat)),
    Injury("flat, noisy", ("flat",), "a channel contains only noise in one drop", once(dead)),
    Injury("spike", ("spike",), "one to three samples of a channel in one drop have an error of 30 to 300 m/s²", once(spikes)),
    Injury("unit, g as m/s²", ("unit",), "a channel is in g, stated as m/s²", everywhere("any", units(1 / G))),
    Injury("unit, mm/s²", ("unit",), "a channel is in mm/s², stated as m/s²", everywhere("any", units(1e3))),
    Injury("unit, m/s² as g", ("unit",), "a channel is in m/s², stated as g", everywhere("any", units(G))),
    Injury("sign, DC", ("sign",), "a channel that measures gravity is inverted", everywhere("DC", units(-1.0))),
    Injury("sign, AC", ("sign",), "a channel that does not measure gravity is inverted", everywhere("AC", units(-1.0))),
    Injury("gain", ("gain",), "a channel has a gain error of +5 or -5 %", everywhere("any", reads_more)),
    Injury("late", ("late",), "a channel is delayed by 3 to 10 ms", everywhere("any", late)),
    Injury("low-pass", ("low-pass", "late"), "a channel passed a low-pass of first or second order at 30 to 50 Hz",
           everywhere("any", low_pass)),
    Injury("corner, DC", ("corner",),
           "a channel stated as DC has a high-pass of 0.05 to 2 Hz", corner_unstated("DC")),
    Injury("corner, AC", ("corner",), "the high-pass of a channel is not stated", corner_unstated("AC")),
    Injury("corner, all DC", ("corner",),
           "all channels stated as DC have the same high-pass of 0.05 to 2 Hz", corner_unstated("DC", every=True)),
    Injury("corner, all AC", ("corner",), "the high-pass of all channels is not stated", corner_unstated("AC", every=True)),
    Injury("corner, misstated", ("corner",),
           "the stated corner frequency of a channel is twice or half the true one", corner_misstated),
    Injury("offset", ("offset", "gain"), "a sensor is tilted by 15 to 25 degrees", everywhere("any", tilted)),
    Injury("drift, straight", ("drift",), "a channel drifts linearly by 0.1 m/s² over each recording", everywhere("any", ramp)),
    Injury("drift, random walk", ("drift",),
           "a channel drifts as a random walk, 0.1 m/s² in one second", everywhere("any", walk)),
    Injury("exchanged, wheels", ("exchanged",), "two wheel channels are exchanged", exchanged("wheel", "wheel")),
    Injury("exchanged, body", ("exchanged",), "two body channels are exchanged", exchanged("body", "body")),
    Injury("exchanged, body and wheel", ("exchanged",),
           "a body channel and a wheel channel are exchanged", exchanged("body", "wheel")),
    Injury("exchanged, one drop", ("exchanged",),
           "two channels of one drop are exchanged", exchanged("any", "any", in_one=True)),
    Injury("copied", ("copy",), "a channel has the samples of another one", copied),
    Injury("twist", ("twist",), "the body has a torsion mode at 9 to 15 Hz, with a tenth of its motion", twist),
)  # fmt: skip
"""Of sensors, their cables and descriptions; and of the body, which is not as stiff as the model has it."""
