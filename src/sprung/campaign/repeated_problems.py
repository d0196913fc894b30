"""One problem for what is wrong in the same way in several recordings."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable
from dataclasses import replace

from sprung.errors import Problem


def merge_repeated(problems: Iterable[Problem], recordings: Collection[str]) -> list[Problem]:
    """Merge the problems that a channel has in several recordings: the first names the number of the others.

    Parameters
    ----------
    problems
        Of a campaign.
    recordings
        Names of its recordings.

    Returns
    -------
    list of Problem
        In the order of the first of each.

    Examples
    --------
    >>> missing = [Problem(f"{i}.csv: travel", "no unit", "a unit", "State it.") for i in range(3)]
    >>> print(*merge_repeated(missing, {"0.csv", "1.csv", "2.csv"}))
    0.csv and 2 more recordings: travel: found no unit; expected a unit. State it.
    """
    alike: defaultdict[Problem, list[str]] = defaultdict(list)
    for problem in problems:
        recording = next((name for name in recordings if problem.where.startswith(f"{name}: ")), "")
        channel = problem.where.removeprefix(f"{recording}: ") if recording else problem.where
        alike[replace(problem, where=channel)].append(recording)
    return [replace(problem, where=_where(problem.where, names)) for problem, names in alike.items()]


def _where(channel: str, recordings: Iterable[str]) -> str:
    first, *others = dict.fromkeys(recordings)
    if not first:
        return channel
    more = f" and {len(others)} more recording{'s' * (len(others) > 1)}" if others else ""
    return f"{first}{more}: {channel}"
