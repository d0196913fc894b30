"""Numbers as people type them: with a decimal point or a decimal comma."""

from __future__ import annotations

import re

_SPACES = re.compile(r"[\s\u00a0\u2009\u202f_'’]")
"""What people write between groups of three digits."""

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)  # TOML has no digits of other scripts


def number_literal(text: str) -> str | None:
    """Return a number as TOML writes it; None if it is none, or could be read in two ways.

    Examples
    --------
    >>> [number_literal(text) for text in ("2,55", "−1.20", "1 194,5", ".5", "1.194,5", "two")]
    ['2.55', '-1.20', '1194.5', '0.5', None, None]
    """
    plain = _SPACES.sub("", text).replace("\u2212", "-")
    if "," in plain and "." in plain:
        return None
    plain = plain.replace(",", ".")
    if not _NUMBER.fullmatch(plain):
        return None
    found = re.fullmatch(r"[+-]?(\d*)(\.?)(\d*)(.*)", plain)
    assert found is not None  # noqa: S101 (it is a number)
    whole, point, fraction, exponent = found.groups()
    sign = "-" if plain.startswith("-") else ""
    return sign + (whole.lstrip("0") or "0") + (f".{fraction or 0}" if point else "") + exponent
