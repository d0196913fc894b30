"""First motion of the body after each release: it goes down on the side on which its wheels lost their blocks.

Within some hundredths of a second after the release a spring that carried a corner of the body loses part of its force, at the
wheels that fell and nowhere else. What the body then gains in velocity is linear in the place on the body, and adds up over the
wheels: v(x, y) = Σ over axles (n (A + B x) + s C y), with n wheels that fell at the axle, s more on the left than on the right.
A body goes down most where its wheels fell (C < 0; B has one sign at the front and the other at the rear), and turns about the
opposite axle, as its radius of gyration is about that of two masses above the axles (centre of percussion). No mass and no rate
has to be known for that, so it tests the stated places of sensors and wheels.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Campaign
from sprung.preprocess.dropped_wheels import Dropped, detect_dropped_wheels, find_disagreeing_wheels
from sprung.preprocess.prepare import Prepared
from sprung.vehicle import STATIONS, Wheel

Real = NDArray[np.float64]

_AFTER = 0.06
"""s after the release over which velocity is gained: the fall from blocks of 0.02 m takes as long."""

_AT_ONCE = 0.02
"""s after the release in which a wheel falls: the stiffest ones swing back soon after."""

_EXPLAINED = 0.75
"""Part of the sum of squares of the velocities that motion about the right places explains at least."""

_SHOWN = 0.15
"""Part of the largest velocity that a slope times the sensors' spread has to make up for its sign to count."""

_ABOUT_THE_REAR, _ABOUT_THE_FRONT = (-2.0, -0.45), (-0.55, 1.0)
"""x over the wheelbase about which a body turns whose front, and whose rear wheels fall: -1 and 0 for a body whose radius of
gyration squared is a b; the limits are those of 0.4 and 2 times that."""


def redetect_dropped_wheels(campaign: Campaign, prepared: Prepared) -> tuple[Dropped, ...]:
    """Detect which wheels lost their blocks in prepared recordings, for a campaign that states other places of their sensors.

    Parameters
    ----------
    campaign
        States the places.
    prepared
        Its recordings.

    Returns
    -------
    tuple of mapping
        For each drop, by the wheel station that the campaign states for a channel, whether the channel shows a fall.
    """
    return tuple(
        detect_dropped_wheels(seen.recording, None if seen.release is None else seen.rest, campaign.sensors)
        for seen in prepared.observations
    )


def count_disagreeing_drops(campaign: Campaign, prepared: Prepared) -> int:
    """Return the number of drops in which sensors that are stated on the same wheel do not agree whether it fell.

    Parameters
    ----------
    campaign
        States the places.
    prepared
        Its recordings.

    Returns
    -------
    int
    """
    shared = [sensor.wheel for sensor in campaign.sensors if sensor.wheel is not None and sensor.reads_gravity]
    if len({*shared}) == len(shared):  # one sensor on each wheel, as in most campaigns
        return 0
    return sum(
        bool(find_disagreeing_wheels(seen.recording, seen.rest, campaign.sensors))
        for seen in prepared.observations
        if seen.release is not None and not seen.drop.is_driven
    )


def is_body_slower(campaign: Campaign, prepared: Prepared) -> bool:
    """Whether every sensor of the body gains less speed at once than the fastest one of the wheels, as in any vehicle.

    Parameters
    ----------
    campaign
        States which sensors are on the body.
    prepared
        Its recordings.

    Returns
    -------
    bool
    """
    body, others = _accelerometers(campaign)
    fastest = (np.nan_to_num(_gained(prepared, len(body), _AT_ONCE)) ** 2).sum(axis=0)
    return bool(fastest[body].max(initial=0.0) < fastest[others].max(initial=0.0))


def begins_upward(campaign: Campaign, prepared: Prepared) -> bool:
    """Whether the largest motion, among the body's sensors or among those of the wheels, begins upward: no vehicle does.

    Parameters
    ----------
    campaign
        States which sensors are on the body.
    prepared
        Its recordings.

    Returns
    -------
    bool
    """
    body, others = _accelerometers(campaign)
    gained, at_once = (_gained(prepared, len(body), span) for span in (_AFTER, _AT_ONCE))
    return _rises(gained[:, body]) or _rises(at_once[:, others])


