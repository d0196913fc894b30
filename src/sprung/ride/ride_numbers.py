"""Ride and inspection numbers of an identified vehicle, each with its uncertainty."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Problems, did_you_mean
from sprung.results import Result
from sprung.ride.distribution import ParameterDistribution, estimate_of_number
from sprung.ride.evaluation import AXLE_NAMES, CURVE_FREQUENCIES, Evaluation, Key, evaluate
from sprung.ride.options import HOUR, USUAL_ROADS, USUAL_SPEED, RideOptions, checked_options
from sprung.ride.quantities import quantity_of
from sprung.ride.records import Estimates, RideNumbers, RoadNumbers, Transmissibility
from sprung.ride.ride_model import RideModel
from sprung.ride.road import Road
from sprung.uncertainty import Estimate, NamedValues
from sprung.vehicle import EMPTY, Load, Vehicle

Real = NDArray[np.float64]

_KMH = 3.6
"""km/h in 1 m/s."""


def ride_numbers(
    source: Result | Vehicle,
    *,
    roads: Iterable[str | Road] = USUAL_ROADS,
    speeds: Sequence[float] = (USUAL_SPEED,),
    places: Mapping[str, Sequence[float]] | None = None,
    load: str | Load = EMPTY,
    tracks: str | None = None,
    duration: float = HOUR,
) -> RideNumbers:
    """Return ride and inspection numbers of a vehicle, each with its standard uncertainty and 95 % interval.

    Uncertainties are propagated from the joint distribution of the parameters, to first order; those of a `Vehicle`, whose
    parameters are exact, are zero. A vehicle with nonlinear elements is linearised for every road at the amplitudes of its
    motion (statistical linearisation), and on a suspension tester at those of every frequency (harmonic linearisation).

    Parameters
    ----------
    source
        Result of an identification, or a vehicle.
    roads
        Classes of ISO 8608, ``A`` to ``H``, or roads.
    speeds
        m/s.
    places
        On the body, by name, m: forward of the front axle, left of the centreline and, for horizontal motion, above the
        ground. Over the axles and half way between them unless given.
    load
        What is on the vehicle: a load of the campaign by its name, or any other.
    tracks
        What the left and the right track have in common: ``isotropic`` (a surface that is alike in every direction), ``same``
        or ``independent``.
    duration
        Of the drive, s, for the vibration dose value.

    Returns
    -------
    RideNumbers

    Raises
    ------
    InputError
        If the verdict is reject, a parameter is not determined, or an option is impossible.
    """
    problems = Problems()
    on_board = _load_of(source, load, problems)
    if isinstance(source, Vehicle):
        distribution, vehicle, terms, own_tracks = ParameterDistribution.of_vehicle(source), source, None, None
    else:
        distribution = ParameterDistribution.of_result(source, on_board)
        values = dict(zip(distribution.names, distribution.values.tolist(), strict=True))
        vehicle = Vehicle.nearest(values, name=source.name, **source.setup.heights)
        terms, own_tracks = source.fit.model, source.fit.tracks
    chosen = _usual_places(vehicle) if places is None else places
    tracks = tracks or ("same" if distribution.undetermined else "isotropic")
    options = checked_options(roads, speeds, chosen, tracks, duration, vehicle.heights, problems)
    problems.raise_if_any()
    points = [(place[0], place[1]) for place in options.places.values()]
    model = RideModel.of(vehicle, on_board, points, distribution.names, terms, own_tracks)
    is_uncertain = bool(distribution.std.any()) or bool(distribution.undetermined) or not distribution.is_scaled
    base = evaluate(model, distribution.values, options, has_neighbours=is_uncertain)
    return _Assembly(model, distribution, options, base).numbers()


def _load_of(source: Result | Vehicle, load: str | Load, problems: Problems) -> Load:
    if isinstance(load, Load):
        return load
    known = {EMPTY.name: EMPTY}
    if not isinstance(source, Vehicle):
        known |= {one.name: one for one in source.setup.loads}
    if load not in known:
        problems.add("ride numbers: load", f"'{load}'", "a load of the campaign", did_you_mean(load, known))
        return EMPTY
    return known[load]


def _usual_places(vehicle: Vehicle) -> dict[str, tuple[float, float]]:
    """Return places over the axles and between them."""
    if not vehicle.layout.pitches:
        return {"body": (0.0, 0.0)}
    wheelbase = round(vehicle.wheelbase, 3)
    return {"front": (0.0, 0.0), "middle": (-wheelbase / 2, 0.0), "rear": (-wheelbase, 0.0)}


@dataclass(frozen=True, eq=False)
class _Assembly:
    """Numbers at the estimates, and what their uncertainties are computed from."""

    model: RideModel
    distribution: ParameterDistribution
    options: RideOptions
    base: Evaluation

    def numbers(self) -> RideNumbers:
        """Return the ride numbers."""
        base, distribution = self.base, self.distribution
        keys = list(base.numbers)
        gains = [np.abs(curve) for curve in base.curves.values()]
        value = np.concatenate([np.array([base.numbers[key] for key in keys]), *gains])

        def function(values: Real) -> Real:
            found = evaluate(self.model, values, self.options, base.neighbour)
            own = np.array([found.numbers.get(key, np.nan) for key in keys])
            return np.concatenate([own, *(np.abs(found.curves[name]) for name in base.curves)])

        std, is_determined = distribution.spread(function, value)
        estimates = {key: self._estimate(key, *one) for key, *one in zip(keys, value, std, is_determined, strict=False)}
        bands = std[len(keys) :].reshape(len(gains), -1)
        curves = {
            name: Transmissibility(CURVE_FREQUENCIES, np.abs(curve), np.unwrap(np.angle(curve)), band)
            for (name, curve), band in zip(base.curves.items(), bands, strict=True)
        }
        axles = {AXLE_NAMES[axle]: own for axle, own in _grouped(estimates, "axles").items()}
        return RideNumbers(
            vehicle=self.model.vehicle.name,
            load=self.model.load.name,
            options=self.options,
            axles=axles,
            half_cars=_grouped(estimates, "half_cars"),
            peaks=_grouped(estimates, "peaks"),
            plates=_grouped(estimates, "plates"),
            roads=tuple(self._roads(estimates)),
            curves=curves,
            notes=tuple(self._notes(estimates)),
        )

    def _estimate(self, key: Key, value: float, std: float, is_determined: bool) -> Estimate:
        quantity = quantity_of(key)
        determined = bool(is_determined) and bool(np.isfinite(std))
        return estimate_of_number(float(value), float(std), quantity.unit, determined, quantity.limits)

    def _roads(self, estimates: Mapping[Key, Estimate]) -> Iterator[RoadNumbers]:
        for i, drive in enumerate(self.options.drives):
            own = {key[2:]: one for key, one in estimates.items() if key[:2] == ("roads", f"{i}")}
            if own:
                groups = {group: _grouped(own, group) for group in ("places", "body", "wheels")}
                yield RoadNumbers(road=drive.road.name, speed=drive.speed, **groups)

    def _notes(self, estimates: Mapping[Key, Estimate]) -> Iterator[str]:
        options, model = self.options, self.model
        low, high = options.band
        tracks = {
            "isotropic": "left and right tracks as on an isotropic surface",
            "same": "one profile under left and right wheels",
            "independent": "independent profiles left and right",
        }[options.tracks]
        beside = f", {tracks}" if model.vehicle.layout.rolls else ""
        behind = (
            ", rear wheels behind front wheels by the wheelbase over the speed" if model.vehicle.layout.pitches else ""
        )
        yield f"Roads of ISO 8608 with the waviness 2, continued from {low:g} to {high:g} Hz, point contact{beside}{behind}."
        dose = f"VDV of a drive of {options.duration:g} s, Gaussian: (3 T)^¼ times the weighted rms."
        yield f"{dose} Accelerations are those of the body itself, under a seat."
        if model.nonlinear is not None:
            drive = options.drives[options.reference]
            yield (
                "The vehicle is not linear: on each road it is linearised at the amplitudes of its motion there (statistical "
                "linearisation), on a suspension tester at those of each frequency (harmonic linearisation), and quarter cars, "
                f"modes and transmissibilities hold on road {drive.road.name} at {_KMH * drive.speed:.3g} km/h."
            )
        if not self.distribution.is_scaled:
            yield (
                "The absolute scale is not determined: masses, rates and forces have no value; all other numbers need no "
                "scale."
            )
        if self.distribution.undetermined:
            names = ", ".join(self.distribution.undetermined)
            yield f"Not determined: {names}. What depends on roll has no value."
        yield from self._warnings(estimates)
        yield from (f"Not computed: {reason}." for reason in dict.fromkeys(self.base.failures.values()))

    def _warnings(self, estimates: Mapping[Key, Estimate]) -> Iterator[str]:
        lifted = sorted({key[1] for key in estimates if key[0] == "plates" and self.base.numbers[key] < 0})
        if lifted:
            yield f"On a tester wheel {', '.join(lifted)} would lift off the plate: its minimum force is zero."
        high = [
            f"{drive.road.name} at {_KMH * drive.speed:.3g} km/h"
            for i, drive in enumerate(self.options.drives)
            for coefficients in [
                [v for k, v in self.base.numbers.items() if k[:2] == ("roads", f"{i}") and k[-1] == "load_coefficient"]
            ]
            if coefficients and max(coefficients) > 1 / 3
        ]
        if high:
            yield (
                f"On road {', '.join(high)} the dynamic wheel load exceeds a third of the static one: wheels lift off at "
                "times, which the linearised tyres do not show."
            )


def _grouped(estimates: Mapping[Key, Estimate], group: str) -> dict[str, Estimates]:
    """Return the estimates of one group by place and name."""
    found: dict[str, dict[str, Estimate]] = {}
    for key, estimate in estimates.items():
        if key[0] == group:
            found.setdefault(key[1], {})[key[-1]] = estimate
    return {place: NamedValues(own) for place, own in found.items()}
