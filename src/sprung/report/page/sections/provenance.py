"""Sections about next step, trace, settings, versions, files and references."""

from __future__ import annotations

from sprung.report.page.literature import references_of
from sprung.report.page.sections.context import Context
from sprung.report.page.summary import model_text
from sprung.results import Result, trace_table
from sprung.tables import Table


def next_step(result: Result) -> Context:
    """Return the recommended next measurement."""
    if result.next_step is not None:
        return {"text": f"{result.next_step[0].upper()}{result.next_step[1:]}".rstrip(".") + "."}
    return {"text": "Remove the reasons of the verdict first. No test can be planned with a model that was rejected."}


def settings(result: Result) -> Context:
    """Return settings, versions, files and checksums."""
    fit = result.fit
    pairs = [
        ("method", fit.method),
        ("model", model_text(result)),
        ("half-distances", f"{fit.tracks}"),
        ("reason for the model", fit.why),
        ("axes of the inertias", fit.axes),
        ("start of the fit", "release" if fit.since == "release" else "landing of the last tyre"),
        (
            "fit",
            (
                f"{fit.samples} samples, {fit.iterations} steps, {'converged' if fit.converged else 'not converged'}; "
                f"{fit.starts_text}"
            ),
        ),
        ("standard uncertainties", _inflation_text(result)),
        result.setup.describe_noise(fit.noise),
    ]
    tables = []
    if fit.path:
        headers = ("model term", "Δ2lnL", "required", "fitted", "accepted")
        rows = tuple(
            (
                step.extra,
                f"{step.gain:.0f}",
                f"{step.asked:.0f}",
                "yes" if step.fitted else "no",
                "yes" if step.taken else "no",
            )
            for step in fit.path
        )
        title = "Selection of model terms: gain in twice the log-likelihood, Δ2lnL, and the gain required"
        tables.append(Table(title, headers, rows, frozenset(headers[1:3])))
    setup, model = result.setup, result.setup.model
    stated = {
        "tracks": model.tracks,
        "extras": None if model.extras is None else ", ".join(model.extras) or "none",
        "forbidden": ", ".join(model.forbid) or None,
        "fall": None if model.fall is None else "yes" if model.fall else "no",
    }
    ratios = (
        f"{name} {ratio.value:g}{f' ± {ratio.std:g}' if ratio.std else ''}"
        for name, ratio in setup.motion_ratio.items()
    )
    pairs += [
        ("motion ratios", ", ".join(ratios)),
        ("model in the campaign file", "; ".join(f"{key}: {value or 'left open'}" for key, value in stated.items())),
        ("options", "; ".join(f"{key}: {value}" for key, value in setup.options.items()) or "none"),
        ("software", ", ".join(f"{name} {number}" for name, number in setup.software.items())),
    ]
    if setup.files:
        files = tuple((file.name, f"{file.size}", file.sha256) for file in setup.files)
        tables.append(Table("Files", ("file", "bytes", "SHA-256"), files, frozenset(("bytes",))))
    return {"pairs": [pair for pair in pairs if pair[1]], "tables": tables}


def _inflation_text(result: Result) -> str:
    fit = result.fit
    if result.verdict.state == "reject":
        return ""
    if fit.inflation <= 1:
        return "those of white noise"
    return f"{fit.inflation**0.5:.2f} times those of white noise, because of {fit.inflated_by}"


def trace(result: Result, unfolded: bool) -> Context | None:
    """Return the steps of the analysis; None where none are recorded."""
    if not result.trace:
        return None
    return {"steps": trace_table(result.trace), "count": len(result.trace), "open": unfolded}


def literature(result: Result) -> Context:
    """Return the references of the methods that were used."""
    return {"references": list(references_of(result))}
