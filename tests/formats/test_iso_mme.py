from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sprung.errors import InputError
from sprung.formats.iso_mme import IsoMmeFormat

if TYPE_CHECKING:
    from pathlib import Path

    from sprung.formats import SampleTable

# Key, colon, value, then one number per line: ISO/TS 13499.
CHANNEL = """Test object number          :1
Name of the channel         :{name}
Channel code                :{code}
Unit                        :m/s²
Reference channel           :implicit
Reference channel name      :NOVALUE
Time of first sample        :{first}
Sampling interval           :{interval}
Comments                    :calibrated: 10:32:45
"""


def channel(values: list[float | str], name: str = "a", first: str = "-0.01", interval: str = "0.002") -> str:
    header = CHANNEL.format(name=name, code=f"11{name.upper()}", first=first, interval=interval)
    return header + "\n".join(map(str, values)) + "\n"


def read(folder: Path, *channels: str | bytes, named: str = "test.mme") -> SampleTable:
    (folder / "Channel").mkdir(exist_ok=True)
    (folder / "test.mme").write_text("Data format :ISO-MME\nTime of test :10:32:45\n")
    (folder / "Channel" / "test.chn").write_text(f"Number of channels :{len(channels)}\n")
    for number, content in enumerate(channels, 1):
        data = content if isinstance(content, bytes) else content.encode("cp1252")
        (folder / "Channel" / f"test.{number:03}").write_bytes(data)
    assert IsoMmeFormat().claims(folder / named, b"")
    return IsoMmeFormat().read(folder / named)


@pytest.mark.parametrize("named", ["test.mme", "Channel/test.chn"])
def test_a_test_is_read_exactly(tmp_path: Path, named: str) -> None:
    table = read(tmp_path, channel([1.5, -2e-3, "NOVALUE"], "a"), channel([4, 5, 6], "Stoß"), named=named)
    assert (table.channels, table.units) == (("a", "Stoß"), ("m/s²", "m/s²"))
    assert table.find_non_number(0) is table.find_non_number(1) is None
    np.testing.assert_array_equal(table.take(), [[1.5, -2e-3, np.nan], [4, 5, 6]])
    np.testing.assert_allclose(table.time, [-0.01, -0.008, -0.006], rtol=1e-12)


def test_the_customers_name_comes_first_and_the_code_last(tmp_path: Path) -> None:
    customer = "Customer channel name :body_fl\n" + channel([1, 2])
    plain = channel([1, 2]).replace("Name of the channel         :a\n", "")
    assert read(tmp_path, customer, plain).channels == ("body_fl", "11A")


def test_a_channel_of_times_is_the_clock_of_those_that_refer_to_it(tmp_path: Path) -> None:
    times = "Channel code :11TIME\nUnit :ms\n0\n2\n5\n"
    values = "Channel code :11ACC\nReference channel :explicit\nReference channel name :11TIME\n7\n8\n9\n"
    table = read(tmp_path, times, values)
    assert table.channels == ("11ACC",)
    np.testing.assert_allclose(table.time, [0, 0.002, 0.005])


@pytest.mark.parametrize("other", [channel([1, 2, 3], "z", interval="0.001"), channel([1, 2], "z")])
def test_a_channel_with_another_clock_is_left_out_and_named(tmp_path: Path, other: str) -> None:
    table = read(tmp_path, channel([1, 2, 3], "a"), channel([4, 5, 6], "b"), other)
    assert table.find_non_number(0) is table.find_non_number(1) is None
    assert str(table.find_non_number(2)).startswith("test.003: z: found")
    assert np.isnan(table.take()[2]).all()


def test_text_among_the_samples_spoils_its_channel(tmp_path: Path) -> None:
    table = read(tmp_path, channel([1, "oops", 3], "a"), channel([4, 5, 6], "b"))
    assert str(table.find_non_number(0)).startswith("test.001: line 11: found 'oops'; expected a number.")


@pytest.mark.parametrize(
    ("channels", "words"),
    [
        ((), "no channel files"),
        ((channel([1, 2], interval="NOVALUE"),), "no channel with a sampling interval"),
        ((channel([1, 2], interval="fast"), channel([1], first="x")), "test.001: sampling interval: found 'fast'"),
        ((channel([1, 2], interval="-1"),), "found -1 s; expected a positive number"),
        ((b"\xff\xfea",), "marked as UTF-16 with invalid text"),
    ],
)
def test_what_is_no_test_is_refused(tmp_path: Path, channels: tuple[str | bytes, ...], words: str) -> None:
    with pytest.raises(InputError) as error:
        read(tmp_path, *channels)
    assert words in str(error.value)


VALID = channel([1.5, -2e-3, "NOVALUE", 7]).encode()


@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], max_examples=150, deadline=10_000
)
@given(
    content=st.one_of(
        st.binary(max_size=200),
        st.tuples(st.integers(0, len(VALID)), st.integers(0, 40), st.binary(max_size=20)).map(
            lambda cut: VALID[: cut[0]] + cut[2] + VALID[cut[0] + cut[1] :]
        ),
    )
)
def test_any_bytes_are_read_or_refused(tmp_path: Path, content: bytes) -> None:
    try:
        table = read(tmp_path, content)
        values = table.take()
    except InputError:
        return
    assert values.shape == (len(table.channels), len(table.time))
