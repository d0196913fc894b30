"""An AC-coupled channel whose high-pass has another corner frequency than is stated."""

from __future__ import annotations

from collections.abc import Iterator

from sprung.errors import Fault
from sprung.faults.channel.hypothesis import ChannelHypothesis, Numbers, Real
from sprung.faults.channel_prediction import ChannelPrediction
from sprung.faults.correction import state_corners
from sprung.faults.high_pass import corner_fault, stated_corner
from sprung.preprocess import is_ac_coupled


def high_pass(prediction: ChannelPrediction) -> Iterator[ChannelHypothesis]:
    """Estimate the corner frequency, where the reading at rest admits a high-pass."""
    if not all(is_ac_coupled(decay)[prediction.channel] for decay in prediction.decays):
        return

    def estimated() -> tuple[Numbers, Real]:
        number = prediction.corner()
        return (number,), prediction.residual_of(prediction.through_high_pass(number))

    def fault(numbers: Numbers, stds: Numbers) -> Fault:
        return corner_fault([prediction.sensor], numbers, stds)

    yield ChannelHypothesis(
        "corner",
        fault,
        estimated,
        lambda numbers: state_corners({prediction.channel: stated_corner(numbers[0])}),
        (prediction.sensor.high_pass or 0.0,),
    )
