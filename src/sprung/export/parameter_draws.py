"""Draws from the joint distribution of the estimated parameters: a table with one vehicle in each row."""

from __future__ import annotations

import importlib
import io
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sprung.dataframes import require_pandas
from sprung.display import shown
from sprung.errors import InputError, Problem
from sprung.export.file import ExportedFile
from sprung.export.outputs import identifier
from sprung.results import Result
from sprung.ride import ParameterDistribution
from sprung.vehicle import EMPTY, PARAMETERS, Vehicle

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

USUAL_NUMBER = 200
"""Draws of a table where none are asked for: a standard deviation from them is known to 5 %."""

MOST = 10_000_000
"""Draws at the most: a table of two gigabytes."""


@shown
@dataclass(frozen=True, slots=True, eq=False)
class Draws:
    """Draws from the joint distribution of the parameters of a vehicle.

    Attributes
    ----------
    names, units
        Of the parameters, in the order of the columns.
    values
        SI, shape (draw, parameter); what was known exactly has one value.
    name, model
        Of the vehicle: its name, and which part of a vehicle it is.
    heights
        m, by their keys in a campaign file.
    notes
        What a reader has to know, one sentence each.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: Array
    name: str
    model: str
    heights: dict[str, float]
    notes: tuple[str, ...] = ()

    def vehicles(self) -> Iterator[Vehicle]:
        """Return the vehicle of each draw, one after the other.

        Returns
        -------
        iterator of Vehicle
        """
        for row in self.values.tolist():
            yield Vehicle.nearest(dict(zip(self.names, row, strict=True)), name=self.name, **self.heights)

    def to_dataframe(self) -> pd.DataFrame:
        """Return the table with a column for each parameter, SI."""
        require_pandas()
        import pandas as pd  # noqa: PLC0415 (optional, and nothing else here needs it)

        return pd.DataFrame(self.values, columns=list(self.names)).rename_axis("draw")

    def csv(self) -> ExportedFile:
        """Return the table as CSV text: a line with the names, then a line for each draw, SI."""
        lines = [",".join(self.names), *(",".join(map(repr, row)) for row in self.values.tolist())]
        return ExportedFile(f"{identifier(self.name)}_draws.csv", ("\n".join(lines) + "\n").encode(), self.notes)

    def parquet(self) -> ExportedFile:
        """Return the table as Parquet, with the units in the metadata of its columns.

        Raises
        ------
        InputError
            If PyArrow is not installed.
        """
        try:
            arrow: Any = importlib.import_module("pyarrow")
            written: Any = importlib.import_module("pyarrow.parquet")
        except ImportError as error:
            do = 'Run: python -m pip install "sprung[parquet]"; or write CSV.'
            raise InputError([Problem("draws as Parquet", "no package pyarrow", "pyarrow installed", do)]) from error
        fields = [
            arrow.field(name, arrow.float64(), metadata={"unit": unit})
            for name, unit in zip(self.names, self.units, strict=True)
        ]
        table = arrow.table([arrow.array(column) for column in self.values.T], schema=arrow.schema(fields))
        content = io.BytesIO()
        written.write_table(table, content)
        return ExportedFile(f"{identifier(self.name)}_draws.parquet", content.getvalue(), self.notes)


def draws(result: Result, number: int = USUAL_NUMBER, *, seed: int | None = None) -> Draws:
    """Draw vehicles from the joint distribution of the estimated parameters.

    The estimates are normally distributed in the coordinates in which they were fitted: the logarithms of parameters that must
    be positive, the others themselves. Correlations, and what the uncertainty of known quantities adds, are in their covariance
    matrix. A parameter that cannot be negative is 0 where its draw is.

    Parameters
    ----------
    result
        Of an identification, every parameter determined.
    number
        Number of draws.
    seed
        Of the random numbers; None gives other ones each time.

    Returns
    -------
    Draws

    Raises
    ------
    InputError
        If the result is rejected, a parameter is not determined, or the number or seed is impossible; all reasons at once.
    """
    problems = [
        Problem(f"draws of {result.name}: {what}", repr(value), f"a whole number, {expected}", "Correct it.")
        for what, value, least, most, expected in (
            ("number", number, 1, MOST, f"1 or more and no more than {MOST}"),
            ("seed", seed, 0, math.inf, "0 or more"),
        )
        if value is not None and (isinstance(value, bool) or int(value) != value or not least <= value <= most)
    ]
    try:
        vehicle = result.vehicle
    except InputError as error:
        problems += error.problems
    if problems:
        raise InputError(problems)
    distribution = ParameterDistribution.of_result(result, EMPTY)
    names, values = distribution.names, distribution.draw(number, seed)
    notes = []
    for column, name in enumerate(names):
        negative = values[:, column] < 0
        if negative.any() and not PARAMETERS[name].signed:
            notes.append(f"{int(negative.sum())} of {number} draws of {name} are 0: it cannot be negative.")
            values[negative, column] = 0.0
    units = tuple(PARAMETERS[name].unit for name in names)
    return Draws(names, units, values, result.name, vehicle.model, dict(result.setup.heights), tuple(notes))
