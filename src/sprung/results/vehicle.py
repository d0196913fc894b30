"""The identified vehicle, to be simulated and exported."""

from __future__ import annotations

from collections.abc import Mapping

from sprung.assessment import Verdict
from sprung.errors import InputError, Problem, RejectedResultError
from sprung.uncertainty import Estimate
from sprung.vehicle import Vehicle


def identified_vehicle(
    name: str, verdict: Verdict, parameters: Mapping[str, Estimate], heights: Mapping[str, float]
) -> Vehicle:
    """Return the vehicle whose parameters are the estimates.

    Parameters
    ----------
    name
        The vehicle's.
    verdict
        Of the result.
    parameters
        By name.
    heights
        Above the ground, m, by their keys in a campaign file.

    Returns
    -------
    Vehicle

    Raises
    ------
    RejectedResultError
        If the verdict is reject.
    InputError
        If a parameter is not determined.
    """
    if verdict.state == "reject":
        do = "Read the reasons of the verdict; measure again, or correct the campaign."
        raise RejectedResultError([Problem(f"result of {name}", "the verdict reject", "accept or doubtful", do)])
    values = {parameter: estimate.value for parameter, estimate in parameters.items() if estimate.value is not None}
    missing = [parameter for parameter in parameters if parameter not in values]
    if missing:
        found = f"no value of {', '.join(missing)}"
        do = "The report says what would determine them; ratios to the total mass are in it, too."
        raise InputError([Problem(f"result of {name}", found, "every parameter determined", do)])
    return Vehicle.nearest(values, name=name, **heights)
