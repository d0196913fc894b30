"""Names of modes from their shapes, one by one: what they say must be what moves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings

from sprung.vehicle import SCHOOL_BUS, Vehicle
from sprung.vibration import Mode, compute_modes, name_modes, paper_name
from strategies import vehicles

# Coordinates: z, pitch, roll, wheels A front left, B front right, C rear left, D rear right.
PURE = {
    "body bounce": [1, 0, 0, 0, 0, 0, 0],
    "body pitch": [0, 1, 0, 0, 0, 0, 0],
    "body roll": [0, 0, 1, 0, 0, 0, 0],
    "front axle hop": [0, 0, 0, 1, 1, 0, 0],
    "rear axle hop": [0, 0, 0, 0, 0, 1, 1],
    "front axle tramp": [0, 0, 0, 1, -1, 0, 0],
    "rear axle tramp": [0, 0, 0, 0, 0, 1, -1],
    "wheel bounce": [0, 0, 0, 1, 1, 1, 1],
    "wheel pitch": [0, 0, 0, -1, -1, 1, 1],
    "wheel roll": [0, 0, 0, 1, -1, 1, -1],
    "wheel warp": [0, 0, 0, 1, -1, -1, 1],
}
BODY = ("body bounce", "body pitch", "body roll")
AXLES = ("front axle hop", "rear axle hop", "front axle tramp", "rear axle tramp")
ALL_FOUR = ("wheel bounce", "wheel pitch", "wheel roll", "wheel warp")

LEFT_RIGHT = np.array([1, 1, -1, 0, 0, 0, 0]), [0, 1, 2, 4, 3, 6, 5]
FRONT_REAR = np.array([1, -1, 1, 0, 0, 0, 0]), [0, 1, 2, 5, 6, 3, 4]


def names_of(shapes: Sequence[Sequence[complex]], *, poles: Sequence[complex] = ()) -> list[str | None]:
    """Name shapes that are given in the order of frequency."""
    poles = poles or [complex(-1, 10 * (i + 1)) for i in range(len(shapes))]
    modes = [Mode(pole, np.array(shape, dtype=complex)) for pole, shape in zip(poles, shapes, strict=True)]
    return [mode.name for mode in name_modes(modes)]


def mirrored(shape: np.ndarray, mirror: tuple[np.ndarray, list[int]]) -> np.ndarray:
    """Look at a shape in a mirror: coordinates change sign, wheels change places."""
    sign, order = mirror
    return np.asarray(np.concatenate([sign[:3], np.ones(4)]) * shape[order])


@pytest.mark.parametrize("wheels", [AXLES, ALL_FOUR, (*AXLES[:2], *ALL_FOUR[2:]), (*ALL_FOUR[:2], *AXLES[2:])])
@pytest.mark.parametrize("factor", [1, -1, 1j, 0.01 * np.exp(2j)])
def test_pure_shapes_are_called_what_they_are(wheels: tuple[str, ...], factor: complex) -> None:
    # Hop and tramp are decided apart: a rigid axle can couple its wheels to the other axle in one and not in the other.
    names = [*BODY, *wheels]
    assert names_of([[factor * part for part in PURE[name]] for name in names]) == names


@pytest.mark.parametrize("name", PURE)
def test_one_mode_alone_is_called_what_it_is(name: str) -> None:
    assert names_of([PURE[name]]) == [name]


@pytest.mark.parametrize(
    ("other_axle", "expected"),
    # Halfway between one axle alone (0) and all four wheels alike (1) in angle: tan 22.5 degrees = 0.414.
    [(0.0, AXLES[:2]), (0.40, AXLES[:2]), (0.43, ALL_FOUR[:2]), (1.0, ALL_FOUR[:2])],
)
def test_a_mixture_is_called_after_what_it_is_closer_to(other_axle: float, expected: tuple[str, str]) -> None:
    front = [0, 0, 0, 1, 1, other_axle, other_axle]
    rear = [0, 0, 0, -other_axle, -other_axle, 1, 1]
    assert names_of([front, rear]) == list(expected)


def test_rigid_axles_hop_and_tramp() -> None:
    # Measured at its wheels a rigid axle shows heave (both alike) and roll about its middle (opposite), with some of the body.
    front = [[-0.05, 0.02, 0, 1, 1, 0.03, 0.03], [0, 0, -0.1, 1, -1, 0.02, -0.02]]
    rear = [[-0.06, -0.03, 0, 0.05, 0.05, 1, 1], [0, 0, -0.1, 0.04, -0.04, 1, -1]]
    assert names_of([*front, *rear]) == ["front axle hop", "front axle tramp", "rear axle hop", "rear axle tramp"]


@pytest.mark.parametrize(
    "shape",
    [
        pytest.param([0, 0, 0, 1, 0, 0, 0], id="one wheel alone: half hop, half tramp"),
        pytest.param([0, 0, 0, 1, 1j, 0, 0], id="a quarter of a period apart: half hop, half tramp"),
        pytest.param([0.5, 0.37, 0.7, 1, 0.9, -0.8, 0.3], id="a little of everything"),
    ],
)
def test_what_is_like_no_template_gets_no_name(shape: list[complex]) -> None:
    assert names_of([shape]) == [None]


def test_a_small_lag_between_left_and_right_leaves_the_name() -> None:
    # cos²(half the angle) of the modal assurance criterion: 30 degrees apart leave 0.93.
    lag = np.exp(1j * np.radians(30))
    assert names_of([[0, 0, 0, 1, lag, 0, 0], [0, 0, 0, 0, 0, 1, -lag]]) == ["front axle hop", "rear axle tramp"]


def test_two_real_poles_of_one_motion_share_its_name() -> None:
    shapes = [PURE["body bounce"], PURE["body roll"], PURE["body roll"]]
    assert names_of(shapes, poles=[complex(-1, 100), -5, -20]) == ["body roll", "body roll", "body bounce"]


@given(vehicles)
@settings(max_examples=30, deadline=None)
def test_left_and_right_exchanged_changes_no_name(vehicle: Vehicle) -> None:
    modes = compute_modes(vehicle.matrices())
    seen = name_modes([Mode(mode.pole, mirrored(mode.shape, LEFT_RIGHT)) for mode in modes], *levers(vehicle))
    assert [mode.name for mode in seen] == [mode.name for mode in modes]


@given(vehicles)
@settings(max_examples=30, deadline=None)
def test_front_and_rear_exchanged_exchanges_the_axles(vehicle: Vehicle) -> None:
    modes = compute_modes(vehicle.matrices())
    seen = name_modes([Mode(mode.pole, mirrored(mode.shape, FRONT_REAR)) for mode in modes], *levers(vehicle))
    exchanged = {"front": "rear", "rear": "front"}
    expected = [" ".join(exchanged.get(word, word) for word in (mode.name or "-").split()) for mode in modes]
    assert [mode.name or "-" for mode in seen] == expected


def levers(vehicle: Vehicle) -> tuple[float, float]:
    """Return the lengths by which `compute_modes` compares angles with displacements."""
    return float(np.sqrt(vehicle.I_yy / vehicle.m_s)), float(np.sqrt(vehicle.I_xx / vehicle.m_s))


def test_the_paper_calls_the_same_shapes_otherwise() -> None:
    # Table 3 lists bounce, pitch, roll and articulation at 12.42, 12.44, 13.86 and 13.97 Hz; in the model of Tables 4 and 5
    # these are the rear axle in phase and in opposition, and the front axle in phase and in opposition.
    wheels = [mode for mode in compute_modes(SCHOOL_BUS.matrices()) if mode.frequency > 5]
    assert [mode.name for mode in wheels] == ["rear axle hop", "rear axle tramp", "front axle hop", "front axle tramp"]
    for mode, opposition in zip(wheels, (False, True, False, True), strict=True):
        axle = mode.shape[3:5] if "front" in str(mode.name) else mode.shape[5:7]
        assert (axle[0] / axle[1]).real == pytest.approx(-1 if opposition else 1)
    expected = ["wheel bounce", "wheel pitch", "wheel roll", "wheel articulation"]
    assert [paper_name(mode.name) for mode in wheels] == expected
    assert paper_name("engine bounce") is None
    assert paper_name(None) is None
