"""The paper reproduced: its tables beside ours, its misprints, and what sensor noise does to its method."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from sprung.analysis import identify
from sprung.campaign import Campaign
from sprung.display import shown
from sprung.paper.method import FIVE_BUMPS, bump_campaign, drop_campaign, identify_as_the_paper, state_matrices
from sprung.paper.misprints import BUS_LOAD, Misprint, find_misprints
from sprung.paper.printed import TABLE_2, TABLE_3
from sprung.paper.structured import structured_least_squares
from sprung.progress import Progress, Step, silent
from sprung.vehicle import PARAMETERS, SCHOOL_BUS, TABLE_1_CAR, Added, Load
from sprung.vibration import compute_modes, paper_name

JointFit = Callable[[Campaign], Mapping[str, float]]
"""Takes a campaign, gives the value of each parameter by name."""

NOISE_LEVELS = (0.0, 1e-4, 1e-3, 1e-2, 2e-2, 5e-2, 1e-1)
"""m/s² rms; 0.02 is that of a usual MEMS accelerometer."""

BUS_KNOWN = ("a", "b", "t_f2", "t_r2")
"""What Table 4 gives beside the total mass."""

CAR_LOAD = Load(
    name="loaded",
    added=Added(
        **{
            name: 0.1 * getattr(TABLE_1_CAR, parameter)
            for name, parameter in {"mass": "m_s", **{n: n for n in ("I_yy", "I_xx", "m_uf", "m_ur")}}.items()
        }
    ),
)
"""ΔM = 0.1 M: what remains of eq. (20), about 10 % on all seven masses."""


@shown
@dataclass(frozen=True, slots=True)
class ParameterRow:
    """One row of Table 2, or of the bus.

    Attributes
    ----------
    name, unit
        Of the parameter.
    known
        What was simulated, SI.
    paper
        What the paper prints as identified, SI.
    identified
        What is identified here, SI.
    given
        Whether it was known beforehand, not identified.
    """

    name: str
    unit: str
    known: float
    paper: float
    identified: float
    given: bool = False

    @property
    def error_percent(self) -> float:
        """Error of what is identified here, %."""
        return 100 * (self.identified / self.known - 1)


@shown
@dataclass(frozen=True, slots=True)
class ModalValues:
    """Frequencies and damping ratio of a mode.

    Attributes
    ----------
    natural_frequency, damped_frequency
        Hz.
    damping_ratio
        Dimensionless.
    """

    natural_frequency: float
    damped_frequency: float
    damping_ratio: float


@shown
@dataclass(frozen=True, slots=True)
class ModeRow:
    """One row of Table 3: what the paper prints and what the model of Tables 4 and 5 has.

    Attributes
    ----------
    mode
        After what moves.
    paper_name
        What the paper calls it.
    paper
        What the paper prints.
    computed
        What the model of Tables 4 and 5 has.
    """

    mode: str
    paper_name: str
    paper: ModalValues
    computed: ModalValues


@shown
@dataclass(frozen=True, slots=True)
class NoisePoint:
    """Worst error of any parameter at one level of sensor noise; medians over seeds, %.

    Attributes
    ----------
    noise
        m/s² rms in every channel.
    paper_method
        Of the paper's method.
    joint_fit
        Of the joint fit to the same records; None where none was given.
    """

    noise: float
    paper_method: float
    joint_fit: float | None


@shown
@dataclass(frozen=True, slots=True)
class PaperReproduction:
    """The paper's numbers beside ours.

    Attributes
    ----------
    table2
        The simulation: Table 1 car, identified from noise-free records of one bump.
    table3
        The school bus: modal parameters.
    bus
        Table 5's bus, identified back from noise-free records with the paper's load on the body alone.
    misprints
        Where the paper as printed cannot be right.
    noise
        What noise does to the paper's method.
    """

    table2: tuple[ParameterRow, ...]
    table3: tuple[ModeRow, ...]
    bus: tuple[ParameterRow, ...]
    misprints: tuple[Misprint, ...]
    noise: tuple[NoisePoint, ...]

    def document(self) -> dict[str, Any]:
        """Give everything as plain lists and numbers, the errors in percent written out: what ``--json`` prints."""

        def rows(table: Sequence[ParameterRow]) -> list[dict[str, Any]]:
            return [{**asdict(row), "error_percent": row.error_percent} for row in table]

        return {**asdict(self), "table2": rows(self.table2), "bus": rows(self.bus)}


def fit_all_records(campaign: Campaign) -> Mapping[str, float]:
    """Identify the paper's linear model as `sprung.identify` does: one joint fit of all records.

    Parameters
    ----------
    campaign
        Recordings of one vehicle.

    Returns
    -------
    mapping
        Value of each parameter that the records determine, by name.
    """
    result = identify(campaign, tracks="shared", extras=())
    return {name: found.value for name, found in result.parameters.items() if found.value is not None}


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
        The identification to compare with under noise: that of `sprung.identify` unless given, None for none.
    noise_levels
        m/s² rms.
    seeds
        How many draws of noise the medians are taken over.

    Returns
    -------
    PaperReproduction
    """
    progress(Step("Table 2: the simulated car"))
    simulated = table_2()
    progress(Step("Table 3: the modes of the school bus"))
    modes = table_3()
    progress(Step("Table 5: the school bus from simulated records"))
    bus = bus_identified_back()
    points = []
    for number, level in enumerate(noise_levels, start=1):
        progress(Step("identifying with noise", number, len(noise_levels), f"{level:g} m/s²"))
        points.append(noise_point(level, seeds, joint_fit))
    return PaperReproduction(simulated, modes, bus, find_misprints(), tuple(points))


