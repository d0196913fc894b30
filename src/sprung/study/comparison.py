"""Results side by side: what differs between them, and how sure that is."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from sprung.dataframes import require_pandas
from sprung.display import shown
from sprung.errors import Problems
from sprung.results import Result, load
from sprung.study.scatter import ScatterEstimate, complete_rows, estimate_scatter
from sprung.study.significance import JointTest, holm, joint_test, two_sided
from sprung.uncertainty import NORMAL_95
from sprung.vehicle import CHARACTERISTICS, PARAMETERS, WHEEL_LOADS

if TYPE_CHECKING:
    import pandas as pd

LIKELY, CERTAIN = 0.05, 0.001
"""Chances, corrected for the number of comparisons, below which a difference is called likely and certain."""

Finding = Literal["none", "likely", "certain", "given", "not comparable"]

_PER_MASS = " / total mass"
_ABSENT = "has another model"
_ABOUT_AXES = ("I_xx", "I_yy")


@shown
@dataclass(frozen=True, slots=True)
class ResultValue:
    """What one result says of a quantity.

    Attributes
    ----------
    value, std
        In the quantity's unit; None where nothing is said, 0 for the std of what was known exactly.
    why_not
        Why nothing is said; empty where something is.
    """

    value: float | None
    std: float | None
    why_not: str = ""


@shown
@dataclass(frozen=True, slots=True)
class Difference:
    """What one result says of a quantity, less what the first says.

    Attributes
    ----------
    value, std
        In the quantity's unit; the standard uncertainty of independent errors. None where nothing can be compared.
    interval95
        Within which the difference is, in the quantity's unit: one that is outside would have been seen.
    percent
        The same in percent of the first's value; None where that is 0.
    z
        In standard uncertainties, dimensionless.
    p, p_holm
        Chance of a larger difference between two tests of the same vehicle, for this quantity alone and corrected for their
        number; dimensionless.
    finding
        ``none`` to be seen, ``likely`` (`p_holm` up to 0.05) or ``certain`` (up to 0.001); ``given`` where both were known
        beforehand; ``not comparable``.
    why
        Why nothing can be compared; empty where it can, and where neither has the quantity.
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
    told
        By each result, in their order.
    differences
        Of each result but the first, against the first.
    """

    unit: str
    told: tuple[ResultValue, ...]
    differences: tuple[Difference, ...]


@shown
@dataclass(frozen=True, slots=True)
class ComparedResult:
    """One of the results that are compared.

    Attributes
    ----------
    name
        What it is called here.
    vehicle, verdict, reasons
        As it says itself.
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
        What is compared; the others with the first.
    per_total_mass
        Whether masses, inertias and rates are divided by the vehicle's total mass, because not every result knows its scale.
    parameters
        By name.
    modes
        By load and mode, such as ``empty, body bounce``: frequency (Hz) and damping ratio (1).
    joint
        Of each result but the first: all parameters at once against the first; None where that cannot be said.
    scatter
        By name of the quantity, where three results or more tell it.
    notes
        What must be known to read it, in sentences.
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
        """Names of the results whose numbers must not be used."""
        return tuple(one.name for one in self.results if one.verdict == "reject")

    def to_dataframe(self) -> pd.DataFrame:
        """Return values and differences as a table, a row for each quantity of each result, SI.

        Returns
        -------
        DataFrame
            By quantity and result: ``value``, ``std`` and ``unit``; and ``difference`` from the first result with its
            ``difference_std``, ``percent``, ``z``, ``p_holm`` and ``finding``, which the first result itself has not.
        """
        require_pandas()
        import pandas as pd  # noqa: PLC0415 (optional, and nothing else here needs it)

        rows = [
            {"quantity": name, "result": one.name, "value": told.value, "std": told.std, "unit": row.unit}
            | ({} if other is None else _difference_columns(other))
            for name, row in {**self.parameters, **self.modes}.items()
            for one, told, other in zip(self.results, row.told, (None, *row.differences), strict=True)
        ]
        columns = ["quantity", "result", "value", "std", "unit", *_difference_columns(Difference())]
        return pd.DataFrame(rows, columns=columns).set_index(["quantity", "result"])

    def document(self) -> dict[str, Any]:
        """Give everything as plain values, for JSON."""
        return {
            **asdict(self),
            "scatter": {name: {**asdict(one), "stands_out": one.stands_out} for name, one in self.scatter.items()},
        }


