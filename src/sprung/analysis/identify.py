"""The one composition: from a campaign to a result."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.metadata import version
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.analysis.amplitude import amplitudes_of
from sprung.analysis.axes import about_roll_axis, axes_of
from sprung.analysis.clocks import clock_reports
from sprung.analysis.fitted import fit_campaign
from sprung.analysis.options import model_options
from sprung.analysis.planned import to_design
from sprung.analysis.profiles import check_asked, profiles_of
from sprung.analysis.stand import Fitted
from sprung.analysis.starting import start_values
from sprung.assessment import BodyMotion, Misfit, ModeAmplitude, body_motions, judge, judge_residuals, validate_drops
from sprung.campaign import CampaignSource, campaign_from
from sprung.checking import check_prepared
from sprung.errors import Omissions
from sprung.estimation import FitResult, FitStatistics, characteristics_of, estimate_of, mode_estimates, to_estimates
from sprung.planning import next_step
from sprung.preprocess import FreeDecay
from sprung.progress import Progress, Step, silent
from sprung.results import FitReport, Result, Series, TestedVehicle, setup_of, withhold_estimates
from sprung.selection import ModelStructure, SelectionStep
from sprung.vehicle import EMPTY, LOAD_MASS, Tracks, Vehicle

METHOD = "joint maximum likelihood"


def identify(
    campaign: CampaignSource,
    *,
    tracks: Tracks | None = None,
    extras: str | Sequence[str] | None = None,
    fall: bool | None = None,
    start: Result | Vehicle | Mapping[str, float] | None = None,
    profile: str | Sequence[str] = (),
    amplitude: bool = False,
    progress: Progress = silent,
) -> Result:
    """Identify every parameter of a vehicle from its drop tests.

    Parameters
    ----------
    campaign
        From `sprung.read` or `sprung.simulate`; or the path of a campaign file or of its folder.
    tracks
        ``shared``: one half-distance per axle; ``separate``: springs and dampers apart. Overrides the campaign.
    extras
        Exactly these extras beyond the paper's model, such as ``anti-roll``; one may be given alone. Overrides the campaign.
    fall
        Whether drops are used from their release on, and not only from when the last tyre is down. It halves the uncertainties
        and takes a few times as long; left open, it is done where a parameter is uncertain by more than 2 %. Overrides the
        campaign.
    start
        A vehicle near the one that is sought: an earlier result, a vehicle, or values by name, SI. It competes with usual
        vehicles for where the search begins, which helps where the vehicle is unlike them all; the likeliest one found wins.
    profile
        Parameters whose 95 % interval is to follow from the whole profile of the likelihood, not from its curvature at the
        maximum: for those that are weakly determined, whose interval is not symmetric. Also derived quantities
        (``total_mass``, ``front_axle_mass``, ``rear_axle_mass``, ``wheelbase``), or ``all`` for every parameter.
    amplitude
        Whether to follow the body's modes through the decays, for frequency and damping against amplitude. Where that
        fails, the result says so under ``omissions``.
    progress
        Called with each step that begins, a `sprung.progress.Step`: a sentence, with its number where steps are counted.

    Returns
    -------
    Result

    Raises
    ------
    InputError
        If the campaign cannot be read, tracks or an extra are unknown, no drop can be used, what is known contradicts the model
        that is wanted, or a profile is wanted of something that the model does not have.

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
    found = identify_campaign(
        campaign, tracks=tracks, extras=extras, fall=fall, start=start, profile=profile, progress=progress
    )
    return with_amplitudes(found, progress) if amplitude else found.result


class Identification(NamedTuple):
    """A result, and the fit that it was made from.

    Attributes
    ----------
    fitted
        The campaign and its fit.
    result
        Everything but what decorates it.
    """

    fitted: Fitted
    result: Result


def identify_campaign(
    campaign: CampaignSource,
    *,
    tracks: Tracks | None = None,
    extras: str | Sequence[str] | None = None,
    fall: bool | None = None,
    start: Result | Vehicle | Mapping[str, float] | None = None,
    profile: str | Sequence[str] = (),
    progress: Progress = silent,
) -> Identification:
    """Identify a vehicle, without anything that only decorates the result, so that it can be saved first.

    Parameters
    ----------
    campaign, tracks, extras, fall, start, profile, progress
        As for `identify`.

    Returns
    -------
    Identification

    Raises
    ------
    InputError
        As `identify` does.
    """
    tracks, extras = model_options(tracks, extras)
    begin = start_values(start)
    campaign = campaign_from(campaign, progress)
    asked = check_asked(profile, campaign, tracks, extras)
    fitted = fit_campaign(campaign, tracks=tracks, extras=extras, fall=fall, start=begin, progress=progress)
    options: dict[str, object] = {"tracks": tracks, "extras": extras, "fall": fall, "profile": asked}
    if begin:
        options["start"] = [f"{name} = {value:g}" for name, value in begin.items()]
    return Identification(fitted, result_of(fitted, asked, progress, options=options))


