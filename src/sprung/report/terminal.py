"""What the terminal shows: the parameter table, the modal tables, the verdict, the faults."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rich.console import Group, RenderableType
from rich.text import Text

from sprung.errors import Fault
from sprung.estimate import Estimate, round_by_uncertainty
from sprung.identification import ModeEstimate
from sprung.pipeline import FitReport, Result
from sprung.report.layout import hanging, table
from sprung.report.plan import next_line
from sprung.vehicle import PARAMETERS

COLOURS = {"accept": "green", "doubtful": "yellow", "reject": "red"}

_FINEST = 6
"""Decimal places beyond which a frequency in Hz or a damping ratio means nothing to anybody."""

_SUPERSCRIPT = str.maketrans({"^": "", "2": "²"})

_OF_ALL = "of the empty vehicle"
_DERIVED = {"I_xx_roll_axis": "roll inertia of the sprung mass about the axis of roll"}
"""What derived quantities mean."""


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
    parts: list[RenderableType] = [parameter_table(result), Text()]
    if profiles := _profiles(result):
        parts += [interval_table(profiles), Text()]
    if result.unidentifiable:
        parts += [Text("Not determined", style="bold")]
        parts += [*(hanging("  - ", item.text) for item in result.unidentifiable), Text()]
    if not result.scale.known and result.scale.per_total_mass:
        parts += [ratio_table(result), Text()]
    for load, modes in result.modes.items():
        parts += [mode_table(load, modes), Text()]
    parts += [fit_line(result), Text()]
    if result.faults:
        parts += [fault_list(result.faults), Text()]
    parts.append(verdict_view(result))
    if result.next_step is not None:
        parts += [Text(), next_line(result.next_step)]
    return Group(*parts)


def verdict_view(result: Result) -> RenderableType:
    """Show the verdict and its reasons."""
    verdict = result.verdict
    head = Text.assemble(("Verdict: ", "bold"), (verdict.state, f"bold {COLOURS[verdict.state]}"))
    return Group(head, *(hanging("  - ", reason) for reason in verdict.reasons))


def parameter_table(result: Result) -> RenderableType:
    """Show every parameter with its uncertainty."""
    headers = ("parameter", "value", "±", "%", "unit", "status", "meaning")
    rows = [[name, *_value_cells(found), PARAMETERS[name].meaning] for name, found in result.parameters.items()]
    rows += [[name, *_value_cells(found), _DERIVED.get(name, _OF_ALL)] for name, found in result.derived.items()]
    title = f"{result.vehicle.name}: parameters, one standard uncertainty"
    return table(title, headers, rows, ("value", "±", "%"), ("meaning", "%", "status"))


def interval_table(profiles: Mapping[str, Estimate]) -> RenderableType:
    """Show the intervals that follow from profiles of the likelihood, by name."""
    rows = [[name, *_interval_cells(found), unit_text(found.unit)] for name, found in profiles.items()]
    shown = table("95 % intervals from the whole likelihood", ("parameter", "from", "to", "unit"), rows, ("from", "to"))
    if any(found.interval95 is not None and None in found.interval95 for found in profiles.values()):
        return Group(shown, Text("< or >: open to the other side, where the recordings set no limit."))
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


def _value_cells(estimate: Estimate) -> list[str]:
    unit = unit_text(estimate.unit)
    if estimate.value is None or estimate.std is None:
        return ["-", "-", "-", unit, estimate.status]
    value, std = round_by_uncertainty(estimate.value, estimate.std)
    percent = "" if estimate.percent is None or estimate.std == 0 else _percent(estimate.percent)
    return [value, std, percent, unit, estimate.status]


def _percent(percent: float) -> str:
    if percent >= 10:
        return f"{percent:.0f}"
    return f"{percent:.2f}" if percent >= 0.01 else f"{percent:.1g}"


def unit_text(unit: str) -> str:
    """Write a unit as people do: nothing for 1, powers raised."""
    return "" if unit == "1" else unit.translate(_SUPERSCRIPT)


def ratio_table(result: Result) -> RenderableType:
    """Show what is left without absolute scale."""
    rows = []
    for name, ratio in result.scale.per_total_mass.items():
        value, std = round_by_uncertainty(ratio.value, ratio.std)
        rows.append([name, value, std, unit_text(ratio.unit)])
    title = "Divided by the empty vehicle's total mass"
    return table(title, ("parameter", "value", "±", "unit"), rows, ("value", "±"))


def mode_table(load: str, modes: Sequence[ModeEstimate]) -> RenderableType:
    """Show the modes of one load, with uncertainties; what is undetermined gets no number."""
    rows = []
    for mode in modes:
        damped = "-" if mode.frequency_std is None else f"{mode.damped_frequency:.3f}"
        frequency = with_std(mode.frequency, mode.frequency_std)
        rows.append([mode.name, *frequency, damped, *with_std(mode.damping_ratio, mode.damping_ratio_std)])
    headers = ("mode", "f_n Hz", "± Hz", "f_d Hz", "damping", "±")
    return table(f"Modes, {load}", headers, rows, headers[1:], ("f_d Hz", "±"))


def with_std(value: float, std: float | None) -> tuple[str, str]:
    """Round a frequency or damping ratio by its uncertainty; without one there is no number."""
    if std is None:
        return "-", "-"
    if std < 10.0**-_FINEST:
        return f"{value:.{_FINEST}f}", f"{0:.{_FINEST}f}"
    return round_by_uncertainty(value, std)


def fit_line(result: Result) -> RenderableType:
    """Say in a line or two how the fit went."""
    fit = result.fit
    noise = ", ".join(f"{channel} {value:.3g}" for channel, value in fit.noise.items())
    extras = f", with {', '.join(fit.model)}" if fit.model else ""
    text = (
        f"Fit: {fit.method}{extras}; {_count(fit.drops, 'drop')}, {fit.samples} samples, {fit.iterations} steps, "
        f"{fit.starts_agreeing} of {fit.starts} starts agree."
    )
    if fit.inflation > 1:
        text += (
            f"\nError bars are {fit.inflation**0.5:.2f} times as wide as white noise would make them{_because(fit)}."
        )
    axes = f"\nAxes: {fit.axes}." if fit.axes else ""
    return Text(f"{text}\nModel: {fit.why}.{axes}\nNoise, m/s² rms: {noise}.")


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
