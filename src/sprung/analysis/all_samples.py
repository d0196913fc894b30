"""All samples of fast recordings, where the search for a model used means of neighbouring ones.

Means of a free decay of a linear vehicle are one of the same vehicle: each mode is smaller by a factor that all sensors share.
They blur what is sudden, the knee of a damper or a wheel that lands. With sensors of little noise that shows.
"""

from __future__ import annotations

from dataclasses import replace

from sprung.analysis.analysis import Analysis
from sprung.preprocess import exclude_drops, prepare
from sprung.progress import Progress, Step
from sprung.selection import final_tolerance


def use_all_samples(run: Analysis, progress: Progress) -> Analysis:
    """Fit a nonlinear vehicle to all samples of the recordings."""
    if not run.model.structure.is_time_stepped:
        return run
    full = with_all_samples(run, progress)
    return run if full is run else full.noted("use_all_samples", "all samples of the recordings are used")


def with_all_samples(run: Analysis, progress: Progress) -> Analysis:
    """Return the analysis with all samples of the recordings, if means were used.

    Parameters
    ----------
    run
        With a fit of its decays.
    progress
        Called with each step that begins.

    Returns
    -------
    Analysis
        Its decays begin where they began.
    """
    recorded, used = run.campaign.recordings, run.prepared.observations
    if all(own.rate == other.recording.rate for own, other in zip(recorded, used, strict=True)):
        return run
    progress(Step("using all samples of the recordings"))
    prepared = exclude_drops(run.campaign, prepare(run.campaign, progress, full_rate=True), run.excluded)
    whole = {decay.file: decay for decay in prepared.decays}
    decays = tuple(whole.get(decay.file, decay).starting_at(decay.start) for decay in run.decays)
    search = replace(run.model, decays=decays, progress=progress)
    search = search.refit(search.structure, enough=final_tolerance(search))
    return replace(run, preparation=prepared, search=search, fits=run.fits + 1, preparations=run.preparations + 1)
