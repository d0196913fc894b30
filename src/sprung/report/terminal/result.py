"""What the terminal shows: the parameter table, the modal tables, the verdict, the faults."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rich.console import Group, RenderableType
from rich.text import Text

from sprung.errors import Fault
from sprung.report.page.summary import record_of
from sprung.report.terminal.layout import hanging, laid_out, table
from sprung.report.terminal.plan import next_line
from sprung.results import (
    FitReport,
    Result,
    characteristics_tables,
    derived_table,
    modes_table,
    other_quantities,
    parameters_table,
    ratios_table,
)
from sprung.tables import unit_text
from sprung.uncertainty import Estimate, round_by_uncertainty

COLOURS = {"accept": "green", "doubtful": "yellow", "reject": "red"}


def result_view(result: Result) -> RenderableType:
    """Show a result.

    Parameters
    ----------
    result
        The result.

    Returns
    -------
    RenderableType
        For `text_of`.
    """
    if result.verdict.state == "reject":
        return _rejected_view(result)
    parts: list[RenderableType] = [
        *_record(result),
        laid_out(parameters_table(result.name, {**result.parameters, **other_quantities(result.derived)})),
        Text(),
    ]
    if characteristics_tables(result.name, result.derived):
        parts += [laid_out(derived_table(result.name, result.derived)), Text()]
    if profiles := _profiles(result):
        parts += [interval_table(profiles), Text()]
    if result.unidentifiable:
        parts += [Text("Not determined", style="bold")]
        parts += [*(hanging("  - ", item.text) for item in result.unidentifiable), Text()]
    if not result.scale.known and result.scale.per_total_mass:
        parts += [laid_out(ratios_table(result.scale.per_total_mass)), Text()]
    for load, modes in result.modes.items():
        parts += [laid_out(modes_table(load, modes)), Text()]
    parts += [fit_line(result), Text()]
    if result.faults:
        parts += [fault_list(result.faults), Text()]
    parts.append(verdict_view(result))
    if result.next_step is not None:
        parts += [Text(), next_line(result.next_step)]
    return Group(*parts)


def _rejected_view(result: Result) -> RenderableType:
    """Show what tells why a result was rejected, and no estimate."""
    parts: list[RenderableType] = [*_record(result), Text(result.name, style="bold")]
    parts += [hanging("", f"{item.text}.") for item in result.unidentifiable]
    parts += [Text(), residual_table(result), Text(), fit_line(result), Text()]
    if result.faults:
        parts += [fault_list(result.faults), Text()]
    return Group(*parts, verdict_view(result))


def _record(result: Result) -> list[RenderableType]:
    """Show what the campaign file says of the test and the vehicle; nothing where it says nothing."""
    lines: list[RenderableType] = [hanging(f"{name}: ", told) for name, told in record_of(result)]
    return [*lines, Text()] if lines else []


def residual_table(result: Result) -> RenderableType:
    """Show how far the fitted model is from each channel, the worst first."""
    fit = result.fit
    worst = sorted(fit.misfit, key=lambda channel: -fit.misfit[channel])
    rows = [[name, f"{100 * fit.misfit[name]:.1f}", f"{fit.noise[name]:.3g}"] for name in worst]
    headers = ("channel", "model error, % of signal", "residual, m/s² rms")
    return table("Residuals", headers, rows, headers[1:])


def verdict_view(result: Result) -> RenderableType:
    """Show the verdict and its reasons."""
    verdict = result.verdict
    head = Text.assemble(("Verdict: ", "bold"), (verdict.state, f"bold {COLOURS[verdict.state]}"))
    return Group(head, *(hanging("  - ", reason) for reason in verdict.reasons))


def interval_table(profiles: Mapping[str, Estimate]) -> RenderableType:
    """Show the intervals that follow from profiles of the likelihood, by name."""
    rows = [[name, *_interval_cells(found), unit_text(found.unit)] for name, found in profiles.items()]
    shown = table("95 % intervals from the whole likelihood", ("parameter", "from", "to", "unit"), rows, ("from", "to"))
    if any(found.interval95 is not None and None in found.interval95 for found in profiles.values()):
        return Group(shown, hanging("", "< or >: open to the other side, where the recordings set no limit."))
    return shown


def _profiles(result: Result) -> dict[str, Estimate]:
    everything = {**result.parameters, **result.derived}
    return {name: found for name, found in everything.items() if found.interval_from == "profile"}


def _interval_cells(estimate: Estimate) -> tuple[str, str]:
    low, high = estimate.interval95 or (None, None)
    before, after = "" if high is not None else "> ", "" if low is not None else "< "
    return (
        "" if low is None else f"{before}{_limit(low, estimate.std)}",
        "" if high is None else f"{after}{_limit(high, estimate.std)}",
    )


def _limit(limit: float, std: float | None) -> str:
    # A limit far below the standard uncertainty keeps two figures of its own.
    return round_by_uncertainty(limit, min(std or abs(limit), abs(limit)) or 1.0)[0]


def fit_line(result: Result) -> RenderableType:
    """Say in a line or two how the fit went."""
    fit = result.fit
    noise = ", ".join(f"{channel} {value:.3g}" for channel, value in fit.noise.items())
    extras = f", with {', '.join(fit.model)}" if fit.model else ""
    text = (
        f"Fit: {fit.method}{extras}; {_count(fit.drops, 'drop')}, {fit.samples} samples, {fit.iterations} steps, "
        f"{fit.starts_agreeing} of {fit.starts} starts agree."
    )
    rejected = result.verdict.state == "reject"
    if fit.inflation > 1 and not rejected:
        text += f"\nUncertainties are {fit.inflation**0.5:.2f} times those of white noise{_because(fit)}."
    if rejected:
        return Text(f"{text}\nModel: {fit.why}.")
    axes = f"\nAxes: {fit.axes}." if fit.axes else ""
    return hanging("", f"{text}\nModel: {fit.why}.{axes}\nNoise, m/s² rms: {noise}.")


def _because(fit: FitReport) -> str:
    match fit.inflated_by:
        case "coloured residuals":
            return f": the residuals are coloured, most of all in {fit.most_coloured}"
        case "drops that disagree":
            return ": the drops disagree by more than their noise"
        case _:
            return ""


def _count(number: int, thing: str) -> str:
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def fault_list(faults: Sequence[Fault]) -> RenderableType:
    """Show what is wrong with the recordings and what to do."""
    lines: list[RenderableType] = [Text("Faults", style="bold")]
    for fault in faults:
        text = Text.assemble(f"{fault.where}: ", (fault.code, "yellow"), f": {fault.what}. {fault.do}")
        lines.append(hanging("  - ", text))
    return Group(*lines)
