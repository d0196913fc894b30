"""When the release was on each logger's clock, and what the flight after it tells, against simulated truth."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.stats import chi2
from wireless import Wireless, wireless

from sprung.analysis.synchronisation import _as_taken, synchronise_at_release
from sprung.estimation import clear_of_splines
from sprung.preprocess import FlightLikelihood, FreeDecay, prepare
from sprung.vehicle import TABLE_1_CAR, Vehicle

Real = NDArray[np.float64]

MANY_RATES = (200.0, 400.0, 500.0, 512.0, 1000.0, 800.0, 600.0, 500.0)


def timed(simulated: Wireless, vehicle: Vehicle) -> list[tuple[FreeDecay, Real]]:
    """Time every drop by its release; beside each what its clocks truly showed at one moment, s."""
    campaign, prepared = simulated.campaign, prepare(simulated.campaign)
    names = [recording.name for recording in campaign.recordings]
    found = []
    for decay in prepared.decays:
        i = names.index(decay.file)
        told = synchronise_at_release(
            decay, prepared.observations[i], campaign.drops[i], vehicle, campaign.load(decay.load), campaign.sensors
        )
        found.append((told, np.array([simulated.ahead[i][clock.channels[0]] for clock in told.clocks])))
    return found


def missed(decay: FreeDecay, truth: Real, vehicle: Vehicle, sure: float) -> tuple[Real, Real]:
    """Return the errors of the well determined clocks, without what is common to all, and their uncertainties; s."""
    off = np.array([clock.expected_delay(vehicle.parameters) - clock.offset for clock in decay.clocks]) + truth
    std = np.array([clock.delay_std for clock in decay.clocks])
    well = std < sure
    return off[well] - np.average(off[well], weights=std[well] ** -2), std[well]


@pytest.mark.parametrize(
    "rates", [pytest.param((500.0,) * 8, marks=pytest.mark.long), MANY_RATES], ids=["one rate", "many rates"]
)
@pytest.mark.slow
def test_the_release_tells_the_clocks_as_well_as_it_says(rates: tuple[float, ...]) -> None:
    off: list[float] = []
    std: list[float] = []
    for seed in (1, 2):
        for decay, truth in timed(wireless(rates=rates, drift=0.0, seed=seed), TABLE_1_CAR):
            for one, other in zip((off, std), missed(decay, truth, TABLE_1_CAR, 1e-4), strict=True):
                one.extend(other.tolist())
    assert len(off) > 100  # of 160: wheels that do not fall hardly move
    scaled = np.array(off) / np.array(std)
    # A Gaussian's 99.99 % of as many; crystals do not drift here, and what is allowed for that makes them less.
    assert np.abs(scaled).max() < 4.8
    assert 0.4 < np.sqrt(np.mean(scaled**2)) < 1.15


def test_blocks_twist_a_vehicle_as_high_as_they_are() -> None:
    # With unlike half-distances a side on blocks twists the springs, and the more the higher the blocks are.
    vehicle = Vehicle.from_parameters({**TABLE_1_CAR.parameters, "t_r": 0.70}, name="narrow behind")
    for decay, truth in timed(wireless(vehicle, drift=0.0, noise=1e-4, loads=()), vehicle):
        off, _ = missed(decay, truth, vehicle, 1e-5)
        assert len(off) >= 4
        assert np.abs(off).max() < 1e-5, decay.name


def flights_of(seed: int) -> list[FlightLikelihood]:
    told = timed(wireless(drift=0.0, seed=seed), TABLE_1_CAR)
    return [decay.flight for decay, _ in told if decay.flight is not None]


@pytest.mark.slow
def test_at_the_truth_a_flight_leaves_noise_and_no_slope() -> None:
    flights = flights_of(4)
    squares = freedom = 0.0
    for flight in flights:
        scaled = flight.information * np.outer(flight.at, flight.at)
        eigenvalues, vectors = np.linalg.eigh(scaled)
        seen = eigenvalues > 1e-6 * eigenvalues[-1]
        squares += float(np.sum((vectors.T @ (flight.gradient * flight.at))[seen] ** 2 / eigenvalues[seen]))
        freedom += int(seen.sum())
    assert freedom > 60
    assert chi2.cdf(squares, freedom) < 0.9999
    assert chi2.cdf(squares, freedom) > 1e-4
    left, samples = (sum(getattr(one, name) for one in flights) for name in ("chi_square", "samples"))
    assert left / samples == pytest.approx(1.0, abs=0.12)  # noise is known from 0.3 s of rest


@pytest.mark.long
def test_what_is_missed_near_by_is_what_another_vehicle_misses() -> None:
    stiffer = {**TABLE_1_CAR.parameters, "k_sf": 17000 * 1.01, "c_sr": 1500 * 0.99}
    vehicle = Vehicle.from_parameters(stiffer, name="stiffer")
    simulated = wireless(drift=0.0, seed=6)
    here, there = (timed(simulated, one)[0][0].flight for one in (TABLE_1_CAR, vehicle))
    assert here is not None
    assert there is not None
    # Clocks are free in both: each is set anew.
    assert here.chi_square_at(there.at) == pytest.approx(there.chi_square, rel=0.03)
    assert there.chi_square > 1.5 * here.chi_square


@pytest.mark.parametrize("rate", [200.0, 400.0, 512.0, 600.0, 800.0])
def test_samples_are_given_back_by_what_was_made_of_them(rate: float) -> None:
    random = np.random.default_rng(1)
    taken = np.arange(0, 1, 1 / rate) + random.uniform(0, 1 / rate)
    samples = random.standard_normal((2, taken.size)) + 100 * (taken > 0.52)  # the release is a jump
    times = np.arange(0.4, 0.6, 1e-3)
    made = CubicSpline(taken, samples, axis=1)(times)
    window = (times > 0.51) & (times < 0.55)
    again, when = _as_taken(made[:, window], times[window], taken, 1 / rate)
    within = np.isin(taken, when)
    assert within.sum() > 5
    np.testing.assert_allclose(again, samples[:, within], atol=1e-5)


def test_slower_loggers_begin_later_and_are_late_by_it() -> None:
    decay = prepare(wireless(rates=MANY_RATES, seed=7).campaign).decays[0]
    later = clear_of_splines(decay)
    before = np.concatenate([decay.earlier, decay.values], axis=1)
    after = np.concatenate([later.earlier, later.values], axis=1)
    assert later.start == decay.start
    for clock, moved in zip(decay.clocks, later.clocks, strict=True):
        skipped = round((moved.delay - clock.delay) * decay.rate)
        # Four samples of its own on each side make a new one.
        assert skipped == (round(4 / clock.rate_ratio) if clock.rate_ratio < 1 else 0)
        assert moved.offset - clock.offset == pytest.approx(skipped / decay.rate)
        own = list(clock.channels)
        np.testing.assert_array_equal(after[own], before[own, skipped : skipped + after.shape[1]])


def test_without_slower_loggers_nothing_moves() -> None:
    decay = prepare(wireless(seed=7).campaign).decays[0]
    np.testing.assert_array_equal(clear_of_splines(decay).values, decay.values)
    assert all(clock.rate_ratio == 1 for clock in decay.clocks)
