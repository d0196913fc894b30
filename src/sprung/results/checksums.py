"""Checksums of a saved result: they detect every change since it was written."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

CHECKSUMS = "checksums"
"""Key of the checksums in results.json."""


def document_checksum(document: Mapping[str, Any]) -> str:
    """Return the checksum of a document, independent of the order of keys, of spaces and of 1 or 1.0.

    Parameters
    ----------
    document
        Plain values, as JSON has them, without the key `CHECKSUMS`.

    Returns
    -------
    str
        ``sha256:`` and 64 hexadecimal digits.
    """
    text = json.dumps(_with_floats(document), sort_keys=True)
    return f"sha256:{hashlib.sha256(text.encode()).hexdigest()}"


def _with_floats(value: Any) -> Any:
    # 3 and 3.0 are one number to JSON: a program that writes the document again may choose either.
    match value:
        case bool():
            return value
        case int():
            return float(value)
        case Mapping():
            return {key: _with_floats(item) for key, item in value.items()}
        case list() | tuple():
            return [_with_floats(item) for item in value]
        case _:
            return value


def arrays_checksum(arrays: Mapping[str, NDArray[Any]]) -> str:
    """Return the checksum of named arrays: of their content, not of how a file compresses it.

    Parameters
    ----------
    arrays
        By name, of any shape and unit; of text or numbers.

    Returns
    -------
    str
        ``sha256:`` and 64 hexadecimal digits.
    """
    checksum = hashlib.sha256()
    for name, array in sorted(arrays.items()):
        portable = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<"))
        checksum.update(f"{name} {portable.dtype.str} {portable.shape}\n".encode())
        checksum.update(portable.tobytes())
    return f"sha256:{checksum.hexdigest()}"
