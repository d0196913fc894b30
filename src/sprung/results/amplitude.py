"""Frequency and damping of the body's modes against amplitude: arrays in a result, lists by mode in results.json."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, fields
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, PlainSerializer, SkipValidation

from sprung.assessment import AmplitudeCurve, ModeAmplitude

_COLUMNS = tuple(field.name for field in fields(AmplitudeCurve) if field.name != "name")


def amplitude_document(amplitudes: Sequence[ModeAmplitude]) -> dict[str, Any]:
    """Return amplitude curves by mode, as JSON holds them.

    Parameters
    ----------
    amplitudes
        From `amplitudes_of`.

    Returns
    -------
    dict
        Curves by the name of the mode.
    """
    return {
        mode.mode: {
            "load": mode.load,
            "frequency": mode.frequency,
            "damping_ratio": mode.damping_ratio,
            "records": {curve.name: curve_document(curve) for curve in mode.records},
            "simulated": {curve.name: curve_document(curve) for curve in mode.simulated},
            "model": curve_document(mode.model),
        }
        for mode in amplitudes
    }


def curve_document(curve: AmplitudeCurve) -> dict[str, list[float]]:
    """Return a curve as plain lists.

    Parameters
    ----------
    curve
        Frequency and damping of a mode over its amplitude.

    Returns
    -------
    dict
        The columns of the curve by name, SI.
    """
    return {name: values.tolist() for name, values in asdict(curve).items() if name != "name"}


def _amplitudes_from(document: Any) -> Any:
    """Return amplitude curves from what JSON holds; such that are none raise ValueError, which pydantic reports."""
    if isinstance(document, tuple):
        return document  # made in memory, not read
    try:
        return tuple(_mode_from(name, entry) for name, entry in document.items())
    except (AttributeError, KeyError, TypeError) as error:
        raise ValueError(f"curves by mode are expected ({type(error).__name__}: {error})") from error


def _mode_from(name: str, entry: Mapping[str, Any]) -> ModeAmplitude:
    records, simulated = (
        tuple(_curve_from(drop, columns) for drop, columns in entry[kind].items()) for kind in ("records", "simulated")
    )
    frequency, damping_ratio = float(entry["frequency"]), float(entry["damping_ratio"])
    model = _curve_from("", entry["model"])
    return ModeAmplitude(name, frequency, damping_ratio, records, simulated, model, entry["load"])


def _curve_from(name: str, columns: Mapping[str, Any]) -> AmplitudeCurve:
    return AmplitudeCurve(name, *(np.array(columns[column], dtype=float) for column in _COLUMNS))


AmplitudeCurves = Annotated[
    SkipValidation[tuple[ModeAmplitude, ...]], BeforeValidator(_amplitudes_from), PlainSerializer(amplitude_document)
]
"""Amplitude curves as a field of a result."""
