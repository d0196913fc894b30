"""What sensors of each quantity read of a motion, and how it depends on the parameters."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from sprung.errors import InputError
from sprung.simulation import default_sensors, drop_from_blocks
from sprung.units import STANDARD_GRAVITY, Quantity, si_factor
from sprung.vehicle import TABLE_1_CAR, Motion, Readout, Sensor

CAR = TABLE_1_CAR
NAMES, VALUES = tuple(CAR.parameters), np.array(list(CAR.parameters.values()))

TRAVEL = Sensor(channel="travel", on="body", relative_to="rl", quantity="displacement")
PITCH = Sensor(channel="pitch", on="body", quantity="angular-rate", axis="pitch")
ROLL = Sensor(channel="roll", on="body", quantity="angular-rate", axis="roll")
FORCE = Sensor(channel="force", on="pad fr", quantity="force", unit="N")


@pytest.fixture(scope="module")
def motion() -> Motion:
    return drop_from_blocks(CAR, wheels=("fl",), height=0.03).motion(1e-3, 400)


def read(sensor: Sensor, motion: Motion) -> NDArray[np.float64]:
    return np.asarray(Readout.of([sensor], NAMES).read(VALUES, motion)[0])


@pytest.mark.parametrize("sensor", default_sensors(CAR), ids=lambda sensor: sensor.channel)
def test_each_quantity_is_the_derivative_of_the_one_before(sensor: Sensor, motion: Motion) -> None:
    quantities: tuple[Quantity, ...] = ("displacement", "velocity", "acceleration")
    x, v, a = (read(replace(sensor, quantity=quantity), motion) for quantity in quantities)
    free = slice(100, -1)
    assert np.gradient(x, 1e-3)[free] == pytest.approx(v[free], abs=2e-3 * np.abs(v).max())
    assert np.gradient(v, 1e-3)[free] == pytest.approx(a[free], abs=2e-2 * np.abs(a).max())


def test_suspension_travel_is_body_over_the_wheel_less_wheel(motion: Motion) -> None:
    z_s, theta, phi, *_ = motion.displacement
    over = z_s + CAR.b * theta + CAR.t_r * phi
    assert read(TRAVEL, motion) == pytest.approx(over - motion.displacement[5])
    placed = replace(TRAVEL, position=(-1.0, 0.3, 0.5))
    assert read(placed, motion) == pytest.approx(z_s + (1.0 - CAR.a) * theta + 0.3 * phi - motion.displacement[5])


def test_gyroscopes_read_rates_of_the_body(motion: Motion) -> None:
    assert read(PITCH, motion) == pytest.approx(motion.velocity[1])
    assert read(ROLL, motion) == pytest.approx(motion.velocity[2])


def test_a_pad_is_pressed_by_its_tyre(motion: Motion) -> None:
    """The change of the force from that at rest: pressing up on the tyre is positive, and a wheel that goes up is lighter."""
    assert read(FORCE, motion) == pytest.approx(-CAR.k_tf * motion.displacement[4])


def test_derivatives_are_those_of_the_readings() -> None:
    sensors = [
        TRAVEL,
        replace(TRAVEL, channel="placed", position=(-1.0, 0.3, 0.5)),
        PITCH,
        FORCE,
        *default_sensors(CAR),
    ]
    readout = Readout.with_unknowns(sensors, NAMES)
    values = np.append(VALUES, 0.01 * np.arange(1, 1 + len(readout.names) - len(NAMES)))
    assert readout.orders == (0, 1, 2)
    slopes = readout.slopes(values)
    for i in range(len(values)):
        step = 1e-4 * max(abs(values[i]), 1.0) * np.eye(len(values))[i]
        change = (readout.at(values + step) - readout.at(values - step)) / (2 * step[i])
        assert slopes[:, i] == pytest.approx(change, rel=1e-6, abs=1e-8)


def test_a_tilted_sensor_reads_gravity_along_the_body(motion: Motion) -> None:
    """Its direction is at the sum of its angle to the body and the body's to the vertical, of whose cosine it reads g."""
    sensor = replace(default_sensors(CAR)[0], gain_std=0.0, position_std=0.0)
    readout = Readout.with_unknowns([sensor], NAMES)
    assert [name.split(" ")[0] for name in readout.names[len(NAMES) :]] == ["gain", "tilt_x", "tilt_y"]
    upright = readout.read([*VALUES, 0.0, 0.0, 0.0], motion)[0]
    assert upright == pytest.approx(read(sensor, motion), rel=1e-12)
    # Nose down and left side up are positive.
    for tilts, angles in (((0.02, 0.0), motion.displacement[1]), ((0.0, -0.03), -motion.displacement[2])):
        leaning = sum(tilts)
        # Less what each of the two angles takes from gravity by itself: the gain contains the one, the other is no linear term.
        both = np.cos(leaning + angles) - np.cos(leaning) - np.cos(angles) + 1
        change = readout.read([*VALUES, 0.0, *tilts], motion)[0] - upright
        # Of the fourth order in angles of 0.03.
        assert change == pytest.approx(STANDARD_GRAVITY * both, rel=1e-3, abs=1e-8)


def test_what_does_not_go_together_is_refused() -> None:
    wrong: tuple[tuple[dict[str, object], str], ...] = (
        ({"on": "body", "quantity": "angular-rate"}, "axis"),
        ({"on": "fl", "quantity": "angular-rate", "axis": "roll"}, "body"),
        ({"on": "body", "position": (0, 0, 0), "axis": "roll"}, "angular-rate"),
        ({"on": "fl", "quantity": "force"}, "pad"),
        ({"on": "pad fl", "quantity": "acceleration"}, "pad"),
        ({"on": "fl", "relative_to": "fr", "quantity": "displacement"}, 'on = "body"'),
        ({"on": "body", "relative_to": "fr"}, 'quantity = "displacement"'),
        ({"on": "body", "relative_to": "nowhere", "quantity": "displacement"}, "fl"),
    )
    for keys, said in wrong:
        with pytest.raises(InputError, match=said):
            Sensor(channel="c", **keys)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("text", "quantity", "factor"),
    [
        ("mm", "displacement", 1e-3),
        ("µm", "displacement", 1e-6),
        ("km/h", "velocity", 1 / 3.6),
        ("°/s", "angular-rate", np.pi / 180),
        ("[deg/s]", "angular-rate", np.pi / 180),
        ("kN", "force", 1e3),
    ],
)
def test_units_of_every_quantity(text: str, quantity: Quantity, factor: float) -> None:
    assert si_factor(text, quantity) == pytest.approx(factor)
    with pytest.raises(ValueError, match=f"not a unit of {quantity.replace('-', ' ')}"):
        si_factor("m/s^2", quantity)
