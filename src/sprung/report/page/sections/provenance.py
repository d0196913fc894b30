"""What to do next, and everything that led here: settings, versions, files, literature."""

from __future__ import annotations

from sprung.report.page.literature import literature_of
from sprung.report.page.sections.context import Context
from sprung.results import Result, trace_table
from sprung.tables import Table


def next_step(result: Result) -> Context:
    """Say what to measure next."""
    if result.next_step is not None:
        return {"said": f"{result.next_step[0].upper()}{result.next_step[1:]}".rstrip(".") + "."}
    return {"said": "Remove the reasons of the verdict first. No test can be planned with a model that was rejected."}


def settings(result: Result) -> Context:
    """Tell every setting, version, file and checksum."""
    fit = result.fit
    pairs = [
        ("method", fit.method),
        ("model", f"seven degrees of freedom{', with ' + ', '.join(fit.model) if fit.model else ''}"),
        ("half-distances", f"{fit.tracks}"),
        ("why this model", fit.why),
        ("axes of the inertias", fit.axes),
        ("drops used from", "their release on" if fit.since == "release" else "when the last tyre was down"),
        (
            "fit",
            (
                f"{fit.samples} samples, {fit.iterations} steps, {'converged' if fit.converged else 'not converged'}; "
                f"{fit.starts_agreeing} of {fit.starts} starts agree"
            ),
        ),
        ("error bars", _bars(result)),
        ("noise, m/s² rms", ", ".join(f"{name} {value:.3g}" for name, value in fit.noise.items())),
    ]
    tables = []
    if fit.path:
        headers = ("tried", "gain", "required", "fitted", "kept")
        rows = tuple(
            (
                one.extra,
                f"{one.gain:.0f}",
                f"{one.asked:.0f}",
                "yes" if one.fitted else "no",
                "yes" if one.taken else "no",
            )
            for one in fit.path
        )
        title = "Selection of model terms: gain in twice the log-likelihood, and the gain required"
        tables.append(Table(title, headers, rows, frozenset(headers[1:3])))
    if (setup := result.setup) is not None:
        model = setup.model
        asked = {
            "tracks": model.tracks,
            "extras": None if model.extras is None else ", ".join(model.extras) or "none",
            "forbidden": ", ".join(model.forbid) or None,
            "fall": None if model.fall is None else "yes" if model.fall else "no",
        }
        pairs.append(
            ("set in the campaign file", "; ".join(f"{key}: {value or 'left open'}" for key, value in asked.items()))
        )
        pairs.append(
            (
                "options of this identification",
                "; ".join(f"{key}: {value}" for key, value in setup.options.items()) or "nothing",
            )
        )
        pairs.append(("software", ", ".join(f"{name} {number}" for name, number in setup.software.items())))
        files = tuple((one.name, f"{one.size}", one.sha256) for one in setup.files)
        if files:
            tables.append(Table("Files", ("file", "bytes", "SHA-256"), files, frozenset(("bytes",))))
    return {"pairs": [pair for pair in pairs if pair[1]], "tables": tables}


def _bars(result: Result) -> str:
    fit = result.fit
    if result.verdict.state == "reject":
        return ""
    if fit.inflation <= 1:
        return "those of white noise"
    because = f", because of {fit.inflated_by}" if fit.inflated_by not in {None, "nothing"} else ""
    return f"{fit.inflation**0.5:.2f} times those of white noise{because}"


def trace(result: Result, unfolded: bool) -> Context | None:
    """Return the steps of the analysis; None where none are recorded."""
    if not result.trace:
        return None
    return {"steps": trace_table(result.trace), "count": len(result.trace), "open": unfolded}


def literature(result: Result) -> Context:
    """Name what was written on the methods that were used."""
    return {"works": list(literature_of(result))}
