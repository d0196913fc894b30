"""WAV files, as sound recorders and some vibration loggers write them."""

from __future__ import annotations

import io
import warnings
from typing import TYPE_CHECKING

import numpy as np

from sprung.errors import InputError, Problem
from sprung.recording.formats.refusals import Allowance, reading
from sprung.recording.formats.table import Table

if TYPE_CHECKING:
    from pathlib import Path


class WavFormat:
    """WAV files of integers or floating-point numbers, any number of channels, called ch1, ch2 and so on."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Claim RIFF files of sound by their ending and first bytes."""
        riff = head[:4] in {b"RIFF", b"RIFX", b"RF64"} and head[8:12] == b"WAVE"
        return riff and path.suffix.lower() in {".wav", ".wave"}

    def read(self, path: Path) -> Table:
        """Read one file; integers become parts of full scale.

        Raises
        ------
        InputError
            If it is damaged or compressed, or holds no samples.
        """
        from scipy.io import wavfile  # noqa: PLC0415 (heavy, and needed only once such a file is met)

        kind = "a WAV file of plain samples"
        with reading(path, kind), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of the chunks that hold no samples
            warnings.filterwarnings("error", message="Reached EOF prematurely")
            # From memory: from a file, it would set aside as much as the header says before it looks.
            rate, samples = wavfile.read(io.BytesIO(path.read_bytes()))
        if not samples.size or not rate:
            found = f"{len(samples)} samples at {rate} Hz"
            raise InputError([Problem(path.name, found, kind, "Copy or export it again.")])
        samples = samples.reshape(len(samples), -1)
        Allowance(path).take(samples.nbytes + 8 * samples.size)
        values = np.array(samples.T, dtype=np.float64, order="C")
        notes: tuple[str, ...] = ()
        if samples.dtype.kind in "iu":
            # Unsigned samples lie around the middle of their range; 24 bits come in the upper ones of 32.
            half = 2.0 ** (8 * samples.dtype.itemsize - 1)
            values -= half if samples.dtype.kind == "u" else 0.0
            values /= half
            notes = ("integers were divided by full scale; a WAV file does not say what full scale is in m/s²",)
        channels = tuple(f"ch{index}" for index in range(1, len(values) + 1))
        return Table(channels, (None,) * len(values), values, float(rate), notes=notes)
