from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from spoiling import Spoiling, read_or_refused, spoilings
from sprung.errors import InputError
from sprung.formats.rpc import RpcFormat

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from sprung.formats import SampleTable

RAW = np.random.default_rng(4).integers(-32000, 32000, size=(2, 3, 64))  # (group, channel, time)


def content(dtype: str = "<i2", **changes: Any) -> bytes:
    """Write a file by the description of the format, without any library."""
    keys: dict[str, str | None] = {"FORMAT": "BINARY_IEEE_LITTLE_END", "NUM_HEADER_BLOCKS": "8", "NUM_PARAMS": "24"}
    keys |= {"FILE_TYPE": "TIME_HISTORY", "TIME_TYPE": "RESPONSE", "DATA_TYPE": "SHORT_INTEGER", "CHANNELS": "3"}
    keys |= {"DELTA_T": "4.882813E-04", "PTS_PER_FRAME": "32", "PTS_PER_GROUP": "64", "FRAMES": "4"}
    for channel, unit in enumerate(("g", "m/s^2", ""), 1):
        keys |= {f"DESC.CHAN_{channel}": f"a{channel}", f"UNITS.CHAN_{channel}": unit}
        keys |= {f"SCALE.CHAN_{channel}": f"{channel}E-3"}
    written = {key: value for key, value in (keys | changes).items() if value is not None}
    records = [f"{key:\0<32}{value:\0<96}".encode() for key, value in written.items()]
    return b"".join(records).ljust(8 * 512, b"\0") + RAW.astype(dtype).tobytes()


def read(folder: Path, written: bytes) -> SampleTable:
    path = folder / "x.rsp"
    path.write_bytes(written)
    assert RpcFormat().claims(path, written[:8192])
    return RpcFormat().read(path)


def samples() -> NDArray[np.float64]:
    return RAW.swapaxes(0, 1).reshape(3, 128).astype(float)


@pytest.mark.parametrize(
    ("form", "dtype"), [("BINARY_IEEE_LITTLE_END", "<i2"), ("BINARY", "<i2"), ("BINARY_IEEE_BIG_END", ">i2")]
)
def test_integers_are_scaled_in_double_precision(tmp_path: Path, form: str, dtype: str) -> None:
    table = read(tmp_path, content(dtype, FORMAT=form))
    assert table.channels == ("a1", "a2", "a3")
    assert table.units == ("g", "m/s^2", None)
    assert table.clock == 2048.0  # 1/4.882813e-4 is 2047.99979
    np.testing.assert_allclose(table.take(), samples() * [[1e-3], [2e-3], [3e-3]], rtol=1e-15)


def test_floats_are_not_scaled(tmp_path: Path) -> None:
    table = read(tmp_path, content("<f4", DATA_TYPE="FLOATING_POINT"))
    np.testing.assert_array_equal(table.take(), samples())


@pytest.mark.parametrize(
    ("step", "rate"), [("0.0005", 2000), ("0.0006", 1 / 0.0006), ("1E-3", 1000), ("0.00048828125", 2048)]
)
def test_the_rate_that_a_step_means(tmp_path: Path, step: str, rate: float) -> None:
    assert read(tmp_path, content(DELTA_T=step)).clock == pytest.approx(rate, rel=1e-15)


def test_the_last_group_may_be_half_full(tmp_path: Path) -> None:
    np.testing.assert_array_equal(read(tmp_path, content(FRAMES="3")).take()[0], 1e-3 * samples()[0, :96])
    np.testing.assert_array_equal(read(tmp_path, content(SAMPLES="70")).take()[0], 1e-3 * samples()[0, :70])


def test_names_that_do_not_tell_apart(tmp_path: Path) -> None:
    table = read(tmp_path, content("<i2", **{"DESC.CHAN_1": "z", "DESC.CHAN_2": "z", "DESC.CHAN_3": None}))
    assert table.channels == ("z (channel 1)", "z (channel 2)", "channel 3")


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("FORMAT", "ASCII", "header FORMAT: found 'ASCII'"),
        ("DATA_TYPE", "DOUBLE", "header DATA_TYPE: found 'DOUBLE'"),
        ("FILE_TYPE", "HISTOGRAM", "header FILE_TYPE: found 'HISTOGRAM'"),
        ("CHANNELS", None, "header CHANNELS: found nothing; expected a whole number, 1 or more"),
        ("CHANNELS", "-3", "header CHANNELS: found '-3'"),
        ("CHANNELS", "30000000", r"found 1536 of the \d+ bytes|found 768 of the \d+ bytes"),
        ("FRAMES", "1e300", "header FRAMES: found '1e300'"),
        ("DELTA_T", "0", "header DELTA_T"),
        ("DELTA_T", "NaN", "header DELTA_T: found 'NaN'"),
        ("SCALE.CHAN_2", "x", r"header SCALE\.CHAN_2: found 'x'; expected a number"),
        ("NUM_HEADER_BLOCKS", "400", "bytes of its header"),
    ],
)
def test_what_is_wrong_with_a_header(tmp_path: Path, key: str, value: str | None, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read(tmp_path, content("<i2", **{key: value}))


@pytest.mark.parametrize("kind", [int, float])
def test_against_another_library(tmp_path: Path, kind: type) -> None:
    rpc3 = pytest.importorskip("rpc3")
    rpc3.rpc3.progressbar = False
    values = np.random.default_rng(5).normal(size=(3, 200))
    path = tmp_path / "x.rsp"
    channels = [rpc3.Channel(f"a{i}", "g", 1 / 2048, row) for i, row in enumerate(values)]
    rpc3.write(str(path), channels, datatype=kind, pts_per_group=64)
    table, (theirs, _) = RpcFormat().read(path), rpc3.read(str(path))
    assert table.channels == tuple(channel.name for channel in theirs)
    assert table.clock == 2048.0
    # It rounds to single precision; integers have 16 bits over the largest value.
    np.testing.assert_allclose(table.take(), [channel.data for channel in theirs], rtol=1e-7, atol=0)
    resolution = {int: np.abs(values).max() / 32752, float: 1e-6}[kind]
    np.testing.assert_allclose(table.take(), values, rtol=0, atol=resolution)


@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], max_examples=200, deadline=None
)
@given(spoiling=spoilings(until=0.7))
def test_whatever_happens_to_a_file(tmp_path: Path, spoiling: Spoiling) -> None:
    path = tmp_path / "x.rsp"
    path.write_bytes(spoiling.of(content()))
    read_or_refused(RpcFormat(), path)
