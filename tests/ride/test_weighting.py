"""The weightings of ISO 2631-1 at the frequencies of its tables 3 and 4."""

from __future__ import annotations

import numpy as np
import pytest

from sprung.ride import Weighting, frequency_weighting

TABLES: dict[Weighting, str] = {
    "W_k": """
        0.1 31.2; 0.125 48.6; 0.16 79; 0.2 121; 0.25 182; 0.315 263; 0.4 352; 0.5 418; 0.63 459; 0.8 477; 1 482; 1.25
        484; 1.6 494; 2 531; 2.5 631; 3.15 804; 4 967; 5 1039; 6.3 1054; 8 1036; 10 988; 12.5 902; 16 768; 20 636; 25
        513; 31.5 405; 40 314; 50 246; 63 186; 80 132; 100 88.7; 125 54; 160 28.5; 200 15.2; 250 7.9; 315 3.98; 400
        1.95
    """,
    "W_d": """
        0.1 62.4; 0.125 97.3; 0.16 158; 0.2 243; 0.25 365; 0.315 530; 0.4 713; 0.5 853; 0.63 944; 0.8 992; 1 1011;
        1.25 1008; 1.6 968; 2 980; 2.5 776; 3.15 642; 4 512; 5 409; 6.3 323; 8 253; 10 212; 12.5 161; 16 125; 20 100;
        25 80; 31.5 63.2; 40 49.4; 50 38.8; 63 29.5; 80 21.1; 100 14.1; 125 8.63; 160 4.55; 200 2.43; 250 1.26; 315
        0.64; 400 0.31
    """,
    "W_f": """
        0.02 24.2; 0.025 37.7; 0.0315 59.7; 0.04 97.1; 0.05 157; 0.063 267; 0.08 461; 0.1 695; 0.125 895; 0.16 1006;
        0.2 992; 0.25 854; 0.315 619; 0.4 384; 0.5 224; 0.63 116; 0.8 53; 1 23.5; 1.25 9.98; 1.6 3.77; 2 1.55; 2.5
        0.64; 3.15 0.25; 4 0.097
    """,
    "W_c": """
        0.1 62.4; 0.125 97.2; 0.16 158; 0.2 243; 0.25 364; 0.315 527; 0.4 708; 0.5 843; 0.63 929; 0.8 972; 1 991; 1.25
        1000; 1.6 1007; 2 1012; 2.5 1017; 3.15 1022; 4 1024; 5 1013; 6.3 974; 8 891; 10 776; 12.5 647; 16 512; 20 409;
        25 325; 31.5 256; 40 199; 50 156; 63 118; 80 84.4; 100 56.7; 125 34.5; 160 18.2; 200 9.71; 250 5.06; 315 2.55;
        400 1.25
    """,
    "W_e": """
        0.1 62.5; 0.125 97.5; 0.16 159; 0.2 245; 0.25 368; 0.315 536; 0.4 723; 0.5 862; 0.63 939; 0.8 941; 1 880; 1.25
        772; 1.6 632; 2 512; 2.5 409; 3.15 323; 4 253; 5 202; 6.3 160; 8 125; 10 100; 12.5 80.1; 16 62.5; 20 50; 25
        39.9; 31.5 31.6; 40 24.7; 50 19.4; 63 14.8; 80 10.5; 100 7.07; 125 4.31; 160 2.27; 200 1.21; 250 0.63; 315
        0.32; 400 0.16
    """,
    "W_j": """
        0.1 31; 0.125 48.3; 0.16 78.5; 0.2 120; 0.25 181; 0.315 262; 0.4 351; 0.5 417; 0.63 458; 0.8 478; 1 484; 1.25
        485; 1.6 483; 2 482; 2.5 489; 3.15 524; 4 628; 5 793; 6.3 946; 8 1017; 10 1030; 12.5 1026; 16 1018; 20 1012;
        25 1007; 31.5 1001; 40 991; 50 972; 63 931; 80 843; 100 708; 125 539; 160 364; 200 243; 250 158; 315 100; 400
        62.4
    """,
}
"""Frequency, Hz, and thousand times the factor: ISO 2631-1:1997, tables 3 and 4, as the public data set baby-vibration
(mechmotum) has them. Computed at the nominal frequencies, printed to three figures or to whole thousandths, some of them cut
off there (W_k at 16 Hz: 768.7 as 768)."""

SLIPS = {("W_d", 2.0): 890.0, ("W_d", 10.0): 202.0}
"""Where the factor and the level in dB of one row contradict each other: the factor of the level, 1.01 dB being -1.01 dB."""


def last_place(factor: float) -> float:
    """Last place of a printed factor: whole thousandths, or three figures, two below one."""
    return 1.0 if factor >= 100 else 0.1 if factor >= 10 else 0.01 if factor >= 0.1 else 0.001


@pytest.mark.parametrize("name", TABLES)
def test_factors_are_those_of_the_tables_to_the_last_place(name: Weighting) -> None:
    rows = [tuple(map(float, row.split())) for row in TABLES[name].split(";")]
    assert len(rows) >= 24
    for frequency, factor in rows:
        printed = SLIPS.get((name, frequency), factor)
        found = 1000 * abs(frequency_weighting(name, frequency))
        assert abs(found - printed) < last_place(printed), (frequency, found, printed)


def test_rail_weighting_is_unity_where_it_is_largest() -> None:
    """W_b (ISO 2631-4:2001): 1.024 makes the gain one near 8 Hz within a tenth, and it falls on both sides."""
    f = np.geomspace(0.5, 80, 400)
    gain = np.abs(frequency_weighting("W_b", f))
    top = f[np.argmax(gain)]
    assert 5 < top < 12
    assert gain.max() == pytest.approx(1.0, abs=0.1)
