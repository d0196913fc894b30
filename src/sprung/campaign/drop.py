"""One drop: what is stated of it, and its recording."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import field, fields, replace
from pathlib import PurePath
from typing import Annotated, Literal, Self, get_args

from pydantic import Field, InstanceOf, model_validator

from sprung.campaign.recording import Recording
from sprung.vehicle import WHEELS, Finite, Layout, Positive, Wheel, checked_record

DROP_KINDS: Mapping[frozenset[Wheel], str] = {
    frozenset(WHEELS): "bounce",
    frozenset(("fl", "fr")): "pitch front",
    frozenset(("rl", "rr")): "pitch rear",
    frozenset(("fl", "rl")): "roll left",
    frozenset(("fr", "rr")): "roll right",
    frozenset(("front", "rear")): "bounce",
    frozenset(("left", "right")): "bounce",
    frozenset(("wheel",)): "bounce",
    frozenset(("front",)): "pitch front",
    frozenset(("rear",)): "pitch rear",
    frozenset(("left",)): "roll left",
    frozenset(("right",)): "roll right",
}
"""The usual drops by the wheels that fall."""


DEFAULT_HEIGHT = 0.05
"""Height of the blocks where a drop does not say, m."""


Excitation = Literal["drop", "push", "pass", "pads"]
"""Released from blocks; pushed or pulled and let go; driven over an unknown bump onto flat road; or driven by pads."""


def drop_kind(wheels: Sequence[Wheel], excitation: Excitation = "drop") -> str:
    """Return the name of a drop by its wheels, such as ``pitch front``; the wheels themselves where it has none.

    Parameters
    ----------
    wheels
        Those that fall; of a push those between which the body is pushed, of a pass those that run over the bump.
    excitation
        What excites the vehicle.

    Returns
    -------
    str

    Examples
    --------
    >>> drop_kind(("fl", "fr")), drop_kind(("fl", "fr"), "push"), drop_kind(("fl", "fr", "rl", "rr"), "pass")
    ('pitch front', 'push front', 'pass')
    """
    kind = DROP_KINDS.get(frozenset(wheels), " ".join(wheels))
    if excitation == "drop":
        return kind
    motion, _, where = kind.partition(" ")
    return excitation if kind == "bounce" else f"{excitation} {where if motion in {'pitch', 'roll'} else kind}"


def excitation_of(kind: str) -> Excitation:
    """Return what excites the vehicle in a drop of a kind.

    Parameters
    ----------
    kind
        From `drop_kind`.

    Returns
    -------
    str

    Examples
    --------
    >>> excitation_of("pitch front"), excitation_of("push front"), excitation_of("pass")
    ('drop', 'push', 'pass')
    """
    first = kind.partition(" ")[0]
    return next((name for name in get_args(Excitation) if name == first), "drop")


@checked_record
class Drop:
    """One drop, or another excitation of the vehicle, as a campaign file describes it."""

    # Where it is not known yet, the load is empty text and there are no wheels.

    file: str | None = None
    """Path of the recording, relative to the campaign file; not in a vehicle file."""
    files: Annotated[tuple[str, ...], Field(max_length=64)] = ()
    """Recordings of this drop by several loggers, each with its own clock; instead of `file`."""
    name: Annotated[str, Field(min_length=1)] | None = None
    """Unique name of the drop; default: the name of its recording."""
    window: tuple[Finite, Finite] | None = None
    """Part of the recording that contains this drop, s on the clock of the (first) file, if it contains several drops."""
    load: str = "empty"
    """Name of the load on the vehicle."""
    wheels: Annotated[tuple[Wheel, ...], Field(json_schema_extra={"minItems": 1})] = ("fl", "fr", "rl", "rr")
    """Which wheels were dropped, between which the body was pushed, or which ran over the bump; all others stood."""
    excitation: Excitation = "drop"
    """Released from blocks; pushed or pulled and let go; driven over an unknown bump onto flat road; or driven by pads."""
    speed: Positive | None = None
    """Speed of a pass over a bump, m/s, where it is known; 0.2 to 15 m/s."""
    height: Positive | None = None
    """Height of the blocks, m."""
    start: Finite | None = None
    """Beginning of the free decay, s on the clock of the (first) file; used as given."""
    end: Finite | None = None
    """End of the free decay, s on the clock of the (first) file; used as given."""

    @model_validator(mode="after")
    def _consistent(self) -> Drop:
        if len(set(self.wheels)) != len(self.wheels):
            raise ValueError("name each wheel once")
        if self.start is not None and self.end is not None and self.end <= self.start:
            raise ValueError(f"the end, {self.end:g} s, must come after the start, {self.start:g} s")
        if self.file is not None and self.files:
            raise ValueError("name either the file or, where several loggers recorded it, the files")
        if self.speed is not None and self.excitation != "pass":
            raise ValueError(
                f'a speed is that of a pass, not of a {self.excitation}; write excitation = "pass", or remove speed'
            )
        if self.height is not None and self.excitation != "drop":
            raise ValueError(
                f"the height of blocks is for a drop, not for a {self.excitation}; remove height, or excitation"
            )
        if len(set(self.files)) != len(self.files):
            raise ValueError("name each file once")
        if self.name is not None and (not self.name.isprintable() or {"/", "\\"} & set(self.name)):
            raise ValueError("a drop's name is printable text without / and \\")
        if self.window is not None and self.window[1] <= self.window[0]:
            raise ValueError(f"the window must end after {self.window[0]:g} s, where it begins")
        return self

    def on_wheels_of(self, layout: Layout) -> Self:
        """Return the drop on the wheels of a layout: those stated, or all where the default names other ones.

        Parameters
        ----------
        layout
            Of the vehicle.
        """
        return replace(self, wheels=layout.wheels) if self.wheels == WHEELS != layout.wheels else self

    @property
    def recording_files(self) -> tuple[str, ...]:
        """Names of the files that recorded it."""
        return self.files if self.file is None else (self.file,)

    @property
    def recording_name(self) -> str | None:
        """Name of its recording: the file, with the beginning of its window, or what its files have in common."""
        shared = self.file or next(iter(self.files), None)
        if len(self.files) > 1:
            own = len(self._shared) - 1 - len(PurePath(self.files[0]).suffix)
            shared = self._shared if own > 0 else f"{self.files[0]} and {len(self.files) - 1} more"
        return shared if shared is None or self.window is None else f"{shared} from {self.window[0]:g} s"

    @property
    def label(self) -> str:
        """Short name: its own, the recording's without its folder and ending, or made from the load and the wheels."""
        if self.name is not None:
            return self.name
        if self.file is not None:
            return PurePath(self.file).stem + self._from
        shared = PurePath(self._shared).stem.replace("*", "").strip("_-. ") if self.files else ""
        return (shared or f"{self.load}_{self.kind.replace(' ', '_')}") + self._from

    @property
    def _shared(self) -> str:
        """What the names of its files have in common, a star for the rest."""
        start, end = _shared_beginning(self.files), _shared_beginning([file[::-1] for file in self.files])[::-1]
        return self.files[0] if len(self.files) < 2 else f"{start}*{end}"

    @property
    def _from(self) -> str:
        return "" if self.window is None else f"_{self.window[0]:g}s"

    @property
    def _long_name(self) -> str:
        """Name that says which folder the first of its files is in."""
        path = PurePath(next(iter(self.recording_files), self.label))
        return "_".join([*path.parts[:-1], path.stem]) + self._from

    @property
    def kind(self) -> str:
        """What kind of drop it is, by the wheels that were dropped: ``pitch front``; or just the wheels."""
        return drop_kind(self.wheels, self.excitation)

    @property
    def is_driven(self) -> bool:
        """Whether the vehicle was driven until it vibrated freely, by a push or over a bump: no wheel fell."""
        return self.excitation in {"push", "pass"}

    def with_recording(self, recording: Recording) -> DropTest:
        """Return the drop as it was recorded.

        Parameters
        ----------
        recording
            Its samples, the channels in the order of the campaign's sensors.

        Returns
        -------
        DropTest
        """
        stated = {key.name: getattr(self, key.name) for key in fields(Drop)}
        return DropTest(**stated, recording=recording)