def table_2() -> tuple[ParameterRow, ...]:
    """Identify the Table 1 car from one bump under its left wheels, empty and with ΔM = 0.1 M, without noise.

    Returns
    -------
    tuple of ParameterRow
    """
    found = _by_the_paper(bump_campaign(TABLE_1_CAR, CAR_LOAD))
    return tuple(
        ParameterRow(name, PARAMETERS[name].unit, value, TABLE_2[name].identified, found[name])
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


def bus_identified_back() -> tuple[ParameterRow, ...]:
    """Identify the bus of Tables 4 and 5 from noise-free drops off blocks, loaded on the body alone as in the experiment.

    The total mass and the geometry of Table 4 are known. Eq. (18) is singular for this load; the parameters come from
    the state matrices by one structured least squares.

    Returns
    -------
    tuple of ParameterRow
        The paper's value is what was simulated.
    """
    campaign = drop_campaign(SCHOOL_BUS, BUS_LOAD)
    found = state_matrices(campaign, SCHOOL_BUS.a)
    known = {name: float(getattr(SCHOOL_BUS, name)) for name in BUS_KNOWN}
    fit = structured_least_squares(
        [(load, found[load.name]) for load in campaign.loads],
        known={**known, "total_mass": SCHOOL_BUS.total_mass},
        tracks="separate",
    )
    return tuple(
        ParameterRow(name, PARAMETERS[name].unit, value, value, fit.parameters[name], name in BUS_KNOWN)
        for name, value in SCHOOL_BUS.parameters.items()
    )


def noise_point(noise: float, seeds: int = 3, joint_fit: JointFit | None = None) -> NoisePoint:
    """Identify the Table 1 car from five bumps, empty and with ΔM = 0.1 M, with sensor noise.

    Five bumps, as the experiment has five drops: that is kinder to the paper's method than the one of its simulation.

    Parameters
    ----------
    noise
        m/s² rms in every channel.
    seeds
        How many draws of the noise.
    joint_fit
        Another identification of the same records.

    Returns
    -------
    NoisePoint
    """
    paper, joint = [], []
    for seed in range(seeds if noise else 1):
        campaign = bump_campaign(TABLE_1_CAR, CAR_LOAD, FIVE_BUMPS, noise=noise, seed=seed)
        paper.append(_worst_error(_by_the_paper(campaign)))
        if joint_fit is not None:
            joint.append(_worst_error(joint_fit(campaign)))
    return NoisePoint(noise, float(np.median(paper)), float(np.median(joint)) if joint else None)


def _by_the_paper(campaign: Campaign) -> Mapping[str, float]:
    return identify_as_the_paper(campaign, 0.1 * TABLE_1_CAR.matrices().M, TABLE_1_CAR.a)


def _worst_error(found: Mapping[str, float]) -> float:
    """Give the largest error of any parameter, %; one that was not found at all counts as infinite."""
    return max(100 * abs(found.get(name, np.inf) / value - 1) for name, value in TABLE_1_CAR.parameters.items())
