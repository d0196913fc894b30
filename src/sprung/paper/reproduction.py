"""Reproduction of the paper: its tables, its misprints, and the sensitivity of its method to noise."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from sprung.analysis import identify
from sprung.campaign import Campaign
from sprung.paper.method import FIVE_BUMPS, bump_campaign, drop_campaign, identify_by_paper_method, state_matrices
from sprung.paper.misprints import BUS_LOAD, find_misprints
from sprung.paper.printed import TABLE_2, TABLE_3
from sprung.paper.structured import structured_least_squares
from sprung.paper.tables import ModalValues, ModeRow, NoisePoint, PaperReproduction, ParameterRow
from sprung.progress import Progress, Step, silent
from sprung.vehicle import PARAMETERS, SCHOOL_BUS, TABLE_1_CAR, Added, Load
from sprung.vibration import compute_modes, paper_name

JointFit = Callable[[Campaign], Mapping[str, float]]
"""Function from a campaign to the value of each parameter by name."""

NOISE_LEVELS = (0.0, 1e-4, 1e-3, 1e-2, 2e-2, 5e-2, 1e-1)
"""Noise of the sensors, m/s² rms; 0.02 is typical of a MEMS accelerometer."""

BUS_KNOWN = ("a", "b", "t_f2", "t_r2")
"""Known quantities of Table 4 beside the total mass."""

CAR_LOAD = Load(
    name="loaded",
    added=Added(
        **{
            name: 0.1 * getattr(TABLE_1_CAR, parameter)
            for name, parameter in {"mass": "m_s", **{n: n for n in ("I_yy", "I_xx", "m_uf", "m_ur")}}.items()
        }
    ),
)
"""ΔM = 0.1 M, the legible part of eq. (20): about 10 % on all seven masses."""


def fit_all_records(campaign: Campaign) -> Mapping[str, float]:
    """Identify the paper's linear model by one joint fit of all recordings, as `sprung.identify` does.

    Parameters
    ----------
    campaign
        Recordings of one vehicle.

    Returns
    -------
    mapping
        Value of each determined parameter by name.
    """
    result = identify(campaign, tracks="shared", extras=())
    return {name: estimate.value for name, estimate in result.parameters.items() if estimate.value is not None}


def reproduce(
    progress: Progress = silent,
    *,
    joint_fit: JointFit | None = fit_all_records,
    noise_levels: Sequence[float] = NOISE_LEVELS,
    seeds: int = 3,
) -> PaperReproduction:
    """Reproduce the paper.

    Parameters
    ----------
    progress
        Called with each step that begins.
    joint_fit
        Identification that is compared with the paper's method; None for none.
    noise_levels
        m/s² rms.
    seeds
        Number of noise realisations for the medians.

    Returns
    -------
    PaperReproduction
    """
    progress(Step("Table 2: the simulated car"))
    simulated = table_2()
    progress(Step("Table 3: the modes of the school bus"))
    modes = table_3()
    progress(Step("Table 5: the school bus from simulated records"))
    bus = bus_table()
    points = []
    for number, level in enumerate(noise_levels, start=1):
        progress(Step("identifying with noise", number, len(noise_levels), f"{level:g} m/s²"))
        points.append(largest_errors(level, seeds, joint_fit))
    return PaperReproduction(simulated, modes, bus, find_misprints(), tuple(points))


def table_2() -> tuple[ParameterRow, ...]:
    """Identify the Table 1 car from one bump under its left wheels, empty and with ΔM = 0.1 M, without noise.

    Returns
    -------
    tuple of ParameterRow
    """
    identified = _by_paper_method(bump_campaign(TABLE_1_CAR, CAR_LOAD))
    return tuple(
        ParameterRow(name, PARAMETERS[name].unit, value, TABLE_2[name].identified, identified[name])
        for name, value in TABLE_1_CAR.parameters.items()
    )


def table_3() -> tuple[ModeRow, ...]:
    """Compute the modes of the bus of Tables 4 and 5.

    Returns
    -------
    tuple of ModeRow
    """
    modes = {paper_name(mode.name): mode for mode in compute_modes(SCHOOL_BUS.matrices())}
    return tuple(
        ModeRow(
            str(modes[name].name),
            name,
            ModalValues(row.natural_frequency, row.damped_frequency, row.damping_ratio),
            ModalValues(modes[name].frequency, modes[name].damped_frequency, modes[name].damping_ratio),
        )
        for name, row in TABLE_3.items()
    )


def bus_table() -> tuple[ParameterRow, ...]:
    """Identify the bus of Tables 4 and 5 from noise-free drops off blocks, loaded on the body alone as in the experiment.

    The total mass and the geometry of Table 4 are known. Eq. (18) is singular for this load; the parameters are computed from
    the state matrices by one structured least squares.

    Returns
    -------
    tuple of ParameterRow
        The value in the paper is the simulated one.
    """
    campaign = drop_campaign(SCHOOL_BUS, BUS_LOAD)
    matrices = state_matrices(campaign, SCHOOL_BUS.a)
    known = {name: float(getattr(SCHOOL_BUS, name)) for name in BUS_KNOWN}
    fit = structured_least_squares(
        [(load, matrices[load.name]) for load in campaign.loads],
        known={**known, "total_mass": SCHOOL_BUS.total_mass},
        tracks="separate",
    )
    return tuple(
        ParameterRow(name, PARAMETERS[name].unit, value, value, fit.parameters[name], name in BUS_KNOWN)
        for name, value in SCHOOL_BUS.parameters.items()
    )


def largest_errors(noise: float, seeds: int = 3, joint_fit: JointFit | None = None) -> NoisePoint:
    """Identify the Table 1 car from five bumps, empty and with ΔM = 0.1 M, with sensor noise.

    Five bumps, as the experiment has five drops; more favourable to the paper's method than the single bump of its simulation.

    Parameters
    ----------
    noise
        m/s² rms in every channel.
    seeds
        Number of noise realisations.
    joint_fit
        Another identification of the same recordings.

    Returns
    -------
    NoisePoint
    """
    paper, joint = [], []
    for seed in range(seeds if noise else 1):
        campaign = bump_campaign(TABLE_1_CAR, CAR_LOAD, FIVE_BUMPS, noise=noise, seed=seed)
        paper.append(_largest_error(_by_paper_method(campaign)))
        if joint_fit is not None:
            joint.append(_largest_error(joint_fit(campaign)))
    return NoisePoint(noise, float(np.median(paper)), float(np.median(joint)) if joint else None)


def _by_paper_method(campaign: Campaign) -> Mapping[str, float]:
    return identify_by_paper_method(campaign, 0.1 * TABLE_1_CAR.matrices().M, TABLE_1_CAR.a)


def _largest_error(identified: Mapping[str, float]) -> float:
    """Return the largest error of any parameter, %; infinite where one was not identified."""
    return max(100 * abs(identified.get(name, np.inf) / value - 1) for name, value in TABLE_1_CAR.parameters.items())