@checked_record
class DropTest(Drop):
    """One release off the blocks, as it is stated, and what was recorded of it; equal where the same is stated."""

    recording: InstanceOf[Recording] = field(compare=False)
    """Its samples; the channels have the order of the campaign's sensors."""


def unique_drop_names(drops: Sequence[Drop]) -> tuple[str, ...]:
    """Return a unique name for every drop of a campaign, as short as possible.

    Parameters
    ----------
    drops
        All of them.

    Returns
    -------
    tuple of str
        In the same order.
    """
    return _make_unique([(drop.label,) if drop.name else (drop.label, drop._long_name) for drop in drops])


def unique_recording_names(drops: Sequence[Drop]) -> tuple[str, ...]:
    """Return a unique name for every drop's recording: the drop's own name, or what its files have in common.

    Parameters
    ----------
    drops
        All of a campaign.

    Returns
    -------
    tuple of str
        In the same order.
    """
    firsts = [(f"{drop.files[0]} and {len(drop.files) - 1} more",) if drop.files[1:] else () for drop in drops]
    return _make_unique(
        [(drop.name or drop.recording_name or drop.label, *first) for drop, first in zip(drops, firsts, strict=True)]
    )


def _make_unique(names: Sequence[Sequence[str]]) -> tuple[str, ...]:
    """Return a unique name for each thing: the first of its names that no other has, otherwise its last one, numbered."""
    occurrences = Counter(name for candidates in names for name in set(candidates))
    unique: dict[str, None] = {}
    for candidates in names:
        name = next((name for name in candidates if occurrences[name] == 1), candidates[-1])
        numbered = itertools.chain([name], (f"{name} ({number})" for number in itertools.count(2)))
        unique[next(name for name in numbered if name not in unique)] = None
    return tuple(unique)


def _shared_beginning(texts: Sequence[str]) -> str:
    alike = [len(set(letters)) == 1 for letters in zip(*texts, strict=False)]
    return texts[0][: (*alike, False).index(False)]
