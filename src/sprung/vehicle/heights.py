"""Heights: the effect of gravity and of lateral motion on roll and pitch, where heights were measured.

A body that turns about an axis moves everything above or below that axis sideways, and mass that moves sideways adds to the
roll inertia. Its centre of gravity sinks as it turns, by its height above the lateral support, which acts like a negative
spring.
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
    """

    cg_height: float | None = None
    wheel_height: float | None = None
    roll_axis_height: float | None = None
    carried_at: CarriedAt = "wheels"

    @property
    def by_key(self) -> dict[str, float | None]:
        """The heights by their keys in a campaign file."""
        return {key: getattr(self, key) for key in ("cg_height", "wheel_height", "roll_axis_height")}

    @property
    def has_effect(self) -> bool:
        """Whether roll and pitch depend on them beyond the places of loads."""
        return self.cg_height is not None and self._support is not None

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
        return self.cg_height - self.roll_axis_height

    @property
    def wheel_arms(self) -> tuple[float, float]:
        """Heights of the wheel centres above the axes of roll and pitch, m; the latter is level with the centre of gravity."""
        if self.cg_height is None or self.wheel_height is None:
            return 0.0, 0.0
        above = self.wheel_height - self.cg_height
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
        return STANDARD_GRAVITY * (height - support)


LEVEL = Heights()
"""No height known: everything is level with the centre of gravity."""
