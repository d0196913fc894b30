"""The plan: every alternative with its bound, and the cheapest step that is sufficient."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from sprung.dataframes import require_pandas
from sprung.display import shown
from sprung.errors import InputError, SprungError
from sprung.planning.alternatives import Alternative, Cost, compute_bound, list_alternatives
from sprung.planning.cramer_rao import CramerRaoBound, two_figures
from sprung.planning.detectability import TermDetectability
from sprung.planning.setup import PlannedTest

if TYPE_CHECKING:
    import pandas as pd


@shown
@dataclass(frozen=True, eq=False)
class PlanRow:
    """One alternative.

    Attributes
    ----------
    label
        A few words.
    text
        What is done.
    cost
        Where it stands in the order of `Cost`; None for a test that is no step beyond the one planned.
    bound
        Cramér-Rao bound; None where it cannot be done.
    refused
        The reason why it cannot be done.
    """

    label: str
    text: str
    cost: Cost | None
    bound: CramerRaoBound | None = field(repr=False)
    refused: str | None = None


@shown
@dataclass(frozen=True, eq=False)
class NextStep:
    """What to measure next.

    Attributes
    ----------
    labels
        Alternatives to combine; none where nothing more is needed, or nothing helps.
    enough
        Whether every parameter then has at most the wanted uncertainty.
    text
        One sentence.
    bound
        Of the test with that step; None where the vehicle is not known.
    """

    labels: tuple[str, ...]
    enough: bool
    text: str
    bound: CramerRaoBound | None = field(repr=False)


@shown
@dataclass(frozen=True, eq=False)
class Plan:
    """Table of alternatives to a test.

    Attributes
    ----------
    vehicle
        Name of the vehicle.
    wanted
        Standard uncertainty that no parameter is to exceed, %.
    noise, rate
        Of the sensors, m/s² root-mean-square by channel, and samples per second.
    rows
        The first one is the test as it is planned, or the campaign as it is; none of a rejected campaign, whose vehicle is not
        known.
    next_step
        The cheapest sufficient step.
    rejected
        Reasons of the verdict where the campaign was rejected.
    terms
        By the label of a test, what it would show of each usual model term; empty unless asked for.
    """

    vehicle: str
    wanted: float
    noise: dict[str, float]
    rate: float
    rows: tuple[PlanRow, ...]
    next_step: NextStep
    rejected: tuple[str, ...] = ()
    terms: Mapping[str, tuple[TermDetectability, ...]] = field(default_factory=dict)

    def to_dataframe(self) -> pd.DataFrame:
        """Return the standard uncertainty to expect of each parameter, %, a row for each alternative; NaN: not determined."""
        require_pandas()
        import pandas as pd  # noqa: PLC0415 (optional, and nothing else here needs it)

        rows = {row.label: {} if row.bound is None else dict(row.bound.percents) for row in self.rows}
        return pd.DataFrame.from_dict(rows, orient="index").astype(float).rename_axis("alternative")

    def document(self) -> dict[str, Any]:
        """Return the plan as JSON holds it; percentages of undetermined parameters are null."""
        return {
            "vehicle": self.vehicle,
            "wanted": self.wanted,
            "noise": self.noise,
            "rate": self.rate,
            "alternatives": [self._row(row) for row in self.rows],
            "next_step": {
                "alternatives": list(self.next_step.labels),
                "enough": self.next_step.enough,
                "text": self.next_step.text,
                "percent": {} if self.next_step.bound is None else dict(self.next_step.bound.percents),
            },
            "rejected": list(self.rejected),
            "terms": {label: [_of_term(one) for one in found] for label, found in self.terms.items()},
        }

    def _row(self, row: PlanRow) -> dict[str, Any]:
        cost = None if row.cost is None else row.cost.name.lower().replace("_", " ")
        head = {"name": row.label, "text": row.text, "cost": cost, "refused": row.refused}
        if row.bound is None:
            return {**head, "worst": None, "above": None, "percent": {}, "unidentifiable": []}
        unidentifiable = [{"parameters": list(one.parameters), "text": one.text} for one in row.bound.unidentifiable]
        body = {
            "worst": row.bound.worst,
            "above": row.bound.count_above(self.wanted),
            "percent": dict(row.bound.percents),
        }
        return {**head, **body, "unidentifiable": unidentifiable}


def _of_term(term: TermDetectability) -> dict[str, Any]:
    beside = term.smallest_beside if math.isfinite(term.smallest_beside) else None
    smallest = term.smallest if math.isfinite(term.smallest) else None
    head = {"name": term.name, "usual": term.size, "gain": term.gain, "smallest": smallest}
    return {**head, "rival": term.rival or None, "smallest_beside": beside}


def tabulate_alternatives(test: PlannedTest, wanted: float = 1.0) -> Plan:
    """Tabulate the alternatives to a test.

    Parameters
    ----------
    test
        The test, planned or completed.
    wanted
        Standard uncertainty that no parameter is to exceed, %.

    Returns
    -------
    Plan

    Raises
    ------
    InputError
        If the test itself cannot be done.
    """
    own = (
        ("as planned", "the test as planned")
        if test.recorded_information is None
        else ("as it is", "the campaign as it is")
    )
    others = tuple(list_alternatives(test))
    setup = test.setup
    return Plan(
        vehicle=setup.vehicle.name,
        wanted=wanted,
        noise={sensor.channel: float(level) for sensor, level in zip(setup.sensors, setup.noise, strict=True)},
        rate=setup.rate,
        rows=(PlanRow(*own, None, compute_bound(test)), *(_row(test, alternative) for alternative in others)),
        next_step=_choose_step(test, wanted, others),
    )


def tabulate_rejected(
    vehicle: str, wanted: float, noise: Mapping[str, float], rate: float, reasons: Sequence[str]
) -> Plan:
    """Return the plan after a rejected campaign: without bounds, as the vehicle is not known.

    Parameters
    ----------
    vehicle
        Name of the one whose campaign was rejected.
    wanted
        Standard uncertainty that no parameter was to exceed, %.
    noise, rate
        Of its sensors, m/s² root-mean-square by channel, and samples per second.
    reasons
        Of the verdict.

    Returns
    -------
    Plan
    """
    return Plan(
        vehicle=vehicle,
        wanted=wanted,
        noise=dict(noise),
        rate=rate,
        rows=(),
        next_step=NextStep((), False, "remove the reasons of the verdict", None),
        rejected=tuple(reasons),
    )


def next_step(test: PlannedTest, wanted: float = 1.0) -> NextStep:
    """Choose what to measure next, without the table; only the drops that are needed are simulated.

    Parameters
    ----------
    test
        The test, planned or completed.
    wanted
        Standard uncertainty that no parameter is to exceed, %.

    Returns
    -------
    NextStep
    """
    return _choose_step(test, wanted, tuple(list_alternatives(test)))


def _row(test: PlannedTest, alternative: Alternative) -> PlanRow:
    try:
        return PlanRow(alternative.label, alternative.text, alternative.cost, compute_bound(test, alternative))
    except SprungError as error:
        return PlanRow(alternative.label, alternative.text, alternative.cost, None, _reason(error))


def _reason(error: SprungError) -> str:
    if isinstance(error, InputError):
        return "; ".join(f"{problem.found}, expected {problem.expected}" for problem in error.problems)
    return str(error)


def _combine_steps(others: Sequence[Alternative]) -> Iterator[tuple[Alternative, ...]]:
    """Yield single steps and pairs in the order of the most expensive step, then of the other one."""
    steps = [one for one in others if one.cost is not None]
    for dearest, step in enumerate(steps):
        yield (step,)
        # Two of one kind are of no use, except drops of different wheels.
        yield from (
            (cheaper, step) for cheaper in steps[:dearest] if cheaper.cost != step.cost or step.cost is Cost.DROP
        )


def _choose_step(test: PlannedTest, wanted: float, others: Sequence[Alternative]) -> NextStep:
    now = compute_bound(test)
    if not now.count_above(wanted):
        return NextStep((), True, _satisfied(now, wanted), now)
    best: tuple[tuple[Alternative, ...], CramerRaoBound] | None = None
    for step in _combine_steps(others):
        try:
            then = compute_bound(test, *step)
        except SprungError:
            continue
        if not then.count_above(wanted):
            return NextStep(tuple(one.label for one in step), True, _enough(now, then, step, wanted), then)
        if best is None or then.sort_key < best[1].sort_key:
            best = step, then
    if best is None or not best[1].sort_key < now.sort_key:
        return NextStep((), False, f"no single step or pair of steps brings every parameter to {wanted:g} %", now)
    labels, text = tuple(one.label for one in best[0]), _not_enough(now, *best, wanted)
    return NextStep(labels, False, text, best[1])


def _satisfied(now: CramerRaoBound, wanted: float) -> str:
    if now.worst is None:
        return "every parameter is known beforehand; no measurement is needed"
    worst = f"{now.worst} worst with {two_figures(now.percents[now.worst])} %"
    return f"nothing more is needed; every parameter is known to {wanted:g} % or better, {worst}"


def _enough(now: CramerRaoBound, then: CramerRaoBound, step: Sequence[Alternative], wanted: float) -> str:
    return f"{_change(now, then, step)} and bring every parameter to {wanted:g} % or better"


def _not_enough(now: CramerRaoBound, step: Sequence[Alternative], then: CramerRaoBound, wanted: float) -> str:
    left = f"{then.count_above(wanted)} parameters" if then.count_above(wanted) > 1 else "one parameter"
    best = "no other step or pair of steps of the table is better"
    return f"{_change(now, then, step)}; {left} would stay above {wanted:g} %, and {best}"


def _change(now: CramerRaoBound, then: CramerRaoBound, step: Sequence[Alternative]) -> str:
    doing = " and ".join(one.text for one in step)
    if not now.undetermined:
        worst = str(now.worst)
        before, after = two_figures(now.percents[worst]), two_figures(then.percents[worst])
        return f"{doing} would take {worst} from {before} % to {after} %"
    determined = [name for name in now.undetermined if then.percents[name] is not None]
    if not determined:
        return f"{doing} would determine no more, but the others better"
    what = ", ".join(determined) if len(determined) <= 4 else f"{len(determined)} more parameters"
    return f"{doing} would determine {what} ({determined[0]} to {two_figures(then.percents[determined[0]])} %)"
