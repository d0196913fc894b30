"""Removal of every number that follows from the fitted vehicle from a rejected result.

What shows why it was rejected stays: residuals, noise, misfit of each channel, measured and fitted recordings, the errors of
prediction, the faults, and how the model was chosen. `sprung.modes` finds modes without a vehicle.
"""

from __future__ import annotations

from dataclasses import replace

from sprung.estimation import Correlation, Scale, Unidentifiable
from sprung.results.result import Result
from sprung.results.setup import Setup
from sprung.uncertainty import Estimate

NO_ESTIMATES = "The model does not describe the recordings; no estimates are reported"


def withhold_estimates(result: Result) -> Result:
    """Return a result without estimates where it is rejected, and any other as it is.

    Parameters
    ----------
    result
        As it was fitted.

    Returns
    -------
    Result
        With every estimated parameter and derived quantity ``unidentifiable`` and without value, and without ratios,
        comparisons with what was known beforehand, correlations, modes of the fitted vehicle, sensors, additional terms,
        force and amplitude curves and a next step.
    """
    if result.verdict.state != "reject":
        return result
    parameters = {name: without_value(estimate) for name, estimate in result.parameters.items()}
    names = tuple(name for name, estimate in parameters.items() if estimate.status == "unidentifiable")
    return replace(
        result,
        parameters=parameters,
        derived={name: without_value(estimate) for name, estimate in result.derived.items()},
        scale=Scale(result.scale.known, {}),
        unidentifiable=(Unidentifiable(names, NO_ESTIMATES),) if names else (),
        correlation=Correlation((), ()),
        modes=dict.fromkeys(result.modes, ()),
        sensors=(),
        additional_terms="",
        curves={},
        amplitude=(),
        next_step=None,
        setup=_without_estimates(result.setup),
    )


def without_value(estimate: Estimate) -> Estimate:
    """Return an estimate as undetermined; what was known beforehand stays known."""
    if estimate.status != "estimated":
        return estimate
    return Estimate(None, None, None, estimate.unit, "unidentifiable")


def _without_estimates(setup: Setup) -> Setup:
    known = {name: replace(prior, found=without_value(prior.found), missed=None) for name, prior in setup.known.items()}
    return replace(setup, known=known)
