"""The records as the closed form uses them: centred, cut into blocks, those that share their channels in one batch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

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
"""Blocks in a batch at the most, unless one record has more: its products then stay in a processor's cache."""


@dataclass(frozen=True, eq=False)
class RecordBatch:
    """Records with the same channels; those of one load and rate, and so of the same poles and shapes, form a group.

    Attributes
    ----------
    positions
        Position of each record in the fit's list of decays, shape (record,).
    group
        Which group it belongs to, ascending, shape (record,).
    load
        Position of each group's load in the sorted names of the loads, shape (group,).
    step
        Sampling interval of each group, s, shape (group,).
    samples
        Of each record, shape (record,).
    channel_weights
        0 for a channel that is left out, else 1; for one that was interpolated the samples that were taken for each one that is
        there; shape (channel,).
    energy
        Sum of squares of the centred records, (m/s²)², shape (record, channel).
    blocks
        Centred records cut into blocks, one after the other, padded with zeros; channels that are left out are zero; shape
        (block, channel, BLOCK_LENGTH).
    clock_design
        1 where a logger recorded a channel, shape (channel, logger), every record then being a group; no column where all
        channels have one clock.
    expected_delays, delay_std
        What is known beforehand of the loggers' delays at parameters of zero, and its standard uncertainty, s, shape (record,
        logger).
    d_delay_d_parameter
        Derivative of what is expected by the parameters, s per SI unit, shape (record, logger, parameter).
    flight_values, flight_gradient, flight_information
        Log-likelihood of the flight before each record, to second order: parameters, and gradient and information there; shapes
        (record, parameter) twice and (record, parameter, parameter).
    """

    positions: Index
    group: Index
    load: Index
    step: Real
    samples: Index
    channel_weights: Real
    energy: Real
    blocks: Real
    clock_design: Real
    expected_delays: Real
    delay_std: Real
    d_delay_d_parameter: Real
    flight_values: Real
    flight_gradient: Real
    flight_information: Real

    @cached_property
    def counts(self) -> Index:
        """Number of blocks of each record, shape (record,)."""
        return -(-self.samples // BLOCK_LENGTH)

    @cached_property
    def duration(self) -> float:
        """Length of the longest record, s."""
        return float((self.samples * self.step[self.group]).max())

    @cached_property
    def _first(self) -> Index:
        """First record of each group."""
        return np.searchsorted(self.group, np.arange(len(self.load)))

    def sum_groups(self, values: Complex) -> Complex:
        """Sum over the records of each group; shape (record, ...) to (group, ...)."""
        return np.add.reduceat(values, self._first, axis=0)

    def members(self, group: int) -> slice:
        """Return the records of a group."""
        ends = [*self._first.tolist(), len(self.group)]
        return slice(ends[group], ends[group + 1])

    def find(self, position: int) -> int | None:
        """Return the group of a decay by its position in the fit's list, None where it is in another batch."""
        found = np.flatnonzero(self.positions == position)
        return int(self.group[found[0]]) if found.size else None

    def decimated(self, group: int, rate: float, longest: float, most: int) -> RecordBatch:
        """Return records of a group decimated and cut to one length.

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
        long, records, step = self.thinned(group, rate, longest, most)
        blocks, samples = split_into_blocks(list(records)), np.full(len(long), records.shape[2])
        return RecordBatch(
            positions=self.positions[long],
            group=np.zeros(len(long), dtype=np.int64),
            load=self.load[group : group + 1],
            step=np.array([step]),
            samples=samples,
            channel_weights=self.channel_weights,
            energy=_energy(blocks, samples),
            blocks=blocks,
            clock_design=self.clock_design[:, :0],
            expected_delays=self.expected_delays[long, :0],
            delay_std=self.delay_std[long, :0],
            d_delay_d_parameter=self.d_delay_d_parameter[long, :0],
            flight_values=self.flight_values[long],
            flight_gradient=self.flight_gradient[long],
            flight_information=self.flight_information[long],
        )

    def thinned(self, group: int, rate: float, longest: float, most: int) -> tuple[list[int], Real, float]:
        """Return the positions of records of a group, samples of them as of `decimated`, and the interval of these, s.

        Returns
        -------
        positions
            In the batch.
        records
            Shape (record, channel, time).
        step
            s.
        """
        step = float(self.step[group])
        own = np.arange(len(self.group))[self.members(group)]
        long = own[2 * self.samples[own] >= self.samples[own].max()][:most].tolist()
        every = max(int(1 / (step * rate)), 1)
        samples = min(int(longest / step), int(self.samples[long].min()))
        return long, np.array([self.record(i)[:, :samples:every] for i in long]), every * step

    def record(self, index: int) -> Real:
        """Centred record, shape (channel, time)."""
        end = int(self.counts[: index + 1].sum())
        whole = self.blocks[end - self.counts[index] : end].swapaxes(0, 1)
        record: Real = whole.reshape(whole.shape[0], -1)[:, : self.samples[index]]
        return record

    def correlate(self, exponent: Complex, secular: bool = True) -> Complex:
        """Return the inner products of the records with e^{λk} and, if wanted, k e^{λk}.

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
        # Of every pair of conjugate poles one is enough for real records; the group with most real ones sets the width.
        upper = exponent.imag >= 0
        width = upper.sum(axis=1).max()
        chosen = np.take_along_axis(exponent, np.argsort(~upper, axis=1, kind="stable")[:, :width], axis=1)
        half = correlate_with_exponentials(self.blocks, self.counts, chosen, self.group, secular)
        of_pair = (np.cumsum(upper, axis=1) - 1)[self.group]
        whole = np.take_along_axis(half, of_pair[:, None, None], axis=-1)
        whole.imag *= np.where(upper, 1.0, -1.0)[self.group][:, None, None]
        return whole.reshape(*whole.shape[:2], -1)

    def flight_score(self, values: Real) -> Real:
        """Gradient of the flights' log-likelihoods at parameters, shape (parameter,); shape (record, parameter)."""
        step = (values - self.flight_values)[:, :, None]
        return np.asarray(self.flight_gradient - (self.flight_information @ step)[:, :, 0])

    def flight_penalty(self, values: Real) -> float:
        """Loss of the flights' log-likelihoods at parameters, twice, against where they were expanded."""
        return -float(np.sum((values - self.flight_values) * (self.flight_gradient + self.flight_score(values))))


def batch_records(decays: Sequence[FreeDecay], names: Sequence[str] = ()) -> tuple[RecordBatch, ...]:
    """Return decays of any load, rate and length in batches, to be fitted by parameters of these names."""
    together: dict[tuple[object, ...], list[list[int]]] = {}
    for i in sorted(range(len(decays)), key=lambda i: (decays[i].load, decays[i].rate)):
        loggers = tuple(clock.channels for clock in decays[i].clocks)
        batches = together.setdefault((*decays[i].usable, *channel_rate_ratios(decays[i]), loggers), [[]])
        if batches[-1] and sum(decays[member].samples for member in (*batches[-1], i)) > _LARGEST * BLOCK_LENGTH:
            batches.append([])
        batches[-1].append(i)
    return tuple(_batch(positions, decays, names) for batches in together.values() for positions in batches)


def in_order(batches: Sequence[RecordBatch], by_batch: Sequence[Real]) -> Real:
    """Return what belongs to each record in the order of the fit's list of decays."""
    drops = sum(len(batch.positions) for batch in batches)
    ordered = np.zeros((drops, *by_batch[0].shape[1:]))
    for batch, values in zip(batches, by_batch, strict=True):
        ordered[batch.positions] = values
    return ordered


def channel_rate_ratios(decay: FreeDecay) -> Real:
    """Return the samples that each channel's logger took for each one of the decay, shape (channel,)."""
    ratios = np.array(decay.rate_ratios or np.ones(len(decay.values)))
    for clock in decay.clocks:
        ratios[list(clock.channels)] *= clock.rate_ratio
    return ratios


def _batch(positions: Sequence[int], decays: Sequence[FreeDecay], names: Sequence[str]) -> RecordBatch:
    """Return decays that share their channels as one batch, by their positions in the list of all."""
    first = decays[positions[0]]
    loads = sorted({decay.load for decay in decays})
    kind = {i: (loads.index(decays[i].load), 1.0 / decays[i].rate, i if first.clocks else 0) for i in positions}
    kinds = sorted(set(kind.values()))
    positions = sorted(positions, key=lambda i: kinds.index(kind[i]))
    own = [decays[i] for i in positions]
    blocks = split_into_blocks([decay.values for decay in own], first.usable)
    samples = np.array([decay.samples for decay in own])
    flight_values, flight_gradient, flight_information = _flights(own, names)
    return RecordBatch(
        positions=np.array(positions),
        group=np.array([kinds.index(kind[i]) for i in positions]),
        load=np.array([load for load, *_ in kinds]),
        step=np.array([step for _, step, _ in kinds]),
        samples=samples,
        channel_weights=first.usable * channel_rate_ratios(first),
        energy=_energy(blocks, samples),
        blocks=blocks,
        clock_design=_clock_design(first),
        expected_delays=np.array([[clock.delay for clock in decay.clocks] for decay in own]),
        delay_std=np.array([[clock.delay_std for clock in decay.clocks] for decay in own]),
        d_delay_d_parameter=np.array([[_delay_derivatives(clock, names) for clock in decay.clocks] for decay in own]),
        flight_values=flight_values,
        flight_gradient=flight_gradient,
        flight_information=flight_information,
    )


def _energy(blocks: Real, samples: Index) -> Real:
    """Return the sum of squares of each record by its blocks, shape (record, channel)."""
    squares, counts = np.einsum("bct,bct->bc", blocks, blocks), -(-samples // BLOCK_LENGTH)
    return np.asarray(np.add.reduceat(squares, np.cumsum(counts) - counts, axis=0))


def _flights(decays: Sequence[FreeDecay], names: Sequence[str]) -> tuple[Real, Real, Real]:
    """Return the flights' log-likelihoods in the parameters of a fit, which may share half-distances."""
    values, gradient = np.zeros((2, len(decays), len(names)))
    information = np.zeros((len(decays), len(names), len(names)))
    for i, flight in enumerate(decay.flight for decay in decays):
        if flight is not None:
            own = np.array(
                [[name in separate_track_names(fitted) for name in flight.names] for fitted in names], dtype=float
            )
            values[i] = own @ flight.at / np.maximum(own.sum(axis=1), 1)
            gradient[i], information[i] = own @ flight.gradient, own @ flight.information @ own.T
    return values, gradient, information


def _clock_design(decay: FreeDecay) -> Real:
    """Return 1 where a logger recorded a channel, shape (channel, logger)."""
    design = np.zeros((len(decay.values), len(decay.clocks)))
    for column, clock in enumerate(decay.clocks):
        design[list(clock.channels), column] = 1.0
    return design


def _delay_derivatives(clock: LoggerClock, names: Sequence[str]) -> list[float]:
    """Return the derivatives of a clock's expected delay by the parameters of a fit, which may share half-distances."""
    return [sum(clock.d_delay_d_parameter.get(own, 0.0) for own in separate_track_names(name)) for name in names]
