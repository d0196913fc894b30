"""Drops with nonlinear forces: where these are none, the exact drop; and against equations written out elsewhere."""

from __future__ import annotations

import numpy as np
import pytest
from hysteresis import measured

import sprung
from sprung.simulation import BlockSupport, drop_from_blocks, simulate_nonlinear_drops
from sprung.vehicle import EMPTY, SCHOOL_BUS, TABLE_1_CAR, Load, Vehicle, Wheel, parse_record

BALLAST = parse_record(Load, {"name": "ballast", "items": [{"mass": 150.0, "position": (-1.0, 0.3, 0.5)}]})


UNEVEN = Vehicle.from_parameters(
    TABLE_1_CAR.parameters
    | {"y_s": 0.02, "d_ksf": 500.0, "d_ksr": 0.0, "d_csf": 0.0, "d_csr": -100.0, "d_ktf": 9e3, "d_ktr": -12e3},
    name="uneven",
)
"""Tyres of unlike rates: in the air none of them pulls."""


TALL = TABLE_1_CAR.with_values(cg_height=0.75, wheel_height=0.3)
"""The weight of a load turns it: from where it stood empty."""


@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, SCHOOL_BUS, UNEVEN, TALL])
@pytest.mark.slow
def test_hardly_any_force_makes_hardly_any_difference(vehicle: Vehicle) -> None:
    """Through lift-off, flight and landing it is the drop that is known exactly; a wheel that hangs among them."""
    almost = vehicle.with_values(r_f=1 + 1e-9, r_r=1 + 1e-9)
    cases: list[tuple[Load, tuple[Wheel, ...], float]] = [
        (EMPTY, ("fl", "fr"), 0.05), (BALLAST, ("fl", "rl"), 0.08), (EMPTY, ("fl",), 0.1),
    ]  # fmt: skip
    motions = simulate_nonlinear_drops(almost, [BlockSupport(*case) for case in cases], 0.002, 600, 0.001)
    for (load, wheels, height), motion in zip(cases, motions, strict=True):
        exact = drop_from_blocks(vehicle, load, wheels, height, duration=1.3).motion(0.002, 600, 0.001)
        for name in ("displacement", "velocity"):
            found, known = getattr(motion, name), getattr(exact, name)
            assert np.abs(found - known).max() < 2e-4 * np.abs(known).max(), name


@pytest.mark.slow
def test_friction_and_rebound_against_equations_written_out_elsewhere() -> None:
    car = Vehicle.from_parameters(
        TABLE_1_CAR.parameters | {"F_f": 100.0, "F_r": 130.0, "s_f": 2e5, "s_r": 3e5, "r_f": 2.0, "r_r": 1.5}
    )
    drops = [{"wheels": ["fl", "fr"], "height": 0.06}, {"wheels": ["fr", "rr"], "height": 0.06}]
    other = measured(car, drops=drops, noise=0.0, duration=1.5)
    ours = sprung.simulate(car, drops=drops, noise=0.0, rate=500, duration=1.5, rest=0.4)
    for one, two in zip(ours.recordings, other.recordings, strict=True):
        count = min(one.values.shape[1], two.values.shape[1])
        apart = (one.values - two.values)[:, :count]
        moving = np.abs(two.values - two.values[:, :1]).max(axis=1)
        # At an instant when friction turns round one sample may fall on either side of it.
        assert np.all(np.sqrt(np.mean(apart**2, axis=1)) < 2e-3 * moving)
