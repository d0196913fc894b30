"""All ride numbers of a vehicle with given parameters, one after another: what the error bars are computed from."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sprung.ride.bench import Plate, PlateTest
from sprung.ride.equivalents import axle_numbers, half_car_numbers
from sprung.ride.options import RideOptions
from sprung.ride.ride_model import RideModel
from sprung.ride.road_response import Drive, NotConvergedError, RoadResponse, TravelGuess, guess_of, respond
from sprung.ride.weighting import frequency_weighting
from sprung.vehicle import STATIONS, EquivalentElements

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

Key = tuple[str, ...]
"""Where a number belongs: group, place in it, and quantity."""

CURVE_FREQUENCIES = np.geomspace(0.3, 30.0, 161)
"""Hz, of the transmissibilities."""

_GAUSSIAN_DOSE = 3.0**0.25
"""E[a⁴]^¼ of a Gaussian process over its root mean square."""

_ROTATIONS = {"theta": "pitch", "phi": "roll"}
"""Axis of each angle of the body."""

_NEAR = 1.004
"""Ratio of neighbouring frequencies from which a peak is interpolated."""


@dataclass(frozen=True, eq=False)
class Neighbour:
    """What the numbers at neighbouring parameters are computed from: nothing is searched for again.

    Attributes
    ----------
    travels
        By drive: the response of a nonlinear vehicle.
    plates
        By wheel: what a tester finds; None where it finds nothing.
    peaks
        By curve: frequency of the peak, Hz.
    """

    travels: Mapping[int, TravelGuess | None]
    plates: Mapping[str, PlateTest | None]
    peaks: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Evaluation:
    """The ride numbers at some parameters.

    Attributes
    ----------
    numbers
        SI, by key.
    curves
        Transmissibilities at `CURVE_FREQUENCIES`, by name, complex.
    neighbour
        For the evaluation at neighbouring parameters.
    failures
        By key of a group: why its numbers could not be computed.
    """

    numbers: Mapping[Key, float]
    curves: Mapping[str, Complex]
    neighbour: Neighbour
    failures: Mapping[Key, str] = field(default_factory=dict)


def evaluate(
    model: RideModel, values: Real, options: RideOptions, near: Neighbour | None = None, *, has_neighbours: bool = True
) -> Evaluation:
    """Return all ride numbers of a vehicle.

    Parameters
    ----------
    model, values
        The vehicle, and its parameters, SI.
    options
        Roads, speeds and places.
    near
        Of an evaluation at neighbouring parameters.
    has_neighbours
        Whether such evaluations will follow.

    Returns
    -------
    Evaluation
    """
    numbers, failures = dict[Key, float](), dict[Key, str]()
    guesses, plates, peaks = dict[int, TravelGuess | None](), dict[str, PlateTest | None](), dict[str, float]()
    reference: EquivalentElements | None = None
    before: TravelGuess | None = None
    drives = options.drives
    for i, drive in enumerate(drives):
        alike = next((j for j in range(i) if _is_proportional(drives[j], drive)), None)
        if model.nonlinear is None and alike is not None:
            # The response of a linear vehicle is proportional to the road.
            factor = float(np.sqrt(drive.road.roughness / drives[alike].road.roughness))
            first = f"{alike}"
            numbers |= {
                (group, f"{i}", *rest): factor * value
                for (group, *at), value in list(numbers.items())
                if group == "roads" and at[0] == first
                for rest in [at[1:]]
            }
            continue
        if near is not None and i not in near.travels:
            continue
        try:
            # The road before is the nearest that is known of a first response.
            response = respond(model, values, drive, before if near is None else near.travels[i])
        except NotConvergedError as error:
            failures["roads", f"{i}"] = str(error)
            continue
        guesses[i] = near.travels[i] if near is not None else guess_of(response) if has_neighbours else None
        before = guesses[i]
        if reference is None and i >= options.reference:
            reference = response.equivalents
        numbers |= {("roads", f"{i}", *key): value for key, value in _road_numbers(response, options)}
    if model.nonlinear is not None and reference is None:
        failures["axles",] = "no equivalent linear vehicle was found"
    else:
        of_axles = axle_numbers(model, values, reference)
        numbers |= {("axles", axle, name): value for axle, own in of_axles.items() for name, value in own.items()}
        between = {
            axle: float(np.sqrt(own["body_frequency"] * own["hop_frequency"]))
            for axle, own in of_axles.items()
            if {"body_frequency", "hop_frequency"} <= own.keys()
        }
        for name, frequency, gain in _peaks(model, values, options, reference, near, between):
            peaks[name] = frequency
            numbers["peaks", name, "frequency"], numbers["peaks", name, "gain"] = frequency, gain
    halves = half_car_numbers(model, values)
    numbers |= {("half_cars", plane, name): value for plane, own in halves.items() for name, value in own.items()}
    for key, value in _plate_numbers(model, values, options, near, plates, failures):
        numbers[key] = value
    curves = {} if ("axles",) in failures else _curves(model, values, options, reference, CURVE_FREQUENCIES)
    return Evaluation(numbers, curves, Neighbour(guesses, plates, peaks), failures)


def _is_proportional(one: Drive, other: Drive) -> bool:
    """Return whether the roads of two drives differ by a factor alone."""
    return one.speed == other.speed and one.road.waviness == other.road.waviness


def _road_numbers(response: RoadResponse, options: RideOptions) -> Iterator[tuple[Key, float]]:
    """Yield the numbers of one drive."""
    model, values, frequency = response.model, response.values, response.frequency
    # One profile under left and right wheels does not roll a vehicle whose sides are alike.
    still = {"phi"} if options.tracks == "same" and model.is_symmetric else set[str]()
    turning = [angle for angle in model.vehicle.layout.body if angle in _ROTATIONS and angle not in still]
    vertical = np.abs(frequency_weighting("W_k", frequency)) ** 2
    horizontal = np.abs(frequency_weighting("W_d", frequency)) ** 2
    dose = _GAUSSIAN_DOSE * options.duration**0.25
    up = response.accelerations(model.point.at(values))
    for i, (name, place) in enumerate(options.places.items()):
        weighted = float(np.sqrt(vertical @ up[:, i]))
        yield ("places", name, "acceleration"), float(np.sqrt(up[:, i].sum()))
        yield ("places", name, "weighted"), weighted
        yield ("places", name, "vibration_dose"), dose * weighted
        if len(place) == 3:
            rows = model.horizontal(values, place)
            along = np.sqrt(horizontal @ response.accelerations(rows))
            axes = [axis for axis, angle in (("forward", "theta"), ("left", "phi")) if angle in turning]
            squares = [along[("forward", "left").index(axis)] ** 2 for axis in axes]
            for axis, square in zip(axes, squares, strict=True):
                yield ("places", name, f"{axis}_weighted"), float(np.sqrt(square))
            yield ("places", name, "total"), float(np.sqrt(weighted**2 + sum(squares)))
    rotations = np.abs(frequency_weighting("W_e", frequency)) ** 2
    layout = model.vehicle.layout
    for angle in turning:
        row = np.eye(1, model.linear.size, layout.body.index(angle))
        spectrum = response.accelerations(row)[:, 0]
        yield ("body", _ROTATIONS[angle], "acceleration"), float(np.sqrt(spectrum.sum()))
        yield ("body", _ROTATIONS[angle], "weighted"), float(np.sqrt(rotations @ spectrum))
    static, dynamic, travel = model.static_loads(values), response.wheel_loads, response.suspension_travel
    hub = np.sqrt(response.accelerations(model.pads.rows).sum(axis=0))
    for i, wheel in enumerate(model.wheels):
        yield ("wheels", wheel, "acceleration"), float(hub[i])
        yield ("wheels", wheel, "travel"), float(travel[i])
        yield ("wheels", wheel, "load"), float(dynamic[i])
        yield ("wheels", wheel, "load_coefficient"), float(dynamic[i] / static[i])


def _plate_numbers(
    model: RideModel,
    values: Real,
    options: RideOptions,
    near: Neighbour | None,
    plates: dict[str, PlateTest | None],
    failures: dict[Key, str],
) -> Iterator[tuple[Key, float]]:
    """Yield the numbers of a suspension tester; where both sides are alike those of the right are those of the left."""
    static = model.static_loads(values)
    for i, wheel in enumerate(model.wheels):
        yield ("plates", wheel, "static_load"), float(static[i])
        _, axle, side, _ = STATIONS[wheel]
        left = next((one for one in model.vehicle.layout.wheels_of(axle) if STATIONS[one].side > 0), None)
        if side < 0 and left is not None and model.is_symmetric:
            found = plates[left]
        elif near is not None and near.plates[wheel] is None:
            continue
        else:
            try:
                plate = Plate(model, wheel, options.plate_amplitude)
                found = plate.test(values, None if near is None else near.plates[wheel])
            except NotConvergedError as error:
                failures["plates", wheel], found = str(error), None
        plates[wheel] = found
        if found is None:
            continue
        yield ("plates", wheel, "least_load"), found.least_load
        yield ("plates", wheel, "resonance"), found.resonance
        if found.phase is None:
            failures["plates", wheel, "least_phase"] = (
                f"the resonance of wheel {wheel} is below 6 Hz: it has no minimum phase"
            )
        else:
            yield ("plates", wheel, "least_phase"), found.phase


def _curves(
    model: RideModel, values: Real, options: RideOptions, equivalents: EquivalentElements | None, frequency: Real
) -> dict[str, Complex]:
    """Return transmissibilities at frequencies in Hz: all wheels move alike."""
    omega = 2 * np.pi * frequency
    of_rows = None if equivalents is None else equivalents.dynamic_stiffness(omega)
    displacements = model.displacements(values, omega, of_rows)
    together = displacements.sum(axis=2)
    forces = model.tyre_forces(values, omega, displacements).sum(axis=2) / model.static_loads(values)
    travel = together @ model.travel.at(values).T
    hubs = together @ model.pads.rows.T
    found = dict[str, Complex]()
    layout = model.vehicle.layout
    for axle in layout.axles:
        own = [layout.wheels.index(wheel) for wheel in layout.wheels_of(axle)]
        hub, over = hubs[:, own].mean(axis=1), travel[:, own].mean(axis=1)
        named = {"body": hub + over, "wheel": hub, "travel": over, "load": forces[:, own].mean(axis=1)}
        found |= {curve_name(kind, axle): curve for kind, curve in named.items()}
    points = together @ model.point.at(values).T
    return found | {f"place_{name}": points[:, i] for i, name in enumerate(options.places)}


def curve_name(kind: str, axle: str) -> str:
    """Return the name of a transmissibility: ``body_front``, or ``body`` of a vehicle with one axle."""
    return f"{kind}_{AXLE_NAMES[axle]}" if axle else kind


AXLE_NAMES = {"f": "front", "r": "rear", "": "axle"}
"""Names of the axles by their index."""


def _peaks(
    model: RideModel,
    values: Real,
    options: RideOptions,
    equivalents: EquivalentElements | None,
    near: Neighbour | None,
    between: Mapping[str, float],
) -> Iterator[tuple[str, float, float]]:
    """Yield the peaks of the transmissibilities to body and wheel: name, frequency in Hz and gain.

    That of the wheel is above a frequency between those of body and wheel, by axle; a wheel that is damped much has none.
    """
    if near is not None:
        yield from _interpolated(model, values, options, equivalents, near.peaks)
        return
    curves = _curves(model, values, options, equivalents, CURVE_FREQUENCIES)
    centres = {}
    for axle in model.vehicle.layout.axles:
        for kind, low in (("body", 0.0), ("wheel", between.get(axle, 0.0))):
            name = curve_name(kind, axle)
            gain = np.where(low <= CURVE_FREQUENCIES, np.abs(curves[name]), -1.0)
            top = int(np.argmax(gain))
            if 0 < top < len(gain) - 1 and gain[top - 1] >= 0:
                centres[name] = float(CURVE_FREQUENCIES[top])
    # Twice: the parabola is then centred on the peak.
    centres = {name: peak for name, peak, _ in _interpolated(model, values, options, equivalents, centres)}
    yield from _interpolated(model, values, options, equivalents, centres)


def _interpolated(
    model: RideModel,
    values: Real,
    options: RideOptions,
    equivalents: EquivalentElements | None,
    centres: Mapping[str, float],
) -> Iterator[tuple[str, float, float]]:
    if not centres:
        return
    ratios = _NEAR ** np.array([-1.0, 0.0, 1.0])
    frequency = np.concatenate([centre * ratios for centre in centres.values()])
    curves = _curves(model, values, options, equivalents, frequency)
    for i, (name, centre) in enumerate(centres.items()):
        low, middle, high = np.abs(curves[name][3 * i : 3 * i + 3])
        first, second = (high - low) / 2, high - 2 * middle + low
        step = float(np.clip(-first / second, -3, 3)) if second < 0 else 0.0
        yield name, centre * _NEAR**step, float(middle + first * step + second * step**2 / 2)
