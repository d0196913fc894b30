"""Records of a check: what one channel, one drop and a whole campaign show."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from sprung.campaign import Campaign, Excitation, MissingEntry, excitation_of
from sprung.checking.recorded import PlottedRecording
from sprung.dataframes import require_pandas
from sprung.display import shown
from sprung.errors import Fault
from sprung.units import Quantity, si_symbol
from sprung.vehicle import SensorPlace, Wheel

if TYPE_CHECKING:
    import pandas as pd


@shown
@dataclass(frozen=True)
class ClockReport:
    """Clock offset of a logger in a drop.

    Attributes
    ----------
    logger
        The logger's file.
    ahead, std
        Its reading at time zero of the first logger's clock, s, and the standard uncertainty of that.
    """

    logger: str
    ahead: float
    std: float


@shown
@dataclass(frozen=True)
class ChannelReport:
    """Check of one channel of one drop.

    Attributes
    ----------
    name
        The channel's.
    on
        What its sensor sits on: the body, or a wheel station; None for a wheel station that is not known.
    quantity
        What its sensor measures.
    noise
        At rest on the blocks, SI root-mean-square; None where the recording shows no rest.
    peak
        Largest reading from the release on, counted from the reading at rest (without one, from the mean), SI; None
        where nothing of the channel can be read.
    used
        Whether the decay holds it.
    faults
        Codes of its faults.
    """

    name: str
    on: SensorPlace | None
    noise: float | None
    peak: float | None
    used: bool
    faults: tuple[str, ...]
    quantity: Quantity = "acceleration"

    @property
    def unit(self) -> str:
        """SI unit of its readings, as it is printed."""
        return si_symbol(self.quantity)


@shown
@dataclass(frozen=True)
class DropReport:
    """One drop: its events, the part that is used, the reasons, and the codes of its faults.

    Times are in s on the recording's own clock.

    Attributes
    ----------
    file
        The recording.
    load
        Name of the load on the vehicle.
    start, end
        Of the decay, as the recording shows it, the same from `check` and in a result; None where no part is used.
    faults
        Codes, each once.
    kind
        ``bounce``, ``pitch front``, ``pitch rear``, ``roll left``, ``roll right``, or the wheels by name; of other excitations
        ``push`` or ``pass``, and ``front`` and so on.
    wheels
        Which wheels were dropped, as the campaign states; empty where it does not.
    wheels_seen
        Which wheels fell as the release shows; as stated where no sensor shows it. None without a release.
    release, landing, last_lift_off
        First motion; when the last wheel that fell met the ground; the last moment, not before the landing, at which a tyre may
        have been off the ground once more. They follow each other in this order, and ``start`` follows them. None where the
        records do not show them, the last also where no tyre can have been off the ground again.
    why_start, why_end
        The reason for each limit of the decay, in words.
    fit_start, why_fit
        From where a fit uses the drop, and why, where that is not ``start``: it determines to the sample when the last tyre of
        the fitted vehicle is down, or uses the fall too. None and empty from `check`.
    rate
        Samples per second.
    channels
        Check of each channel.
    clocks
        Of several loggers, as estimated by the fit.
    name
        The drop's short name, by which its series are found.
    title
        The name that the campaign states; empty where it states none.
    """

    file: str
    load: str
    start: float | None
    end: float | None
    faults: tuple[str, ...]
    kind: str = ""
    wheels: tuple[Wheel, ...] = ()
    wheels_seen: tuple[Wheel, ...] | None = None
    release: float | None = None
    landing: float | None = None
    last_lift_off: float | None = None
    why_start: str = ""
    why_end: str = ""
    fit_start: float | None = None
    why_fit: str = ""
    rate: float | None = None
    channels: tuple[ChannelReport, ...] = ()
    clocks: tuple[ClockReport, ...] = ()
    name: str = ""
    title: str = ""

    @property
    def used_from(self) -> float | None:
        """From where the fit uses the drop, s on the recording's own clock; without a fit from where its decay begins."""
        return self.start if self.fit_start is None else self.fit_start

    @property
    def excitation(self) -> Excitation:
        """What excited the vehicle, as its kind states."""
        return excitation_of(self.kind)

    @property
    def is_driven(self) -> bool:
        """Whether pads drive the vehicle all along, so that the used part is no free decay."""
        return self.excitation == "pads"

    @property
    def label(self) -> str:
        """Label: the name that the campaign states, or else the recording."""
        return self.title or self.file

    @property
    def contradicted(self) -> bool:
        """Whether the records show other wheels to have fallen than the campaign states."""
        return bool(self.wheels) and self.wheels_seen is not None and set(self.wheels_seen) != set(self.wheels)


@shown
@dataclass(frozen=True)
class Check:
    """Check of a campaign's recordings, and of what the campaign does not state yet.

    Attributes
    ----------
    drops
        Events of each drop, and which part of it can be used.
    faults
        All faults, the harmless included.
    recorded
        Whole recordings, to draw: of the drops in their order, without the last ones, which could not be read.
    campaign
        The campaign that was checked; None where only its reports are at hand.
    missing
        What an identification needs besides the recordings, or profits from.
    """

    drops: tuple[DropReport, ...]
    faults: tuple[Fault, ...]
    recorded: tuple[PlottedRecording, ...] = field(default=(), repr=False)
    campaign: Campaign | None = field(default=None, repr=False)
    missing: tuple[MissingEntry, ...] = ()

    @property
    def usable(self) -> bool:
        """Whether at least one drop can be used."""
        return any(drop.start is not None for drop in self.drops)

    def to_dataframe(self) -> pd.DataFrame:
        """Return the drops as a table, times in s on the recording's own clock."""
        require_pandas()
        import pandas as pd  # noqa: PLC0415 (optional, and nothing else here needs it)

        columns = ["file", "load", "kind", "release", "landing", "start", "end", "rate", "faults"]
        rows = [[getattr(drop, one) for one in columns[:-1]] + [", ".join(drop.faults)] for drop in self.drops]
        return pd.DataFrame(rows, columns=columns).set_index("file")

    @property
    def summary(self) -> str:
        """How many drops can be used, and what is missing: ``10 of 10 drops usable; missing: wheelbase``."""
        usable = sum(drop.start is not None for drop in self.drops)
        items = ", ".join(dict.fromkeys(one.item for one in self.missing))
        counted = f"{usable} of {len(self.drops)} drop{'s' * (len(self.drops) != 1)} usable"
        return f"{counted}; missing: {items}" if items else counted

    def faults_of(self, drop: DropReport) -> tuple[Fault, ...]:
        """Return the faults of one drop.

        Parameters
        ----------
        drop
            One of `drops`.
        """
        return tuple(fault for fault in self.faults if fault.where == drop.file or is_within(fault.where, drop.file))

    @property
    def common_faults(self) -> tuple[Fault, ...]:
        """Faults of the campaign, or of a channel in all drops."""
        of_drops = {fault for drop in self.drops for fault in self.faults_of(drop)}
        return tuple(fault for fault in self.faults if fault not in of_drops)

    def document(self) -> dict[str, Any]:
        """Return drops, faults and what is missing, as JSON holds them."""
        return {
            "drops": [asdict(drop) for drop in self.drops],
            "faults": [asdict(fault) for fault in self.faults],
            "missing": [one.document() for one in self.missing],
        }


def is_within(place: str, file: str) -> bool:
    """Return whether a fault's place is a channel of a recording."""
    return place.startswith(f"{file}: ")
