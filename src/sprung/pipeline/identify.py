"""The one composition: from a campaign to a result."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from importlib.metadata import version
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Fault, Problems
from sprung.identification import (
    CONVERGED,
    NEAR,
    Fit,
    Summit,
    ascend,
    ascend_from_contact,
    conclude,
    describe,
    look_around,
    mode_estimates,
)
from sprung.pipeline.amplitude import amplitudes_of
from sprung.pipeline.axes import about_roll_axis, axes_of
from sprung.pipeline.candidates import ENGINE, fit_from
from sprung.pipeline.check import check_prepared
from sprung.pipeline.choice import Choice, choose_model
from sprung.pipeline.clocks import clock_reports, set_clocks, told_by_flights
from sprung.pipeline.diagnosis import (
    Bench,
    Hypothesis,
    Suspicion,
    diagnose,
    scores,
    suspicious,
    walking_slowly,
    without_looking_at_wheels,
)
from sprung.pipeline.extras import Attempt, Way
from sprung.pipeline.flight import fly, is_needed
from sprung.pipeline.profiles import check_asked, profiles_of
from sprung.pipeline.result import FitReport, Result, VehicleName
from sprung.pipeline.series import Series
from sprung.pipeline.setup import setup_of
from sprung.planning import PlannedDrop, PlannedTest, campaign_of_fit, next_step, subject_of_fit
from sprung.prepare import Decay, Prepared, prepare
from sprung.recording import Campaign
from sprung.simulation import DEFAULT_HEIGHT
from sprung.validation import BodyMotion, Misfit, body_motions, doubt_of, judge, judge_residuals, validate_drops
from sprung.vehicle import Tracks

METHOD = "joint maximum likelihood"

_DIAGNOSES = 3
"""How many times what is wrong is looked for, each time in what was put right before."""

_SOUND = 10.0
"""Inflation above which a model errs by so much that nothing is to be gained from more samples."""

_BEFORE_DECAY = 0.1
"""s from the release to the decay in a usual drop, for planning further ones."""


def identify(
    campaign: Campaign,
    *,
    tracks: Tracks | None = None,
    extras: Sequence[str] | None = None,
    fall: bool | None = None,
    profile: str | Sequence[str] = (),
    amplitude: bool = False,
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
    fall
        Whether drops are used from their release on, and not only from when the last tyre is down. It halves the uncertainties
        and takes a few times as long; left open, it is done where a parameter is uncertain by more than 2 %. Overrides the
        campaign.
    profile
        Parameters whose 95 % interval is to follow from the whole profile of the likelihood, not from its curvature at the
        maximum: for those that are weakly determined, whose interval is not symmetric. Also derived quantities
        (``total_mass``, ``front_axle_mass``, ``rear_axle_mass``, ``wheelbase``), or ``all`` for every parameter.
    amplitude
        Whether to follow the body's modes through the decays, for frequency and damping against amplitude.
    progress
        Told in words what is being done.

    Returns
    -------
    Result

    Raises
    ------
    InputError
        If no drop can be used, what is known contradicts the model that is wanted, or a profile is wanted of something that
        the model does not have.

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
    asked = check_asked(profile, campaign, tracks, extras)
    fitted = fit_campaign(campaign, tracks=tracks, extras=extras, fall=fall, progress=progress)
    options = {"tracks": tracks, "extras": extras, "fall": fall, "profile": asked}
    return result_of(fitted, asked, progress, amplitude=amplitude, options=options)


class Fitted(NamedTuple):
    """A campaign and its fit.

    Attributes
    ----------
    campaign
        What was fitted.
    choice, why, path
        With which model, what decided that, and what was tried.
    prepared
        Its decays, from where they were used.
    summit
        Where the fit ended.
    fit
        How sure it is.
    found
        The decays as they were found, before any fit.
    accused
        What is probably wrong, though nothing was done about it.
    """

    campaign: Campaign
    choice: Choice
    why: str
    prepared: Prepared
    summit: Summit
    fit: Fit
    found: tuple[Decay, ...]
    path: tuple[Attempt, ...] = ()
    accused: tuple[Fault, ...] = ()


def fit_campaign(
    campaign: Campaign,
    *,
    tracks: Tracks | None = None,
    extras: Sequence[str] | None = None,
    fall: bool | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Fitted:
    """Fit a campaign, as `identify` does before it judges; what is wrong with it is put right or left out, and named."""
    fitted, mended = _fit(campaign, tracks, extras, (), progress), tuple[Hypothesis, ...]()
    for _ in range(_DIAGNOSES):
        suspicion = suspicious(fitted.campaign, fitted.prepared.decays, fitted.summit)
        if suspicion == "none":
            break
        progress("looking for what is wrong")
        taken = _diagnosed(fitted, suspicion)
        mended = (*mended, *(one for one in taken if one.remedy != "named"))
        accused = tuple(one.fault for one in taken if one.remedy == "named")
        if len(taken) > len(accused):
            fitted = _fit(campaign, tracks, extras, mended, progress)
        fitted = fitted._replace(accused=accused)
        if accused or not taken:
            break
    if any(one.settle is not None for one in mended):
        listed = scores(fitted.campaign, fitted.prepared.decays, fitted.summit)
        mended = tuple(one if one.settle is None else one.settle(listed) for one in mended)
        fitted = _fit(campaign, tracks, extras, mended, progress)._replace(accused=fitted.accused)
    return _with_the_fall(
        _with_flights(_with_drifts(fitted), progress), campaign.model.fall if fall is None else fall, progress
    )


def _is_sound(fitted: Fitted) -> bool:
    """Say whether more of the same model is worth trying."""
    return fitted.fit.converged and not fitted.accused and fitted.fit.inflation < _SOUND


def _with_flights(fitted: Fitted, progress: Callable[[str], None]) -> Fitted:
    """Use what flights tell of the vehicle that had to tell the clocks of several loggers."""
    if not _is_sound(fitted) or fitted.choice.followed:
        return fitted
    told = told_by_flights(
        fitted.campaign,
        fitted.prepared,
        fitted.summit,
        lambda decays: fit_from(fitted.choice, decays, fitted.summit, CONVERGED, progress),
    )
    if told is None:
        return fitted
    decays, summit = told
    return fitted._replace(
        why=f"{fitted.why}; what the flights that told the clocks tell of the vehicle is used too",
        prepared=fitted.prepared._replace(decays=decays),
        summit=summit,
        fit=describe(summit, decays),
    )


def _with_the_fall(fitted: Fitted, wanted: bool | None, progress: Callable[[str], None]) -> Fitted:
    """Use the drops from their releases on, where that is wanted or needed, and where it says more."""
    if wanted is False or (wanted is None and not (_is_sound(fitted) and is_needed(fitted.fit))):
        return fitted
    flown = fly(fitted.campaign, fitted.choice, fitted.prepared, fitted.summit, fitted.fit, progress)
    if flown is None:
        return fitted._replace(why=f"{fitted.why}; the fall before the landing was tried and says nothing more")
    return fitted._replace(
        choice=flown.choice,
        why=f"{fitted.why}; the fall is used too, which makes uncertainties {flown.sharper:.2f} times what they were",
        prepared=fitted.prepared._replace(decays=flown.decays),
        summit=flown.summit,
        fit=flown.fit,
    )


def _with_drifts(fitted: Fitted) -> Fitted:
    """Name the channels whose level walks too little to spoil the fit, as far as nobody has."""
    campaign, decays = fitted.campaign, fitted.prepared.decays
    faults = [*campaign.faults, *(fault for decay in decays for fault in decay.faults)]
    said = {fault.where for fault in faults if fault.code == "drift"}
    named = {one.channel for one in campaign.sensors if any(one.channel in where for where in said)}
    more = tuple(one for one in walking_slowly(decays, fitted.summit, campaign.sensors) if one.where not in named)
    return fitted._replace(campaign=replace(campaign, faults=(*campaign.faults, *more)))


def _fit(
    campaign: Campaign,
    tracks: Tracks | None,
    extras: Sequence[str] | None,
    mended: Sequence[Hypothesis],
    progress: Callable[[str], None],
) -> Fitted:
    """Fit a campaign with what is wrong put right or left out."""
    left_out = {one.drop: one.fault for one in mended if one.drop is not None}
    for one in mended:
        if one.drop is None:
            changed = one.change(campaign)
            campaign = replace(changed, faults=(*changed.faults, one.fault))
    wanted = choose_model(campaign, tracks, None if extras is None else tuple(extras))
    # An engine that no sensor feels is put into a vehicle that is there already: nothing tells of it before.
    choice = wanted.having(tuple(extra for extra in wanted.linear_extras if extra != ENGINE))
    progress("finding the decays")
    prepared = _without(campaign, prepare(campaign), left_out)
    _need_decays(campaign, prepared)
    prepared, first = set_clocks(
        campaign,
        prepared,
        lambda known: _without(campaign, prepare(known), left_out),
        lambda decays: _ascend(campaign, choice, decays, None, NEAR, progress),
    )
    start = None if first is None else first.parameters
    first = _ascend(campaign, choice, prepared.decays, start, NEAR, progress)
    way = Way(choice, first, prepared.decays, (), progress).carried()
    way = way.wanting([extra for extra in wanted.linear_extras if extra not in choice.extras]).linear()
    way = _from_contact(way)
    way = (
        way.with_forces(wanted)
        if wanted.nonlinear
        else way.nonlinear(replace(choice, carried_at=way.choice.carried_at))
    )
    if way.choice.nonlinear:
        way = _from_contact(way)
    progress("judging the fit")
    summit, decays = look_around(way.summit), tuple(way.decays)
    fit, found = describe(summit, decays), prepared.decays
    return Fitted(campaign, way.choice, way.why, prepared._replace(decays=decays), summit, fit, found, way.path)


def _from_contact(way: Way) -> Way:
    """Let the fitted vehicle say where each decay begins, and fit to the end."""
    decays, summit = ascend_from_contact(
        way.decays,
        way.choice.models,
        way.summit,
        lambda decays, found, states: fit_from(way.choice, decays, found, CONVERGED, way.progress, states),
    )
    return replace(way, decays=decays, summit=summit)


def _without(campaign: Campaign, prepared: Prepared, left_out: Mapping[str, Fault]) -> Prepared:
    """Leave drops out of what was prepared, by their recordings."""
    named = {one.name: (drop, one) for drop, one in zip(campaign.drops, campaign.recordings, strict=True)}
    gone = [decay for decay in prepared.decays if decay.file in left_out]
    return prepared._replace(
        decays=tuple(decay for decay in prepared.decays if decay.file not in left_out),
        left_out=(*prepared.left_out, *((*named[one.file], (*one.faults, left_out[one.file])) for one in gone)),
    )


def _diagnosed(fitted: Fitted, suspicion: Suspicion) -> tuple[Hypothesis, ...]:
    """Look for what is wrong, with the larger of the models that are open."""
    choice = fitted.choice
    tracks: Tracks = "separate" if choice.open else choice.tracks

    def bench(decays: Sequence[Decay]) -> Bench:
        return Bench.of(fitted.campaign, decays, tracks, choice.linear_extras)

    if suspicion == "contradicted":
        return diagnose(bench(fitted.prepared.decays))
    # A sensor that tells something wrong may have told the landing wrong. Without any, what is left may be too little.
    safe = bench(without_looking_at_wheels(fitted.campaign, fitted.found))
    taken = diagnose(safe)
    if safe.base.explained or any(not one.specific and one.fault.code != "drift" for one in taken):
        return diagnose(bench(fitted.found)) or taken
    return taken


def as_test(fitted: Fitted) -> PlannedTest:
    """Take what was fitted as a test to which others may be added, of the vehicle that was found as far as it is linear."""
    campaign, decays = fitted.campaign, fitted.prepared.decays
    choice = fitted.choice.having(fitted.choice.linear_extras)
    fit = fitted.fit.only(choice.names)
    subject = subject_of_fit(
        fit,
        choice.tracks,
        choice.extras,
        choice.known,
        campaign.sensors,
        rate=float(np.median([decay.rate for decay in decays])),
        duration=_BEFORE_DECAY + float(np.median([decay.samples / decay.rate for decay in decays])),
        heights=choice.heights,
        name=campaign.name,
    )
    used = {decay.file for decay in decays}
    dropped = [
        PlannedDrop(campaign.load(drop.load), seen.wheels, drop.height or DEFAULT_HEIGHT)
        for drop, seen in zip(campaign.drops, fitted.prepared.seen, strict=True)
        if seen.recording.name in used
    ]
    return campaign_of_fit(subject, fit, dropped)


def _ascend(
    campaign: Campaign,
    choice: Choice,
    decays: Sequence[Decay],
    start: Mapping[str, float] | None,
    enough: float,
    progress: Callable[[str], None],
) -> Summit:
    models, sensors, known = choice.models, campaign.sensors, choice.known
    return ascend(decays, models, sensors, known, start=start, enough=enough, progress=progress)


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


def result_of(
    fitted: Fitted,
    profile: Sequence[str] = (),
    progress: Callable[[str], None] = lambda _: None,
    *,
    amplitude: bool = False,
    options: Mapping[str, object] = MappingProxyType({}),
) -> Result:
    """Judge a fit, and put together what is said of it, with intervals from profiles of what is named."""
    campaign, choice, why, prepared, summit, fit, _, path, accused = fitted
    decays = prepared.decays
    channels = tuple(sensor.channel for sensor in campaign.sensors)
    looked_at = check_prepared(campaign, prepared)
    clocks = clock_reports(summit, fit, decays)
    estimates = conclude(fit, choice.known)
    misfit = judge_residuals(fit, decays)
    motions = body_motions(fit, decays, campaign.sensors)
    validated = validate_drops(summit, fit, decays, channels, motions)
    verdict = judge(fit, misfit, estimates.parameters, channels, [fault.what for fault in accused], validated)
    doubt = doubt_of(verdict, fit, misfit)
    if doubt:
        fit = fit.widened(doubt)
        estimates = conclude(fit, choice.known).refused(verdict.reasons[0])
    profiles = profiles_of(profile, summit, fit, choice.known, progress)
    if amplitude:
        progress("following the modes of the body through the decays")
    loads = [load.name for load in campaign.loads if any(decay.load == load.name for decay in decays)]
    return Result(
        version=version("sprung"),
        vehicle=VehicleName(name=campaign.name),
        verdict=verdict,
        next_step=None if verdict.state == "reject" else next_step(as_test(fitted)).text,
        parameters={name: profiles.get(name, found) for name, found in estimates.parameters.items()},
        derived={
            **about_roll_axis(fit, choice.heights),
            **{name: found for name, found in profiles.items() if name not in estimates.parameters},
        },
        scale=estimates.scale,
        unidentifiable=estimates.unidentifiable,
        correlation=estimates.correlation,
        modes={load: mode_estimates(fit, choice.models[load], campaign.sensors) for load in loads},
        fit=_fit_report(choice, why, path, fit, decays, channels, misfit),
        drops=tuple(replace(drop, clocks=clocks.get(drop.file, ())) for drop in looked_at.drops),
        faults=(*looked_at.faults, *accused),
        validation=validated,
        setup=setup_of(campaign, fit, choice.known, options),
        amplitude=amplitudes_of(fit, choice, decays, campaign.sensors, motions) if amplitude else (),
        series={
            decay.name: _series(decay, fitted, motion, channels)
            for decay, fitted, motion in zip(decays, fit.fitted, motions, strict=True)
        },
        recordings={drop.name: one for drop, one in zip(looked_at.drops, looked_at.recorded, strict=True)},
    )


def _fit_report(
    choice: Choice,
    why: str,
    path: tuple[Attempt, ...],
    fit: Fit,
    decays: Sequence[Decay],
    channels: Sequence[str],
    misfit: Misfit,
) -> FitReport:
    return FitReport(
        samples=sum(int(decay.usable.sum()) * decay.samples for decay in decays),
        drops=len(decays),
        noise=dict(zip(channels, fit.noise.tolist(), strict=True)),
        model=choice.extras,
        tracks=choice.tracks,
        why=why,
        axes=axes_of(choice.heights),
        since="release" if choice.airborne else "landing",
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
    )


def _series(decay: Decay, fitted: NDArray[np.float64], motion: BodyMotion, channels: tuple[str, ...]) -> Series:
    level = decay.values.mean(axis=1, keepdims=True)
    body = motion.measured.astype(np.float32), motion.simulated.astype(np.float32)
    return Series(channels, motion.time, decay.values, fitted + level, *body)
