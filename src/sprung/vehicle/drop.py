"""The drop from blocks: exact, because between two changes of tyre contact the vehicle is linear.

Before the release the vehicle rests with blocks under some wheels; at the release the blocks vanish. A tyre pushes and
never pulls, so each of the sixteen patterns of wheels on and off the ground has its own linear equations of motion with
a constant force, whose solution is a matrix exponential. The instants at which the pattern changes are roots of that
solution and are solved for, not stepped over. Nothing depends on a sampling rate.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from sprung.display import shown
from sprung.errors import Problems, SprungError, did_you_mean
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle.ground import Ground
from sprung.vehicle.kinematics import WHEELS, Wheel
from sprung.vehicle.load import EMPTY, Load
from sprung.vehicle.response import Motion, affine_response
from sprung.vehicle.vehicle import Vehicle
from sprung.vehicle.zero_crossing import find_first_zero

Array = NDArray[np.float64]

_WINDOW = 256
_MOST_EVENTS = 10_000

Phase = Literal["contact", "relaxing", "air"]
"""On the ground; still compressed but, held back by tyre damping, without force; clear of the ground."""

_CHANGES: dict[Phase, tuple[tuple[Literal["force", "compression"], float, Phase], ...]] = {
    "contact": (("force", 1.0, "relaxing"),),
    "relaxing": (("compression", 1.0, "air"), ("force", -1.0, "contact")),
    "air": (("compression", -1.0, "contact"),),
}
"""How each phase ends: this, times the sign, is positive during it and falls to zero; the phase that follows."""


class ContactEvent(NamedTuple):
    """A wheel leaves the ground or comes back to it."""

    time: float
    """s after the release."""
    wheel: Wheel
    """Which one."""
    kind: Literal["lift-off", "landing"]
    """What it does."""


class LinearSegment(NamedTuple):
    """One linear piece of the motion: Ẏ = generator Y with Y = {X, Ẋ, 1}."""

    start: float
    """s after the release."""
    state: Array
    """Y at the start, SI, shape (2n + 1,) with n coordinates."""
    generator: Array
    """SI, shape (2n + 1, 2n + 1); the last column holds the constant force."""

    def at(self, time: float) -> Array:
        """Give Y at a time, s after the release; SI, shape (2n + 1,)."""
        return expm(self.generator * (time - self.start)) @ self.state


@shown
@dataclass(frozen=True, eq=False)
class DropMotion:
    """The motion after one release, exact at any time.

    Attributes
    ----------
    pieces
        The linear pieces, one after the other.
    events
        Every lift-off and landing, in order; wheels with blocks higher than their tyres were compressed lift off at 0.
    until
        Up to when the motion is known, s after the release; infinite once no wheel can lift off any more.
    """

    pieces: tuple[LinearSegment, ...]
    events: tuple[ContactEvent, ...]
    until: float

    @property
    def decay_start(self) -> float:
        """Time of the last event, s after the release: the free vibration of eq. (3) holds from here on."""
        return self.events[-1].time if self.events else 0.0

    @property
    def settled(self) -> bool:
        """Whether it is certain that no wheel leaves the ground any more after `decay_start`."""
        return math.isinf(self.until)

    def state(self, time: float) -> Array:
        """Give the state {X, Ẋ}, shape (2n,), from static equilibrium on flat ground.

        Parameters
        ----------
        time
            s after the release, from 0 to `until`.

        Raises
        ------
        ValueError
            If the time is outside.
        """
        self._check(time, time)
        piece = self.pieces[int(np.searchsorted([piece.start for piece in self.pieces], time, side="right")) - 1]
        return piece.at(time)[:-1]

    def motion(self, step: float, samples: int, start: float = 0.0) -> Motion:
        """Sample the motion; exact at every sample.

        Parameters
        ----------
        step
            Sampling interval, s.
        samples
            How many samples.
        start
            Time of the first one, s after the release.

        Returns
        -------
        Motion
            Displacement from static equilibrium on flat ground, velocity and acceleration, each (coordinate, samples).

        Raises
        ------
        ValueError
            If a sample is before the release or after `until`.
        """
        times = start + step * np.arange(samples)
        if samples:
            self._check(times[0], times[-1])
        owner = np.searchsorted([piece.start for piece in self.pieces], times, side="right") - 1
        size = len(self.pieces[0].state)
        n = size // 2
        sampled = np.empty((3 * n, samples))
        for i, piece in enumerate(self.pieces):
            mine = np.flatnonzero(owner == i)
            if mine.size:
                states = affine_response(piece.generator, np.zeros(size), piece.at(times[mine[0]]), step, mine.size)
                sampled[:, mine] = np.vstack([states[:-1], (piece.generator @ states)[n:-1]])
        return Motion(sampled[:n], sampled[n : 2 * n], sampled[2 * n :])

    def _check(self, first: float, last: float) -> None:
        if not 0.0 <= first <= last <= self.until:
            raise ValueError(
                f"the motion is known from 0 to {self.until:g} s after the release, but {first:g} to {last:g} s were "
                "asked for; give a longer duration"
            )


def drop_from_blocks(
    vehicle: Vehicle,
    load: Load = EMPTY,
    wheels: tuple[Wheel, ...] = WHEELS,
    height: float = 0.05,
    *,
    duration: float = 60.0,
    gravity: float = STANDARD_GRAVITY,
) -> DropMotion:
    """Release a vehicle that rests on blocks, and follow it exactly through every lift-off and landing.

    Parameters
    ----------
    vehicle, load
        What is dropped.
    wheels
        The wheels with blocks under them; the others stand on the ground.
    height
        Of the blocks, m.
    duration
        How long to follow the motion at most, s; once the energy left cannot lift any wheel, it is known for ever.
    gravity
        m/s².

    Returns
    -------
    Fall

    Raises
    ------
    InputError
        If the vehicle does not stand on its four wheels, or there are no such blocks; all faults at once.
    SprungError
        If its wheels hop on and on, as those of a vehicle without damping do.

    Notes
    -----
    A tyre's force is max(0, W - k_t z_u - c_t ż_u) while it is compressed, with W the static wheel load, and zero while
    it is not. Without tyre damping that is continuous; with it the force jumps at a landing, to c_t times the speed.

    Examples
    --------
    >>> from sprung.vehicle import TABLE_1_CAR
    >>> fall = drop_from_blocks(TABLE_1_CAR, wheels=("fl", "fr"), height=0.05)
    >>> [event.kind for event in fall.events]
    ['lift-off', 'lift-off', 'landing', 'landing']
    """
    ground = Ground.under(vehicle, load, gravity)
    at_rest = _resting(ground, vehicle, load, wheels, height)
    Y = np.concatenate([at_rest, np.zeros_like(at_rest), [1.0]])
    phases: list[Phase] = ["contact" if value >= 0 else "air" for value in ground.compression @ Y]
    events = [
        ContactEvent(0.0, wheel, "lift-off") for wheel, phase in zip(WHEELS, phases, strict=True) if phase == "air"
    ]
    # A tenth of the fastest time constant: within it a response has one extremum at most.
    step = 0.1 / float(np.abs(np.linalg.eigvals(ground.matrices.state)).max())

    pieces: list[LinearSegment] = []
    time = 0.0
    while len(pieces) < _MOST_EVENTS:
        contact = np.array([phase == "contact" for phase in phases])
        pieces.append(LinearSegment(time, Y, ground.generator(contact)))
        change = _next_change(ground, pieces[-1], phases, step, duration)
        if isinstance(change, float):
            return DropMotion(tuple(pieces), tuple(events), change)
        time, Y, station, phases[station] = change
        if contact[station] != (phases[station] == "contact"):
            events.append(ContactEvent(time, WHEELS[station], "lift-off" if contact[station] else "landing"))
    raise SprungError(
        f"the drop of {vehicle.name} was given up after {len(events)} lift-offs and landings within {time:g} s of the "
        "release; is the vehicle damped?"
    )


def _next_change(
    ground: Ground, piece: LinearSegment, phases: list[Phase], step: float, duration: float
) -> tuple[float, Array, int, Phase] | float:
    """Find the next change of a wheel's phase: time, Y, wheel and new phase; without one, until when that is known."""
    rows = {"force": ground.force, "compression": ground.compression}
    changes = [
        (station, sign * rows[what][station], after if ground.damping[station] or after != "relaxing" else "air")
        for station, phase in enumerate(phases)
        for what, sign, after in _CHANGES[phase]
    ]
    watch = np.array([row for _, row, _ in changes])
    time, Y = piece.start, piece.state
    while time < duration:
        if all(phase == "contact" for phase in phases) and ground.keeps_contact(Y):
            return math.inf
        fall = find_first_zero(watch, piece.generator, Y, step, _WINDOW)
        if isinstance(fall, tuple):
            station, _, after = changes[fall[1]]
            time += fall[0]
            return (time, piece.at(time), station, after) if time < duration else duration
        time, Y = time + _WINDOW * step, fall
    return duration


def _resting(ground: Ground, vehicle: Vehicle, load: Load, wheels: tuple[Wheel, ...], height: float) -> Array:
    """Give X on the blocks, shape (coordinate,), or say why there is none."""
    problems = Problems()
    where = f"drop of {vehicle.name}, load '{load.name}'"
    if not wheels:
        problems.add(where, "no wheels", "at least one wheel on a block", "Name the wheels that are dropped.")
    for wheel in wheels:
        if wheel not in WHEELS:
            problems.add(where, f"wheel '{wheel}'", "a wheel station", did_you_mean(wheel, WHEELS))
    if not (math.isfinite(height) and height > 0):
        problems.add(where, f"blocks of {height} m", "a positive height", "Give the height of the blocks in m.")
    if np.any(ground.wheel_loads <= 0):
        each = ", ".join(f"{wheel} {weight:.0f} N" for wheel, weight in zip(WHEELS, ground.wheel_loads, strict=True))
        problems.add(where, f"static wheel loads {each}", "four wheels pressed to the ground", "Move the load inwards.")
    problems.raise_if_any()
    return ground.rest(np.array([height if wheel in wheels else 0.0 for wheel in WHEELS]))
