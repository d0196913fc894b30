"""One row per identified campaign: verdict, parameters, characteristics, and the covariance matrix of its estimates."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sprung.analysis import Analysis, identify_campaign, result_of
from sprung.batch import Columns, Row
from sprung.campaign import Campaign, read
from sprung.vehicle import CHARACTERISTICS, PARAMETERS, is_nuisance

Real = NDArray[np.float64]

_ABOUT: Columns = {
    "vehicle": "text",
    "identification": "text",
    "date": "text",
    "place": "text",
    "operator": "text",
    "verdict": "text",
    "reasons": "texts",
    "faults": "texts",
    "model": "texts",
    "tracks": "text",
    "drops": "integer",
    "sprung": "text",
}

VECTOR: Columns = {"coordinates": "texts", "position": "numbers", "covariance": "numbers"}
"""Columns with all estimates of a campaign as a vector: names, values of the coordinates, and their covariance matrix, row by
row. The coordinate of a positive parameter is the natural logarithm of its value in SI; that of another is the value."""

QUANTITIES = (*PARAMETERS, *CHARACTERISTICS)
"""Quantities with a column of values and, ``_std`` appended to its name, one of standard uncertainties; SI."""

COLUMNS: Columns = {
    **_ABOUT,
    **{column: "number" for name in QUANTITIES for column in (name, f"{name}_std")},
    **VECTOR,
}
"""Columns of the row of a campaign."""


def identify_row(argument: tuple[str, dict[str, Any]]) -> Row:
    """Read and identify a campaign, and return its row.

    Parameters
    ----------
    argument
        Path of the campaign file, and options of `sprung.identify`.

    Returns
    -------
    Row
        With the columns of `COLUMNS`.

    Raises
    ------
    InputError
        If the campaign cannot be used.
    """
    path, options = argument
    return row_of(identify_campaign(read(path), **options))


def row_of(run: Analysis) -> Row:
    """Return the row of an analysis that is complete.

    Parameters
    ----------
    run
        From `sprung.analysis.identify_campaign`.

    Returns
    -------
    Row
        With the columns of `COLUMNS`.
    """
    result = result_of(run)
    campaign: Campaign = run.campaign
    test = campaign.test
    row: Row = {
        "vehicle": result.name,
        "identification": result.tested_vehicle.identification,
        "date": None if test.date is None else test.date.isoformat(),
        "place": test.place,
        "operator": test.operator,
        "verdict": result.verdict.state,
        "reasons": list(result.verdict.reasons),
        "faults": sorted({fault.code for fault in result.faults}),
        "model": list(result.fit.model),
        "tracks": result.fit.tracks,
        "drops": len(result.drops),
        "sprung": version("sprung"),
    }
    for name, estimate in {**result.parameters, **result.derived}.items():
        if name in QUANTITIES:
            row[name], row[f"{name}_std"] = estimate.value, estimate.std
    if result.verdict.state != "reject":
        row |= _vector(run)
    return row


def _vector(run: Analysis) -> Row:
    """Return all estimates of the vehicle with their covariance matrix, in the coordinates in which they are normal."""
    statistics = run.statistics
    assert statistics is not None  # noqa: S101 (the analysis is complete; for the type checker)
    own = statistics.only([name for name in statistics.names if not is_nuisance(name)])
    positive = np.array([PARAMETERS[name].positive for name in own.names])
    scale = np.where(positive, 1.0, own.slopes)
    with np.errstate(divide="ignore", invalid="ignore"):
        position = np.where(positive, np.log(own.values), own.values)
    covariance: Real = own.relative_covariance * np.outer(scale, scale)
    return {"coordinates": list(own.names), "position": position.tolist(), "covariance": covariance.ravel().tolist()}
