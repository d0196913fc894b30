"""Errors in the printed paper, each with the reason; numbers in reasons are computed here."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sprung.display import shown
from sprung.paper.printed import K_ID_FRONT_RIGHT_WHEEL, TABLE_2, TABLE_3
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, Added, Load
from sprung.vibration import Mode, compute_modes, paper_name

BUS_LOAD = Load(name="loaded", added=Added(mass=470, I_yy=1057.5, I_xx=339.6))
"""The load of the paper's experiment, section 4.1: on the body alone."""


@shown
@dataclass(frozen=True, slots=True)
class Misprint:
    """An error in the printed paper.

    Attributes
    ----------
    where
        Equation, table or section.
    printed
        Printed text.
    should_be
        Correct text.
    reason
        Reason.
    computed
        Whether the reason rests on numbers that are computed here, or else on reading. The paper was available as recognised
        text, in which a letter may be misread.
    """

    where: str
    printed: str
    should_be: str
    reason: str
    computed: bool = False


def find_misprints() -> tuple[Misprint, ...]:
    """Return the paper's misprints in the order of its pages.

    Returns
    -------
    tuple of Misprint
    """
    return (*_equations(), *_simulation(), *_experiment())


def table_2_misfits() -> dict[str, float]:
    """Return the rows of Table 2 whose printed error does not follow from the printed values within rounding.

    Returns
    -------
    dict
        By parameter: error that follows from the printed values, %.
    """
    misfits = {}
    for name, (known, identified, printed) in TABLE_2.items():
        digits = 2 if known > 10 else 3
        rounding = 100 * 0.5 * 10.0**-digits / known + 0.001
        error = 100 * (identified / known - 1)
        if abs(error - printed) > rounding * (1 + 1e-9):
            misfits[name] = error
    return misfits


def table_3_misfits() -> dict[str, float]:
    """Return the rows of Table 3 in which f_d = f_n √(1 - ζ²) does not hold within rounding.

    Returns
    -------
    dict
        By mode: damped frequency that follows from the printed f_n and ζ, Hz.
    """
    misfits = {}
    for name, row in TABLE_3.items():
        damped = row.natural_frequency * np.sqrt(1 - row.damping_ratio**2)
        rounding = 1e-4 + row.natural_frequency * row.damping_ratio * 0.5e-4
        if abs(damped - row.damped_frequency) > rounding:
            misfits[name] = float(damped)
    return misfits


def _equations() -> Iterator[Misprint]:
    K = TABLE_1_CAR.matrices().K
    yield Misprint(
        "section 2.1",
        "z_ai, displacement of ground input",
        "z_gi",
        "The force F of eq. (2) and section 3 write z_gA to z_gD; section 3 has another z_aD.",
    )
    yield Misprint(
        "eq. (2), C",
        "a matrix that breaks off in its first row",
        "K with c for k, t_f1 and t_r1 for t_f2 and t_r2, and no tyres",
        "Dampers act on the same rows as springs; section 2.1 gives them half-distances of their own.",
    )
    yield Misprint(
        "eq. (2), K, rows 4 and 7",
        "six entries each",
        "seven: one more zero between the wheels",
        "K is 7 by 7: each wheel has one zero for each of the three others.",
    )
    yield Misprint(
        "eq. (2), K, row 5",
        "-k_sr, -b k_sr, ...",
        "-k_sf, a k_sf, ...",
        "Wheel B is a front wheel and K is symmetric: with Table 1 its column 5 begins "
        f"{K[0, 4]:.0f}, {K[1, 4]:.0f} N, the printed row {-TABLE_1_CAR.k_sr:.0f}, "
        f"{-TABLE_1_CAR.b * TABLE_1_CAR.k_sr:.0f} N.",
        computed=True,
    )
    yield Misprint(
        "eq. (2), K, row 3",
        "t_r2 k_cr",
        "t_r2 k_sr",
        "No k_cr is defined, and the entry left of it is -t_r2 k_sr.",
    )
    yield _transition()
    yield Misprint(
        "eqs. (8) and (10)",
        "Φ̄ is an error matrix",
        "Φ̃ is an error matrix",
        "Eq. (8) adds Φ̃; Φ̄ is the matrix of later states, eq. (9). With Φ̄ the errors that least squares leaves, Φ̄Φᵀ "
        "is zero and so is A₁ by eq. (10).",
    )
    yield Misprint(
        "eqs. (9), (11) and (14)",
        "Φ for the states, one eigenvector and all eigenvectors",
        "three symbols",
        "Eq. (10) means the states, eq. (12) the eigenvectors' upper halves.",
    )
    yield Misprint(
        "eqs. (11), (13) and (14)",
        "i = 1, 2, ..., 7, and conjugates in eq. (12)",
        "i = 1, 2, ..., 14 wherever poles are real",
        "A is 14 by 14. Seven poles and their conjugates are all of it only while no mode is overdamped.",
    )
    yield Misprint(
        "section 2.2, after eqs. (14), (15) and (18)",
        "M, C and K by solving (3)",
        "(4), or (16) and A22 = -M⁻¹C",
        "Eq. (3) is the equation of motion Ẏ = A Y; what A holds stands in eq. (4).",
    )
    yield _unknowns()


