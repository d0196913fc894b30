"""Differences between results, and their significance."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from sprung.display import count_text
from sprung.errors import Problems
from sprung.results import Result, load
from sprung.study.comparability import ABSENT, contradiction_of, part_of, unit_of, value_of
from sprung.study.comparison import ComparedResult, Comparison, Difference, Finding, QuantityComparison, ResultValue
from sprung.study.scatter import complete_rows, estimate_scatter
from sprung.study.significance import JointTest, holm, joint_test, two_sided
from sprung.uncertainty import NORMAL_95
from sprung.vehicle import CHARACTERISTICS, PARAMETERS, WHEEL_LOADS

LIKELY, CERTAIN = 0.05, 0.001
"""Probabilities, corrected for the number of comparisons, below which a difference is called likely and certain."""

_PER_MASS = " / total mass"


def compare(results: Sequence[Result | str | Path], *, names: Sequence[str] | None = None) -> Comparison:
    """Compare results, and test the significance of their differences.

    Parameters
    ----------
    results
        Two or more: from `sprung.identify`, or the folders (or their results.json) where they were saved. The first is the
        reference.
    names
        Labels; from folders or vehicles unless given.

    Returns
    -------
    Comparison

    Raises
    ------
    InputError
        If there are fewer than two, not as many names as results, or a file is not a result; with every reason.

    Notes
    -----
    Errors of different results are assumed independent. Common errors (the same weighing, the same misplaced sensor) shift both
    results alike, so that the significance is underestimated. Probabilities are corrected by Holm's method, those of the
    parameters and those of the modes as one table each: between two tests of the same vehicle, a table has any difference that
    is called likely or certain in at most 5 of 100 cases.

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
    _check_arguments(results, names)
    problems = Problems()
    read: list[Result] = []
    for result in results:
        with problems.collect():
            read.append(result if isinstance(result, Result) else load(result, series=False))
    problems.raise_if_any()
    labels = tuple(names) if names is not None else _labels(results, read)
    ratios = any(
        result.scale.per_total_mass and not result.scale.known for result in read if result.verdict.state != "reject"
    )
    parameters = _with_findings(_parameter_rows(read, labels, ratios))
    modes = _with_findings(_mode_rows(read, labels))
    return Comparison(
        results=tuple(
            ComparedResult(label, result.name, result.verdict.state, result.verdict.reasons)
            for label, result in zip(labels, read, strict=True)
        ),
        per_total_mass=ratios,
        parameters=parameters,
        modes=modes,
        joint=tuple(_test_jointly(read[0], other, parameters, i) for i, other in enumerate(read[1:])),
        scatter=estimate_scatter(
            {
                name: complete_rows(
                    (label, own.value, own.std)
                    for label, own, result in zip(labels, row.values, read, strict=True)
                    if not contradiction_of(read[0], result, "" if name in modes else name.removesuffix(_PER_MASS))
                )
                for name, row in {**parameters, **modes}.items()
            }
        ),
        notes=tuple(_notes(read, labels, ratios)),
    )


def _check_arguments(results: Sequence[object], names: Sequence[str] | None) -> None:
    problems = Problems()
    if isinstance(results, str | Path | Result) or len(results) < 2:  # a string is a sequence too
        found = count_text(1 if isinstance(results, str | Path | Result) else len(results), "result")
        problems.add("compare", found, "two or more", "Name the results folders to compare.")
    elif names is not None and (len(names) != len(results) or len(set(names)) != len(names)):
        found = f"the names {', '.join(names)} for {len(results)} results"
        problems.add("compare", found, "a unique name for each", "Give as many different names as results.")
    problems.raise_if_any()


def _labels(given: Sequence[Result | str | Path], read: Sequence[Result]) -> tuple[str, ...]:
    """Return labels: the part of each path that differs from the others, or the name of the vehicle."""
    parts = [
        ()
        if isinstance(source, Result)
        else tuple(part for part in Path(source).resolve().parts if part not in ("/", "results.json"))
        for source in given
    ]
    while all(parts) and len({path[-1] for path in parts}) == 1:
        parts = [path[:-1] for path in parts]
    while all(parts) and len({path[0] for path in parts}) == 1:
        parts = [path[1:] for path in parts]
    labels = ["/".join(path) or result.name for path, result in zip(parts, read, strict=True)]
    return tuple(
        label if labels.count(label) == 1 else f"{label} ({labels[: i + 1].count(label)})"
        for i, label in enumerate(labels)
    )


def _parameter_rows(read: Sequence[Result], labels: Sequence[str], ratios: bool) -> dict[str, QuantityComparison]:
    names = [name for name in PARAMETERS if any(name in result.parameters for result in read)]
    # Quantities that follow from the parameters would be tested twice; a profile has an interval of its own.
    names += [
        name
        for name in dict.fromkeys(name for result in read for name in result.derived)
        if name not in names
        and (
            (name not in CHARACTERISTICS and name not in WHEEL_LOADS)
            or any(_is_profiled(result, name) for result in read)
        )
    ]
    rows = {}
    for name in names:
        per_mass = ratios and name in PARAMETERS and PARAMETERS[name].scales
        values = tuple(value_of(result, name, per_mass) for result in read)
        unit = next((unit for result in read if (unit := unit_of(result, name, per_mass))), "")
        differences = tuple(
            _difference(values[0], other, labels, i, contradiction_of(read[0], read[i], name))
            for i, other in enumerate(values[1:], start=1)
        )
        rows[name + _PER_MASS * per_mass] = QuantityComparison(unit, values, differences)
    return rows