def _difference_columns(found: Difference) -> dict[str, float | str | None]:
    return {
        "difference": found.value,
        "difference_std": found.std,
        "percent": found.percent,
        "z": found.z,
        "p_holm": found.p_holm,
        "finding": found.finding,
    }


def compare(results: Sequence[Result | str | Path], *, names: Sequence[str] | None = None) -> Comparison:
    """Put results side by side and say which differences are more than chance.

    Parameters
    ----------
    results
        Two or more: from `sprung.identify`, or the folders (or their results.json) where they were saved. The first is what the
        others are compared with.
    names
        What to call them; found from folders or vehicles where it is not given.

    Returns
    -------
    Comparison

    Raises
    ------
    InputError
        If there are fewer than two, not as many names as results, or a file is not a result; with every reason.

    Notes
    -----
    Errors of different results are taken to be independent. What they have in common (the same weighing, the same misplaced
    sensor) moves both alike, so that a difference is then surer than is said here. Chances are corrected by
    Holm's method, those of the parameters and those of the modes each as one table: between two tests of the same vehicle a
    table holds any difference that is called likely or certain in at most 5 of 100 cases.

    Examples
    --------
    >>> import sprung
    >>> car = sprung.Vehicle(m_s=1380, I_yy=2440, I_xx=380, m_uf=40.5, m_ur=45.4, k_sf=17000, k_sr=22000, k_tf=192000,
    ...                      k_tr=192000, c_sf=1500, c_sr=1500, a=1.25, b=1.51, t_f=0.74, t_r=0.74)
    >>> worn = sprung.Vehicle.from_parameters({**car.parameters, "c_sf": 1300})
    >>> found = [sprung.identify(sprung.simulate(one, seed=seed)) for seed, one in enumerate((car, worn))]
    >>> comparison = sprung.compare(found, names=["new", "worn"])
    >>> {name: row.differences[0].finding for name, row in comparison.parameters.items() if "c_s" in name}
    {'c_sf / total mass': 'certain', 'c_sr / total mass': 'none'}
    """
    _check(results, names)
    problems = Problems()
    read: list[Result] = []
    for one in results:
        with problems.collect():
            read.append(one if isinstance(one, Result) else load(one, series=False))
    problems.raise_if_any()
    labels = tuple(names) if names is not None else _labels(results, read)
    ratios = any(one.scale.per_total_mass and not one.scale.known for one in read if one.verdict.state != "reject")
    parameters = _tested(_parameters(read, labels, ratios))
    modes = _tested(_modes(read, labels))
    return Comparison(
        results=tuple(
            ComparedResult(label, one.name, one.verdict.state, one.verdict.reasons)
            for label, one in zip(labels, read, strict=True)
        ),
        per_total_mass=ratios,
        parameters=parameters,
        modes=modes,
        joint=tuple(_jointly(read[0], other, parameters, i) for i, other in enumerate(read[1:])),
        scatter=estimate_scatter(
            {
                name: complete_rows((label, told.value, told.std) for label, told in zip(labels, row.told, strict=True))
                for name, row in {**parameters, **modes}.items()
            }
        ),
        notes=tuple(_notes(read, labels, ratios)),
    )


def _check(results: Sequence[object], names: Sequence[str] | None) -> None:
    problems = Problems()
    if isinstance(results, str | Path | Result) or len(results) < 2:  # a string is a sequence too
        found = "one result" if isinstance(results, str | Path | Result) else f"{len(results)} results"
        problems.add("compare", found, "two or more", "Name the results folders to put side by side.")
    elif names is not None and (len(names) != len(results) or len(set(names)) != len(names)):
        found = f"the names {', '.join(names)} for {len(results)} results"
        problems.add("compare", found, "a name of its own for each", "Give as many different names as results.")
    problems.raise_if_any()


