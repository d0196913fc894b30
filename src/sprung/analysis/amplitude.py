"""Frequency and damping of the body's modes against amplitude, for a fitted campaign."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sprung.analysis.analysis import Analysis
from sprung.assessment import BodyMotion, ModeAmplitude, follow_modes
from sprung.progress import Progress, silent
from sprung.vehicle import EMPTY


def amplitudes_of(
    run: Analysis, motions: Sequence[BodyMotion], progress: Progress = silent
) -> tuple[ModeAmplitude, ...]:
    """Follow the modes of the body through the decays of one load: the empty vehicle's, where there are any.

    Parameters
    ----------
    run
        The analysis of the campaign.
    motions
        Of the body, one for each decay.
    progress
        Called with each step that begins.
    """
    structure = run.model.structure
    # On pads no vibration is free.
    free = [(motion, decay.load) for motion, decay in zip(motions, run.decays, strict=True) if not decay.pads]
    if not free:
        return ()
    loads = [load for _, load in free]
    load = EMPTY.name if EMPTY.name in loads else loads[0]
    # Modes belong to a vehicle on the ground.
    grounded = replace(structure, unilateral_tyres=False)
    model = grounded.nonlinear_models[load] if structure.is_nonlinear else structure.linear_models[load]
    own = [motion for motion, of in free if of == load]
    found = follow_modes(run.uncertainty, model, run.campaign.sensors, own, progress)
    return tuple(replace(one, load=load) for one in found)
