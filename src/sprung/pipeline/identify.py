"""The one composition: from a campaign to a result."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib.metadata import version

import numpy as np

from sprung.errors import Problems
from sprung.identification import Fit, conclude, fit_jointly, mode_estimates
from sprung.pipeline.check import check_prepared
from sprung.pipeline.choice import Choice, choose_model
from sprung.pipeline.result import FitReport, Result, Series, VehicleName
from sprung.prepare import Decay, Prepared, prepare
from sprung.recording import Campaign
from sprung.validation import Misfit, judge, judge_residuals
from sprung.vehicle import Tracks

METHOD = "joint maximum likelihood"


def identify(
    campaign: Campaign,
    *,
    tracks: Tracks | None = None,
    extras: Sequence[str] | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Result:
    """Identify every parameter of a vehicle from its drop tests.

    Parameters
    ----------
    campaign
        From `sprung.read` or `sprung.simulate`.
    tracks
        ``shared``: one half-distance per axle; ``separate``: springs and dampers apart. Overrides the campaign.
    extras
        Exactly these extras beyond the paper's model, such as ``anti-roll``. Overrides the campaign.
    progress
        Told in words what is being done.

    Returns
    -------
    Result

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
    >>> result = sprung.identify(campaign)
    >>> result.verdict.state, abs(result.parameters["k_sf"].value / 17000 - 1) < 0.01
    ('accept', True)
    """
    choice = choose_model(campaign, tracks, None if extras is None else tuple(extras))
    progress("finding the decays")
    prepared = prepare(campaign)
    _need_decays(campaign, prepared)
    fit = fit_jointly(prepared.decays, choice.models, campaign.sensors, choice.known, progress=progress)
    progress("judging the fit")
    return _result(campaign, choice, prepared, fit)


def _need_decays(campaign: Campaign, prepared: Prepared) -> None:
    if prepared.decays:
        return
    problems = Problems()
    where = "campaign" if campaign.path is None else campaign.path.name
    problems.add(where, "no drop that can be used", "at least one", "Read the reasons below and record again.")
    for _, _, faults in prepared.left_out:
        for fault in faults:
            problems.add(fault.where, fault.what, "a usable decay", fault.do)
    problems.raise_if_any()


def _result(campaign: Campaign, choice: Choice, prepared: Prepared, fit: Fit) -> Result:
    decays = prepared.decays
    channels = tuple(sensor.channel for sensor in campaign.sensors)
    looked_at = check_prepared(campaign, prepared)
    estimates = conclude(fit, choice.known)
    misfit = judge_residuals(fit, decays)
    loads = [load.name for load in campaign.loads if any(decay.load == load.name for decay in decays)]
    return Result(
        version=version("sprung"),
        vehicle=VehicleName(name=campaign.name),
        verdict=judge(fit, misfit, estimates.parameters, channels),
        parameters=estimates.parameters,
        scale=estimates.scale,
        unidentifiable=estimates.unidentifiable,
        correlation=estimates.correlation,
        modes={load: mode_estimates(fit, choice.models[load], campaign.sensors) for load in loads},
        fit=_fit_report(choice, fit, decays, channels, misfit),
        drops=looked_at.drops,
        faults=looked_at.faults,
        series={decay.name: _series(decay, fitted, channels) for decay, fitted in zip(decays, fit.fitted, strict=True)},
    )


def _fit_report(
    choice: Choice, fit: Fit, decays: Sequence[Decay], channels: Sequence[str], misfit: Misfit
) -> FitReport:
    return FitReport(
        samples=sum(int(decay.usable.sum()) * decay.samples for decay in decays),
        drops=len(decays),
        noise=dict(zip(channels, fit.noise.tolist(), strict=True)),
        model=choice.extras,
        tracks=choice.tracks,
        method=METHOD,
        iterations=fit.iterations,
        converged=fit.converged,
        starts=fit.starts,
        starts_agreeing=fit.starts_agreeing,
        inflation=fit.inflation,
        misfit=dict(zip(channels, misfit.relative.tolist(), strict=True)),
    )


def _series(
    decay: Decay, fitted: np.ndarray[tuple[int, ...], np.dtype[np.float64]], channels: tuple[str, ...]
) -> Series:
    time = decay.start + np.arange(decay.samples) / decay.rate
    level = decay.values.mean(axis=1, keepdims=True)
    return Series(channels, time, decay.values, fitted + level)
