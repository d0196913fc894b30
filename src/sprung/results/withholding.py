"""What a rejected result keeps to itself: every number that follows from the fitted vehicle.

What shows why it was rejected stays: residuals, noise, misfit of each channel, measured and fitted recordings, how well each
drop is predicted, what was wrong, and how the model was chosen. Modes that need no vehicle come from `sprung.modes`.
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
        As it was fitted, or read from a file that an older sprung wrote.

    Returns
    -------
    Result
        With every estimated parameter and derived quantity ``unidentifiable`` and without value, and without ratios,
        correlations, modes of the fitted vehicle, amplitude curves and a next step.
    """
    if result.verdict.state != "reject":
        return result
    parameters = {name: without_value(found) for name, found in result.parameters.items()}
    names = tuple(name for name, found in parameters.items() if found.status == "unidentifiable")
    return replace(
        result,
        parameters=parameters,
        derived={name: without_value(found) for name, found in result.derived.items()},
        scale=Scale(result.scale.known, {}),
        unidentifiable=(Unidentifiable(names, NO_ESTIMATES),) if names else (),
        correlation=Correlation((), ()),
        modes=dict.fromkeys(result.modes, ()),
        amplitude=(),
        next_step=None,
        setup=None if result.setup is None else _without_findings(result.setup),
    )


def without_value(found: Estimate) -> Estimate:
    """Return an estimate as undetermined; what was known beforehand stays known."""
    if found.status != "estimated":
        return found
    return Estimate(None, None, None, found.unit, "unidentifiable")


def _without_findings(setup: Setup) -> Setup:
    known = {name: replace(one, found=without_value(one.found)) for name, one in setup.known.items()}
    return replace(setup, known=known)
