"""WAV files, as sound recorders and some vibration loggers write them; SciPy reads them."""

from __future__ import annotations

import warnings
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np

from sprung.formats.reading_errors import input_error, reading
from sprung.formats.sample_store import Store, samples_per_read, store_by_ranges
from sprung.formats.table import SampleTable

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

_KIND = "a WAV file of plain samples"
_SIGNATURES = frozenset((b"RIFF", b"RF64", b"RIFX"))


class WavFormat:
    """WAV files of integers or floating-point numbers; the channels are called ch1, ch2 and so on."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Return whether the file name and the first bytes are those of a WAV file."""
        return head[:4] in _SIGNATURES and head[8:12] == b"WAVE" and path.suffix.lower() in {".wav", ".wave"}

    def read(self, path: Path) -> SampleTable:
        """Read a file; integers are divided by full scale.

        Raises
        ------
        InputError
            If it is damaged or compressed, or holds no samples.
        """
        rate, samples = _read(path)
        if not samples.size or not rate:
            found = f"{len(samples)} samples at {rate} Hz"
            raise input_error(path.name, found, _KIND, "Copy or export it again.")
        note = "integers were divided by full scale; a WAV file does not say what full scale is in m/s²"
        width = samples.shape[1]
        return SampleTable(
            channels=tuple(f"ch{index}" for index in range(1, width + 1)),
            units=(None,) * width,
            store=_store(path, samples),
            clock=float(rate),
            notes=() if samples.dtype.kind == "f" else (note,),
        )


def _read(path: Path) -> tuple[int, NDArray[Any]]:
    """Return the sampling rate, Hz, and the samples, shape (time, channel); mapped from the file where SciPy can do that."""
    from scipy.io import wavfile  # noqa: PLC0415 (needed for WAV files only)

    with reading(path.name, _KIND), warnings.catch_warnings():
        warnings.filterwarnings("error", "Reached EOF prematurely", wavfile.WavFileWarning)
        try:
            rate, samples = wavfile.read(path, mmap=True)
        except ValueError:  # samples of 24 bits, or none at all, cannot be mapped
            rate, samples = wavfile.read(BytesIO(path.read_bytes()))
    return rate, samples if samples.ndim > 1 else samples[:, None]


def _store(path: Path, samples: NDArray[Any]) -> Store:
    """Return a store of the samples; those that can be mapped stay in the file, which is not kept open."""
    in_memory = None if isinstance(samples, np.memmap) else samples
    length, width = samples.shape
    kind, size = samples.dtype.kind, samples.dtype.itemsize
    # SciPy puts integers of fewer bits into the upper ones. Those of 8 bits are unsigned, around the middle of their range.
    full_scale = 1.0 if kind == "f" else 2.0 ** (8 * size - 1)
    middle = full_scale if kind == "u" else 0.0

    def get(columns: Sequence[int], first: int, last: int) -> NDArray[np.float64]:
        source = _read(path)[1] if in_memory is None else in_memory
        with reading(path.name, _KIND):
            values = np.array([source[first:last, column] for column in columns], dtype=np.float64)
            return (values - middle) / full_scale

    return store_by_ranges(width, length, get, samples_per_read(width * size))
