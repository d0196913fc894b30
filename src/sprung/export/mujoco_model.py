"""MJCF: the vehicle as joints and tendons of MuJoCo; a row is a fixed tendon, exactly.

Joints are the coordinates: body and wheels hang on the world, wheels move vertically. A fixed tendon is a linear function of
the joints, so that springs and dampers are tendons with the rows of the vehicle room. Piecewise linear forces are actuators
with a limited force, and so are tyres, which push and never pull: their control is the height of the road.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from sprung.errors import InputError, Problem
from sprung.export.equations import Equations, RowForce
from sprung.export.file import ExportedFile
from sprung.export.outputs import identifier, of_wheel
from sprung.export.requests import check_terms, resolve_load, without_terms
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import STATIONS, CurveParameters, Load, Rows, Sensor, Vehicle

Array = NDArray[np.float64]

_LACKING = {
    "friction": "MuJoCo's friction loss instead, which has no presliding",
    "load-friction": "the friction of the empty vehicle",
    "uneven-friction": "MuJoCo's friction loss instead, which has no presliding",
    "rounded-knee": "knees without rounding",
    "air": "the spring rate at rest",
    "levelled-air": "the spring rate at rest",
    "tyre-curve": "the tyre rate at the static load",
    "damper-mount": "dampers without mounts",
    "mount-damping": "dampers without mounts",
    "zener": "the spring rate at rest",
    "interconnection": "no interconnection",
    "twist": "a rigid body",
    "bending": "a rigid body",
    "uneven-occupants": "people who are alike on the left and on the right",
}
"""What MJCF cannot hold, and what stands for it in an approximation."""

_FRICTION = frozenset({"friction", "uneven-friction"})
"""Model terms that become a friction loss."""

_LIMIT = 1e9
"""N: force that no actuator reaches."""

_STEP = 5e-4
"""Time step, s, of the method of Runge and Kutta."""

_AXLE_INERTIA = "the roll inertia of the unsprung masses alone"
"""What stands for additional roll inertia of rigid axles: joints of MuJoCo that share a mass must be those of one body."""


def mjcf(
    vehicle: Vehicle,
    load: Load | None = None,
    *,
    sensors: Sequence[Sensor] = (),
    height: float = 0.05,
    approximate: bool = False,
) -> ExportedFile:
    """Return a vehicle as a model of MuJoCo (MJCF).

    Its joints are named as the coordinates of the vehicle and count from springs and tyres without force. The control of an
    actuator ``tyre_fl`` is the height of the road under this wheel, m. The key frame ``rest`` is the rest on flat ground,
    ``drop`` that on blocks under all wheels, from which the first step releases it.

    Parameters
    ----------
    vehicle
        The vehicle, such as `Result.vehicle`.
    load
        What is on it; nothing unless given.
    sensors
        Accelerometers on body and wheels that become sites with accelerometers, which read gravity as well.
    height
        Of the blocks of the key frame ``drop``, m.
    approximate
        Whether terms that MuJoCo has not are approximated; the notes state how.

    Returns
    -------
    ExportedFile
        XML.

    Raises
    ------
    InputError
        If the vehicle has terms that MuJoCo has not, or a sensor is no accelerometer on body or wheel; all at once.
    """
    load, where = resolve_load(load), f"MJCF of {vehicle.name}"
    problems = [
        Problem(where, f"sensor '{one.channel}'", "an accelerometer on body or wheel", "Leave it out.")
        for one in sensors
        if one.quantity != "acceleration" or one.pad is not None
    ]
    added = [name for name in ("m_xf", "m_xr", "m_x") if vehicle.parameters.get(name)]
    lacking = {**_LACKING, "rigid-axle": _AXLE_INERTIA} if added else _LACKING
    notes: list[str] = []
    try:
        notes = check_terms(vehicle, lacking, where, approximate)
    except InputError as error:
        problems += error.problems
    if problems:
        raise InputError(problems)
    # Dry friction stays in the equations, where it becomes a friction loss, and axles stay rigid.
    vehicle = vehicle.with_values(**dict.fromkeys(added, 0.0))
    kept = without_terms(vehicle, load, frozenset(_LACKING.keys() & {*vehicle.extras}) - _FRICTION)
    text = _Model(Equations.of(kept, load), tuple(sensors), height).text(notes)
    return ExportedFile(f"{identifier(vehicle.name)}.xml", text.encode(), tuple(notes))


@dataclass(frozen=True, eq=False)
class _Model:
    """The model of a vehicle, part by part."""

    equations: Equations
    sensors: tuple[Sensor, ...]
    height: float

    def text(self, notes: Sequence[str]) -> str:
        vehicle, load = self.equations.vehicle, self.equations.load
        about = [f"{vehicle.name}, {load.name}: ride model written by sprung, SI units.", *notes]
        lines = [
            *(f"<!-- {line.replace('--', '- -')} -->" for line in about),
            f"<mujoco model={quoteattr(vehicle.name)}>",
            '<compiler angle="radian" autolimits="true"/>',
            f'<option timestep="{_STEP}" integrator="RK4" gravity="0 0 {-STANDARD_GRAVITY}"><flag contact="disable"/></option>',
            '<visual><headlight ambient="0.4 0.4 0.4"/></visual>',
            "<worldbody>",
            '<light pos="0 0 4" dir="0 0 -1" diffuse="0.6 0.6 0.6"/>',
            '<geom name="ground" type="plane" size="10 10 0.1" rgba="0.8 0.8 0.8 1"/>',
            *self._body(),
            *self._further_bodies(),
            "</worldbody>",
            *self._section("tendon", self._tendons()),
            *self._section("actuator", self._actuators()),
            *self._section("sensor", self._readings()),
            "<keyframe>",
            self._key("rest", 0.0),
            self._key("drop", self.height),
            "</keyframe>",
            "</mujoco>",
        ]
        return "\n".join(lines) + "\n"

    @property
    def _names(self) -> tuple[str, ...]:
        return self.equations.forced

    @property
    def _mass(self) -> Array:
        return self.equations.vehicle.matrices(self.equations.load).M

    @cached_property
    def _rest(self) -> list[float]:
        """Positions of the joints at rest, as which the places of bodies are meant: the body is level there."""
        return [float(position) for position in self.equations.rest()]

    @property
    def _body_size(self) -> int:
        return len(self.equations.vehicle.layout.body)

    def _section(self, name: str, lines: Iterator[str]) -> list[str]:
        inside = list(lines)
        return [f"<{name}>", *inside, f"</{name}>"] if inside else []

    def _body(self) -> Iterator[str]:
        """Yield the body of the vehicle: its part of the mass matrix is that of a rigid body."""
        vehicle, layout = self.equations.vehicle, self.equations.vehicle.layout
        at = {coordinate: i for i, coordinate in enumerate(layout.body)}
        M, mass = self._mass, float(self._mass[0, 0])
        pitch, roll = at.get("theta"), at.get("phi")
        x, y = (float(-M[0, pitch]) / mass if pitch else 0.0), (float(M[0, roll]) / mass if roll else 0.0)
        turning = {
            "pitch": float(M[pitch, pitch] - mass * x**2) if pitch else None,
            "roll": float(M[roll, roll] - mass * y**2) if roll else None,
        }
        own = [inertia for inertia in turning.values() if inertia is not None] or [1.0]
        about_x, about_y = (turning[axis] or max(own) for axis in ("roll", "pitch"))
        product = float(M[pitch, roll] + mass * x * y) if pitch and roll else 0.0
        lift = vehicle.cg_height or 0.5
        yield f'<body name="body" pos="{-vehicle.a if pitch else 0.0:.12g} 0 {lift:.12g}">'
        yield f'<joint name="z_s" type="slide" axis="0 0 1" ref="{self._rest[0]!r}"/>'
        for coordinate, axis in (("theta", "0 1 0"), ("phi", "1 0 0")):
            if coordinate in at:
                yield f'<joint name="{coordinate}" type="hinge" axis="{axis}" ref="{self._rest[at[coordinate]]!r}"/>'
        inertia = f"{about_x!r} {about_y!r} {max(about_x, about_y)!r} {product!r} 0 0"
        yield f'<inertial pos="{x!r} {y!r} 0" mass="{mass!r}" fullinertia="{inertia}"/>'
        length, width = max(vehicle.wheelbase, 0.5) / 2, self._half_width
        middle = (vehicle.a - vehicle.b) / 2 if pitch else 0.0
        yield f'<geom type="box" pos="{middle:.6g} 0 0" size="{length:.6g} {width:.6g} 0.15" rgba="0.2 0.4 0.7 0.6"/>'
        for sensor in self.sensors:
            if sensor.position is not None:
                forward, left, _ = sensor.position
                place = f"{forward + (vehicle.a if pitch else 0.0)!r} {left!r} 0"
                yield f'<site name={quoteattr(sensor.channel)} pos="{place}"/>'
        yield "</body>"

    @property
    def _half_width(self) -> float:
        parameters = self.equations.vehicle.parameters
        return max([value for name, value in parameters.items() if name.startswith("t_") or name == "t"], default=0.3)

    def _further_bodies(self) -> Iterator[str]:
        """Yield what moves vertically beside the body: wheels, and masses on springs of their own."""
        vehicle, M, rising = self.equations.vehicle, self._mass, self.equations.heave
        stations = {STATIONS[wheel].coordinate: wheel for wheel in vehicle.layout.wheels}
        for i in range(self._body_size, len(self._names)):
            name, mass = self._names[i], float(M[i, i])
            wheel = stations.get(name)
            x, y = 0.0, 0.0
            if wheel is not None:
                _, _, side, end = STATIONS[wheel]
                x, y = (-vehicle.wheelbase if end < 0 else 0.0), side * self._half_width
            radius = vehicle.wheel_height or 0.3
            shape = f'type="cylinder" size="{radius:.6g} 0.1" zaxis="0 1 0"' if wheel else 'type="sphere" size="0.1"'
            weight = "" if rising[name] else ' gravcomp="1"'
            title = of_wheel("wheel", wheel) if wheel else f"mass_{name}"
            yield f'<body name="{title}" pos="{x:.12g} {y:.12g} {radius:.6g}"{weight}>'
            yield f'<joint name="{name}" type="slide" axis="0 0 1" ref="{self._rest[i]!r}"/>'
            yield f'<inertial pos="0 0 0" mass="{mass!r}" diaginertia="1 1 1"/>'
            yield f'<geom {shape} rgba="0.15 0.15 0.15 0.8"/>'
            for sensor in self.sensors:
                if wheel is not None and sensor.wheel == wheel:
                    yield f'<site name={quoteattr(sensor.channel)} pos="0 0 0"/>'
            yield "</body>"

    def _row(self, position: int) -> Array:
        """Return a row at the values of the parameters, shape (coordinate,)."""
        row: Array = Rows.of([self.equations.rows[position]], self.equations.names).at(self.equations.values)[0]
        return row

    def _tendons(self) -> Iterator[str]:
        equations = self.equations
        values = dict(zip(equations.names, equations.values.tolist(), strict=True))
        rates: dict[int, dict[str, float]] = {}
        for element, row, offset in equations.linear:
            if element.law != "mass":
                coefficient = element.coefficient
                size = element.factor * (values[coefficient] if isinstance(coefficient, str) else coefficient)
                own = rates.setdefault(row, {"spring": 0.0, "damper": 0.0, "preload": 0.0})
                own[element.law] += size
                own["preload"] += size * offset
        for force in equations.forces:
            rates.setdefault(force.row, {"spring": 0.0, "damper": 0.0, "preload": 0.0})
        for position, own in rates.items():
            friction = sum(_friction(one, values) for one in equations.forces if one.row == position)
            unloaded = own["preload"] / own["spring"] if own["spring"] else 0.0
            attributes = f'stiffness="{own["spring"]!r}" damping="{own["damper"]!r}" springlength="{unloaded!r}"'
            attributes += f' frictionloss="{friction!r}"' if friction else ""
            yield self._tendon(f"row{position}", attributes, self._row(position))
        for i, force in enumerate(equations.forces):
            if force.law == "progressive":
                growth, rate = (values[name] for name in force.element.parameters)
                attributes = f'stiffness="0 {-0.5 * growth * rate!r}" springlength="{force.offset!r}"'
                yield self._tendon(f"progressive{i}", attributes, self._row(force.row))

    def _tendon(self, name: str, attributes: str, row: Array) -> str:
        joints = "".join(
            f'<joint joint="{joint}" coef="{value!r}"/>'
            for joint, value in zip(self._names, row.tolist(), strict=True)
            if value
        )
        return f'<fixed name="{name}" {attributes}>{joints}</fixed>'

    def _actuators(self) -> Iterator[str]:
        equations = self.equations
        values = dict(zip(equations.names, equations.values.tolist(), strict=True))
        for tyre in equations.tyres:
            stiffness, damping = (sum(f * values[name] for name, f in part) for part in (tyre.stiffness, tyre.damping))
            yield (
                f'<general name="{of_wheel("tyre", tyre.wheel)}" joint="{tyre.coordinate}" gaintype="fixed" '
                f'gainprm="{stiffness!r}" biastype="affine" biasprm="0 {-stiffness!r} {-damping!r}" '
                f'forcerange="0 {_LIMIT}"/>'
            )
        for i, force in enumerate(equations.forces):
            for k, (constant, by_travel, by_rate, is_push) in enumerate(_pieces(force, values)):
                limits = f"0 {_LIMIT}" if is_push else f"{-_LIMIT} 0"
                # With a gain of 0 MuJoCo would take the damping for a damping ratio; the control stays 0.
                name = f"{force.law}{i}_{k}"
                yield (
                    f'<general name="{name}" tendon="row{force.row}" gaintype="fixed" gainprm="1" biastype="affine" '
                    f'biasprm="{constant!r} {by_travel!r} {by_rate!r}" forcerange="{limits}"/>'
                )

    def _readings(self) -> Iterator[str]:
        for name in self._names:
            yield f'<jointpos name="position_{name}" joint="{name}"/><jointvel name="velocity_{name}" joint="{name}"/>'
        for wheel in self.equations.wheels:
            tyre = of_wheel("tyre", wheel)
            yield f'<actuatorfrc name="{tyre.replace("tyre", "tyre_force")}" actuator="{tyre}"/>'
        for sensor in self.sensors:
            channel = quoteattr(sensor.channel)
            yield f"<accelerometer name={channel} site={channel}/>"

    def _key(self, name: str, height: float) -> str:
        positions = " ".join(map(repr, self.equations.rest([height] * len(self.equations.wheels)).tolist()))
        return f'<key name="{name}" qpos="{positions}"/>'


def _friction(force: RowForce, values: Mapping[str, float]) -> float:
    """Return the dry friction of a force at which it slides, N; 0 for any other force."""
    own = [values[name] for name in force.element.parameters]
    match force.law:
        case "friction":
            return own[0]
        case "friction left" | "friction right":
            return own[1] + force.side * own[0]
        case _:
            return 0.0


def _pieces(force: RowForce, values: dict[str, float]) -> Iterator[tuple[float, float, float, bool]]:
    """Yield a force as pieces c + k x + d v that are zero beyond a limit: c, k, d, and whether the limit is below."""
    names = force.element.parameters
    own = [values[name] for name in names]
    if force.law == "rebound":
        ratio, damping = own
        yield 0.0, 0.0, -(ratio - 1) * damping, ratio < 1
    elif force.law == "bump-stop":
        stiffness, clearance = own
        yield stiffness * (force.offset - clearance), -stiffness, 0.0, True
    elif force.law == "damper-curve":
        curve = CurveParameters.of(force.curve_parts, own, 1.0)
        # What a knee takes off the force of the damper, in rebound and in compression.
        rebound, compression, bend = curve.ratio * curve.damping, curve.damping, curve.slope_ratio
        for velocity, slope in zip(curve.velocities, curve.ratios, strict=True):
            drops = rebound * (1 - slope * bend), compression * (1 - slope)
            rebound, compression, bend = rebound * slope * bend, compression * slope, 1.0
            yield -drops[0] * curve.velocity_ratio * velocity, 0.0, drops[0], drops[0] > 0
            yield drops[1] * velocity, 0.0, drops[1], drops[1] < 0