def _accelerometers(campaign: Campaign) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which channels are accelerometers on the body, and which elsewhere, shape (channel,) each."""
    accelerometers = np.array([sensor.reads_gravity for sensor in campaign.sensors])
    on_body = np.array([sensor.on == "body" for sensor in campaign.sensors])
    return accelerometers & on_body, accelerometers & ~on_body


def _gained(prepared: Prepared, channels: int, span: float) -> Real:
    """Velocity that each channel gains in some time after the release, m/s, shape (drop, channel); NaN where no wheel fell."""
    gained = np.full((len(prepared.observations), channels), np.nan)
    for drop, seen in enumerate(prepared.observations):
        if seen.release is not None and not seen.drop.is_driven:
            count = max(round(span * seen.recording.rate), 2)
            first = seen.recording.values[:, seen.release : seen.release + count]
            gained[drop] = (first - seen.rest.level[:, None]).sum(axis=1) / seen.recording.rate
    return gained


def _rises(gained: Real) -> bool:
    """Return whether the larger velocities of a group of sensors are upward, shape (drop, channel)."""
    known = np.nan_to_num(gained)
    return bool((known * np.abs(known)).sum() > 0)


def is_first_motion_consistent(
    campaign: Campaign, prepared: Prepared, dropped: Sequence[Sequence[Wheel]], wheelbase: float
) -> bool | None:
    """Return whether the first motion is consistent with stated places of the sensors and stated wheels.

    Parameters
    ----------
    campaign
        States the places of the body's sensors.
    prepared
        Its recordings.
    dropped
        The wheels that fell in each drop.
    wheelbase
        m.

    Returns
    -------
    bool or None
        None where there are neither drops of one end nor of one side.
    """
    # A vehicle with one axle counts as one front axle.
    stations = [[STATIONS[wheel] for wheel in wheels] for wheels in dropped]
    at_ends = [[[one for one in own if (one.end < 0) == rear] for rear in (False, True)] for own in stations]
    counts = np.array([[len(own) for own in ends] for ends in at_ends], dtype=float)
    sides = np.array([[sum(one.side for one in own) for own in ends] for ends in at_ends], dtype=float)
    placed = {
        i: sensor.position
        for i, sensor in enumerate(campaign.sensors)
        if sensor.on == "body" and sensor.position and sensor.reads_gravity
    }
    x, y, _ = np.array(list(placed.values()), dtype=float).reshape(-1, 3).T
    gained = _gained(prepared, len(campaign.sensors), _AFTER)[:, list(placed)]
    there = np.isfinite(gained)
    velocities = gained[there]
    if velocities.size == 0:
        return None
    shown = there.any(axis=1)
    ends_differ = bool(np.linalg.matrix_rank(counts[shown]) == 2)
    sides_differ = bool(sides[shown].any())
    if not ends_differ and not sides_differ:
        return None
    columns = [np.broadcast_to(counts[:, [i]], there.shape) for i in range(2)]
    columns += [counts[:, [i]] * x for i in range(2)] + [sides[:, [i]] * y for i in range(2)]
    design = np.array([column[there] for column in columns]).T
    solution = np.linalg.lstsq(design, velocities, rcond=1e-9)[0]
    residual = velocities - design @ solution
    if residual @ residual > (1 - _EXPLAINED) * (velocities @ velocities):
        return False
    largest = float(np.abs(velocities).max())
    front, rear, slope_front, slope_rear, left_front, left_rear = solution.tolist()
    if sides_differ:
        tilts = (left_front + left_rear) * np.ptp(y)
        if not tilts < -_SHOWN * largest:
            return False
    return not ends_differ or (
        _turns_plausibly(front, slope_front, wheelbase, _ABOUT_THE_REAR, -1.0)
        and _turns_plausibly(rear, slope_rear, wheelbase, _ABOUT_THE_FRONT, 1.0)
    )


def _turns_plausibly(constant: float, slope: float, wheelbase: float, limits: tuple[float, float], way: float) -> bool:
    """Return whether a body goes down where its wheels fall, and turns about a possible place."""
    if slope * way <= 0:
        return False
    low, high = limits
    return low <= -constant / slope / wheelbase <= high
