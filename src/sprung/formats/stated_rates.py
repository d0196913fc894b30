"""Rates and sampling intervals that are written above the samples, in the words and units of many loggers."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

TIME_UNITS = {
    **dict.fromkeys(("s", "sec", "sec.", "seconds", "second", "sekunden", "sek"), 1.0),
    **dict.fromkeys(("ms", "msec", "milliseconds", "millisekunden"), 1e-3),
    **dict.fromkeys(("us", "µs", "μs", "usec", "microseconds", "mikrosekunden"), 1e-6),
    **dict.fromkeys(("ns", "nsec", "nanoseconds"), 1e-9),
}
_SAMPLING = r"(?:sampl\w{0,4}|abtast|mess|scan|d?['’ ]?[eé]chantillon\w{0,4}|muestr\w{0,3}|campionamento|amostragem)"
_FREQUENCY = r"(?:rate|fr[eéè][qc]\w{0,8}|tasa)"
_INTERVAL = r"(?:interval\w{0,3}|p[eé]r[ií]od\w{0,2}|time|zeit|step|schritt)"
_OF = r"[ _-]{0,2}(?:d[eia]{0,2}\s)?"
_RATE_WORDS = re.compile(
    rf"(?i)\bf_?s\b|@|{_SAMPLING}{_OF}{_FREQUENCY}|{_FREQUENCY}{_OF}{_SAMPLING}"
    rf"|(?P<step>\b(?:dt|Δt|delta[ _]?t)\b|{_SAMPLING}{_OF}{_INTERVAL}|{_INTERVAL}{_OF}{_SAMPLING}"
    r"|time[ _-]?step|zeitschritt|schrittweite)"
)
_RATE_VALUE = re.compile(
    r"(?i)(?P<between>[^\d\n+-]{0,40}?)(?P<value>\d*[.,]?\d+(?:e[+-]?\d{1,3})?)(?![\d.,:])"
    r"[\s,;\"|]{0,4}(?P<unit>(?:[kM]?Hz|S/s|1/s|sps|m?sec|[mnuµμ]?s)\b)?"
)
_RATE_UNITS = {"hz": 1.0, "khz": 1e3, "mhz": 1e6, "s/s": 1.0, "1/s": 1.0, "sps": 1.0}


@dataclass(frozen=True, slots=True)
class Rate:
    """A rate or a sampling interval written above the samples.

    Attributes
    ----------
    hertz
        Samples per second.
    line
        Where it stands.
    written
        As written in the file.
    """

    hertz: float
    line: int
    written: str


def find_stated_rate(lines: Sequence[str], decimal: str) -> Rate | None:
    """Find a rate or a sampling interval in the lines above the samples.

    Parameters
    ----------
    lines
        Those lines.
    decimal
        The decimal mark of the samples: the other one may be a thousands separator.

    Raises
    ------
    ValueError
        If it may be read in two ways; says what was found.
    """
    for index, line in enumerate(lines):
        words = _RATE_WORDS.search(line)
        value = _RATE_VALUE.match(line, words.end()) if words else None
        if words is None or value is None:
            continue
        unit = (value["unit"] or "").lower()
        if not unit:
            bracketed = re.search(r"[\[(]\s?([^\])]{1,12}?)\s?[\])]", value["between"])
            unit = bracketed[1].lower() if bracketed else ""
        written = f"{value['value']} {value['unit'] or unit}".strip()
        if re.fullmatch(rf"[1-9]\d{{0,2}}[{'.' if decimal == ',' else ','}]\d{{3}}", value["value"]):
            message = f"line {index + 1}|the rate '{written}'"
            raise ValueError(message)
        number = float(value["value"].replace(",", "."))
        number *= TIME_UNITS.get(unit, 1.0) if unit in TIME_UNITS else _RATE_UNITS.get(unit, 1.0)
        is_step = unit in TIME_UNITS or (words["step"] is not None and unit not in _RATE_UNITS)
        hertz = (1 / number if number else 0.0) if is_step else number
        if 0 < hertz < 1e9:
            return Rate(hertz, index + 1, written)
    return None
