"""What a fit is told beforehand: of the vehicle, of its sensors, and what holds in vehicles of all kinds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sprung.estimation.starts import VehicleSize
from sprung.uncertainty import KnownValue
from sprung.vehicle import LOW_PASS_CORNER, PARAMETERS, Readout, Sensor, layout_of, parameter_of, uncertainties_of


def statements_of(
    known: Mapping[str, KnownValue], sensors: Sequence[Sensor], names: Sequence[str]
) -> dict[str, KnownValue]:
    """Return everything that is known beforehand, SI, by name.

    Parameters
    ----------
    known
        What is stated of the vehicle and of loads, SI. Parameters of terms that the model has not yet are left out.
    sensors
        With the uncertainties of their gains, places and delays.
    names
        Parameters of the model: some are about the same in every vehicle, unless they are stated.

    Returns
    -------
    dict
    """
    about = {name: parameter_of(name) for name in names}
    usual = {name: KnownValue(one.usual, one.usual_std) for name, one in about.items() if one.usual_std > 0}
    stated = {name: value for name, value in known.items() if name in names or name not in PARAMETERS}
    return {**usual, **stated, **uncertainties_of(sensors)}


def readout_of(sensors: Sequence[Sensor], names: Sequence[str], known: Mapping[str, KnownValue]) -> Readout:
    """Return what sensors read, everything uncertain of them as further parameters.

    Parameters
    ----------
    sensors
        With the uncertainties of their gains, places and delays.
    names
        Parameters of the model.
    known
        What is known beforehand, SI, by name; the corner of a low-pass that all passed is a parameter if it is among them.

    Returns
    -------
    Readout
    """
    wheelbase = VehicleSize.of(known, sensors, layout_of(names)).wheelbase
    return Readout.with_unknowns(sensors, names, wheelbase, has_corner=LOW_PASS_CORNER in known)
