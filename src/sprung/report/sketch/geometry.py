"""Dimensions of the vehicle in a campaign or a result, for the sketch."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from sprung.campaign import Campaign
from sprung.results import Result
from sprung.uncertainty import round_by_uncertainty
from sprung.vehicle import EMPTY, FULL, Layout, Load, Sensor, half_distances, layout_of, parameter_name

_FINEST = 0.01
"""Smallest standard uncertainty for rounding, m: lengths are rounded to 1 mm at most."""


@dataclass(frozen=True, slots=True)
class Length:
    """A length in the sketch.

    Attributes
    ----------
    value
        m; None where it is not known.
    std
        Standard uncertainty, m; 0 for an exact value.
    written
        Text in place of the value; empty for the value itself.
    """

    value: float | None = None
    std: float = 0.0
    written: str = ""

    @property
    def text(self) -> str:
        """The value, rounded by its uncertainty to 1 mm at most; ``?`` where it is not known."""
        if self.written or self.value is None:
            return self.written or "?"
        written = round_by_uncertainty(self.value, max(self.std, _FINEST))[0] if self.std else f"{self.value:.4g}"
        return f"{written} m"

    def __sub__(self, other: Length) -> Length:
        if self.value is None or other.value is None:
            return UNKNOWN
        return Length(self.value - other.value, (self.std**2 + other.std**2) ** 0.5)

    def __add__(self, other: Length) -> Length:
        if self.value is None or other.value is None:
            return UNKNOWN
        return Length(self.value + other.value, (self.std**2 + other.std**2) ** 0.5)


UNKNOWN = Length()
"""A length that is neither measured nor identified."""


@dataclass(frozen=True)
class Geometry:
    """Dimensions, sensors and loads of one vehicle.

    Attributes
    ----------
    name
        The vehicle's.
    wheelbase, a, b
        Front to rear axle; front axle to the centre of gravity of the sprung mass; centre of gravity to rear axle.
    springs, dampers
        Half-distances of the front and the rear axle: t_f2, t_r2 and t_f1, t_r1, or t_f, t_r for both.
    separate
        Whether springs and dampers have half-distances of their own.
    cg_height, wheel_height, roll_axis_height
        Above the ground.
    sensors
        All of them; a body sensor whose position is not known has none.
    loads
        Without the load ``empty``.
    identified
        Whether a, b and the half-distances come from an identification.
    blank
        Whether it is to be filled in by hand, not to scale.
    layout
        Its wheel stations: of a whole vehicle, or of a part of one.
    """

    name: str
    wheelbase: Length = UNKNOWN
    a: Length = UNKNOWN
    b: Length = UNKNOWN
    springs: tuple[Length, Length] = (UNKNOWN, UNKNOWN)
    dampers: tuple[Length, Length] = (UNKNOWN, UNKNOWN)
    separate: bool = False
    cg_height: Length = UNKNOWN
    wheel_height: Length = UNKNOWN
    roll_axis_height: Length = UNKNOWN
    sensors: tuple[Sensor, ...] = ()
    loads: tuple[Load, ...] = ()
    identified: bool = False
    blank: bool = False
    layout: Layout = FULL

    @property
    def half_distances(self) -> Iterator[tuple[str, bool, int, Length]]:
        """Name, whether of the springs, position of the axle, and length of each half-distance that the vehicle has."""
        kinds = (
            ((True, "2", self.springs), (False, "1", self.dampers)) if self.separate else ((True, "", self.springs),)
        )
        for is_spring, index, lengths in kinds if self.layout.rolls else ():
            for i, axle in enumerate(self.layout.axles):
                yield parameter_name("t", axle, index), is_spring, i, lengths[i]


def _drawn(sensor: Sensor) -> Sensor:
    """Return a sensor where it is drawn: what measures suspension travel, or a pad, at its wheel."""
    station = sensor.wheel or sensor.pad or (sensor.relative_to if sensor.position is None else None)
    if station is None:
        return sensor
    return Sensor(channel=sensor.channel, on=station)


def geometry_of(source: Campaign | Result) -> Geometry:
    """Return the dimensions in a campaign or a result.

    Parameters
    ----------
    source
        A campaign has the lengths measured beforehand, a result also the identified ones. Estimates of a rejected result
        are not used.

    Returns
    -------
    Geometry
    """
    if isinstance(source, Result):
        return _of_result(source)
    lengths = {name: Length(known.value, known.std) for name, known in source.known.items()}
    if source.wheelbase is not None:
        lengths["wheelbase"] = Length(source.wheelbase.value, source.wheelbase.std)
    heights = {name: value for name, value in source.heights.by_key.items() if value is not None}
    separate = source.model.tracks == "separate"
    return _geometry(
        source.name, lengths, heights, source.sensors, source.loads, separate, source.layout, identified=False
    )


def _of_result(result: Result) -> Geometry:
    usable = ("known",) if result.verdict.state == "reject" else ("known", "estimated")
    lengths = {
        name: Length(estimate.value, estimate.std or 0.0)
        for name, estimate in {**result.parameters, **result.derived}.items()
        if estimate.status in usable
    }
    setup = result.setup
    lengths = {name: Length(prior.value, prior.std) for name, prior in setup.known.items()} | lengths
    return _geometry(
        result.name,
        lengths,
        setup.heights,
        setup.sensors,
        setup.loads,
        result.fit.tracks == "separate",
        layout_of(result.parameters),
        identified="estimated" in usable,
    )


def _geometry(
    name: str,
    lengths: Mapping[str, Length],
    heights: Mapping[str, float],
    sensors: tuple[Sensor, ...],
    loads: tuple[Load, ...],
    separate: bool,
    layout: Layout,
    *,
    identified: bool,
) -> Geometry:
    def length(*names: str) -> Length:
        return next((lengths[name] for name in names if name in lengths), UNKNOWN)

    wheelbase, a, b = length("wheelbase"), length("a"), length("b")
    if wheelbase.value is None:
        wheelbase = a + b
    a = wheelbase - b if a.value is None else a
    b = wheelbase - a if b.value is None else b
    apart = separate or any(name in lengths for name in half_distances("separate").values())
    springs = (length("t_f2", "t_f", "t_2", "t"), length("t_r2", "t_r", "t_2", "t"))
    dampers = (length("t_f1", "t_f", "t_1", "t"), length("t_r1", "t_r", "t_1", "t"))
    return Geometry(
        name=name,
        wheelbase=wheelbase,
        a=a,
        b=b,
        springs=springs,
        dampers=dampers,
        separate=apart,
        cg_height=Length(heights.get("cg_height")),
        wheel_height=Length(heights.get("wheel_height")),
        roll_axis_height=Length(heights.get("roll_axis_height")),
        sensors=tuple(_drawn(sensor) for sensor in sensors),
        loads=tuple(load for load in loads if load.name != EMPTY.name),
        identified=identified,
        layout=layout,
    )
