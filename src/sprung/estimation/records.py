"""The records as the fit uses them: centred, cut into blocks, those that share their channels in one run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import LoggerClock
from sprung.preprocess import FreeDecay
from sprung.vehicle import separate_track_names
from sprung.vibration import BLOCK_LENGTH, correlate_with_exponentials, split_into_blocks

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.int64]

_LARGEST = 400
"""Blocks in a run at the most, unless one record has more: its products then stay in a processor's cache."""


class FlightInformation(NamedTuple):
    """What flights tell of the vehicle before each record of a run, as `FlightLikelihood` of one does.

    Attributes
    ----------
    at, gradient
        Shape (record, parameter).
    information
        Shape (record, parameter, parameter).
    """

    at: Real
    gradient: Real
    information: Real

    @classmethod
    def of(cls, decays: Sequence[FreeDecay], names: Sequence[str]) -> FlightInformation:
        """Take up what decays have of it, for parameters of a fit, which may share half-distances."""
        at, gradient = np.zeros((2, len(decays), len(names)))
        information = np.zeros((len(decays), len(names), len(names)))
        for i, flight in enumerate(decay.flight for decay in decays):
            if flight is not None:
                own = np.array(
                    [[name in separate_track_names(one) for name in flight.names] for one in names], dtype=float
                )
                at[i] = own @ flight.at / np.maximum(own.sum(axis=1), 1)
                gradient[i], information[i] = own @ flight.gradient, own @ flight.information @ own.T
        return cls(at, gradient, information)

    def score(self, values: Real) -> Real:
        """Give the gradient elsewhere, from the parameters, shape (parameter,), to (record, parameter)."""
        return np.asarray(self.gradient - (self.information @ (values - self.at)[:, :, None])[:, :, 0])

    def penalty(self, values: Real) -> float:
        """Give what it costs to be elsewhere, in twice the log-likelihood."""
        return -float(np.sum((values - self.at) * (self.gradient + self.score(values))))

    def members(self, which: Sequence[int] | slice) -> FlightInformation:
        """Give the same for some of the records."""
        return FlightInformation(self.at[which], self.gradient[which], self.information[which])


