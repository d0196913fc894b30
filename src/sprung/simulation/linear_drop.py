"""The drop from blocks, exact: between two changes of tyre contact the vehicle is linear.

Before the release the vehicle rests with blocks under some wheels; at the release the blocks are removed. A tyre pushes and
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
from sprung.simulation.ground import Ground
from sprung.simulation.zero_crossing import find_first_zero
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import COORDINATES, EMPTY, Load, Motion, Vehicle, Wheel, affine_response

Array = NDArray[np.float64]

_WINDOW = 256
"""Grid intervals that are searched at once for the next change of contact."""

_MOST_SEGMENTS = 10_000

Phase = Literal["contact", "relaxing", "air"]
"""On the ground; still compressed but, held back by tyre damping, without force; clear of the ground."""

_CHANGES: dict[Phase, tuple[tuple[Literal["force", "compression"], float, Phase], ...]] = {
    "contact": (("force", 1.0, "relaxing"),),
    "relaxing": (("compression", 1.0, "air"), ("force", -1.0, "contact")),
    "air": (("compression", -1.0, "contact"),),
}
"""How each phase ends: the quantity that, times the sign, is positive during it and falls to zero; the phase that follows."""


class ContactEvent(NamedTuple):
    """A lift-off or a landing of a wheel."""

    time: float
    """s after the release."""
    wheel: Wheel
    """The wheel."""
    kind: Literal["lift-off", "landing"]
    """What it does."""


@shown
@dataclass(frozen=True, eq=False)
class DropMotion:
    """The motion after a release, exact at any time: linear segments Ẏ = generator Y with Y = {X, Ẋ, 1}.

    Attributes
    ----------
    starts
        Start of each segment, s after the release, shape (segment,).
    states
        Y at each start, SI, shape (segment, n + m + 1) with n coordinates, m with mass.
    generators
        SI, shape (segment, n + m + 1, n + m + 1); the last column of each holds the constant force.
    events
        Every lift-off and landing, in order; wheels on blocks higher than their tyres were compressed lift off at 0.
    until
        End of the time for which the motion is known, s after the release; infinite once no wheel can lift off any more.
    coordinates
        Number of coordinates, n.
    """

    starts: Array
    states: Array
    generators: Array
    events: tuple[ContactEvent, ...]
    until: float
    coordinates: int = len(COORDINATES)

    @property
    def decay_start(self) -> float:
        """Time of the last event, s after the release: the free vibration of eq. (3) holds from here on."""
        return self.events[-1].time if self.events else 0.0

    @property
    def is_settled(self) -> bool:
        """Whether no wheel can leave the ground any more after `decay_start`."""
        return math.isinf(self.until)

    def state(self, time: float) -> Array:
        """Return the state {X, Ẋ} from static equilibrium on flat ground, shape (n + m,).

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
        segment = int(np.searchsorted(self.starts, time, side="right")) - 1
        return self._at(segment, time)[:-1]

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
        segment_of = np.searchsorted(self.starts, times, side="right") - 1
        size = self.states.shape[1]
        n = self.coordinates
        sampled = np.empty((3 * n, samples))
        for segment, generator in enumerate(self.generators):
            inside = np.flatnonzero(segment_of == segment)
            if inside.size:
                first = self._at(segment, times[inside[0]])
                states = affine_response(generator, np.zeros(size), first, step, inside.size)
                rates = generator @ states
                sampled[:, inside] = np.vstack([states[:n], rates[:n], (generator @ rates)[:n]])
        return Motion(sampled[:n], sampled[n : 2 * n], sampled[2 * n :])

    def _at(self, segment: int, time: float) -> Array:
        """Return Y of one segment at a time, s after the release."""
        Y: Array = expm(self.generators[segment] * (time - self.starts[segment])) @ self.states[segment]
        return Y

    def _check(self, first: float, last: float) -> None:
        if not 0.0 <= first <= last <= self.until:
            raise ValueError(
                f"the motion is known from 0 to {self.until:g} s after the release, but {first:g} to {last:g} s were "
                "asked for; give a longer duration"
            )


