"""Heights: what gravity and the wheels' sideways motion do to roll and pitch, where somebody has measured how high things are.

A body that turns about an axis moves everything above or below it sideways, and what is carried sideways counts as roll
inertia. Its centre of gravity sinks as it turns, by its height above what carries it, which works like a negative spring.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from sprung.units import STANDARD_GRAVITY

CarriedAt = Literal["wheels", "roll axis"]
"""Where the suspensions carry the body sideways: see `Heights`."""


class Heights(NamedTuple):
    """Heights above the ground, m, as far as they are known.

    Attributes
    ----------
    cg_height
        Of the sprung mass's centre of gravity; None places every load level with it, and leaves out everything else.
    wheel_height
        Of the wheel centres.
    roll_axis_height
        Of the axis about which the body rolls; None is the centre of gravity's, about which turns what nothing holds sideways.
    carried_at
        Where the suspensions carry the body sideways: ``wheels``, where they slide along the body and turn with it, or
        ``roll axis``, where the ground holds the tyres and links the wheels.
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
    def known(self) -> bool:
        """Whether they tell anything beyond where loads are."""
        return self.cg_height is not None and self._carrying is not None

    @property
    def undecided(self) -> bool:
        """Whether the body may be carried at either of two heights."""
        return self.known and self.wheel_height is not None and self.roll_axis_height is not None

    @property
    def _carrying(self) -> float | None:
        at_wheels = self.carried_at == "wheels" and self.wheel_height is not None
        return self.wheel_height if at_wheels or self.roll_axis_height is None else self.roll_axis_height

    @property
    def cg_arm(self) -> float:
        """Height of the centre of gravity above the axis of roll, m; 0 where nothing is known."""
        if self.cg_height is None or not self.known or self.roll_axis_height is None:
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
        """Give by how much something on the body is above the axes of roll and pitch, m; level with them if nobody knows."""
        if self.cg_height is None:
            return 0.0, 0.0
        above = height - self.cg_height
        return above + self.cg_arm, above

    def tipping(self, height: float | None = None) -> float:
        """Give what gravity takes off the stiffness of roll and pitch for each unit of mass on the body, N m/rad per kg.

        Parameters
        ----------
        height
            Of the mass, m; the centre of gravity's unless given.
        """
        above = self.cg_height if height is None else height
        carrying = self._carrying
        return 0.0 if not self.known or above is None or carrying is None else STANDARD_GRAVITY * (above - carrying)


LEVEL = Heights()
"""Nothing known: everything is level with the centre of gravity."""
