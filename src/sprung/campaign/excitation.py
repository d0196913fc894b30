"""What excites a vehicle: how its body is pushed, and over which bump it is driven."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from sprung.vehicle import Finite, Positive, checked_record


@checked_record
class Bump:
    """What a simulated vehicle drives over in a pass, the same under every wheel that runs over it."""

    shape: Literal["half-sine", "plank", "kerb"] = "half-sine"
    """A half sine; a plank, onto which and off which the tyre rolls; or a kerb onto a level that stays."""
    height: Positive = 0.05
    """Of its top, m."""
    length: Positive = 0.5
    """Of the half sine, or of the plank between its edges, m."""
    edge: Positive = 0.15
    """Way on which a tyre rolls onto a plank or a kerb or off it, m: half a period of a cosine."""


@checked_record
class Push:
    """How the body of a simulated vehicle is pushed or pulled before it is let go."""

    shape: Literal["hand", "rope", "lift"] = "hand"
    """Pushed down some times by hand; pulled down by a rope that is then released; or lifted and let go."""
    force: Positive | None = None
    """Largest force, N; by default 5 % of the vehicle's weight by hand, 10 % otherwise."""
    count: Annotated[int, Field(ge=1)] = 4
    """Number of pushes by hand."""
    frequency: Positive | None = None
    """Pushes per second; by default about the natural frequency with which the place moves that is pushed."""
    position: tuple[Finite, Finite] | None = None
    """Place of the force on the body, m: forward of the front axle, left of the centreline; by default in the middle
    between the wheels that are named."""
