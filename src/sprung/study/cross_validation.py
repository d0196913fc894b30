"""Cross-validation: the identified vehicle against each drop, in the body's motion and against amplitude."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sprung.analysis import identify_campaign, with_amplitudes
from sprung.assessment import BodyMotion, ModeAmplitude, body_motions
from sprung.campaign import CampaignSource
from sprung.display import shown
from sprung.files import atomic_write
from sprung.progress import Progress, silent
from sprung.results import Result, amplitude_document, curve_document, npz_bytes
from sprung.vehicle import EMPTY, Tracks


@shown
@dataclass(frozen=True, eq=False)
class Validation:
    """Result of a :term:`cross-validation`.

    Attributes
    ----------
    result
        Of the identification, with verdict and errors drop by drop.
    motions
        Measured and simulated motion of the body in each drop.
    load
        Load of the drops that `amplitudes` are from.
    amplitudes
        Frequency and damping of each mode of the body against amplitude; empty where the verdict is reject.
    """

    result: Result
    motions: tuple[BodyMotion, ...]
    load: str
    amplitudes: tuple[ModeAmplitude, ...]

    def document(self) -> dict[str, Any]:
        """Return vehicle, verdict, validation by drop and amplitudes by mode as plain values, for JSON."""
        result = self.result.document()
        kept = ("sprung", "vehicle", "verdict", "validation", "faults", "omissions")
        return {**{name: result[name] for name in kept}, "amplitude": amplitude_document(self.amplitudes)}

    def files(self) -> dict[str, bytes]:
        """Return validation.json, and validation.npz with the series of the drawings."""
        arrays: dict[str, NDArray[Any]] = {}
        for motion in self.motions:
            arrays[f"{motion.name}/time"] = motion.time
            arrays[f"{motion.name}/measured"] = motion.measured
            arrays[f"{motion.name}/simulated"] = motion.simulated
        for mode in self.amplitudes:
            curves = {f"records/{curve.name}": curve for curve in mode.records}
            curves |= {f"simulated/{curve.name}": curve for curve in mode.simulated} | {"model": mode.model}
            for where, curve in curves.items():
                columns = curve_document(curve).items()
                arrays |= {f"amplitude/{mode.mode}/{where}/{name}": np.array(values) for name, values in columns}
        text = json.dumps(self.document(), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
        return {"validation.npz": npz_bytes(arrays), "validation.json": text.encode()}

    def save(self, folder: str | Path, *, overwrite: bool = False) -> Path:
        """Write validation.json and validation.npz, whole or not at all.

        Parameters
        ----------
        folder
            Made if it is missing. Files that sprung wrote there are replaced.
        overwrite
            Whether other files of the same names, and files that were changed since sprung wrote them, are replaced too.

        Returns
        -------
        Path
            The folder.

        Raises
        ------
        InputError
            If such files would be overwritten, with their list, or the folder cannot be written.
        """
        atomic_write(Path(folder), self.files(), overwrite=overwrite)
        return Path(folder)


def validate(
    campaign: CampaignSource,
    *,
    tracks: Tracks | None = None,
    extras: str | Sequence[str] | None = None,
    progress: Progress = silent,
) -> Validation:
    """Identify a vehicle, and validate it against each drop.

    Parameters
    ----------
    campaign
        From `sprung.read` or `sprung.simulate`; or the path of a campaign file or of its folder.
    tracks, extras
        As for `identify`.
    progress
        Called with each step that begins, as for `identify`.

    Returns
    -------
    Validation

    Raises
    ------
    InputError
        If the campaign cannot be read, tracks or an extra are unknown, no drop can be used, or what is known contradicts the
        model that is wanted.

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
    run = identify_campaign(campaign, tracks=tracks, extras=extras, progress=progress)
    result = with_amplitudes(run, progress)
    motions = body_motions(run.fit, run.decays, run.fit.fitted, run.campaign.sensors)
    motions = tuple(motion for motion, decay in zip(motions, run.decays, strict=True) if not decay.pads)
    amplitudes = result.amplitude
    return Validation(result, motions, amplitudes[0].load if amplitudes else EMPTY.name, amplitudes)