def drop_from_blocks(
    vehicle: Vehicle,
    load: Load = EMPTY,
    wheels: tuple[Wheel, ...] | None = None,
    height: float = 0.05,
    *,
    duration: float = 60.0,
    gravity: float = STANDARD_GRAVITY,
) -> DropMotion:
    """Return the exact motion of a vehicle released from blocks, through every lift-off and landing.

    Parameters
    ----------
    vehicle, load
        The vehicle and what is on it.
    wheels
        The wheels with blocks under them; the others stand on the ground.
    height
        Of the blocks, m.
    duration
        Of the motion at most, s; once the energy left cannot lift any wheel, the motion is known for all time.
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
        If its wheels never stop hopping, as those of a vehicle without damping.

    Notes
    -----
    A tyre's force is max(0, W - k_t z_u - c_t ż_u) while it is compressed, with W the static wheel load, and zero while
    it is not. Without tyre damping that is continuous; with it the force jumps at a landing, to c_t times the speed.

    Examples
    --------
    >>> from sprung.vehicle import TABLE_1_CAR
    >>> drop = drop_from_blocks(TABLE_1_CAR, wheels=("fl", "fr"), height=0.05)
    >>> [event.kind for event in drop.events]
    ['lift-off', 'lift-off', 'landing', 'landing']
    """
    stations = vehicle.layout.wheels
    wheels = stations if wheels is None else wheels
    ground = Ground.under(vehicle, load, gravity)
    rest = _rest(ground, vehicle, load, wheels, height)
    Y = np.concatenate([rest, np.zeros(ground.matrices.massive), [1.0]])
    phases: list[Phase] = ["contact" if value >= 0 else "air" for value in ground.compression @ Y]
    lifted = [wheel for wheel, phase in zip(stations, phases, strict=True) if phase == "air"]
    events = [ContactEvent(0.0, wheel, "lift-off") for wheel in lifted]
    # A tenth of the fastest time constant: within it a response has one extremum at most.
    step = 0.1 / float(np.abs(np.linalg.eigvals(ground.matrices.state)).max())

    segments: list[tuple[float, Array, Array]] = []
    time = 0.0
    while len(segments) < _MOST_SEGMENTS:
        contact = np.array([phase == "contact" for phase in phases])
        segments.append((time, Y, ground.generator(contact)))
        change = _next_change(ground, *segments[-1], phases, step, duration)
        if isinstance(change, float):
            starts, states, generators = (np.array(column) for column in zip(*segments, strict=True))
            return DropMotion(starts, states, generators, tuple(events), change, len(rest))
        time, Y, station, phases[station] = change
        if contact[station] != (phases[station] == "contact"):
            events.append(ContactEvent(time, stations[station], "lift-off" if contact[station] else "landing"))
    raise SprungError(
        f"the drop of {vehicle.name} was given up after {len(events)} lift-offs and landings within {time:g} s of the "
        "release; is the vehicle damped?"
    )


def _next_change(
    ground: Ground, start: float, state: Array, generator: Array, phases: list[Phase], step: float, duration: float
) -> tuple[float, Array, int, Phase] | float:
    """Find the next change of a wheel's phase: time, Y, wheel and new phase; without one, until when there is none."""
    rows = {"force": ground.force, "compression": ground.compression}
    changes = [
        (station, sign * rows[quantity][station], after if ground.damping[station] or after != "relaxing" else "air")
        for station, phase in enumerate(phases)
        for quantity, sign, after in _CHANGES[phase]
    ]
    watched = np.array([row for _, row, _ in changes])
    time, Y = start, state
    while time < duration:
        if all(phase == "contact" for phase in phases) and ground.keeps_contact(Y):
            return math.inf
        zero = find_first_zero(watched, generator, Y, step, _WINDOW)
        if isinstance(zero, tuple):
            station, _, after = changes[zero[1]]
            time += zero[0]
            return (time, expm(generator * (time - start)) @ state, station, after) if time < duration else duration
        time, Y = time + _WINDOW * step, zero
    return duration


def _rest(ground: Ground, vehicle: Vehicle, load: Load, wheels: tuple[Wheel, ...], height: float) -> Array:
    """Return the rest position X on the blocks, shape (coordinate,), or raise an error if there is none."""
    problems = Problems()
    where, stations = f"drop of {vehicle.name}, load '{load.name}'", vehicle.layout.wheels
    if not wheels:
        problems.add(where, "no wheels", "at least one wheel on a block", "Name the wheels that are dropped.")
    for wheel in wheels:
        if wheel not in stations:
            problems.add(where, f"wheel '{wheel}'", "a wheel station", did_you_mean(wheel, stations))
    if not (math.isfinite(height) and height > 0):
        problems.add(where, f"blocks of {height} m", "a positive height", "Give the height of the blocks in m.")
    if np.any(ground.wheel_loads <= 0):
        each = ", ".join(f"{wheel} {weight:.0f} N" for wheel, weight in zip(stations, ground.wheel_loads, strict=True))
        problems.add(where, f"static wheel loads {each}", "all wheels pressed to the ground", "Move the load inwards.")
    problems.raise_if_any()
    return ground.rest(np.array([height if wheel in wheels else 0.0 for wheel in stations]))
