"""Does the identified vehicle do what was measured? Drop by drop, in coordinates of the body, and against amplitude."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sprung.pipeline.identify import fit_campaign, result_of
from sprung.pipeline.result import Result, packed
from sprung.recording import Campaign, write_whole
from sprung.validation import BodyMotion, ModeAmplitude, Trace, body_motions, mode_amplitudes
from sprung.vehicle import EMPTY, Tracks


@dataclass(frozen=True, eq=False)
class Validation:
    """What a validation shows.

    Attributes
    ----------
    result
        The identification, its verdict and numbers drop by drop among it.
    motions
        Measured and simulated motion of the body in each drop.
    load
        Of the drops from which `amplitudes` are.
    amplitudes
        Frequency and damping of each mode of the body against amplitude.
    """

    result: Result
    motions: tuple[BodyMotion, ...]
    load: str
    amplitudes: tuple[ModeAmplitude, ...]

    def document(self) -> dict[str, Any]:
        """Give vehicle, verdict, validation by drop and amplitudes by mode as plain values, for JSON."""
        result = self.result.model_dump(mode="json", by_alias=True)
        modes = {
            one.mode: {
                "load": self.load,
                "frequency": one.frequency,
                "damping_ratio": one.damping_ratio,
                "records": {trace.name: _plain(trace) for trace in one.records},
                "simulated": {trace.name: _plain(trace) for trace in one.simulated},
                "model": _plain(one.model),
            }
            for one in self.amplitudes
        }
        kept = ("sprung", "vehicle", "verdict", "validation", "faults")
        return {**{name: result[name] for name in kept}, "amplitude": modes}

    def files(self) -> dict[str, bytes]:
        """Give validation.json, and validation.npz with every series that a drawing shows."""
        arrays: dict[str, NDArray[Any]] = {}
        for motion in self.motions:
            arrays[f"{motion.name}/time"] = motion.time
            arrays[f"{motion.name}/measured"] = motion.measured
            arrays[f"{motion.name}/simulated"] = motion.simulated
        for one in self.amplitudes:
            named = {f"records/{trace.name}": trace for trace in one.records}
            named |= {f"simulated/{trace.name}": trace for trace in one.simulated} | {"model": one.model}
            for where, trace in named.items():
                series = _plain(trace).items()
                arrays |= {f"amplitude/{one.mode}/{where}/{name}": np.array(values) for name, values in series}
        text = json.dumps(self.document(), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
        return {"validation.npz": packed(arrays), "validation.json": text.encode()}

    def save(self, folder: str | Path) -> Path:
        """Write validation.json and validation.npz, whole or not at all.

        Parameters
        ----------
        folder
            Made if it is missing.

        Returns
        -------
        Path
            The folder.

        Raises
        ------
        InputError
            If the folder cannot be written.
        """
        write_whole(Path(folder), self.files())
        return Path(folder)


def validate(
    campaign: Campaign,
    *,
    tracks: Tracks | None = None,
    extras: Sequence[str] | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Validation:
    """Identify a vehicle, and hold what it does against what was measured.

    Parameters
    ----------
    campaign
        From `sprung.read` or `sprung.simulate`.
    tracks, extras
        As for `identify`.
    progress
        Told in words what is being done.

    Returns
    -------
    Validation

    Raises
    ------
    InputError
        If no drop can be used, or what is known contradicts the model that is wanted.

    Examples
    --------
    >>> import sprung
    >>> car = sprung.Vehicle(m_s=1380, I_yy=2440, I_xx=380, m_uf=40.5, m_ur=45.4, k_sf=17000, k_sr=22000, k_tf=192000,
    ...                      k_tr=192000, c_sf=1500, c_sr=1500, a=1.25, b=1.51, t_f=0.74, t_r=0.74)
    >>> campaign = sprung.simulate(car, noise=0.02, seed=1, known={"total_mass": car.total_mass})
    >>> validation = sprung.validate(campaign)
    >>> max(drop.predicted_residual for drop in validation.result.validation.values()) < 1.05
    True
    """
    fitted = fit_campaign(campaign, tracks=tracks, extras=extras, progress=progress)
    result = result_of(fitted, (), progress)
    progress("following the modes of the body through the decays")
    fit, choice, decays = fitted.fit, fitted.choice, fitted.prepared.decays
    motions = body_motions(fit, decays, fitted.campaign.sensors)
    loads = [decay.load for decay in decays]
    load = EMPTY.name if EMPTY.name in loads else loads[0]
    # Modes belong to a vehicle on the ground.
    grounded = replace(choice, airborne=False)
    model = grounded.stepped[load] if choice.nonlinear else choice.models[load]
    own = [motion for motion, of in zip(motions, loads, strict=True) if of == load]
    return Validation(result, motions, load, mode_amplitudes(fit, model, fitted.campaign.sensors, own))


def _plain(trace: Trace) -> dict[str, list[float]]:
    return {name: values.tolist() for name, values in asdict(trace).items() if name != "name"}
