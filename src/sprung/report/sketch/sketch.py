"""The sketch of the vehicle: two views, and the list of unknown dimensions."""

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
        Dimensions, sensors and loads.
    drawings
        Plan view and side view.
    unknown
        Unknown dimensions, drawn dashed or not at all, one text each.
    """

    geometry: Geometry
    drawings: tuple[Drawing, Drawing]
    unknown: tuple[str, ...]

    @property
    def key(self) -> str:
        """Legend of the sketch in a sentence or two."""
        geometry = self.geometry
        seats = "; circles: springs" + ("; diamonds: dampers" if geometry.separate else " and dampers")
        axle = "front axle" if geometry.layout.pitches else "axle"
        seats = seats if geometry.layout.rolls else ""
        return (
            f"Axes according to ISO 8855: x forward from the {axle}, y to the left, z up from the ground. Dots: sensors on "
            f"the body; rings: sensors on wheels; crossed squares: loads{seats}. Outlines are schematic."
        )


def vehicle_sketch(source: Campaign | Result) -> VehicleSketch:
    """Return the sketch of a vehicle with axes, dimensions, sensors, loads and centre of gravity.

    Parameters
    ----------
    source
        A campaign, also one whose geometry is not complete, or a result.

    Returns
    -------
    VehicleSketch
        Unknown dimensions are dashed and listed.
    """
    geometry = geometry_of(source)
    return VehicleSketch(geometry, (plan_view(geometry), side_view(geometry)), tuple(_unknown(geometry)))


def _unknown(geometry: Geometry) -> Iterator[str]:
    """Yield the unknown dimensions of the vehicle, its sensors and its loads."""
    if geometry.layout.pitches and geometry.wheelbase.value is None:
        yield "wheelbase"
    if geometry.layout.pitches and geometry.a.value is None:
        yield "centre of gravity (a, b)"
    for springs in (True, False):
        unknown = [one for one in geometry.half_distances if one[1] is springs and one[3].value is None]
        if names := [name for name, *_ in unknown]:
            yield f"half-distance{'s' * (len(names) > 1)} {', '.join(names)}"
    if geometry.cg_height.value is None:
        yield "height of the centre of gravity"
    if geometry.wheel_height.value is None:
        yield "height of the wheel centres"
    yield from _without_position(geometry)


def _without_position(geometry: Geometry) -> Iterator[str]:
    """Yield the sensors and loads without a known position."""
    body = [sensor.channel for sensor in geometry.sensors if sensor.on == "body" and sensor.position is None]
    if body:
        yield f"position{'s' * (len(body) > 1)} of {', '.join(body)}"
    wheels = [sensor.channel for sensor in geometry.sensors if sensor.on is None]
    if wheels:
        yield f"wheel station{'s' * (len(wheels) > 1)} of {', '.join(wheels)}"
    for load in geometry.loads:
        if not load.items:
            yield f"position of load {load.name}" + (
                f" ({load.total_mass():g} kg in total)" if load.added is not None else ""
            )
