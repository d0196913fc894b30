"""The body's modes against amplitude, as a result carries them: arrays in memory, plain lists by mode in JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, PlainSerializer, SkipValidation

from sprung.pipeline.stand import Fitted
from sprung.progress import Progress, silent
from sprung.validation import BodyMotion, ModeAmplitude, Trace, mode_amplitudes
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
    grounded = replace(choice, airborne=False)
    model = grounded.stepped[load] if choice.nonlinear else choice.models[load]
    own = [motion for motion, of in zip(motions, loads, strict=True) if of == load]
    found = mode_amplitudes(fitted.fit, model, fitted.campaign.sensors, own, progress)
    return tuple(replace(one, load=load) for one in found)


def amplitude_document(amplitudes: Sequence[ModeAmplitude]) -> dict[str, Any]:
    """Give amplitude curves by mode as JSON holds them.

    Parameters
    ----------
    amplitudes
        From `amplitudes_of`.
    """
    return {
        one.mode: {
            "load": one.load,
            "frequency": one.frequency,
            "damping_ratio": one.damping_ratio,
            "records": {trace.name: plain_trace(trace) for trace in one.records},
            "simulated": {trace.name: plain_trace(trace) for trace in one.simulated},
            "model": plain_trace(one.model),
        }
        for one in amplitudes
    }


def plain_trace(trace: Trace) -> dict[str, list[float]]:
    """Give a trace as lists by name."""
    return {name: values.tolist() for name, values in asdict(trace).items() if name != "name"}


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid")


class _Trace(_Strict):
    time: tuple[float, ...]
    amplitude: tuple[float, ...]
    frequency: tuple[float, ...]
    frequency_std: tuple[float, ...]
    damping_ratio: tuple[float, ...]
    damping_ratio_std: tuple[float, ...]

    def named(self, name: str) -> Trace:
        return Trace(name, **{key: np.array(values, dtype=float) for key, values in self})


class _Mode(_Strict):
    load: str
    frequency: float
    damping_ratio: float
    records: dict[str, _Trace]
    simulated: dict[str, _Trace]
    model: _Trace


def _understood(document: Any) -> Any:
    if isinstance(document, tuple) and all(isinstance(one, ModeAmplitude) for one in document):
        return document
    if not isinstance(document, Mapping):
        raise ValueError("curves by mode are expected")
    modes = {name: _Mode.model_validate(entry) for name, entry in document.items()}
    return tuple(
        ModeAmplitude(
            name,
            mode.frequency,
            mode.damping_ratio,
            tuple(trace.named(drop) for drop, trace in mode.records.items()),
            tuple(trace.named(drop) for drop, trace in mode.simulated.items()),
            mode.model.named(""),
            mode.load,
        )
        for name, mode in modes.items()
    )


Amplitudes = Annotated[
    SkipValidation[tuple[ModeAmplitude, ...]], BeforeValidator(_understood), PlainSerializer(amplitude_document)
]
"""Amplitude curves as a field of a result."""
