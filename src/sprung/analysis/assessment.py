"""The last stage: validation, verdict and the result."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.analysis.analysis import Analysis
from sprung.analysis.axes import about_roll_axis, axes_of
from sprung.analysis.clocks import clock_reports
from sprung.analysis.design import recommend_next_step
from sprung.analysis.profiles import profiles_of
from sprung.assessment import (
    BodyMotion,
    body_motions,
    cross_validate_drops,
    decide_verdict,
    estimate_model_error,
)
from sprung.checking import check_prepared
from sprung.estimation import (
    FitResult,
    FitStatistics,
    ForceCurve,
    characteristics_of,
    correlation_of,
    estimate_of,
    force_curves,
    mode_estimates,
    rates_at_motion_ratios,
    scale_of,
    to_estimates,
    unidentifiable_combinations,
)
from sprung.faults import CONTRADICTING, detect_drift
from sprung.preprocess import FreeDecay
from sprung.progress import Progress, Step
from sprung.results import FitReport, Result, SensorEstimate, Series, TestedVehicle, setup_of, withhold_estimates
from sprung.selection import SEPARATE_TRACKS, TERMS, ModelStructure, SelectionStep, begin_no_later, describe_terms
from sprung.uncertainty import without_rounding_errors
from sprung.vehicle import (
    EMPTY,
    LOAD_MASS,
    SENSOR_UNKNOWNS,
    Sensor,
    linear_elements,
    nonlinear_elements,
    sensor_unknown,
)

METHOD = "joint maximum likelihood"


def assess(run: Analysis, progress: Progress) -> Analysis:
    """Validate the fit, decide on the verdict, and put the result together."""
    run = _with_drifts(run)
    campaign, structure, optimum = run.campaign, run.model.structure, run.fit
    statistics, fit = run.uncertainty, run.uncertainty.of_vehicle
    decays = run.decays
    doubts = tuple(one.doubt for one in run.corrected if one.doubt is not None)
    suspected = (*run.suspected, *doubts)
    progress(Step("judging the fit: each drop predicted by the others"))
    channels = tuple(sensor.channel for sensor in campaign.sensors)
    looked_at = check_prepared(campaign, run.prepared._replace(decays=decays))
    clocks = clock_reports(optimum, fit, decays)
    estimates = without_rounding_errors(to_estimates(fit, structure.known))
    misfit = estimate_model_error(optimum)
    fitted = optimum.fitted
    motions = body_motions(optimum, decays, fitted, campaign.sensors)
    validated = cross_validate_drops(optimum, fit, decays, channels, motions)
    contradicting = sum(any(fault.code in CONTRADICTING for fault in faults) for _, faults in run.prepared.left_out)
    reasons = [*(f"{fault.where}: {fault.what}" for fault in suspected), *_unexplained_beginning(run)]
    refuting = [fault.what for fault in run.refuting]
    verdict = decide_verdict(fit, misfit, estimates, channels, reasons, validated, contradicting, refuting)
    rejected = verdict.state == "reject"
    profiles = {} if rejected else profiles_of(run.options.profile, optimum, statistics, structure.known, progress)
    loads = [load.name for load in campaign.loads if any(decay.load == load.name for decay in decays)]
    setup = setup_of(campaign, fit, structure.known, run.options.texts)
    derived = {
        **({} if rejected else characteristics_of(fit, structure.known, structure.linear_models[EMPTY.name])),
        **({} if rejected else rates_at_motion_ratios(fit, campaign.motion_ratio)),
        **about_roll_axis(fit, structure.heights),
        **{name: estimate_of(fit, structure.known, name) for name in fit.names if name.startswith(LOAD_MASS)},
        **{name: found for name, found in profiles.items() if name not in estimates},
    }
    result = Result(
        version=setup.software["sprung"],
        tested_vehicle=TestedVehicle(name=campaign.name, identification=campaign.identification),
        verdict=verdict,
        next_step=None if rejected else recommend_next_step(run),
        parameters={name: profiles.get(name, found) for name, found in estimates.items()},
        derived=without_rounding_errors(derived, among=estimates),
        scale=scale_of(fit),
        unidentifiable=unidentifiable_combinations(fit, estimates),
        correlation=correlation_of(fit, estimates),
        modes={load: () if rejected else mode_estimates(fit, structure.linear_models[load]) for load in loads},
        sensors=_sensor_estimates(statistics, structure.sensors),
        additional_terms="" if rejected else _additional_terms(structure, fit),
        curves={} if rejected else _curves_of(structure, fit, optimum),
        fit=_fit_report(structure, _reason(run), run.model.steps, fit, decays, channels, misfit, optimum),
        drops=tuple(replace(drop, clocks=clocks.get(drop.label, ())) for drop in looked_at.drops),
        faults=tuple(dict.fromkeys((*looked_at.faults, *suspected))),
        validation=validated,
        setup=setup,
        series={
            decay.name: _series(decay, modelled, motion, channels)
            for decay, modelled, motion in zip(decays, fitted, motions, strict=True)
        },
        recordings={drop.name: one for drop, one in zip(looked_at.drops, looked_at.recorded, strict=True)},
    )
    run = run.noted("assess", verdict.state, "; ".join(verdict.reasons))
    return replace(run, result=withhold_estimates(replace(result, trace=run.trace)))


def _unexplained_beginning(run: Analysis) -> tuple[str, ...]:
    """Return why a correction is doubted that explains less of the decays than the accelerometers show to be free.

    What a model lacks is largest there: without these samples it may look like a fault, or be missed.
    """
    if not run.corrected:
        return ()
    early = begin_no_later(run.model, run.prepared.decays)
    if early is run.model or not early.has_model_error:
        return ()
    lost = max(decay.start - before.start for decay, before in zip(run.decays, early.decays, strict=True))
    corrected = ", ".join(dict.fromkeys(one.fault.where for one in run.corrected))
    what = f"does not explain up to {lost:.2f} s in which all tyres are on the ground"
    return (f"with the correction of {corrected}, the model {what}: it lacks something, or something else is wrong",)


def _sensor_estimates(fit: FitStatistics, sensors: Sequence[Sensor]) -> tuple[SensorEstimate, ...]:
    """Return what was found of the sensors, channel by channel."""
    std = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0))
    found = []
    for sensor in sensors:
        for quantity, unknown in SENSOR_UNKNOWNS.items():
            name = sensor_unknown(quantity, sensor.channel)
            if name in fit.names:
                at = fit.names.index(name)
                found.append(
                    SensorEstimate(
                        channel=sensor.channel,
                        quantity=quantity,
                        value=float(fit.values[at]),
                        std=float(std[at]),
                        stated_std=sensor.uncertainties[name].std,
                        unit=unknown.unit,
                    )
                )
    return tuple(found)


def _additional_terms(structure: ModelStructure, fit: FitStatistics) -> str:
    """Return one sentence that states what the vehicle has besides springs and dampers."""
    terms = [SEPARATE_TRACKS] * (structure.tracks == "separate") + list(structure.terms)
    return describe_terms([TERMS[name].description for name in terms], fit)


def _curves_of(structure: ModelStructure, fit: FitStatistics, optimum: FitResult) -> dict[str, ForceCurve]:
    """Return the force curves of the dampers, springs and tyres that are not linear."""
    if not structure.is_nonlinear:
        return {}
    tracks, terms, wheelbase, layout = structure.tracks, structure.terms, structure.wheelbase, structure.layout
    linear = linear_elements(tracks, terms, structure.heights, wheelbase, layout)
    nonlinear = nonlinear_elements(tracks, terms, wheelbase, layout=layout)
    return force_curves(fit, optimum, structure.nonlinear_models, linear, nonlinear)


def _fit_report(
    structure: ModelStructure,
    why: str,
    path: tuple[SelectionStep, ...],
    fit: FitStatistics,
    decays: Sequence[FreeDecay],
    channels: Sequence[str],
    misfit: tuple[NDArray[np.float64], NDArray[np.float64]],
    optimum: FitResult,
) -> FitReport:
    return FitReport(
        samples=sum(int(decay.usable.sum()) * decay.samples for decay in decays),
        drops=len(decays),
        noise=dict(zip(channels, fit.noise.tolist(), strict=True)),
        model=structure.terms,
        tracks=structure.tracks,
        why=why,
        axes=axes_of(structure.heights, structure.assumed_heights is not None, structure.layout),
        since="release" if structure.unilateral_tyres else "landing",
        path=path,
        method=METHOD,
        iterations=fit.iterations,
        converged=fit.converged,
        starts=fit.starts,
        starts_agreeing=fit.starts_agreeing,
        inflation=fit.inflation,
        inflated_by=fit.inflated_by,
        most_coloured=None if fit.most_coloured is None else channels[fit.most_coloured],
        misfit=dict(zip(channels, misfit[0].tolist(), strict=True)),
        loglikelihood=optimum.absolute_loglikelihood,
        unknowns=optimum.unknowns,
    )


def _series(decay: FreeDecay, fitted: NDArray[np.float64], motion: BodyMotion, channels: tuple[str, ...]) -> Series:
    level = decay.values.mean(axis=1, keepdims=True)
    body = motion.measured.astype(np.float32), motion.simulated.astype(np.float32)
    return Series(channels, motion.time, decay.values, fitted + level, *body)


def _reason(run: Analysis) -> str:
    """Return what decided on the model, and how the flight was used."""
    return "; ".join((run.model.reason, *run.remarks))


def _with_drifts(run: Analysis) -> Analysis:
    """Return the analysis with the faults of channels whose baseline drift does not affect the fit, unless already known."""
    campaign, decays = run.campaign, run.decays
    faults = [*campaign.faults, *(fault for decay in decays for fault in decay.faults)]
    places = {fault.where for fault in faults if fault.code == "drift"}
    named = {sensor.channel for sensor in campaign.sensors if any(sensor.channel in where for where in places)}
    drifts = [fault for fault in detect_drift(decays, run.fit, campaign.sensors) if fault.where not in named]
    return replace(run, campaign=replace(campaign, faults=(*campaign.faults, *drifts)))
