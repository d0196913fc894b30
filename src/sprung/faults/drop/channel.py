"""A drop of which one channel is wrong."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.faults.channel import channel_hypotheses
from sprung.faults.channel.hypothesis import ChannelHypothesis
from sprung.faults.channel_prediction import ChannelPrediction
from sprung.faults.correction import mask_channel
from sprung.faults.drop.deletion import DropDeletion
from sprung.faults.hypothesis import Hypothesis
from sprung.faults.residual_table import ResidualTable
from sprung.preprocess import FreeDecay

Real = NDArray[np.float64]


def channel_of_drop(deletion: DropDeletion) -> Iterator[Hypothesis]:
    """Leave each channel out of the drop, where the others then agree with the vehicle, and explain it alone."""
    candidate, noise = deletion.candidate, deletion.base.noise
    channels = np.flatnonzero(deletion.counts).tolist()
    masked = [without_channel(deletion.decay, channel) for channel in channels]
    states, residuals = candidate.fit.states_of(masked), candidate.fit.residual_sums_of(masked)
    for channel, residual, state in zip(channels, residuals, states, strict=True):
        counts = deletion.counts.copy()
        counts[channel] = 0
        table = deletion.table(residual, counts)
        if table.is_explained(noise):
            prediction = ChannelPrediction(candidate, channel, [deletion.decay], state[None])
            for hypothesis in channel_hypotheses(prediction, float(noise.level[channel])):
                yield _left_out(deletion, prediction, table, hypothesis)


def without_channel(decay: FreeDecay, channel: int) -> FreeDecay:
    """Return a decay with one channel left out."""
    values = decay.values.copy()
    values[channel] = np.nan
    return replace(decay, values=values)


def _left_out(
    deletion: DropDeletion, prediction: ChannelPrediction, table: ResidualTable, hypothesis: ChannelHypothesis
) -> Hypothesis:
    channel, fault = prediction.channel, hypothesis.fault(hypothesis.numbers, ())
    where, what = f"{deletion.name}: {fault.where}", f"{fault.what}; it is left out of this drop"
    counts = deletion.counts[[channel]][None]
    return Hypothesis(
        replace(fault, where=where, what=what),
        "left out",
        mask_channel(channel, deletion.name),
        table.with_part([deletion.drop], [channel], hypothesis.residual[:, None], counts),
        deletion.candidate,
        hypothesis.free + len(hypothesis.numbers),
        is_specific=hypothesis.code != "unlike-others",
    )
