"""Frequency and damping of the body's modes against amplitude, for a fitted campaign."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sprung.analysis.stand import Fitted
from sprung.assessment import BodyMotion, ModeAmplitude, mode_amplitudes
from sprung.progress import Progress, silent
from sprung.vehicle import EMPTY


def amplitudes_of(
    fitted: Fitted, motions: Sequence[BodyMotion], progress: Progress = silent
) -> tuple[ModeAmplitude, ...]:
    """Follow the modes of the body through the decays of one load: the empty vehicle's, where there are any.

    Parameters
    ----------
    fitted
        The campaign and its fit.
    motions
        Of the body, one for each decay.
    progress
        Called with each step that begins.
    """
    choice = fitted.choice
    loads = [decay.load for decay in fitted.prepared.decays]
    load = EMPTY.name if EMPTY.name in loads else loads[0]
    # Modes belong to a vehicle on the ground.
    grounded = replace(choice, unilateral_tyres=False)
    model = grounded.nonlinear_models[load] if choice.is_nonlinear else choice.linear_models[load]
    own = [motion for motion, of in zip(motions, loads, strict=True) if of == load]
    found = mode_amplitudes(fitted.fit, model, fitted.campaign.sensors, own, progress)
    return tuple(replace(one, load=load) for one in found)
