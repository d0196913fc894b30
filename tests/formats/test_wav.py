from __future__ import annotations

import io
import struct
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.io import wavfile

from sprung.errors import InputError
from sprung.formats import SampleTable
from sprung.formats.wav import WavFormat

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

SAMPLES = np.random.default_rng(4).uniform(-1, 1, size=(40, 3))


def sound(samples: NDArray[Any], rate: int = 2000) -> bytes:
    stream = io.BytesIO()
    wavfile.write(stream, rate, samples)
    return stream.getvalue()


def read(folder: Path, content: bytes) -> SampleTable:
    path = folder / "x.wav"
    path.write_bytes(content)
    assert WavFormat().claims(path, content[:8192])
    return WavFormat().read(path)


@pytest.mark.parametrize("kind", [np.float32, np.float64])
@pytest.mark.parametrize("channels", [1, 3])
def test_floating_point_comes_back_as_it_was(tmp_path: Path, kind: type[np.floating[Any]], channels: int) -> None:
    samples = SAMPLES[:, :channels].astype(kind)
    result = read(tmp_path, sound(samples))
    np.testing.assert_array_equal(result.take(), samples.T)
    assert result.channels == ("ch1", "ch2", "ch3")[:channels]
    assert result.units == (None,) * channels
    assert result.clock == 2000
    assert result.notes == ()


@pytest.mark.parametrize(
    ("kind", "lowest", "middle", "highest"),
    [(np.uint8, 0, 128, 255), (np.int16, -(2**15), 0, 2**15 - 1), (np.int32, -(2**31), 0, 2**31 - 1)],
)
def test_integers_are_parts_of_full_scale(tmp_path: Path, kind: Any, lowest: int, middle: int, highest: int) -> None:
    result = read(tmp_path, sound(np.array([lowest, middle, highest], dtype=kind)))
    # One step below 1 is the largest: the ranges of integers are not symmetric.
    np.testing.assert_array_equal(result.take(), [[-1, 0, 1 - 1 / (highest - middle + 1)]])
    assert "full scale" in result.notes[0]


def test_24_bits_are_parts_of_full_scale_too(tmp_path: Path) -> None:
    samples = b"".join(value.to_bytes(3, "little", signed=True) for value in (-(2**23), 0, 2**22))
    form = struct.pack("<HHIIHH", 1, 1, 500, 1500, 3, 24)
    chunks = b"fmt " + struct.pack("<I", 16) + form + b"data" + struct.pack("<I", 9) + samples + b"\0"
    result = read(tmp_path, b"RIFF" + struct.pack("<I", 4 + len(chunks)) + b"WAVE" + chunks)
    np.testing.assert_array_equal(result.take(), [[-1, 0, 0.5]])


def test_other_chunks_are_passed_over(tmp_path: Path) -> None:
    content = sound(SAMPLES)
    extra = b"LIST" + struct.pack("<I", 4) + b"INFO" + b"odd!" + struct.pack("<I", 4) + b"abcd"
    result = read(tmp_path, content[:4] + struct.pack("<I", len(content) + len(extra) - 8) + content[8:] + extra)
    np.testing.assert_array_equal(result.take(), SAMPLES.T)


@pytest.mark.parametrize("keep", [60, 100, 500])
def test_a_cut_file_is_refused(tmp_path: Path, keep: int) -> None:
    with pytest.raises(InputError, match=r"x\.wav: found a damaged file .*; expected a WAV file of plain samples"):
        read(tmp_path, sound(SAMPLES)[:keep])


def test_no_samples_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="0 samples at 2000 Hz"):
        read(tmp_path, sound(SAMPLES[:0, 0]))


def test_claims_by_ending_and_first_bytes(tmp_path: Path) -> None:
    assert not WavFormat().claims(tmp_path / "x.mp3", sound(SAMPLES))
    assert not WavFormat().claims(tmp_path / "x.wav", b"RIFF....AVI ")
    assert not WavFormat().claims(tmp_path / "x.wav", b"")


@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], max_examples=100, deadline=None
)
@given(data=st.data(), kind=st.sampled_from([np.uint8, np.int16, np.float64]))
def test_damage_is_refused_or_harmless(tmp_path: Path, data: st.DataObject, kind: Any) -> None:
    raw = bytearray(sound((100 * SAMPLES).astype(kind)))
    for place in data.draw(st.lists(st.integers(0, 80), max_size=4)):
        raw[place] = data.draw(st.integers(0, 255))
    path = tmp_path / "x.wav"
    path.write_bytes(raw[: data.draw(st.integers(0, len(raw)) | st.just(len(raw)))])
    try:
        result = WavFormat().read(path)
        values = result.take()
    except InputError as error:
        assert all(problem.where.startswith(path.name) for problem in error.problems)  # noqa: PT017
    else:
        assert values.shape == (len(result.channels), len(result.time))


def test_a_number_that_warns_wherever_it_is_used(tmp_path: Path) -> None:
    samples = np.frombuffer(struct.pack("<3I", 0x7FA00000, 0, 0x3F800000), "<f4")  # a signalling NaN, 0 and 1
    np.testing.assert_array_equal(read(tmp_path, sound(samples)).take(), [[np.nan, 0, 1]])
