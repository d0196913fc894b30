"""Several loggers on one clock: by the first motion that each shows, or as it is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from wireless import wireless

from sprung.preprocess import align_loggers

SIMULATED = wireless(seed=8, drift=0.0)
RECORDING, TRUTH = SIMULATED.campaign.recordings[0], SIMULATED.ahead[0]
STEP = 1 / 500


def test_clocks_that_are_known_are_taken_as_they_are() -> None:
    known = [
        replace(clock, offset=float(TRUTH[i]), delay_std=1e-5 * (1 + i)) for i, clock in enumerate(RECORDING.clocks)
    ]
    together = align_loggers(replace(RECORDING, clocks=tuple(known)))
    off = np.array([clock.offset for clock in together.clocks]) - TRUTH
    assert np.ptp(off) <= STEP * (1 + 1e-6)  # each within half a step of where it is known to be
    assert [clock.delay_std for clock in together.clocks] == [clock.delay_std for clock in known]
    # A bounce: all four wheels, channels 4 to 7, are released in one sample, or two that follow each other.
    moving = [int(np.argmax(np.abs(wheel - wheel[:100].mean()) > 10)) for wheel in together.values[4:]]
    assert max(moving) - min(moving) <= 1


def test_without_that_the_first_motion_tells_to_some_milliseconds() -> None:
    off = np.array([clock.offset for clock in align_loggers(RECORDING).clocks]) - TRUTH
    assert STEP < np.ptp(off) < 0.02
