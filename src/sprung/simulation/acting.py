"""What acts on a vehicle in each drop of a campaign: blocks that are removed, a push, or a bump."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from sprung.campaign import DEFAULT_HEIGHT, Bump, Excitation, Push
from sprung.simulation.contact_motion import DropMotion
from sprung.simulation.excited_motion import DEFAULT_SPEED, bump_drive, drive_over_bump, push_body, push_drive
from sprung.simulation.linear_drop import drop_from_blocks
from sprung.simulation.nonlinear_motion import BlockSupport, DrivenStart
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import Load, Vehicle, Wheel


class Excited(Protocol):
    """A drop or another excitation, as it is stated or planned."""

    @property
    def wheels(self) -> tuple[Wheel, ...]:
        """Those that fall, between which the body is pushed, or that run over the bump."""

    @property
    def excitation(self) -> Excitation:
        """What excites the vehicle."""

    @property
    def height(self) -> float | None:
        """Of the blocks, m."""

    @property
    def speed(self) -> float | None:
        """Of a pass, m/s."""


class Acting(NamedTuple):
    """What acts on a vehicle in the drops of a campaign.

    Attributes
    ----------
    push, bump
        In every push, and in every pass.
    gravity
        m/s².
    """

    push: Push = Push()
    bump: Bump = Bump()
    gravity: float = STANDARD_GRAVITY

    def motion(self, vehicle: Vehicle, load: Load, drop: Excited, duration: float) -> DropMotion:
        """Return the exact motion of a linear vehicle in a drop.

        Parameters
        ----------
        vehicle, load
            The vehicle and what is on it.
        drop
            What is done with it.
        duration
            For which the motion is known at least after nothing drives the vehicle any more, s.
        """
        if drop.excitation == "push":
            held = push_drive(vehicle, load, drop.wheels, self.push, self.gravity)[0].changes[-1]
            return push_body(vehicle, load, drop.wheels, self.push, duration=held + duration, gravity=self.gravity)
        if drop.excitation == "pass":
            speed = drop.speed or DEFAULT_SPEED
            left = bump_drive(vehicle, drop.wheels, speed, self.bump).changes[-1]
            return drive_over_bump(
                vehicle, load, drop.wheels, speed, self.bump, duration=left + duration, gravity=self.gravity
            )
        height = drop.height or DEFAULT_HEIGHT
        return drop_from_blocks(vehicle, load, drop.wheels, height, duration=duration, gravity=self.gravity)

    def beginning(self, vehicle: Vehicle, load: Load, drop: Excited) -> BlockSupport | DrivenStart:
        """Return how a vehicle with nonlinear elements rests before a drop, and what drives it then.

        Parameters
        ----------
        vehicle, load
            The vehicle and what is on it.
        drop
            What is done with it.
        """
        if drop.excitation == "push":
            return DrivenStart(load, *push_drive(vehicle, load, drop.wheels, self.push, self.gravity))
        if drop.excitation == "pass":
            drive = bump_drive(vehicle, drop.wheels, drop.speed or DEFAULT_SPEED, self.bump)
            return DrivenStart(load, drive, None)
        return BlockSupport(load, drop.wheels, drop.height or DEFAULT_HEIGHT)
