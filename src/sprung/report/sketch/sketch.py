"""The sketch of the vehicle: its two views, and in words what is not known yet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sprung.campaign import Campaign
from sprung.report.sketch.geometry import Geometry, geometry_of
from sprung.report.sketch.shapes import Drawing
from sprung.report.sketch.views import plan_view, side_view
from sprung.results import Result


@dataclass(frozen=True, eq=False)
class VehicleSketch:
    """The vehicle from above and from the side.

    Attributes
    ----------
    geometry
        What it is drawn from.
    drawings
        Plan view and side view.
    unknown
        What is drawn dashed or not at all because it is not known, one text each.
    """

    geometry: Geometry
    drawings: tuple[Drawing, Drawing]
    unknown: tuple[str, ...]

    @property
    def key(self) -> str:
        """How the sketch is to be read, in a sentence or two."""
        geometry = self.geometry
        seats = "circles are spring seats, diamonds damper mounts" if geometry.separate else "circles are spring seats"
        return (
            "Axes after ISO 8855: x forward from the front axle, y to the left, z up from the ground. Dots are sensors on the "
            f"body, rings sensors on wheels, crossed squares loads, {seats}. The outlines of body and wheels are schematic."
        )


def vehicle_sketch(source: Campaign | Result) -> VehicleSketch:
    """Sketch a vehicle with axes, dimensions, sensors, loads and centre of gravity.

    Parameters
    ----------
    source
        A campaign, also one whose geometry is not complete, or a result.

    Returns
    -------
    VehicleSketch
        What is not known is dashed and named; nothing is invented.
    """
    geometry = geometry_of(source)
    return VehicleSketch(geometry, (plan_view(geometry), side_view(geometry)), tuple(_unknown(geometry)))


def _unknown(geometry: Geometry) -> Iterator[str]:
    """Name what is not known of the vehicle, its sensors and its loads."""
    if geometry.wheelbase.value is None:
        yield "wheelbase"
    if geometry.a.value is None:
        yield "centre of gravity (a, b)"
    kinds = {"2": geometry.springs, "1": geometry.dampers} if geometry.separate else {"": geometry.springs}
    for index, lengths in kinds.items():
        names = [f"t_{axle}{index}" for axle, one in zip("fr", lengths, strict=True) if one.value is None]
        if names:
            yield f"half-distance{'s' * (len(names) > 1)} {', '.join(names)}"
    if geometry.cg_height.value is None:
        yield "height of the centre of gravity"
    if geometry.wheel_height.value is None:
        yield "height of the wheel centres"
    yield from _placeless(geometry)


def _placeless(geometry: Geometry) -> Iterator[str]:
    """Name the sensors and loads whose place is not known."""
    body = [sensor.channel for sensor in geometry.sensors if sensor.on == "body" and sensor.position is None]
    if body:
        yield f"position{'s' * (len(body) > 1)} of {', '.join(body)}"
    wheels = [sensor.channel for sensor in geometry.sensors if sensor.on is None]
    if wheels:
        yield f"wheel station{'s' * (len(wheels) > 1)} of {', '.join(wheels)}"
    for load in geometry.loads:
        if not load.items:
            yield f"where load {load.name} lies" + (f" ({load.mass:g} kg in all)" if load.added is not None else "")
