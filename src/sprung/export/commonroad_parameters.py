"""CommonRoad: the parameters of its multi-body model that a drop test determines, as YAML; the others are listed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from sprung.errors import InputError, Problem
from sprung.export.file import ExportedFile
from sprung.export.requests import check_terms, resolve_load, without_terms
from sprung.vehicle import Load, Vehicle

_LACKING: Mapping[str, str] = {
    "tyre-damping": "tyres without damping",
    "gravity": "a body whose weight has no moment as it turns",
    "asymmetry": "the mean of left and right",
    "rigid-axle": "springs and dampers over the wheels",
    "engine": "the engine as a part of a rigid body",
    "damper-mount": "dampers without mounts",
    "mount-damping": "dampers without mounts",
    "zener": "the spring rate at rest",
    "interconnection": "no interconnection",
    "twist": "a rigid body",
    "bending": "a rigid body",
    "occupants": "the people as a part of a rigid body",
    "uneven-occupants": "the people as a part of a rigid body",
    "seat-load": "loads as a part of a rigid body",
    "friction": "no dry friction",
    "load-friction": "no dry friction",
    "uneven-friction": "no dry friction",
    "rebound": "the mean of compression and rebound",
    "damper-curve": "the damper rate before the knee",
    "rebound-knee": "the damper rate before the knee",
    "rounded-knee": "the damper rate before the knee",
    "second-knee": "the damper rate before the knee",
    "third-knee": "the damper rate before the knee",
    "progressive": "the spring rate at rest",
    "air": "the spring rate at rest",
    "levelled-air": "the spring rate at rest",
    "bump-stop": "no bump stops",
    "tyre-curve": "the tyre rate at the static load",
}
"""What the parameters of CommonRoad cannot hold, and what stands for it in an approximation."""

_UNKNOWN = (
    ("l, w", "length and width"),
    ("steering.*", "limits of the steering"),
    ("longitudinal.*", "limits of acceleration and velocity"),
    ("I_z, I_xz_s", "yaw inertia and product of inertia"),
    ("K_ras, K_rad", "lateral rate and damping between body and axles"),
    ("I_y_w, R_w", "spin inertia and rolling radius of the wheels"),
    ("K_lt", "lateral compliance of the tyres"),
    ("T_sb, T_se", "split of brake and engine torque"),
    ("D_f, D_r, E_f, E_r", "camber by travel"),
    ("tire.*", "coefficients of the tyre model (Magic Formula)"),
)
"""Parameters of CommonRoad that no drop test determines, and what they are."""

_EQUAL = 1e-9
"""Relative difference of two rates that is none."""


class _Entry(NamedTuple):
    """A line of the file."""

    key: str
    value: float
    about: str


def commonroad(vehicle: Vehicle, load: Load | None = None, *, approximate: bool = False) -> ExportedFile:
    """Return a vehicle as a parameter file of commonroad-vehicle-models (3.0), in YAML.

    It has the masses, inertias, springs, dampers, tyre rate and geometry of the multi-body model. Parameters that no drop test
    determines (steering, tyre model, yaw inertia) are not in it, and are listed in comments: the package loads them as None. A
    load becomes a part of the rigid body.

    Parameters
    ----------
    vehicle
        A whole vehicle, such as `Result.vehicle`.
    load
        What is on it; nothing unless given.
    approximate
        Whether what CommonRoad has not is approximated; the notes, and comments in the file, state how.

    Returns
    -------
    ExportedFile
        YAML.

    Raises
    ------
    InputError
        If it is a part of a vehicle, or has what CommonRoad has not; all reasons at once.
    """
    load, where = resolve_load(load), f"CommonRoad parameters of {vehicle.name}"
    if vehicle.model != "full":
        do = "Export to state-space, modelica, mjcf or fmu."
        raise InputError([Problem(where, f"a {vehicle.model} model", "a whole vehicle", do)])
    is_axle_of_wheels = all(vehicle.parameters.get(name, 1.0) == 1.0 for name in ("n_f", "n_r", *_APART_SHARES))
    lacking = {term: text for term, text in _LACKING.items() if term != "rigid-axle" or not is_axle_of_wheels}
    kept = without_terms(vehicle, load, frozenset(lacking.keys() & {*vehicle.extras}))
    problems, notes = _other_differences(kept, load, where, approximate)
    try:
        notes = check_terms(vehicle, lacking, where, approximate) + notes
    except InputError as error:
        problems = [*error.problems, *problems]
    if problems:
        raise InputError(problems)
    added = {axle: vehicle.parameters.get(f"m_x{axle}", 0.0) for axle in "fr"}
    entries = _entries(kept, load, added)
    lines = [
        f"# {_line(vehicle.name)}, {_line(load.name)}: parameters for commonroad-vehicle-models, written by sprung.",
        "# SI units. Only what a drop test determines is given.",
        *(f"# {note}" for note in notes),
        "",
        *(f"{entry.key}: {entry.value!r}  # {entry.about}" for entry in entries),
        "",
        "# Not determined by a drop test, hence not given; the package loads them as None:",
        *(f"#   {names}: {about}" for names, about in _unknown({entry.key for entry in entries})),
    ]
    unknown = (
        "Steering, tyre model, yaw inertia and others are not determined by a drop test: the file lists and omits them."
    )
    return ExportedFile("parameters_vehicle5.yaml", ("\n".join(lines) + "\n").encode(), (*notes, unknown))


_APART_SHARES = ("n_f1", "n_f2", "n_r1", "n_r2")


def _other_differences(vehicle: Vehicle, load: Load, where: str, approximate: bool) -> tuple[list[Problem], list[str]]:
    """Return what beside the model terms CommonRoad cannot hold: as problems, or, if approximated, as notes."""
    p = vehicle.parameters
    body = _body(vehicle, load)
    found = []
    if abs(p["k_tf"] - p["k_tr"]) > _EQUAL * p["k_tf"]:
        found.append((f"tyre rates k_tf {p['k_tf']:.6g} and k_tr {p['k_tr']:.6g} N/m", "one tyre rate", "their mean"))
    if vehicle.tracks == "separate":
        found.append(
            ("springs and dampers at different half-distances", "one track width", "dampers beside the springs")
        )
    if abs(body["y"]) > _EQUAL:
        expected, instead = "a centre of gravity on the centreline", "it on the centreline"
        found.append((f"a centre of gravity {body['y']:.3g} m left of the centreline", expected, instead))
    if approximate:
        return [], [f"Approximated: {what}: {instead}." for what, _, instead in found]
    do = "Set approximate=True (--approximate): {}."
    return [Problem(where, what, expected, do.format(instead)) for what, expected, instead in found], []


def _body(vehicle: Vehicle, load: Load) -> dict[str, float]:
    """Return mass, place and inertia of the sprung mass with what is on it, SI."""
    level = Vehicle(vehicle.parameters, name=vehicle.name)
    M = level.matrices(load).M
    mass = float(M[0, 0])
    x, y = float(-M[0, 1]) / mass, float(M[0, 2]) / mass
    return {
        "mass": mass,
        "x": x,
        "y": y,
        "pitch": float(M[1, 1]) - mass * x**2,
        "roll": float(M[2, 2]) - mass * y**2,
        "front": float(M[3, 3] + M[4, 4]),
        "rear": float(M[5, 5] + M[6, 6]),
    }


def _entries(vehicle: Vehicle, load: Load, added: Mapping[str, float]) -> list[_Entry]:
    p, body = vehicle.parameters, _body(vehicle, load)
    tracks = {axle: 2 * float(p.get(f"t_{axle}2", p.get(f"t_{axle}", 0.0))) for axle in "fr"}
    unsprung = {"f": body["front"], "r": body["rear"]}
    if "m_xf" in p:  # in M as a mass of each wheel
        unsprung = {axle: mass - p[f"m_x{axle}"] for axle, mass in unsprung.items()}
    entries = [
        _Entry("m", body["mass"] + sum(unsprung.values()), "mass of the whole vehicle [kg]"),
        _Entry("m_s", body["mass"], "sprung mass [kg]"),
        *(_Entry(f"m_u{axle}", unsprung[axle], f"unsprung mass, {_END[axle]} axle [kg]") for axle in "fr"),
        _Entry("a", p["a"] - body["x"], "centre of gravity of the sprung mass to front axle [m]"),
        _Entry("b", p["b"] + body["x"], "centre of gravity of the sprung mass to rear axle [m]"),
        _Entry("I_Phi_s", body["roll"], "roll inertia of the sprung mass [kg m^2]"),
        _Entry("I_y_s", body["pitch"], "pitch inertia of the sprung mass [kg m^2]"),
    ]
    for axle in "fr":
        entries += [
            _Entry(f"K_s{axle}", p[f"k_s{axle}"], f"spring rate, each {_END[axle]} wheel [N/m]"),
            _Entry(f"K_sd{axle}", p[f"c_s{axle}"], f"damper rate, each {_END[axle]} wheel [N s/m]"),
            _Entry(f"T_{axle}", tracks[axle], f"{_END[axle]} track: twice the half-distance of the springs [m]"),
            _Entry(
                f"K_ts{axle}",
                0.0 - p.get(f"k_a{axle}", 0.0) * tracks[axle] ** 2,
                f"{_END[axle]} anti-roll bar, negative where it stiffens [N m/rad]",
            ),
            _Entry(
                f"I_u{axle}",
                (unsprung[axle] + 2 * added[axle]) * (tracks[axle] / 2) ** 2,
                f"roll inertia of the {_END[axle]} unsprung masses [kg m^2]",
            ),
        ]
    entries.append(_Entry("K_zt", (p["k_tf"] + p["k_tr"]) / 2, "vertical rate of a tyre [N/m]"))
    if load.name == "empty" and vehicle.cg_height is not None:
        entries.append(_Entry("h_s", vehicle.cg_height, "centre of gravity of the sprung mass above ground [m]"))
        if vehicle.wheel_height is not None:
            wheels = sum(unsprung.values())
            height = (body["mass"] * vehicle.cg_height + wheels * vehicle.wheel_height) / (body["mass"] + wheels)
            entries.append(_Entry("h_cg", height, "centre of gravity of the whole vehicle above ground [m]"))
    if vehicle.roll_axis_height is not None:
        entries += [_Entry(f"h_ra{axle}", vehicle.roll_axis_height, "roll axis above ground [m]") for axle in "fr"]
    return entries


_END = {"f": "front", "r": "rear"}


def _unknown(given: set[str]) -> list[tuple[str, str]]:
    """Return what is not given, and what it is."""
    heights = [key for key in ("h_s", "h_cg", "h_raf", "h_rar") if key not in given]
    return [*_UNKNOWN, *([(", ".join(heights), "heights")] if heights else [])]


def _line(text: str) -> str:
    return " ".join(text.split())
