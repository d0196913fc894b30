"""Results that displays are tested with: the campaigns they come from, and whether they are still what the program makes.

They are stored as JSON beside the displays, so that a display depends on nothing but its layout: no processor rounds in it.
"""

from __future__ import annotations

import dataclasses
import json
import math
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeGuard

import sprung
from sprung.campaign import Campaign
from sprung.errors import Fault
from sprung.uncertainty import KnownValue

STORED = Path(__file__).parent / "report"
DATA = Path(__file__).parent / "data"

FOUR = ("empty_bounce", "empty_pitch_front", "empty_roll_left", "loaded_bounce")

_PART_OF_STD, _RELATIVE, _ABSOLUTE = 0.05, 0.02, 1e-4
"""How far a stored number may be off: in its standard uncertainties where it has one, else relative or absolute."""

_NO_RESULT = frozenset(("iterations", "starts_agreeing", "software", "sprung", "checksums"))
"""Keys of what depends on the computer, or on the release, or on the last digit of everything else."""

_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[+-]?\d+)?")


def campaign_of(vehicle: str, *names: str) -> Campaign:
    """Read a campaign of the repository, with only these of its drops, or with all of them."""
    whole = sprung.read(DATA / vehicle)
    drops = (drop for drop in whole.drops if not names or drop.recording.name.removesuffix(".csv") in names)
    return dataclasses.replace(whole, drops=tuple(drops))


def accepted() -> sprung.Result:
    """All drops of the sedan, with nothing said of the model."""
    return sprung.identify(campaign_of("sedan"))


def doubtful() -> sprung.Result:
    """The sedan with a mass that its known load contradicts: it is 1551.8 kg."""
    known = {"total_mass": KnownValue(1600.0, 1.0)}
    return _linear(dataclasses.replace(campaign_of("sedan", *FOUR), known=known))


def rejected() -> sprung.Result:
    """Three drops of a bus whose leaf springs rub, with the linear model asked for."""
    return _linear(campaign_of("leafbus", *FOUR[:3]))


def unidentifiable() -> sprung.Result:
    """Two drops of the empty sedan, nothing weighed; in the first one a wheel's cable was loose."""
    two = campaign_of("sedan", *FOUR[:2])
    fault = Fault(
        "missing",
        "empty_bounce.csv: wheel_fl",
        "1 of 1800 samples are missing, the first in line 502; the channel is left out of this drop",
        "Check the sensor's cable and the logger, or export the recording again.",
    )
    values = two.recordings[0].values.copy()
    values[list(two.recordings[0].channels).index("wheel_fl")] = float("nan")
    recording = dataclasses.replace(two.recordings[0], values=values, faults=(fault,))
    return _linear(two.with_recordings((recording, two.recordings[1])))


def _linear(campaign: Campaign) -> sprung.Result:
    return sprung.identify(campaign, tracks="shared", extras=(), fall=False)


RESULTS: dict[str, Callable[[], sprung.Result]] = {
    "accept": accepted,
    "doubtful": doubtful,
    "reject": rejected,
    "unidentifiable": unidentifiable,
}


def stored_result(name: str) -> sprung.Result:
    """Read a stored result."""
    return sprung.load(STORED / f"{name}.json", series=False)


def regenerate_results() -> None:
    """Identify every campaign and store the results that no longer match; those that do stay as they are, to the last digit."""
    for name, identify in RESULTS.items():
        path, made = STORED / f"{name}.json", identify().to_json()
        if not path.exists() or any(True for _ in differences(json.loads(path.read_text("utf-8")), json.loads(made))):
            path.write_text(made, encoding="utf-8")


def differences(stored: Any, made: Any, where: str = "result", std: float = 0.0) -> Iterator[str]:
    """Name what differs between a stored document and one that was made now, beyond what a processor's rounding may do.

    Parameters
    ----------
    stored, made
        From JSON.
    where
        What they are part of.
    std
        Standard uncertainty of a number; 0 where it has none.

    Yields
    ------
    str
        One sentence for each difference.
    """
    if isinstance(stored, dict) and isinstance(made, dict):
        for key in sorted((stored.keys() | made.keys()) - _NO_RESULT):
            if key not in stored or key not in made:
                yield f"{where}: '{key}' is only in what was {'made' if key in made else 'stored'}"
            else:
                own = stored.get("std" if key in ("value", "interval95") else f"{key}_std")
                yield from differences(stored[key], made[key], f"{where}.{key}", own if _is_number(own) else std)
    elif isinstance(stored, list) and isinstance(made, list) and len(stored) == len(made):
        for i, (one, other) in enumerate(zip(stored, made, strict=True)):
            yield from differences(one, other, f"{where}[{i}]", std)
    elif not _alike(stored, made, std):
        yield f"{where}: {stored} is stored, {made} was made"


def _alike(stored: Any, made: Any, std: float) -> bool:
    if _is_number(stored) and _is_number(made):
        relative, absolute = (0.0, _PART_OF_STD * std) if std else (_RELATIVE, _ABSOLUTE)
        return math.isclose(stored, made, rel_tol=relative, abs_tol=absolute)
    if isinstance(stored, str) and isinstance(made, str):
        return _NUMBER.sub("0", stored) == _NUMBER.sub("0", made)
    return bool(stored == made)


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, int | float) and not isinstance(value, bool)
