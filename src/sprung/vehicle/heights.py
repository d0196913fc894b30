"""Heights: the effect of gravity and of lateral motion on roll and pitch, where heights were measured.

A body that turns about an axis moves everything above or below that axis sideways, and mass that moves sideways adds to the
roll inertia. Where nothing holds the vehicle sideways, it turns about the axis that leaves its momentum zero. Its centre of
gravity sinks as it turns, by its height above the lateral support, which acts like a negative spring. A load lets the body
rest lower, which shortens both arms.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from sprung.units import STANDARD_GRAVITY

CarriedAt = Literal["wheels", "roll axis"]
"""Lateral support of the body by its suspensions: see `Heights`."""


class Heights(NamedTuple):
    """Heights above the ground, m, as far as they are known.

    Attributes
    ----------
    cg_height
        Of the sprung mass's centre of gravity; None places every load level with it and leaves out all other effects.
    wheel_height
        Of the wheel centres.
    roll_axis_height
        Of the axis about which the body rolls; None is that of the centre of gravity, about which a body without lateral
        support turns.
    carried_at
        Lateral support of the body: ``wheels``, where these slide along the body and turn with it, or ``roll axis``, where the
        ground holds the tyres and links hold the wheels.
    sunk
        How much lower the body rests on its wheels under a load than without it, m; the other heights are without it.
    """

    cg_height: float | None = None
    wheel_height: float | None = None
    roll_axis_height: float | None = None
    carried_at: CarriedAt = "wheels"
    sunk: float = 0.0

    @property
    def by_key(self) -> dict[str, float | None]:
        """The heights by their keys in a campaign file."""
        return {key: getattr(self, key) for key in ("cg_height", "wheel_height", "roll_axis_height")}

    @property
    def has_effect(self) -> bool:
        """Whether roll and pitch depend on them beyond the places of loads."""
        return self.cg_height is not None and self._support is not None

    @property
    def is_free(self) -> bool:
        """Whether nothing holds the vehicle sideways or lengthways: the body turns about no axis that is known."""
        return self.has_effect and self.roll_axis_height is None

    @property
    def is_ambiguous(self) -> bool:
        """Whether the lateral support may be at either of two heights."""
        return self.has_effect and self.wheel_height is not None and self.roll_axis_height is not None

    @property
    def _support(self) -> float | None:
        at_wheels = self.carried_at == "wheels" and self.wheel_height is not None
        return self.wheel_height if at_wheels or self.roll_axis_height is None else self.roll_axis_height

    @property
    def cg_arm(self) -> float:
        """Height of the centre of gravity above the axis of roll, m; 0 where it is not known."""
        if self.cg_height is None or not self.has_effect or self.roll_axis_height is None:
            return 0.0
        return self.cg_height - self.sunk - self.roll_axis_height

    @property
    def wheel_arms(self) -> tuple[float, float]:
        """Heights of the wheel centres above the axes of roll and pitch, m; the latter is level with the centre of gravity."""
        if self.cg_height is None or self.wheel_height is None:
            return 0.0, 0.0
        above = self.wheel_height - self.cg_height + self.sunk
        return above + self.cg_arm, above

    def item_arms(self, height: float) -> tuple[float, float]:
        """Return the heights of an item on the body above the axes of roll and pitch, m; 0 where these are not known."""
        if self.cg_height is None:
            return 0.0, 0.0
        above = height - self.cg_height
        return above + self.cg_arm, above

    def gravity_stiffness(self, height: float | None = None) -> float:
        """Return the reduction of the roll and pitch stiffness by gravity, for each unit of mass on the body, N m/rad per kg.

        Parameters
        ----------
        height
            Of the mass, m; the centre of gravity's unless given.
        """
        height, support = self.cg_height if height is None else height, self._support
        if not self.has_effect or height is None or support is None:
            return 0.0
        return STANDARD_GRAVITY * (height - self.sunk - support)

    @property
    def sinking_stiffness(self) -> float:
        """Growth of the roll and pitch stiffness, for each unit of mass on the body, as it rests lower, N m/rad per kg."""
        return STANDARD_GRAVITY * self.sunk if self.has_effect else 0.0


LEVEL = Heights()
"""No height known: everything is level with the centre of gravity."""
