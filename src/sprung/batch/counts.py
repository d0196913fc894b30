"""Progress of a batch: done, failed, left, rate and remaining time."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

from sprung.display import shown
from sprung.progress import Progress, Step

_SOON = 3.0
"""Time after which a rate is stated, s."""

_OFTEN = 0.25
"""Time between two reports, s."""


@shown
@dataclass(frozen=True, slots=True)
class BatchCounts:
    """How far a batch has come.

    Attributes
    ----------
    done
        Campaigns with a result, those of earlier runs included.
    failed
        Campaigns with a message instead.
    left
        Campaigns still to do.
    rate
        Campaigns per second of this run, 1/s; None before it is known.
    remaining
        Estimated remaining time, s; None before it is known.
    """

    done: int
    failed: int
    left: int
    rate: float | None = None
    remaining: float | None = None

    def document(self) -> dict[str, Any]:
        """Return the counts as plain values."""
        return asdict(self)


class BatchStep(Step):
    """A step of a batch, with its counts.

    Attributes
    ----------
    counts
        How far the batch has come.
    """

    __slots__ = ("counts",)
    counts: BatchCounts


def step_of(counts: BatchCounts) -> BatchStep:
    """Return the step of some counts."""
    step = BatchStep("identifying the campaigns", detail=describe_counts(counts))
    object.__setattr__(step, "counts", counts)
    return step


def describe_counts(counts: BatchCounts) -> str:
    """Return counts in one line.

    Parameters
    ----------
    counts
        How far a batch has come.

    Returns
    -------
    str

    Examples
    --------
    >>> describe_counts(BatchCounts(120, 2, 878, 3.4, 258.2))
    '120 done, 2 failed, 878 left, 3.4 per s, about 4:18 more'
    """
    text = f"{counts.done} done, {counts.failed} failed, {counts.left} left"
    if counts.rate is not None and counts.remaining is not None:
        minutes, seconds = divmod(round(counts.remaining), 60)
        hours, minutes = divmod(minutes, 60)
        clock = f"{hours}:{minutes:02d}:{seconds:02d}" if hours else f"{minutes}:{seconds:02d}"
        text += f", {counts.rate:.2g} per s, about {clock} more"
    return text


class Counter:
    """Counts the campaigns of a batch and reports them from time to time."""

    def __init__(self, total: int, progress: Progress, clock: Callable[[], float] = time.monotonic) -> None:
        self._total, self._progress, self._clock = total, progress, clock
        self.done = self.failed = self.computed = 0
        self._began: float | None = None
        self._reported = -_OFTEN

    def skip(self, failed: bool) -> None:
        """Count a campaign whose row is there already."""
        self.failed += failed
        self.done += not failed
        self.report()

    def start_clock(self) -> None:
        """Note that the first campaign of this run is begun: the rate counts from here."""
        if self._began is None:
            self._began = self._clock()

    def add(self, failed: bool) -> None:
        """Count a campaign of this run."""
        self.computed += 1
        self.failed += failed
        self.done += not failed
        self.report()

    @property
    def counts(self) -> BatchCounts:
        """How far the batch has come."""
        left = max(self._total - self.done - self.failed, 0)
        elapsed = 0.0 if self._began is None else self._clock() - self._began
        if elapsed < _SOON or not self.computed:
            return BatchCounts(self.done, self.failed, left)
        rate = self.computed / elapsed
        return BatchCounts(self.done, self.failed, left, rate, left / rate)

    def report(self, last: bool = False) -> None:
        """Report the counts, at most a few times per second."""
        now = self._clock()
        if last or now - self._reported >= _OFTEN:
            self._reported = now
            self._progress(step_of(self.counts))
