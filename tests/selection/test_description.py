"""Every model term is stated in one sentence, with its size and standard error, where it is significant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from sprung.estimation import FitStatistics
from sprung.selection import SEPARATE_TRACKS, TERMS, describe_terms
from sprung.vehicle import EXTRAS, NEUTRAL, Tracks, Vehicle, parameter_names

CAR = Vehicle(
    m_s=1000, I_yy=1800, I_xx=400, m_uf=40, m_ur=40, a=1.2, b=1.4, t_f=0.7, t_r=0.7,
    k_sf=20e3, k_sr=20e3, k_tf=2e5, k_tr=2e5, c_sf=1500, c_sr=1500,
)  # fmt: skip


@dataclass
class Fit:
    """A fit with known values and standard errors, without correlation."""

    values: dict[str, float]
    stds: dict[str, float]

    def statistics(self, terms: tuple[str, ...], tracks: Tracks) -> FitStatistics:
        names = parameter_names(tracks, terms)
        own = CAR.parameters
        values = np.array([self.values.get(name, own.get(name, NEUTRAL.get(name, 0.7))) for name in names])
        variances = np.array([self.stds.get(name, 0.0) for name in names]) ** 2
        slopes = np.where(values == 0, 1.0, values)
        nothing = np.zeros(0)
        return FitStatistics(
            names=names, values=values, slopes=slopes, relative_covariance=np.diag(variances / slopes**2),
            covariance=np.diag(variances), undetermined=np.zeros((len(names), 0)), noise=nothing, residual=nothing,
            inflation=1.0, residuals=(), contradictions={}, loglikelihood=0.0, iterations=1, converged=True,
            starts_agreeing=1, starts=1,
        )  # fmt: skip


def sentence(
    terms: tuple[str, ...], values: dict[str, float], stds: dict[str, float], tracks: Tracks = "shared"
) -> str:
    described = (SEPARATE_TRACKS, *terms) if tracks == "separate" else terms
    return describe_terms([TERMS[name].description for name in described], Fit(values, stds).statistics(terms, tracks))


PHRASES: dict[str, tuple[dict[str, float], float, str]] = {
    "friction": (
        {"F_f": 41.0, "F_r": 38.2},
        2.0,
        "dry friction of 41 ± 2 N at each front wheel and 38 ± 2 N at each rear wheel",
    ),
    "uneven-friction": (
        {"d_Ff": 20.0, "d_Fr": -9.0},
        1.0,
        (
            "dry friction of the left front wheel that is 20 ± 1 N above the mean of both sides "
            "and -9 ± 1 N of the left rear wheel"
        ),
    ),
    "rebound": (
        {"r_f": 2.4, "r_r": 1.9},
        0.13,
        "front dampers 2.4 ± 0.1 times as stiff in rebound as in compression and rear ones 1.9 ± 0.1 times",
    ),
    "anti-roll": (
        {"k_af": 12e3, "k_ar": 6e3},
        30.0,
        "a front anti-roll bar of 12.00 ± 0.03 N/mm and a rear one of 6.00 ± 0.03 N/mm",
    ),
    "tyre-damping": (
        {"c_tf": 121.0, "c_tr": 104.0},
        5.0,
        "tyre damping of 121 ± 5 N s/m at each front wheel and 104 ± 5 N s/m at each rear wheel",
    ),
    # Of 2 (20 + 20) kN/m 0.49 m² = 39 200 N m.
    "gravity": ({"w_h": 1960.0}, 39.2, "gravity that takes 5.0 ± 0.1 % off the roll stiffness of the springs"),
    # 2 x 500 N/m of 20 kN/m.
    "asymmetry": ({"d_ksf": 500.0}, 20.0, "left and right sides that differ by up to 5.0 ± 0.2 %"),
    "rigid-axle": (
        {"n_r": 0.7, "n_f": 1.0},
        0.01,
        "a rigid rear axle with its springs at 0.70 ± 0.01 of the half-distance of its wheels",
    ),
    "engine": ({"m_e": 152.0}, 4.0, "an engine of 152 ± 4 kg that moves on its mounts"),
    "uneven-occupants": (
        {"d_mo": -12.0, "d_ko": 1e4},
        1.0,
        "people on the left and on the right who differ by 24 ± 2 kg, on seats whose rates differ by 20.00 ± 0.01 N/mm",
    ),
    "progressive": (
        {"p_f": 4.0, "p_r": -3.0},
        0.2,
        "front springs whose rate grows by 20 ± 1 % over 5 cm of compression and rear ones by -15 ± 1 %",
    ),
    "bump-stop": (
        {"k_bf": 50e3, "x_bf": 0.021, "k_br": 40e3, "x_br": 0.03},
        0.001,
        (
            "front bump stops of 50.00 ± 0.01 N/mm, met after 21 ± 1 mm of compression "
            "and rear ones of 40.00 ± 0.01 N/mm, met after 30 ± 1 mm"
        ),
    ),
}  # fmt: skip
"""Values and their standard error, and what is to be said of them."""


@pytest.mark.parametrize("term", PHRASES)
def test_a_term_is_stated_with_its_size_and_its_standard_error(term: str) -> None:
    values, std, phrase = PHRASES[term]
    said = sentence((term,), values, dict.fromkeys(values, std))
    assert said == f"Besides springs and dampers the recordings show {phrase} (± one standard error)."


def test_every_term_has_words_for_what_it_is() -> None:
    assert set(EXTRAS) <= TERMS.keys()
    for term in TERMS.values():
        assert term.description.text
        assert ("{axle}" in term.description.text) is bool(term.description.again)


def test_several_terms_are_one_sentence_and_what_is_not_there_is_not_in_it() -> None:
    values, stds = {"F_f": 41.0, "F_r": 3.0, "r_f": 2.4, "r_r": 1.1}, {"F_f": 2.0, "F_r": 2.0, "r_f": 0.1, "r_r": 0.1}
    assert sentence(("friction", "rebound"), values, stds) == (
        "Besides springs and dampers the recordings show dry friction of 41 ± 2 N at each front wheel; front dampers 2.4 ± 0.1 "
        "times as stiff in rebound as in compression (± one standard error)."
    )
    assert not sentence((), {}, {})
    assert not sentence(("friction",), {"F_f": 1.0, "F_r": 1.0}, {"F_f": 1.0, "F_r": 1.0})


def test_separate_half_distances_are_stated() -> None:
    places = {"t_f1": 0.63, "t_f2": 0.7, "t_r1": 0.56, "t_r2": 0.7}
    assert "front dampers at 0.90 ± 0.01 times the half-distance of the springs and rear ones at 0.80 ± 0.01 times" in (
        sentence((), places, dict.fromkeys(places, 0.006), "separate")
    )


def test_the_standard_error_follows_from_all_parameters() -> None:
    # c_t / c_s is not stated, but places are: the ratio 0.9 of two lengths with 1 % each has 1.4 %.
    places = {"t_f1": 0.63, "t_f2": 0.7, "t_r1": 0.63, "t_r2": 0.7}
    said = sentence((), places, {name: 0.01 * value for name, value in places.items()}, "separate")
    assert "0.90 ± 0.01" in said
