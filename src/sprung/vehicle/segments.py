"""Segments of motions, all followed side by side from predicted initial states (multiple shooting).

A step of the program costs nearly the same for one motion as for many. Where the motions are known roughly, they are cut into
segments, which are followed at once; Newton's method closes what they leave between them, and Broyden's update corrects its
derivatives by what each pass shows.

References
----------
H. G. Bock, Springer Series in Chemical Physics 18 (1981) 102; C. G. Broyden, Math. Comp. 19 (1965) 577.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.force_laws import ElementInput
from sprung.vehicle.stepping import Stepper, Trajectory

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_SEGMENTS = 16
"""Of a recording: many make few steps of the program, until they exceed a processor's cache."""

_MOST_PASSES = 9
"""Passes through the segments at the most: more would take longer than following whole motions."""

_CLOSED = 1e-6
"""Gap between segments, as a part of the largest state, that is none: less is below what the forces of a step are solved to."""

_PROMISING = 1e-3
"""Gap that the passes left would leave, if each reduced it as the last one did, up to which they are tried."""

_TINY = float(np.finfo(float).tiny)

_NEARLY = 3e-5
"""Differences of forces, as a part of the largest, that are corrected without another evaluation."""


class NearbyMotion(NamedTuple):
    """What is known of motions from others nearby.

    Attributes
    ----------
    starts
        State and memories at the start of each segment, SI and dimensionless, shape (drop, segment, start).
    transitions
        The end of each segment by its start, SI, shape (drop, segment, start, start).
    forces
        Of the rows of the nonlinear elements, and their surplus, N, shape (step + 1, drop, 2 row).
    """

    starts: Array
    transitions: Array
    forces: Array


