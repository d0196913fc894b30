"""A result, for the terminal: parameters, modes, fit, faults, verdict."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rich.console import Group, RenderableType
from rich.text import Text

from sprung.errors import Fault, merge_faults
from sprung.report.page.summary import test_record_of
from sprung.report.terminal.layout import hanging_text, render_rows, render_table
from sprung.report.terminal.plan import next_line
from sprung.results import (
    FitReport,
    Result,
    characteristics_tables,
    damper_tables,
    derived_table,
    modes_table,
    other_quantities,
    parameters_table,
    ratios_table,
    sensors_table,
)
from sprung.tables import unit_text
from sprung.uncertainty import Estimate, round_by_uncertainty

COLOURS = {"accept": "green", "doubtful": "yellow", "reject": "red"}


_UNEXPLAINED = 0.95
"""Residual over the signal of a drop above which nothing of the signal is modelled."""


def result_view(result: Result) -> RenderableType:
    """Return the view of a result.

    Parameters
    ----------
    result
        Of an identification.

    Returns
    -------
    RenderableType
        For `text_of`.
    """
    if result.verdict.state == "reject":
        return _rejected_view(result)
    parts: list[RenderableType] = [
        *_test_record(result),
        render_table(parameters_table(result.name, {**result.parameters, **other_quantities(result.derived)})),
        Text(),
    ]
    masses = [derived_table(result.name, result.derived)] if characteristics_tables(result.name, result.derived) else []
    for table in (*masses, *damper_tables(result.curves)):
        parts += [render_table(table), Text()]
    if profiles := _profiles(result):
        parts += [interval_table(profiles), Text()]
    if result.unidentifiable:
        parts += [Text("Not determined", style="bold")]
        parts += [*(hanging_text("  - ", item.text) for item in result.unidentifiable), Text()]
    if not result.scale.known and result.scale.per_total_mass:
        parts += [render_table(ratios_table(result.scale.per_total_mass)), Text()]
    for load, modes in result.modes.items():
        parts += [render_table(modes_table(load, modes)), Text()]
    parts += _sensors(result)
    if result.additional_terms:
        parts += [hanging_text("", result.additional_terms), Text()]
    parts += [fit_line(result), Text()]
    if result.faults:
        parts += [fault_list(result.faults), Text()]
    parts.append(verdict_view(result))
    if result.next_step is not None:
        parts += [Text(), next_line(result.next_step)]
    return Group(*parts)


def _sensors(result: Result) -> list[RenderableType]:
    """Return the table of what was found of the sensors, as far as they are uncertain."""
    return [render_table(sensors_table(result.sensors)), Text()] if result.sensors else []


def _rejected_view(result: Result) -> RenderableType:
    """Return the view of a rejected result: the evidence, no estimates."""
    parts: list[RenderableType] = [*_test_record(result), Text(result.name, style="bold")]
    parts += [hanging_text("", f"{item.text}.") for item in result.unidentifiable]
    parts += [Text(), residual_table(result), Text(), fit_line(result), Text()]
    if result.faults:
        parts += [fault_list(result.faults), Text()]
    return Group(*parts, verdict_view(result))


def _test_record(result: Result) -> list[RenderableType]:
    """Return the test record of the campaign file, as far as there is one."""
    lines: list[RenderableType] = [hanging_text(f"{name}: ", text) for name, text in test_record_of(result)]
    return [*lines, Text()] if lines else []


def residual_table(result: Result) -> RenderableType:
    """Return the table of model error and residual by channel, the largest error first."""
    fit = result.fit
    worst = sorted(fit.misfit, key=lambda channel: -fit.misfit[channel])
    units = result.setup.units
    # Where no drop has a modelled signal there is no error of it: all of the signal is residual.
    drops = result.validation.values()
    is_modelled = not drops or any(drop.fitted < _UNEXPLAINED for drop in drops)
    errors = {name: f"{100 * part:.1f}" if part or is_modelled else "-" for name, part in fit.misfit.items()}
    alike = len(set(units.values())) == 1
    rows = [[name, errors[name], f"{fit.noise[name]:.3g}{'' if alike else f' {units[name]}'}"] for name in worst]
    headers = ("channel", "model error, % of signal", f"residual, {f'{units[worst[0]]} ' if alike else ''}rms")
    return render_rows("Residuals", headers, rows, headers[1:])


def verdict_view(result: Result) -> RenderableType:
    """Return the verdict and its reasons."""
    verdict = result.verdict
    head = Text.assemble(("Verdict: ", "bold"), (verdict.state, f"bold {COLOURS[verdict.state]}"))
    return Group(head, *(hanging_text("  - ", reason) for reason in verdict.reasons))


def interval_table(profiles: Mapping[str, Estimate]) -> RenderableType:
    """Return the table of intervals from likelihood profiles."""
    rows = [[name, *_interval_cells(estimate), unit_text(estimate.unit)] for name, estimate in profiles.items()]
    shown = render_rows(
        "95 % intervals from likelihood profiles", ("parameter", "from", "to", "unit"), rows, ("from", "to")
    )
    if any(estimate.interval95 is not None and None in estimate.interval95 for estimate in profiles.values()):
        return Group(shown, hanging_text("", "< or >: open interval; the recordings give no limit on the other side."))
    return shown


def _profiles(result: Result) -> dict[str, Estimate]:
    estimates = {**result.parameters, **result.derived}
    return {name: estimate for name, estimate in estimates.items() if estimate.interval_from == "profile"}


def _interval_cells(estimate: Estimate) -> tuple[str, str]:
    low, high = estimate.interval95 or (None, None)
    before, after = "" if high is not None else "> ", "" if low is not None else "< "
    return (
        "" if low is None else f"{before}{_limit(low, estimate.std)}",
        "" if high is None else f"{after}{_limit(high, estimate.std)}",
    )


def _limit(limit: float, std: float | None) -> str:
    # A limit far below the standard uncertainty is given with two figures.
    return round_by_uncertainty(limit, min(std or abs(limit), abs(limit)) or 1.0)[0]


def fit_line(result: Result) -> RenderableType:
    """Return a summary of the fit in a few lines."""
    fit = result.fit
    noise = ": ".join(result.setup.describe_noise(fit.noise))
    extras = f", with {', '.join(fit.model)}" if fit.model else ""
    text = (
        f"Fit: {fit.method}{extras}; {_count(fit.drops, 'drop')}, {fit.samples} samples, {fit.iterations} steps, "
        f"{fit.starts_text}."
    )
    rejected = result.verdict.state == "reject"
    if fit.inflation > 1 and not rejected:
        text += f"\nUncertainties are {fit.inflation**0.5:.2f} times those of white noise{_inflation_reason(fit)}."
    if rejected:
        return Text(f"{text}\nModel: {fit.why}.")
    axes = f"\nAxes: {fit.axes}." if fit.axes else ""
    return hanging_text("", f"{text}\nModel: {fit.why}.{axes}\n{noise[0].upper()}{noise[1:]}.")


def _inflation_reason(fit: FitReport) -> str:
    match fit.inflated_by:
        case "coloured residuals":
            return f": the residuals are autocorrelated, most in {fit.most_coloured}"
        case "drops that disagree":
            return ": the drops disagree by more than their noise"
        case "large and small motions that disagree":
            return ": large and small motions disagree by more than their noise"
        case _:
            return ""


def _count(number: int, thing: str) -> str:
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def fault_list(faults: Sequence[Fault]) -> RenderableType:
    """Return the list of faults with their remedies, those of one kind in one entry."""
    lines: list[RenderableType] = [Text("Faults", style="bold")]
    for fault in merge_faults(faults):
        text = Text.assemble(f"{fault.where}: ", (fault.code, "yellow"), f": {fault.what}. {fault.do}")
        lines.append(hanging_text("  - ", text))
    return Group(*lines)
