"""Records of a comparison of results."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Literal

from sprung.dataframes import require_pandas
from sprung.display import shown
from sprung.study.scatter import ScatterEstimate
from sprung.study.significance import JointTest

if TYPE_CHECKING:
    import pandas as pd

Finding = Literal["none", "likely", "certain", "given", "not comparable"]


@shown
@dataclass(frozen=True, slots=True)
class ResultValue:
    """A quantity in one result.

    Attributes
    ----------
    value, std
        In the quantity's unit; None where the result has no value, std 0 where it was known exactly.
    why_not
        Why the result has no value; empty where it has one.
    """

    value: float | None
    std: float | None
    why_not: str = ""


@shown
@dataclass(frozen=True, slots=True)
class Difference:
    """Difference of a quantity between one result and the first.

    Attributes
    ----------
    value, std
        In the quantity's unit; standard uncertainty for independent errors. None where it is not comparable.
    interval95
        95 % confidence interval of the difference, in the quantity's unit.
    percent
        Difference in percent of the first value; None where that is 0.
    z
        Difference in standard uncertainties, dimensionless.
    p, p_holm
        Probability of a larger difference between two tests of the same vehicle, for this quantity alone and corrected for the
        number of quantities; dimensionless.
    finding
        ``none``: not significant; ``likely``: `p_holm` up to 0.05; ``certain``: up to 0.001; ``given``: known in both;
        ``not comparable``.
    why
        Why it is not comparable; empty where it is, and where neither result has the quantity.
    """

    value: float | None = None
    std: float | None = None
    interval95: tuple[float, float] | None = None
    percent: float | None = None
    z: float | None = None
    p: float | None = None
    p_holm: float | None = None
    finding: Finding = "not comparable"
    why: str = ""


@shown
@dataclass(frozen=True, slots=True)
class QuantityComparison:
    """One row of the comparison.

    Attributes
    ----------
    unit
        SI; Hz of frequencies, 1 of ratios.
    values
        Of each result, in their order.
    differences
        Of each result but the first, from the first.
    """

    unit: str
    values: tuple[ResultValue, ...]
    differences: tuple[Difference, ...]


@shown
@dataclass(frozen=True, slots=True)
class ComparedResult:
    """One of the compared results.

    Attributes
    ----------
    name
        Label in the comparison.
    vehicle, verdict, reasons
        Of the result.
    """

    name: str
    vehicle: str
    verdict: Literal["accept", "doubtful", "reject"]
    reasons: tuple[str, ...]


@shown
@dataclass(frozen=True, slots=True)
class Comparison:
    """Results side by side.

    Attributes
    ----------
    results
        The compared results; the first is the reference.
    per_total_mass
        Whether masses, inertias and rates are divided by the total mass, because the scale of a result is not known.
    parameters
        By name.
    modes
        By load and mode, such as ``empty, body bounce``: frequency (Hz) and damping ratio (1).
    joint
        Of each result but the first: joint test of all parameters against the first; None where it is not possible.
    scatter
        By name of the quantity, where three results or more have it.
    notes
        Remarks on the comparison, in sentences.
    """

    results: tuple[ComparedResult, ...]
    per_total_mass: bool
    parameters: dict[str, QuantityComparison]
    modes: dict[str, QuantityComparison]
    joint: tuple[JointTest | None, ...]
    scatter: dict[str, ScatterEstimate]
    notes: tuple[str, ...]

    @property
    def rejected(self) -> tuple[str, ...]:
        """Labels of the rejected results."""
        return tuple(result.name for result in self.results if result.verdict == "reject")

    def to_dataframe(self) -> pd.DataFrame:
        """Return values and differences as a table, a row for each quantity of each result, SI.

        Returns
        -------
        DataFrame
            By quantity and result: ``value``, ``std`` and ``unit``; and, except for the first result, ``difference`` from
            it with ``difference_std``, ``percent``, ``z``, ``p_holm`` and ``finding``.
        """
        require_pandas()
        import pandas as pd  # noqa: PLC0415 (optional, and nothing else here needs it)

        rows = [
            {"quantity": name, "result": result.name, "value": own.value, "std": own.std, "unit": row.unit}
            | ({} if difference is None else _difference_columns(difference))
            for name, row in {**self.parameters, **self.modes}.items()
            for result, own, difference in zip(self.results, row.values, (None, *row.differences), strict=True)
        ]
        columns = ["quantity", "result", "value", "std", "unit", *_difference_columns(Difference())]
        return pd.DataFrame(rows, columns=columns).set_index(["quantity", "result"])

    def document(self) -> dict[str, Any]:
        """Return everything as plain values, for JSON."""
        return {
            **asdict(self),
            "scatter": {
                name: {**asdict(scatter), "stands_out": scatter.stands_out} for name, scatter in self.scatter.items()
            },
        }


def _difference_columns(difference: Difference) -> dict[str, float | str | None]:
    return {
        "difference": difference.value,
        "difference_std": difference.std,
        "percent": difference.percent,
        "z": difference.z,
        "p_holm": difference.p_holm,
        "finding": difference.finding,
    }
