"""Records of a drafted campaign."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from sprung.campaign import Excitation, drop_kind
from sprung.drafting.detected_drop import DetectedDrop
from sprung.drafting.detection import RejectedEvent
from sprung.units import Quantity
from sprung.vehicle import SensorPlace, Wheel


@dataclass(frozen=True)
class DraftSensor:
    """A sensor, as far as its readings and its name show.

    Attributes
    ----------
    channel
        Its name.
    on
        The body, a wheel station or a pad; "wheel" or "pad" where the station is not known, None where nothing of it is.
    corner
        Corner of the body at which it sits.
    unit
        Its unit; None where it is not known.
    stated_unit
        Unit that the files state.
    direction
        Direction of a positive reading.
    coupling
        DC where it reads gravity at rest, AC where it reads zero.
    full_scale
        A reading at which it stays for some samples, in its unit.
    notes
        Findings and conclusions, in words.
    logger
        The part of its recordings' names that states its logger, where several loggers' channels have one name; the channel
        then begins with it.
    quantity
        What it measures.
    axis
        Axis about which an angular rate is measured; None where it is not known.
    is_travel
        Whether it measures the travel of a suspension, from the body to a wheel.
    relative_to
        The wheel station then; None where it is not known.
    """

    channel: str
    on: SensorPlace | Literal["pad"] | None
    corner: Wheel | None
    unit: str | None
    stated_unit: str | None
    direction: Literal["up", "down"]
    coupling: Literal["DC", "AC"]
    full_scale: float | None
    notes: tuple[str, ...]
    logger: str | None = None
    quantity: Quantity = "acceleration"
    axis: Literal["pitch", "roll"] | None = None
    is_travel: bool = False
    relative_to: Wheel | None = None


@dataclass(frozen=True, eq=False)
class DraftDrop:
    """A drop.

    Attributes
    ----------
    files
        The recording, or the recordings of several loggers.
    window
        s on the file's clock, where the recording holds more than this drop.
    load
        Name of the load; None where it is not known.
    wheels
        Which wheels fell; none where it is not known.
    found
        The drop as detected.
    notes
        Findings and conclusions, in words.
    proposed
        Whether its load follows from the periods of the body, not from a name.
    excitation
        What excited the vehicle; None where it is not known.
    """

    files: tuple[str, ...]
    window: tuple[float, float] | None
    load: str | None
    wheels: tuple[Wheel, ...]
    found: DetectedDrop
    notes: tuple[str, ...]
    proposed: bool = False
    excitation: Excitation | None = "drop"

    @property
    def kind(self) -> str | None:
        """What such a drop is called."""
        return drop_kind(self.wheels, self.excitation or "drop") if self.wheels else None


@dataclass(frozen=True, eq=False)
class DraftFile:
    """A recording that was read.

    Attributes
    ----------
    name
        Relative to the folder.
    rate
        Samples per second.
    start, end
        s on its clock.
    drops
        Number of drops in it.
    rejected
        The largest of the other events, and why they are no drops.
    events
        How many other events there were.
    left_out
        Channels that are no vertical accelerations, each with the reason.
    """

    name: str
    rate: float
    start: float
    end: float
    drops: int
    rejected: tuple[RejectedEvent, ...]
    events: int
    left_out: Mapping[str, str]
