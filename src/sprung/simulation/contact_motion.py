"""Motion with tyre contact, exact: between two changes of contact, or of what drives the vehicle, it is linear.

A tyre pushes and never pulls, so each of the sixteen patterns of wheels on and off the ground has its own linear equations of
motion with a constant force, whose solution is a matrix exponential; pushes and bumps are pieces of sines, and further states.
The instants at which the pattern changes are roots of that solution and are solved for, not stepped over. Nothing depends on a
sampling rate.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from sprung.display import shown
from sprung.errors import SprungError
from sprung.simulation.excitation import Drive
from sprung.simulation.ground import Ground
from sprung.simulation.zero_crossing import find_first_zero
from sprung.vehicle import COORDINATES, Motion, Wheel, affine_response

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
    """The motion after a release, exact at any time: linear segments Ẏ = generator Y with Y = {X, Ẋ, w, 1}.

    Of a push or a bump the time counts from its beginning, and w are the signals that drive the vehicle.

    Attributes
    ----------
    starts
        Start of each segment, s after the release, shape (segment,).
    states
        Y at each start, SI, shape (segment, n + m + w + 1) with n coordinates, m with mass.
    generators
        SI, shape (segment, n + m + w + 1, n + m + w + 1); the last column of each holds the constant force.
    events
        Every lift-off and landing, in order; wheels on blocks higher than their tyres were compressed lift off at 0.
    until
        End of the time for which the motion is known, s after the release; infinite once no wheel can lift off any more.
    coordinates
        Number of coordinates, n.
    state_size
        Length of {X, Ẋ}, n + m.
    driven_until
        End of what drives the vehicle, s after the release: 0 for a drop.
    """

    starts: Array
    states: Array
    generators: Array
    events: tuple[ContactEvent, ...]
    until: float
    coordinates: int = len(COORDINATES)
    state_size: int = 2 * len(COORDINATES)
    driven_until: float = 0.0

    @property
    def decay_start(self) -> float:
        """Time of the last event, s after the release: the free vibration of eq. (3) holds from here on."""
        return max(self.events[-1].time if self.events else 0.0, self.driven_until)

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
        return self._at(segment, time)[: self.state_size]

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


Segment = tuple[float, Array, Array]
"""When it begins, s, Y there, and its generator."""


def follow_motion(ground: Ground, start: Array, *, duration: float, what: str) -> DropMotion:
    """Follow a vehicle through every lift-off and landing, and through what drives it.

    Parameters
    ----------
    ground
        The vehicle on the ground, and what drives it.
    start
        X at the beginning, at rest, shape (coordinate,).
    duration
        Of the motion at most, s; once the energy left cannot lift any wheel, the motion is known for all time.
    what
        What is followed, for an error.

    Raises
    ------
    SprungError
        If its wheels never stop hopping, as those of a vehicle without damping.
    """
    n, size, drive = len(start), ground.state_size, ground.drive
    stations = ground.layout.wheels
    Y = np.concatenate([start, np.zeros(ground.matrices.massive + 3 * len(drive.signals)), [1.0]])
    phases: list[Phase] = ["contact" if value >= 0 else "air" for value in ground.compression @ Y]
    lifted = [wheel for wheel, phase in zip(stations, phases, strict=True) if phase == "air"]
    events = [ContactEvent(0.0, wheel, "lift-off") for wheel in lifted]
    fastest = max([float(np.abs(np.linalg.eigvals(ground.matrices.state)).max()), *_frequencies(drive)])
    # A tenth of the fastest time constant: within it a response has one extremum at most.
    step = 0.1 / fastest

    segments: list[Segment] = []
    time, changes = 0.0, [change for change in drive.changes if change < duration]
    while len(segments) < _MOST_SEGMENTS:
        arcs = drive.at(time)
        frequencies = np.array([arc.frequency for arc in arcs])
        for signal, arc in enumerate(arcs):
            if arc.start == time:
                Y = Y.copy()
                Y[size + 3 * signal : size + 3 * signal + 3] = arc.state
        contact = np.array([phase == "contact" for phase in phases])
        segments.append((time, Y, ground.generator(contact, frequencies)))
        until = next((change for change in changes if change > time), None)
        change = _next_change(
            ground, ground.force(frequencies), segments[-1], phases, step, until or duration, is_last=until is None
        )
        if isinstance(change, float) and until is None:
            starts, states, generators = (np.array(column) for column in zip(*segments, strict=True))
            last = max(changes, default=0.0)
            return DropMotion(starts, states, generators, tuple(events), change, n, size, last)
        if isinstance(change, float):
            Y, time = expm(segments[-1][2] * (change - time)) @ Y, change
            continue
        time, Y, station, phases[station] = change
        if contact[station] != (phases[station] == "contact"):
            events.append(ContactEvent(time, stations[station], "lift-off" if contact[station] else "landing"))
    raise SprungError(
        f"the {what} was given up after {len(events)} lift-offs and landings within {time:g} s; is the vehicle damped?"
    )


def _frequencies(drive: Drive) -> list[float]:
    return [arc.frequency for arcs in drive.signals for arc in arcs]


def _next_change(
    ground: Ground, force: Array, segment: Segment, phases: list[Phase], step: float, duration: float, is_last: bool
) -> tuple[float, Array, int, Phase] | float:
    """Find the next change of a wheel's phase: time, Y, wheel and new phase; without one, until when there is none."""
    start, state, generator = segment
    rows = {"force": force, "compression": ground.compression}
    changes = [
        (station, sign * rows[quantity][station], after if ground.damping[station] or after != "relaxing" else "air")
        for station, phase in enumerate(phases)
        for quantity, sign, after in _CHANGES[phase]
    ]
    watched = np.array([row for _, row, _ in changes])
    time, Y = start, state
    while time < duration:
        if is_last and all(phase == "contact" for phase in phases) and ground.keeps_contact(Y):
            return math.inf
        zero = find_first_zero(watched, generator, Y, step, _WINDOW)
        if isinstance(zero, tuple):
            station, _, after = changes[zero[1]]
            time += zero[0]
            return (time, expm(generator * (time - start)) @ state, station, after) if time < duration else duration
        time, Y = time + _WINDOW * step, zero
    return duration
