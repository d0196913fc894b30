"""The body's modes against amplitude, as a result carries them: arrays in memory, plain lists by mode in JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, PlainSerializer, SkipValidation

from sprung.assessment import AmplitudeTrace, ModeAmplitude


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


def plain_trace(trace: AmplitudeTrace) -> dict[str, list[float]]:
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

    def named(self, name: str) -> AmplitudeTrace:
        return AmplitudeTrace(name, **{key: np.array(values, dtype=float) for key, values in self})


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