def _labels(given: Sequence[Result | str | Path], read: Sequence[Result]) -> tuple[str, ...]:
    """Call each by the part of its path in which it differs from the others, or by its vehicle."""
    parts = [
        ()
        if isinstance(one, Result)
        else tuple(part for part in Path(one).resolve().parts if part not in ("/", "results.json"))
        for one in given
    ]
    while all(parts) and len({one[-1] for one in parts}) == 1:
        parts = [one[:-1] for one in parts]
    while all(parts) and len({one[0] for one in parts}) == 1:
        parts = [one[1:] for one in parts]
    called = ["/".join(one) or result.name for one, result in zip(parts, read, strict=True)]
    return tuple(
        name if called.count(name) == 1 else f"{name} ({called[: i + 1].count(name)})" for i, name in enumerate(called)
    )


def _parameters(read: Sequence[Result], labels: Sequence[str], ratios: bool) -> dict[str, QuantityComparison]:
    names = [name for name in PARAMETERS if any(name in one.parameters for one in read)]
    # What only follows from the parameters would be asked twice; a profile is an interval of its own.
    names += [
        name
        for name in dict.fromkeys(name for one in read for name in one.derived)
        if name not in names
        and ((name not in CHARACTERISTICS and name not in WHEEL_LOADS) or any(_is_profiled(one, name) for one in read))
    ]
    rows = {}
    for name in names:
        per_mass = ratios and name in PARAMETERS and PARAMETERS[name].scales
        told = tuple(_told(one, name, per_mass) for one in read)
        unit = next((unit for one in read if (unit := _unit(one, name, per_mass))), "")
        differences = tuple(
            _difference(told[0], other, labels, i, _contradiction(read[0], read[i], name))
            for i, other in enumerate(told[1:], start=1)
        )
        rows[name + _PER_MASS * per_mass] = QuantityComparison(unit, told, differences)
    return rows


def _is_profiled(result: Result, name: str) -> bool:
    return name in result.derived and result.derived[name].interval_from == "profile"


def _told(result: Result, name: str, per_mass: bool) -> ResultValue:
    if result.verdict.state == "reject":
        return ResultValue(None, None, "was rejected")
    found = result.parameters.get(name) or result.derived.get(name)
    if found is None:
        return ResultValue(None, None, _ABSENT)
    if per_mass:
        ratio = result.scale.per_total_mass.get(name)
        return (
            ResultValue(ratio.value, ratio.std)
            if ratio is not None
            else ResultValue(None, None, "does not determine it")
        )
    return ResultValue(found.value, found.std, "" if found.value is not None else "does not determine it")


def _unit(result: Result, name: str, per_mass: bool) -> str | None:
    if per_mass:
        ratio = result.scale.per_total_mass.get(name)
        return None if ratio is None else ratio.unit
    found = result.parameters.get(name) or result.derived.get(name)
    return None if found is None else found.unit


def _contradiction(first: Result, second: Result, name: str) -> str:
    """Say why a quantity of two results is not the same thing; nothing where it is."""
    units = [_unit(one, name, False) for one in (first, second)]
    if None not in units and units[0] != units[1]:
        return f"units {units[0]} and {units[1]}"
    if "reject" in (first.verdict.state, second.verdict.state):
        return ""  # nothing of it is compared
    if name in _ABOUT_AXES and first.fit.axes and second.fit.axes and first.fit.axes != second.fit.axes:
        return "about other axes: the campaigns give different heights"
    return ""


def _difference(
    first: ResultValue, second: ResultValue, labels: Sequence[str], i: int, contradiction: str
) -> Difference:
    if first.why_not == second.why_not == _ABSENT:
        return Difference()
    silent = [f"{label} {one.why_not}" for label, one in ((labels[0], first), (labels[i], second)) if one.why_not]
    if silent or contradiction:
        return Difference(why="; ".join((*silent, *((contradiction,) if contradiction else ()))))
    if first.value is None or second.value is None or first.std is None or second.std is None:
        return Difference(why="has no uncertainty")
    value, std = second.value - first.value, (first.std**2 + second.std**2) ** 0.5
    percent = 100 * value / abs(first.value) if first.value else None
    if std == 0:
        return Difference(value, 0.0, (value, value), percent, finding="given")
    half = NORMAL_95 * std
    return Difference(value, std, (value - half, value + half), percent, value / std, two_sided(value / std))


