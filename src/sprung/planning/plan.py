"""The plan: every alternative with its bound, and the cheapest step that is enough."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from sprung.dataframes import require_pandas
from sprung.display import shown
from sprung.errors import InputError, SprungError
from sprung.planning.alternatives import Alternative, Cost, alternatives, bound
from sprung.planning.cramer_rao import Bound, two_figures
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
        What it would tell; None where it cannot be done.
    refused
        Why it cannot be done.
    """

    label: str
    text: str
    cost: Cost | None
    bound: Bound | None = field(repr=False)
    refused: str | None = None


@shown
@dataclass(frozen=True, eq=False)
class NextStep:
    """What to measure next.

    Attributes
    ----------
    labels
        The alternatives to take together; none where nothing more is needed, or nothing helps.
    enough
        Whether every parameter is then below the wanted percentage.
    text
        One sentence.
    bound
        Of the test with that step; None where the vehicle is not known.
    """

    labels: tuple[str, ...]
    enough: bool
    text: str
    bound: Bound | None = field(repr=False)


@shown
@dataclass(frozen=True, eq=False)
class Plan:
    """The table of alternatives.

    Attributes
    ----------
    vehicle
        Its name.
    wanted
        Percent that no parameter is to exceed.
    noise, rate
        Of the sensors, m/s² root-mean-square by channel, and samples per second.
    rows
        The first one is the test as it is planned, or the campaign as it is; none of a rejected campaign, whose vehicle is not
        known.
    next_step
        What to take of it.
    rejected
        Why the campaign's own result must not be used, where that is so.
    """

    vehicle: str
    wanted: float
    noise: dict[str, float]
    rate: float
    rows: tuple[PlanRow, ...]
    next_step: NextStep
    rejected: tuple[str, ...] = ()

    def to_dataframe(self) -> pd.DataFrame:
        """Return the standard uncertainty to expect of each parameter, %, a row for each alternative; NaN: not determined."""
        require_pandas()
        import pandas as pd  # noqa: PLC0415 (optional, and nothing else here needs it)

        rows = {row.label: {} if row.bound is None else dict(row.bound.percents) for row in self.rows}
        return pd.DataFrame.from_dict(rows, orient="index").astype(float).rename_axis("alternative")

    def document(self) -> dict[str, Any]:
        """Give it as what JSON knows; percentages of undetermined parameters are null."""
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
        }

    def _row(self, row: PlanRow) -> dict[str, Any]:
        cost = None if row.cost is None else row.cost.name.lower().replace("_", " ")
        head = {"name": row.label, "text": row.text, "cost": cost, "refused": row.refused}
        if row.bound is None:
            return {**head, "worst": None, "above": None, "percent": {}, "unidentifiable": []}
        silent = [{"parameters": list(one.parameters), "text": one.text} for one in row.bound.why]
        told = {"worst": row.bound.worst, "above": row.bound.above(self.wanted), "percent": dict(row.bound.percents)}
        return {**head, **told, "unidentifiable": silent}


def tabulate_alternatives(test: PlannedTest, wanted: float = 1.0) -> Plan:
    """Draw up the table of alternatives to a test.

    Parameters
    ----------
    test
        The test, planned or done.
    wanted
        Percent that no parameter is to exceed.

    Returns
    -------
    Plan

    Raises
    ------
    InputError
        If the test itself cannot be done.
    """
    own = ("as planned", "the test as planned") if test.recorded is None else ("as it is", "the campaign as it is")
    others = tuple(alternatives(test))
    subject = test.subject
    return Plan(
        vehicle=subject.vehicle.name,
        wanted=wanted,
        noise={one.channel: float(level) for one, level in zip(subject.sensors, subject.noise, strict=True)},
        rate=subject.rate,
        rows=(PlanRow(*own, None, bound(test)), *(_row(test, one) for one in others)),
        next_step=_choose(test, wanted, others),
    )


def tabulate_rejected(
    vehicle: str, wanted: float, noise: Mapping[str, float], rate: float, reasons: Sequence[str]
) -> Plan:
    """Return a plan that promises nothing: every bound would be one of a vehicle that is not known.

    Parameters
    ----------
    vehicle
        Name of the one whose campaign was rejected.
    wanted
        Percent that no parameter was to exceed.
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
    """Say what to measure next, without the table; no drop is simulated that need not be.

    Parameters
    ----------
    test
        The test, planned or done.
    wanted
        Percent that no parameter is to exceed.

    Returns
    -------
    NextStep
    """
    return _choose(test, wanted, tuple(alternatives(test)))


def _row(test: PlannedTest, one: Alternative) -> PlanRow:
    try:
        return PlanRow(one.label, one.text, one.cost, bound(test, one))
    except SprungError as error:
        return PlanRow(one.label, one.text, one.cost, None, _reason(error))


def _reason(error: SprungError) -> str:
    if isinstance(error, InputError):
        return "; ".join(f"{problem.found}, expected {problem.expected}" for problem in error.problems)
    return str(error)


def _steps(others: Sequence[Alternative]) -> Iterator[tuple[Alternative, ...]]:
    """Order single steps and pairs by the dearest in them, then by the other one; the list is ordered by cost itself."""
    steps = [one for one in others if one.cost is not None]
    for dearest, step in enumerate(steps):
        yield (step,)
        # Of one kind there is no use in two, but for drops of different wheels.
        yield from (
            (cheaper, step) for cheaper in steps[:dearest] if cheaper.cost != step.cost or step.cost is Cost.DROP
        )


def _choose(test: PlannedTest, wanted: float, others: Sequence[Alternative]) -> NextStep:
    now = bound(test)
    if not now.above(wanted):
        return NextStep((), True, _satisfied(now, wanted), now)
    best: tuple[tuple[Alternative, ...], Bound] | None = None
    for step in _steps(others):
        try:
            then = bound(test, *step)
        except SprungError:
            continue
        if not then.above(wanted):
            return NextStep(tuple(one.label for one in step), True, _enough(now, then, step, wanted), then)
        if best is None or then.rank < best[1].rank:
            best = step, then
    if best is None or not best[1].rank < now.rank:
        return NextStep((), False, f"no single step or pair of steps brings every parameter to {wanted:g} %", now)
    labels, text = tuple(one.label for one in best[0]), _not_enough(now, *best, wanted)
    return NextStep(labels, False, text, best[1])


def _satisfied(now: Bound, wanted: float) -> str:
    if now.worst is None:
        return "every parameter is known beforehand; nothing is left to measure"
    worst = f"{now.worst} worst with {two_figures(now.percents[now.worst])} %"
    return f"nothing more is needed; every parameter is known to {wanted:g} % or better, {worst}"


def _enough(now: Bound, then: Bound, step: Sequence[Alternative], wanted: float) -> str:
    return f"{_change(now, then, step)} and bring every parameter to {wanted:g} % or better"


def _not_enough(now: Bound, step: Sequence[Alternative], then: Bound, wanted: float) -> str:
    left = f"{then.above(wanted)} parameters" if then.above(wanted) > 1 else "one parameter"
    best = "no step of the table, nor two of them, does more"
    return f"{_change(now, then, step)}; {left} would stay above {wanted:g} %, and {best}"


def _change(now: Bound, then: Bound, step: Sequence[Alternative]) -> str:
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
