"""Checksums by which a saved result is known to be as it was written."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

SEALS = "checksums"
"""Key of results.json under which they stand; results written before there were any lack it."""


def document_seal(document: Mapping[str, Any]) -> str:
    """Give the checksum of a document, whatever its order, its spaces and its way to write numbers.

    Parameters
    ----------
    document
        Plain values, as JSON has them; what stands under `SEALS` does not count.

    Returns
    -------
    str
        ``sha256:`` and 64 hexadecimal digits.
    """
    text = json.dumps(_plain({key: value for key, value in document.items() if key != SEALS}), sort_keys=True)
    return f"sha256:{hashlib.sha256(text.encode()).hexdigest()}"


def _plain(value: Any) -> Any:
    # 3 and 3.0 are one number to JSON: a program that writes the document again may choose either.
    match value:
        case bool():
            return value
        case int():
            return float(value)
        case dict():
            return {key: _plain(one) for key, one in value.items()}
        case list() | tuple():
            return [_plain(one) for one in value]
        case _:
            return value


def arrays_seal(arrays: Mapping[str, NDArray[Any]]) -> str:
    """Give the checksum of named arrays: of what they hold, not of how a file packs it.

    Parameters
    ----------
    arrays
        By name, of any shape and unit; of text or numbers.

    Returns
    -------
    str
        ``sha256:`` and 64 hexadecimal digits.
    """
    seal = hashlib.sha256()
    for name, array in sorted(arrays.items()):
        kept = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<"))
        seal.update(f"{name} {kept.dtype.str} {kept.shape}\n".encode())
        seal.update(kept.tobytes())
    return f"sha256:{seal.hexdigest()}"