def _transition() -> Misprint:
    """Eq. (7) holds for {X, Ẋ}; the state of eq. (6) is {X(k), X(k+1)}."""
    step = 0.01
    pole = compute_modes(TABLE_1_CAR.matrices())[0].pole
    z = np.exp(pole * step)
    return Misprint(
        "eqs. (6), (7) and (11)",
        "A₁ = exp(A ΔT), and Φ_i = P_i",
        "A₁ = T exp(A ΔT) T⁻¹; Φ_i is the upper half of P_i",
        "Eq. (6) makes the state of X twice, eq. (3) of X and Ẋ: A₁ and exp(A ΔT) share eigenvalues, not eigenvectors. "
        f"The lower half is z times the upper one in P, λ times in A's: {z:.3f} and {pole:.3f} for the Table 1 car's "
        f"body bounce at ΔT = {1e3 * step:.0f} ms.",
        computed=True,
    )


def _unknowns() -> Misprint:
    """One state gives M up to a factor: K = -M A₂₁ is symmetric, so m_i A_ij = m_j A_ji."""
    A21 = TABLE_1_CAR.matrices().state[7:, :7]
    equations = []
    for i, j in np.argwhere(np.triu(np.abs(A21) > 1e-9 * np.abs(A21).max(), 1)).tolist():
        row = np.zeros(7)
        row[i], row[j] = A21[i, j], -A21[j, i]
        equations.append(row / np.abs(row).max())
    rank = int(np.linalg.matrix_rank(np.array(equations), tol=1e-9))
    return Misprint(
        "section 2.2, after eq. (14)",
        "fewer equations than unknowns without the added mass",
        "one equation too few",
        f"K is symmetric and M diagonal: m_i A_ij = m_j A_ji has rank {rank} in the 7 masses, so {7 - rank} number is "
        "missing, their common factor. A weighing gives it as well as an added mass does.",
        computed=True,
    )


def _simulation() -> Iterator[Misprint]:
    first, last = (0.09 * np.sin(5 * np.pi * t) for t in (0.1, 0.3))
    yield Misprint(
        "eq. (19)",
        "0.09 sin(5πt) for 0.1 ≤ t ≤ 0.3",
        "0.09 sin(5π(t - 0.1))",
        f"As printed the ground jumps to {first:.2f} m at 0.1 s and comes back from {last:.2f} m at 0.3 s; a half-sine "
        "bump begins and ends at 0.",
        computed=True,
    )
    yield Misprint(
        "section 3",
        "z_gB and z_aD both are zero function",
        "z_gB and z_gD",
        "Wheel D's ground input is z_gD in eq. (2).",
    )
    for name, error in table_2_misfits().items():
        known, identified, printed = TABLE_2[name]
        meant = known * (1 + printed / 100)
        from_matrix = K_ID_FRONT_RIGHT_WHEEL - TABLE_2["k_tf"].identified
        largest = max(abs(row.error_percent) for row in TABLE_2.values())
        yield Misprint(
            f"Table 2, {name}",
            f"{identified:.2f} with an error of {printed} %",
            f"{_one_digit_away(identified, meant)}",
            f"{identified:.2f} is {error:.2f} % off {known:.0f}, more than the largest error of {largest} % claimed; "
            f"{printed} % makes {meant:.1f}, and entry (5, 5) of K_id less k_tf makes {from_matrix:.1f}.",
            computed=True,
        )


