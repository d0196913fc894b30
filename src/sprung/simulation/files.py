"""From a vehicle file to a campaign."""

from __future__ import annotations

import os
from dataclasses import replace

from sprung.progress import Progress, silent
from sprung.recording import Campaign, read_vehicle
from sprung.simulation.drops import simulate


def simulate_file(
    path: str | os.PathLike[str],
    *,
    rate: float = 500.0,
    noise: float = 0.02,
    seed: int | None = None,
    progress: Progress = silent,
) -> Campaign:
    """Simulate the drop tests that a vehicle file describes.

    Parameters
    ----------
    path
        VEHICLE.toml: ``[vehicle]``, ``[parameters]`` in SI, ``[[sensor]]``, ``[[load]]`` and ``[[drop]]`` without files.
    rate
        Samples per second.
    noise
        White noise of every channel, m/s² rms.
    seed
        Of the noise; None gives other noise each time.
    progress
        Called with each drop that is begun.

    Returns
    -------
    Campaign

    Raises
    ------
    InputError
        If the file cannot be used; all faults at once.
    """
    file = read_vehicle(path)
    known = dict(file.known)
    if file.wheelbase is not None:
        known["wheelbase"] = file.wheelbase
    campaign = simulate(
        file.vehicle,
        sensors=file.sensors or None,
        loads=file.loads,
        drops=file.drops or None,
        rate=rate,
        noise=noise,
        seed=seed,
        known=known,
        model=file.model,
        progress=progress,
    )
    return replace(campaign, identification=file.identification, test=file.test)