def _modes(read: Sequence[Result], labels: Sequence[str]) -> dict[str, QuantityComparison]:
    rows = {}
    for load_name in [name for name in read[0].modes if all(name in one.modes for one in read)]:
        by_name = [{mode.name: mode for mode in one.modes[load_name]} for one in read]
        for mode in by_name[0]:
            for of, unit in (("frequency", "Hz"), ("damping_ratio", "1")):
                told = tuple(_told_of_mode(one, modes.get(mode), of) for one, modes in zip(read, by_name, strict=True))
                differences = tuple(
                    _difference(told[0], other, labels, i, "") for i, other in enumerate(told[1:], start=1)
                )
                rows[f"{load_name}, {mode}, {of.replace('_', ' ')}"] = QuantityComparison(unit, told, differences)
    return rows


def _told_of_mode(result: Result, mode: object, of: str) -> ResultValue:
    if result.verdict.state == "reject":
        return ResultValue(None, None, "was rejected")
    std = getattr(mode, f"{of}_std", None)
    return ResultValue(None, None, "does not determine it") if std is None else ResultValue(getattr(mode, of), std)


def _tested(rows: Mapping[str, QuantityComparison]) -> dict[str, QuantityComparison]:
    """Correct the chances of each result's differences for their number, and say what they mean."""
    changed = {name: list(row.differences) for name, row in rows.items()}
    for i in range(max((len(row.differences) for row in rows.values()), default=0)):
        asked = {name: p for name, row in rows.items() if (p := row.differences[i].p) is not None}
        for name, chance in zip(asked, holm(list(asked.values())), strict=True):
            finding: Finding = "certain" if chance <= CERTAIN else "likely" if chance <= LIKELY else "none"
            changed[name][i] = replace(changed[name][i], p_holm=chance, finding=finding)
    return {name: replace(row, differences=tuple(changed[name])) for name, row in rows.items()}


def _jointly(first: Result, second: Result, parameters: Mapping[str, QuantityComparison], i: int) -> JointTest | None:
    if "reject" in (first.verdict.state, second.verdict.state):
        return None
    return joint_test(first, second, [name for name, row in parameters.items() if row.differences[i].p is not None])


def _notes(read: Sequence[Result], labels: Sequence[str], ratios: bool) -> Iterator[str]:
    for label, one in zip(labels, read, strict=True):
        if one.verdict.state != "accept":
            numbers = "its numbers must not be used and are not shown" if one.verdict.state == "reject" else "usable"
            yield f"{label}: {one.verdict.state}, {numbers}: {one.verdict.reasons[0]}"
    if ratios:
        unknown = [
            label
            for label, one in zip(labels, read, strict=True)
            if not one.scale.known and one.verdict.state != "reject"
        ]
        yield (
            f"the absolute scale is not known of {', '.join(unknown)}: masses, inertias and rates are compared as parts of the "
            "empty vehicle's total mass"
        )
    for label, one in zip(labels[1:], read[1:], strict=True):
        if one.fit.model != read[0].fit.model or one.fit.tracks != read[0].fit.tracks:
            yield (
                f"{labels[0]} and {label} were fitted with other models ({_model(read[0])}; {_model(one)}): a term that "
                "one of them lacks changes its other parameters; identify both with the same [model]"
            )
        if one.parameters == read[0].parameters and one.fit == read[0].fit:
            yield f"{labels[0]} and {label} are the same result"
        if one.name != read[0].name:
            yield f"{labels[0]} is of '{read[0].name}', {label} of '{one.name}'"


def _model(result: Result) -> str:
    return f"{', '.join(result.fit.model) or 'no extras'}, {result.fit.tracks} half-distances"
