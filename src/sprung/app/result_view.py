"""What the pages of a result show of it; runs in the process that answers questions."""

from __future__ import annotations

from collections import OrderedDict
from pathlib import Path
from typing import Any

import sprung
from sprung.report import verdict_text
from sprung.results import Result, other_quantities, parameters_table

_KEPT = 3
"""Number of results that are kept in memory: one with its series takes some megabytes."""

_read: OrderedDict[tuple[str, bool, tuple[int, ...]], Result] = OrderedDict()


def load_result(folder: str, *, series: bool = False) -> Result:
    """Return a saved result; one that was read before and not written since is kept.

    Parameters
    ----------
    folder
        Its folder.
    series
        Whether with its time series.

    Raises
    ------
    ResultFileError
        If it cannot be read, or was changed after it was written.
    """
    key = (folder, series, tuple(_stamp(Path(folder) / file) for file in ("results.json", "series.npz")))
    if key not in _read:
        _read[key] = sprung.load(folder, series=series)
        while len(_read) > _KEPT:
            _read.popitem(last=False)
    _read.move_to_end(key)
    return _read[key]


def _stamp(path: Path) -> int:
    try:
        state = path.stat()
    except OSError:
        return 0
    return hash((state.st_mtime_ns, state.st_size, state.st_ino))


def summary(folder: str) -> dict[str, Any]:
    """Return name, verdict, next step, undetermined parameters, loads and parameters of a result.

    Parameters
    ----------
    folder
        The results folder.

    Returns
    -------
    dict
        ``parameters`` is a table as HTML, empty for a rejected result; all else is text.
    """
    result = load_result(folder)
    text = verdict_text(result)
    estimates = {**result.parameters, **other_quantities(result.derived)}
    rejected = result.verdict.state == "reject"
    return {
        "name": result.name,
        "state": result.verdict.state,
        "reasons": list(result.verdict.reasons),
        "symbol": text.symbol,
        "statement": text.statement,
        "explanation": text.explanation,
        "next_step": result.next_step,
        "undetermined": [name for name, one in result.parameters.items() if one.value is None],
        "loads": [load.name for load in result.setup.loads if load.name != "empty"],
        "parameters": "" if rejected else parameters_table(result.name, estimates).html(),
    }
