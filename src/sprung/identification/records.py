"""The records as the fit uses them: centred, cut into blocks, those that share poles side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sprung.identification.sums import BLOCK, blocks, correlate
from sprung.prepare import Decay

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Records:
    """Decays of any load, rate and length.

    Attributes
    ----------
    order
        Position of each record in the fit's list of decays: here those of one load and rate stand together; shape (drop,).
    load
        Which load each belongs to, by its position in `loads`, shape (drop,).
    loads
        Names of the loads.
    step
        Sampling interval of each, s, shape (drop,).
    samples
        Shape (drop,).
    present
        1 for a channel that is used, 0 for one that is left out; shape (drop, channel).
    energy
        Sum of squares of the centred records, (m/s²)², shape (drop, channel).
    blocked
        Centred records cut into blocks, one after the other, channels that are left out zero; shape (block, channel,
        BLOCK).
    """

    order: Index
    load: Index
    loads: tuple[str, ...]
    step: Real
    samples: Index
    present: Real
    energy: Real
    blocked: Real

    @classmethod
    def of(cls, decays: Sequence[Decay]) -> Records:
        """Take up decays."""
        loads = tuple(sorted({decay.load for decay in decays}))
        order = sorted(range(len(decays)), key=lambda i: (decays[i].load, decays[i].rate))
        chosen = [decays[i] for i in order]
        centred = [_centred(decay) for decay in chosen]
        return cls(
            order=np.array(order),
            load=np.array([loads.index(decay.load) for decay in chosen]),
            loads=loads,
            step=np.array([1.0 / decay.rate for decay in chosen]),
            samples=np.array([decay.samples for decay in chosen]),
            present=np.array([decay.usable for decay in chosen], dtype=float),
            energy=np.array([np.sum(record**2, axis=1) for record in centred]),
            blocked=np.concatenate([blocks(record) for record in centred]),
        )

    @cached_property
    def _counts(self) -> Index:
        return -(-self.samples // BLOCK)

    @cached_property
    def _ends(self) -> Index:
        """Give where the blocks of each record end, 0 before the first."""
        return np.concatenate([[0], np.cumsum(self._counts)])

    @cached_property
    def _runs(self) -> list[slice]:
        """Give the runs of records that share load and step, and so poles."""
        new = np.flatnonzero((np.diff(self.load) != 0) | (np.diff(self.step) != 0)) + 1
        edges = [0, *new.tolist(), len(self.load)]
        return [slice(begin, end) for begin, end in pairwise(edges)]

    @property
    def largest(self) -> Records:
        """The most of them that share load and rate, with that one load."""
        run = max(self._runs, key=lambda run: int(run.stop - run.start))
        return Records(
            order=self.order[run],
            load=np.zeros_like(self.load[run]),
            loads=(self.loads[self.load[run.start]],),
            step=self.step[run],
            samples=self.samples[run],
            present=self.present[run],
            energy=self.energy[run],
            blocked=self.blocked[self._ends[run.start] : self._ends[run.stop]],
        )

    def record(self, drop: int) -> Real:
        """Give one centred record, shape (channel, time)."""
        whole = self.blocked[self._ends[drop] : self._ends[drop + 1]].swapaxes(0, 1)
        record: Real = whole.reshape(whole.shape[0], -1)[:, : self.samples[drop]]
        return record

    def correlate(self, exponent: Complex, secular: bool) -> Complex:
        """Give the inner products of the records with e^{λt} and, if wanted, t e^{λt}.

        Parameters
        ----------
        exponent
            λ times the sampling interval, for each drop; shape (drop, mode).
        secular
            Whether the second half is wanted.

        Returns
        -------
        ndarray
            Shape (drop, channel, mode or twice as many).
        """
        parts = []
        for run in self._runs:
            # Poles come in conjugate pairs, one beside the other: one of each pair is enough for real records.
            poles, step = exponent[run.start], self.step[run.start]
            upper = poles.imag >= 0
            of_pair = np.cumsum(upper) - 1
            blocked = self.blocked[self._ends[run.start] : self._ends[run.stop]]
            halves = correlate(blocked, self._counts[run], poles[upper], secular)
            whole = [np.where(upper, half[:, :, of_pair], half[:, :, of_pair].conj()) for half in halves]
            parts.append(np.concatenate([half * step**power for power, half in enumerate(whole)], axis=2))
        return np.concatenate(parts)


def _centred(decay: Decay) -> Real:
    record = np.zeros(decay.values.shape)
    usable = decay.values[decay.usable]
    record[decay.usable] = usable - usable.mean(axis=1, keepdims=True)
    return record