def with_amplitudes(found: Identification, progress: Progress = silent) -> Result:
    """Return a result with the amplitude curves of the body's modes, or with the reason why there are none.

    Parameters
    ----------
    found
        From `identify_campaign`.
    progress
        As for `identify`.

    Returns
    -------
    Result
    """
    fitted, result = found
    if result.verdict.state == "reject":
        return result  # what does not describe the recordings has no modes to follow
    omissions = Omissions(result.omissions)
    amplitudes: tuple[ModeAmplitude, ...] = ()
    with omissions.noting("The amplitude curves"):
        motions = body_motions(fitted.fit, fitted.prepared.decays, fitted.campaign.sensors)
        amplitudes = amplitudes_of(fitted, motions, progress)
    return replace(result, amplitude=amplitudes, omissions=omissions.sentences)


def result_of(
    fitted: Fitted,
    profile: Sequence[str] = (),
    progress: Progress = silent,
    *,
    options: Mapping[str, object] = MappingProxyType({}),
) -> Result:
    """Judge a fit, and put together what is said of it, with intervals from profiles of what is named."""
    campaign, choice, why, prepared, optimum, fit, path, accused = fitted
    progress(Step("judging the fit: each drop predicted by the others"))
    decays = prepared.decays
    channels = tuple(sensor.channel for sensor in campaign.sensors)
    looked_at = check_prepared(campaign, prepared)
    clocks = clock_reports(optimum, fit, decays)
    estimates = to_estimates(fit, choice.known)
    misfit = judge_residuals(fit, decays)
    motions = body_motions(fit, decays, campaign.sensors)
    validated = validate_drops(optimum, fit, decays, channels, motions)
    verdict = judge(fit, misfit, estimates.parameters, channels, [fault.what for fault in accused], validated)
    rejected = verdict.state == "reject"
    profiles = {} if rejected else profiles_of(profile, optimum, fit, choice.known, progress)
    loads = [load.name for load in campaign.loads if any(decay.load == load.name for decay in decays)]
    result = Result(
        version=version("sprung"),
        tested_vehicle=TestedVehicle(name=campaign.name, identification=campaign.identification),
        verdict=verdict,
        next_step=None if rejected else next_step(to_design(fitted)).text,
        parameters={name: profiles.get(name, found) for name, found in estimates.parameters.items()},
        derived={
            **({} if rejected else characteristics_of(fit, choice.known, choice.linear_models[EMPTY.name])),
            **about_roll_axis(fit, choice.heights),
            **{name: estimate_of(fit, choice.known, name) for name in fit.names if name.startswith(LOAD_MASS)},
            **{name: found for name, found in profiles.items() if name not in estimates.parameters},
        },
        scale=estimates.scale,
        unidentifiable=estimates.unidentifiable,
        correlation=estimates.correlation,
        modes={
            load: () if rejected else mode_estimates(fit, choice.linear_models[load], campaign.sensors)
            for load in loads
        },
        fit=_fit_report(choice, why, path, fit, decays, channels, misfit, optimum),
        drops=tuple(replace(drop, clocks=clocks.get(drop.label, ())) for drop in looked_at.drops),
        faults=tuple(dict.fromkeys((*looked_at.faults, *accused))),
        validation=validated,
        setup=setup_of(campaign, fit, choice.known, options),
        series={
            decay.name: _series(decay, fitted, motion, channels)
            for decay, fitted, motion in zip(decays, fit.fitted, motions, strict=True)
        },
        recordings={drop.name: one for drop, one in zip(looked_at.drops, looked_at.recorded, strict=True)},
    )
    return withhold_estimates(result)


def _fit_report(
    choice: ModelStructure,
    why: str,
    path: tuple[SelectionStep, ...],
    fit: FitStatistics,
    decays: Sequence[FreeDecay],
    channels: Sequence[str],
    misfit: Misfit,
    optimum: FitResult,
) -> FitReport:
    return FitReport(
        samples=sum(int(decay.usable.sum()) * decay.samples for decay in decays),
        drops=len(decays),
        noise=dict(zip(channels, fit.noise.tolist(), strict=True)),
        model=choice.terms,
        tracks=choice.tracks,
        why=why,
        axes=axes_of(choice.heights),
        since="release" if choice.unilateral_tyres else "landing",
        path=path,
        method=METHOD,
        iterations=fit.iterations,
        converged=fit.converged,
        starts=fit.starts,
        starts_agreeing=fit.starts_agreeing,
        inflation=fit.inflation,
        inflated_by=fit.inflated_by,
        most_coloured=None if fit.most_coloured is None else channels[fit.most_coloured],
        misfit=dict(zip(channels, misfit.relative.tolist(), strict=True)),
        loglikelihood=optimum.absolute_loglikelihood,
        unknowns=optimum.unknowns,
    )


def _series(decay: FreeDecay, fitted: NDArray[np.float64], motion: BodyMotion, channels: tuple[str, ...]) -> Series:
    level = decay.values.mean(axis=1, keepdims=True)
    body = motion.measured.astype(np.float32), motion.simulated.astype(np.float32)
    return Series(channels, motion.time, decay.values, fitted + level, *body)
