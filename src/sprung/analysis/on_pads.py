"""What cannot be done with records of a vehicle on pads: they are fitted in the frequency domain, and not stepped in time."""

from __future__ import annotations

from collections.abc import Mapping

from sprung.analysis.analysis import Analysis
from sprung.errors import Fault, Problems
from sprung.selection import choose_structure
from sprung.vehicle import SensorQuantity, sensor_unknown

NOT_STEPPED = "records on pads are not followed step by step"
"""Why nothing nonlinear is tried with them."""


_FAR = 5.0
"""Standard uncertainties from which a sensor is not what is stated of it."""

_IN_WORDS: Mapping[SensorQuantity, str] = {
    "gain": "gain",
    "x": "place",
    "y": "place",
    "tilt_x": "tilt",
    "tilt_y": "tilt",
    "delay": "delay",
}
"""Unknowns of a sensor in words."""


def has_pads(run: Analysis) -> bool:
    """Return whether pads drove the vehicle in any of the records that are used."""
    return any(decay.pads for decay in run.prepared.decays)


def require_linear_terms(run: Analysis) -> None:
    """Raise an `InputError` where nonlinear terms are requested for records on pads.

    Parameters
    ----------
    run
        With its decays.
    """
    if not has_pads(run):
        return
    requested = choose_structure(run.campaign, run.options.tracks, run.options.terms)
    nonlinear = [term for term in requested.terms if term not in requested.linear_terms]
    problems = Problems()
    if nonlinear:
        do = "Leave them out, or identify the drops without the records on pads."
        where = "campaign" if run.campaign.path is None else f"{run.campaign.path.name}: [model]"
        found = f"extras {', '.join(nonlinear)}, and drops on pads"
        problems.add(where, found, "linear terms where pads drive the vehicle", do)
    problems.raise_if_any()


def suspect_sensor(run: Analysis) -> tuple[Fault, ...]:
    """Return the sensor that the fit of records on pads takes furthest from what is stated of it, as a fault, if it is far.

    Which of several sensors is at fault is not isolated there, and what is stated is not corrected.

    Parameters
    ----------
    run
        With its fit.
    """
    found = run.fit.parameters
    far = [
        ((found[name] - stated.value) / stated.std, sensor.channel, what)
        for sensor in run.model.structure.sensors
        for quantity, what in _IN_WORDS.items()
        if (name := sensor_unknown(quantity, sensor.channel)) in found
        and (stated := sensor.uncertainties.get(name)) is not None
    ]
    ratio, channel, what = max(far, key=lambda one: abs(one[0]), default=(0.0, "", ""))
    if abs(ratio) < _FAR or not has_pads(run):
        return ()
    text = f"the fit takes its {what} {abs(ratio):.0f} times as far from what is stated as its standard uncertainty"
    do = "Check this sensor and those of the same wheel station; correct what is stated of it."
    return (Fault("unlike-others", channel, f"{text}; nothing was changed", do),)