@dataclass(frozen=True, eq=False)
class RecordBatch:
    """Decays with the same channels, those of one load and rate, and so of the same poles and shapes, in one group.

    Attributes
    ----------
    order
        Position of each record in the fit's list of decays, shape (record,).
    group
        Which group it belongs to, ascending, shape (record,).
    load
        Which load each group has, by its position in the list of loads, shape (group,).
    step
        Sampling interval of each group, s, shape (group,).
    samples
        Of each record, shape (record,).
    present
        1 for a channel that is used, 0 for one that is left out, and for one that was interpolated the samples that were taken
        for each that is there; shape (channel,).
    energy
        Sum of squares of the centred records, (m/s²)², shape (record, channel).
    blocked
        Centred records cut into blocks, one after the other, channels that are left out zero; shape (block, channel,
        BLOCK).
    late
        Of several loggers which one recorded each channel, shape (channel, logger), every record then being a group; no
        column where all channels have one clock.
    expected, expected_std
        How late each of them was in each record as far as anybody knows, and how sure that is, s, shape (record, logger).
    follows
        By how much the first of these, s at parameters of zero, grows with each parameter, s per SI unit; shape (record,
        logger, parameter).
    flown
        What the flight before each of these records tells of the vehicle.
    """

    order: Index
    group: Index
    load: Index
    step: Real
    samples: Index
    present: Real
    energy: Real
    blocked: Real
    late: Real
    expected: Real
    expected_std: Real
    follows: Real
    flown: FlightInformation

    @classmethod
    def of(
        cls, order: Sequence[int], decays: Sequence[FreeDecay], loads: Sequence[str], names: Sequence[str] = ()
    ) -> RecordBatch:
        """Take up decays that belong together, by their positions in the list of all."""
        clocks = decays[order[0]].clocks
        kind = {i: (loads.index(decays[i].load), 1.0 / decays[i].rate, i if clocks else 0) for i in order}
        alike = sorted(set(kind.values()))
        groups = {i: alike.index(kind[i]) for i in order}
        order = sorted(order, key=groups.__getitem__)
        samples = np.array([decays[i].samples for i in order])
        cut = [split_into_blocks(decays[i].values, decays[i].usable) for i in order]
        return cls(
            order=np.array(order),
            group=np.array([groups[i] for i in order]),
            load=np.array([load for load, *_ in alike]),
            step=np.array([step for _, step, _ in alike]),
            samples=samples,
            present=decays[order[0]].usable * channel_rate_ratios(decays[order[0]]),
            energy=np.array([np.einsum("bct,bct->c", record, record) for record in cut]),
            blocked=np.concatenate(cut),
            late=_loggers(decays[order[0]]),
            expected=np.array([[clock.delay for clock in decays[i].clocks] for i in order]),
            expected_std=np.array([[clock.delay_std for clock in decays[i].clocks] for i in order]),
            follows=np.array([[_by_parameter(clock, names) for clock in decays[i].clocks] for i in order]),
            flown=FlightInformation.of([decays[i] for i in order], names),
        )

    @cached_property
    def counts(self) -> Index:
        """How many blocks each record has, shape (record,)."""
        return -(-self.samples // BLOCK_LENGTH)

    @cached_property
    def _first(self) -> Index:
        """Give the first record of each group."""
        return np.searchsorted(self.group, np.arange(len(self.load)))

    def by_group(self, values: Complex) -> Complex:
        """Add up over the records of each group; shape (record, ...) to (group, ...)."""
        return np.add.reduceat(values, self._first, axis=0)

    def members(self, group: int) -> slice:
        """Give the records of a group."""
        ends = [*self._first.tolist(), len(self.group)]
        return slice(ends[group], ends[group + 1])

    def sketch(self, group: int, rate: float, longest: float, most: int) -> RecordBatch:
        """Thin records of a group, and cut them to one length.

        Parameters
        ----------
        group
            Which.
        rate
            Samples per second to go down to.
        longest
            s of each record at the most.
        most
            Records at the most; those much shorter than the others are left out.
        """
        step = float(self.step[group])
        own = np.arange(len(self.group))[self.members(group)]
        long = own[2 * self.samples[own] >= self.samples[own].max()][:most].tolist()
        every = max(int(1 / (step * rate)), 1)
        samples = min(int(longest / step), int(self.samples[long].min()))
        cut = [split_into_blocks(self.record(i)[:, :samples:every]) for i in long]
        return RecordBatch(
            order=self.order[long],
            group=np.zeros(len(long), dtype=np.int64),
            load=self.load[group : group + 1],
            step=np.array([every * step]),
            samples=np.full(len(long), -(-samples // every)),
            present=self.present,
            energy=np.array([np.einsum("bct,bct->c", record, record) for record in cut]),
            blocked=np.concatenate(cut),
            late=self.late[:, :0],
            expected=self.expected[long, :0],
            expected_std=self.expected_std[long, :0],
            follows=self.follows[long, :0],
            flown=self.flown.members(long),
        )

    def shortened(self, duration: float) -> RecordBatch:
        """Cut the records of a sketch to a duration, s."""
        return self.sketch(0, 1.0 / float(self.step[0]), duration, len(self.samples))

    def record(self, position: int) -> Real:
        """Give one centred record, shape (channel, time)."""
        end = int(self.counts[: position + 1].sum())
        whole = self.blocked[end - self.counts[position] : end].swapaxes(0, 1)
        record: Real = whole.reshape(whole.shape[0], -1)[:, : self.samples[position]]
        return record

    def correlate(self, exponent: Complex, secular: bool = True) -> Complex:
        """Give the inner products of the records with e^{λk} and, if wanted, k e^{λk}.

        Parameters
        ----------
        exponent
            λ per sample, conjugates beside each other, shape (group, mode).
        secular
            Whether the second half is wanted.

        Returns
        -------
        ndarray
            Shape (record, channel, mode or twice as many).
        """
        # Of every pair of conjugate poles one is enough for real records; which has more real ones sets the width.
        upper = exponent.imag >= 0
        width = upper.sum(axis=1).max()
        chosen = np.take_along_axis(exponent, np.argsort(~upper, axis=1, kind="stable")[:, :width], axis=1)
        half = correlate_with_exponentials(self.blocked, self.counts, chosen, self.group, secular)
        of_pair = (np.cumsum(upper, axis=1) - 1)[self.group]
        whole = np.take_along_axis(half, of_pair[:, None, None], axis=-1)
        whole.imag *= np.where(upper, 1.0, -1.0)[self.group][:, None, None]
        return whole.reshape(*whole.shape[:2], -1)


@dataclass(frozen=True, eq=False)
class Records:
    """All decays of a fit.

    Attributes
    ----------
    loads
        Names of the loads.
    runs
        The decays.
    drops
        How many there are.
    """

    loads: tuple[str, ...]
    runs: tuple[RecordBatch, ...]
    drops: int

    @classmethod
    def of(cls, decays: Sequence[FreeDecay], names: Sequence[str] = ()) -> Records:
        """Take up decays of any load, rate and length, to be fitted by parameters of these names."""
        loads = tuple(sorted({decay.load for decay in decays}))
        together: dict[tuple[object, ...], list[list[int]]] = {}
        for i in sorted(range(len(decays)), key=lambda i: (decays[i].load, decays[i].rate)):
            loggers = tuple(clock.channels for clock in decays[i].clocks)
            runs = together.setdefault((*decays[i].usable, *channel_rate_ratios(decays[i]), loggers), [[]])
            if runs[-1] and sum(decays[other].samples for other in (*runs[-1], i)) > _LARGEST * BLOCK_LENGTH:
                runs.append([])
            runs[-1].append(i)
        return cls(
            loads,
            tuple(RecordBatch.of(order, decays, loads, names) for runs in together.values() for order in runs),
            len(decays),
        )

    def in_order(self, by_run: Sequence[Real]) -> Real:
        """Put what belongs to each record where the fit's list of decays has it."""
        ordered = np.zeros((self.drops, *by_run[0].shape[1:]))
        for run, values in zip(self.runs, by_run, strict=True):
            ordered[run.order] = values
        return ordered


def channel_rate_ratios(decay: FreeDecay) -> Real:
    """Give the samples that each channel's logger took for each one of the decay, shape (channel,)."""
    shares = np.array(decay.rate_ratios or np.ones(len(decay.values)))
    for clock in decay.clocks:
        shares[list(clock.channels)] *= clock.rate_ratio
    return shares


def _loggers(decay: FreeDecay) -> Real:
    """Say which logger recorded which channel, shape (channel, logger)."""
    own = np.zeros((len(decay.values), len(decay.clocks)))
    for column, clock in enumerate(decay.clocks):
        own[list(clock.channels), column] = 1.0
    return own


def _by_parameter(clock: LoggerClock, names: Sequence[str]) -> list[float]:
    """Give how a clock follows the parameters of a fit, which may share half-distances; shape (parameter,)."""
    return [sum(clock.d_delay_d_parameter.get(own, 0.0) for own in separate_track_names(name)) for name in names]