def _one_digit_away(printed: float, meant: float) -> str:
    """Return a printed number with the one digit replaced that brings it nearest to the correct value."""
    text = f"{printed:.2f}"
    places = [i for i, letter in enumerate(text) if letter.isdigit()]
    candidates = [text[:i] + digit + text[i + 1 :] for i in places for digit in "0123456789"]
    return min(candidates, key=lambda candidate: abs(float(candidate) - meant))


def _experiment() -> Iterator[Misprint]:
    added = SCHOOL_BUS.matrices(BUS_LOAD).M - SCHOOL_BUS.matrices().M
    difference = SCHOOL_BUS.matrices().state[7:, :7] - SCHOOL_BUS.matrices(BUS_LOAD).state[7:, :7]
    size = np.linalg.norm(difference, axis=1, keepdims=True)
    rank = int(np.linalg.matrix_rank(difference / np.where(size > 1e-9, size, np.inf)))
    yield Misprint(
        "section 4.1 with eq. (18)",
        "parameters of the bus by added mass on the body alone",
        "a structured least squares for the parameters",
        f"ΔM has rank {np.linalg.matrix_rank(added)} of 7, A21 - Ā21 rank {rank}: eq. (18) divides by zero.",
        computed=True,
    )
    yield Misprint(
        "section 4.1",
        "state matrices Ā of the original and double-barred A of the loaded vehicle",
        "A and Ā",
        "Eqs. (12) and (15) call them so.",
    )
    yield Misprint(
        "Table 3, heading",
        "ω_n (Hz)",
        "f_n (Hz)",
        "ω_n is in rad/s; the values go with f_d = f_n √(1 - ζ²) in Hz.",
    )
    yield from _table_3()


def _table_3() -> Iterator[Misprint]:
    modes = {paper_name(mode.name): mode for mode in compute_modes(SCHOOL_BUS.matrices())}
    for name, damped in table_3_misfits().items():
        row, model = TABLE_3[name], modes[name]
        natural = row.damped_frequency / np.sqrt(1 - row.damping_ratio**2)
        swapped = row.damped_frequency * np.sqrt(1 - row.damping_ratio**2)
        if row.damped_frequency > row.natural_frequency:
            should_be = f"f_d {row.natural_frequency}, f_n {row.damped_frequency}: exchanged"
            why = f"A damped frequency is below the natural one; exchanged, f_n √(1 - ζ²) = {swapped:.4f}."
        else:
            should_be = f"f_n {natural:.4f} if f_d holds, f_d {damped:.4f} if f_n holds"
            why = f"f_n √(1 - ζ²) = {damped:.4f}."
        yield Misprint(
            f"Table 3, {name}",
            f"f_d {row.damped_frequency}, f_n {row.natural_frequency}, ζ {row.damping_ratio}",
            should_be,
            f"{why} The model of Tables 4 and 5 has f_d {model.damped_frequency:.4f}, f_n {model.frequency:.4f}.",
            computed=True,
        )
    yield Misprint(
        "Table 3, names of the wheel modes",
        "wheel bounce, pitch, roll, articulation",
        "rear axle hop, rear axle tramp, front axle hop, front axle tramp",
        "In the model of Tables 4 and 5 each axle hops alone: "
        + "; ".join(f"{mode.frequency:.2f} Hz {_wheel_motion(mode)}" for mode in modes.values() if _is_hop(mode))
        + ". Left against right is not pitch, and both together is not roll.",
        computed=True,
    )


def _is_hop(mode: Mode) -> bool:
    return bool(np.linalg.norm(mode.shape[3:]) > np.linalg.norm(mode.shape[:3]))


def _wheel_motion(mode: Mode) -> str:
    wheels = mode.shape[3:].real
    return "(" + ", ".join(f"{value:+.2f}" for value in wheels) + ")"