def _is_profiled(result: Result, name: str) -> bool:
    return name in result.derived and result.derived[name].interval_from == "profile"


def _difference(
    first: ResultValue, second: ResultValue, labels: Sequence[str], i: int, contradiction: str
) -> Difference:
    if first.why_not == second.why_not == ABSENT:
        return Difference()
    reasons = [
        f"{label} {value.why_not}" for label, value in ((labels[0], first), (labels[i], second)) if value.why_not
    ]
    if contradiction or reasons:
        return Difference(why=contradiction or "; ".join(reasons))
    if first.value is None or second.value is None or first.std is None or second.std is None:
        return Difference(why="has no uncertainty")
    value, std = second.value - first.value, (first.std**2 + second.std**2) ** 0.5
    percent = 100 * value / abs(first.value) if first.value else None
    if std == 0:
        return Difference(value, 0.0, (value, value), percent, finding="given")
    half = NORMAL_95 * std
    return Difference(value, std, (value - half, value + half), percent, value / std, two_sided(value / std))


def _mode_rows(read: Sequence[Result], labels: Sequence[str]) -> dict[str, QuantityComparison]:
    rows = {}
    for load_name in [name for name in read[0].modes if all(name in result.modes for result in read)]:
        by_name = [{mode.name: mode for mode in result.modes[load_name]} for result in read]
        for mode in by_name[0]:
            for quantity, unit in (("frequency", "Hz"), ("damping_ratio", "1")):
                values = tuple(
                    _mode_value(result, modes.get(mode), quantity) for result, modes in zip(read, by_name, strict=True)
                )
                differences = tuple(
                    _difference(values[0], other, labels, i, contradiction_of(read[0], read[i]))
                    for i, other in enumerate(values[1:], start=1)
                )
                rows[f"{load_name}, {mode}, {quantity.replace('_', ' ')}"] = QuantityComparison(
                    unit, values, differences
                )
    return rows


def _mode_value(result: Result, mode: object, quantity: str) -> ResultValue:
    if result.verdict.state == "reject":
        return ResultValue(None, None, "was rejected")
    std = getattr(mode, f"{quantity}_std", None)
    return (
        ResultValue(None, None, "does not determine it") if std is None else ResultValue(getattr(mode, quantity), std)
    )


def _with_findings(rows: Mapping[str, QuantityComparison]) -> dict[str, QuantityComparison]:
    """Return rows with the probabilities corrected for their number, and with findings."""
    changed = {name: list(row.differences) for name, row in rows.items()}
    for i in range(max((len(row.differences) for row in rows.values()), default=0)):
        probabilities = {name: p for name, row in rows.items() if (p := row.differences[i].p) is not None}
        for name, p in zip(probabilities, holm(list(probabilities.values())), strict=True):
            finding: Finding = "certain" if p <= CERTAIN else "likely" if p <= LIKELY else "none"
            changed[name][i] = replace(changed[name][i], p_holm=p, finding=finding)
    return {name: replace(row, differences=tuple(changed[name])) for name, row in rows.items()}


def _test_jointly(
    first: Result, second: Result, parameters: Mapping[str, QuantityComparison], i: int
) -> JointTest | None:
    if "reject" in (first.verdict.state, second.verdict.state):
        return None
    return joint_test(first, second, [name for name, row in parameters.items() if row.differences[i].p is not None])


def _notes(read: Sequence[Result], labels: Sequence[str], ratios: bool) -> Iterator[str]:
    for label, result in zip(labels, read, strict=True):
        if result.verdict.state != "accept":
            use = "no estimates" if result.verdict.state == "reject" else "usable with reservations"
            yield f"{label}: {result.verdict.state}, {use}: {result.verdict.reasons[0]}"
    if ratios:
        unknown = [
            label
            for label, result in zip(labels, read, strict=True)
            if not result.scale.known and result.verdict.state != "reject"
        ]
        yield (
            f"the absolute scale of {', '.join(unknown)} is not known: masses, inertias and rates are compared as ratios to "
            "the total mass of the empty vehicle"
        )
    first = read[0]
    for label, result in zip(labels[1:], read[1:], strict=True):
        if part_of(result) != part_of(first):
            yield (
                f"{labels[0]} is of a {part_of(first)}, {label} of a {part_of(result)}: parameters and modes are compared only "
                "between results with the same [vehicle] model"
            )
        elif (result.fit.model, result.fit.tracks) != (first.fit.model, first.fit.tracks):
            yield (
                f"{labels[0]} and {label} were fitted with different models ({_model(first)}; {_model(result)}): a model term "
                "changes the other parameters; identify both with the same [model]"
            )
        if result.parameters == first.parameters and result.fit == first.fit:
            yield f"{labels[0]} and {label} are the same result"
        if result.name != first.name:
            yield f"{labels[0]} is of '{first.name}', {label} of '{result.name}'"


def _model(result: Result) -> str:
    return f"{', '.join(result.fit.model) or 'no model terms'}, {result.fit.tracks} half-distances"