def segments_of(steps: int, every: int) -> tuple[int, int]:
    """Return how motions are cut into segments.

    Parameters
    ----------
    steps
        Of the motions.
    every
        Steps from one sample to the next.

    Returns
    -------
    number, length
        Number of segments, and steps of each, a multiple of those between samples.
    """
    samples = steps // every + 1
    number = min(_SEGMENTS, samples)
    return number, -(-samples // number) * every


def steps_of_segments(number: int, length: int) -> Index:
    """Return the steps of each segment of a length, its end included, shape (step + 1, segment)."""
    return np.arange(length + 1)[:, None] + length * np.arange(number)


def cut_into_segments(values: Array, steps: Index, slots: Index) -> Array:
    """Cut values along motions into segments; a *place* is a segment of one drop of a kind.

    Parameters
    ----------
    values
        Of each step, shape (step + 1, drop, column).
    steps
        Which of them, shape (step, segment); beyond the end the last one stands.
    slots
        Drops of each kind, shape (kind, slot).

    Returns
    -------
    ndarray
        Shape (step, kind, place, column).
    """
    chosen = np.moveaxis(values[np.minimum(steps, len(values) - 1)][:, :, slots], 1, 3)
    return chosen.reshape(*chosen.shape[:2], chosen.shape[2] * chosen.shape[3], chosen.shape[4])


def integrate_near(
    stepper: Stepper, states: Array, memories: Array, steps: int, every: int, near: NearbyMotion
) -> Trajectory:
    """Integrate motions from their initial states that are known roughly.

    Parameters
    ----------
    stepper
        What steps.
    states, memories
        Of each drop, SI, shapes (drop, state) and (drop, memory).
    steps
        How many.
    every
        Steps from one sample to the next.
    near
        What is known of them.

    Returns
    -------
    Trajectory
        As from `Stepper.integrate`.
    """
    number, length = segments_of(steps, every)
    slots, (kind, slot) = stepper.slots, stepper.places
    starts, state = near.starts.copy(), states.shape[1]
    starts[:, 0] = np.concatenate([states, memories], axis=1)
    scale = _scale(stepper, starts, near.forces)

    def by_drop(values: Array) -> Array:
        """Return values (step, kind, slot · segment, column) as (drop, segment, step, column)."""
        split = values.reshape(*values.shape[:2], slots.shape[1], number, values.shape[3])
        return np.moveaxis(split, 0, 3)[kind, slot]

    similar = cut_into_segments(near.forces, steps_of_segments(number, length), slots)
    transitions, changes, before, error = near.transitions, np.zeros_like(starts), starts, np.inf
    for left in reversed(range(_MOST_PASSES)):
        begin = starts[slots].reshape(len(slots), -1, starts.shape[2])
        motions, kept, surplus = stepper.follow(
            begin[..., :state], begin[..., state:], length, similar=similar, nearly=_NEARLY
        )
        similar = np.concatenate([motions[..., state:-1], surplus], axis=3)
        ends = by_drop(np.concatenate([motions[-1:, ..., :state], kept[-1:]], axis=3))[:, :, 0]
        transitions, before = _learnt(transitions, ends - before, changes, scale), ends
        changes = np.zeros_like(starts)
        for segment in range(number - 1):
            moved = transitions[:, segment] @ changes[:, segment, :, None]
            changes[:, segment + 1] = ends[:, segment] - starts[:, segment + 1] + moved[..., 0]
        previous, error = error, float(np.max(np.abs(changes) / scale))
        if error <= _CLOSED:
            whole, memory = (
                np.swapaxes(np.concatenate(np.swapaxes(by_drop(values[:-1]), 0, 1), axis=1)[:, : steps + 1], 0, 1)
                for values in (motions, kept)
            )
            # Those of the step that ends where a segment begins belong to the segment before.
            moving = np.swapaxes(np.concatenate(np.swapaxes(by_drop(surplus[1:]), 0, 1), axis=1)[:, :steps], 0, 1)
            moving = np.concatenate([np.zeros_like(moving[:1]), moving])
            return Trajectory(whole[..., :state], whole[..., state:-1], memory, moving)
        if not _is_promising(error, previous, left):
            break
        starts = starts + changes
    return stepper.integrate(states, memories, steps, similar=near.forces)


def _is_promising(error: float, previous: float, left: int) -> bool:
    """Whether so many further passes will close the gaps that the last two left, as parts of the motions; inf before the first.

    They reduce it more than the last one did, as the motions come nearer; what the first one leaves says little.
    """
    if np.isinf(previous):
        return error < 1
    # As logarithms: of a motion that runs away any power would be too large a number.
    return bool(np.log(error) + left * np.log(error / previous) <= np.log(_PROMISING))


def _learnt(transitions: Array, moved: Array, changes: Array, scale: Array) -> Array:
    """Return transitions that agree with what the last pass showed of them (Broyden's update).

    A kink that some motion has passed since makes them wrong, and Newton's method slow.

    Parameters
    ----------
    transitions
        The end of each segment by its start, SI, shape (drop, segment, start, start).
    moved
        How the ends moved as the starts changed, SI, shape (drop, segment, start).
    changes
        Of the starts, SI, shape (drop, segment, start).
    scale
        Of each of them, SI, shape (start,); infinite where it does not count.
    """
    parts = changes / scale
    squares = np.sum(parts**2, axis=-1, keepdims=True)
    missed = moved - (transitions @ changes[..., None])[..., 0]
    along = np.divide(parts / scale, squares, out=np.zeros_like(parts), where=squares > _CLOSED**2)
    learnt: Array = transitions + missed[..., :, None] * along[..., None, :]
    return learnt


def _scale(stepper: Stepper, starts: Array, forces: Array) -> Array:
    """Return the largest displacement, velocity and memory of motions for each of theirs, shape (start,).

    A coordinate that hardly moves need not be known to a part of its own motion; angles act at levers of about 1 m. And the
    memory of a force that is small beside others need not be known as well as these: it may change as fast as it likes.

    Parameters
    ----------
    stepper
        What steps.
    starts
        State and memories, SI, shape (drop, segment, start).
    forces
        Of the rows of the nonlinear elements, and their surplus, N, shape (step, drop, 2 row).
    """
    largest = np.abs(starts).max(axis=(0, 1))
    state, rows = stepper.steps.shape[1], stepper.forces.number
    motion, memories = np.split(largest, [state])
    at_rest = np.zeros(rows)
    by_memory = stepper.forces_at.evaluate(ElementInput(at_rest, at_rest, at_rest, np.zeros(len(memories)))).by_memory
    effects = np.abs(by_memory)
    unnoticed = np.divide(
        np.abs(forces[..., :rows]).max(), effects, out=np.full_like(effects, np.inf), where=effects > 0
    )
    scales = [np.full(len(part), max(part.max(), _TINY)) for part in np.split(motion, [stepper.displacements])]
    return np.concatenate([*scales, np.maximum(memories, unnoticed)])
