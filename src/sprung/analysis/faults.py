"""The stages in which faults are isolated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from sprung.analysis.analysis import MOST_RESTARTS, Analysis
from sprung.analysis.baseline import begun_no_earlier, converged, explains_beginnings
from sprung.analysis.correcting import restart_corrected
from sprung.analysis.first_term import explaining_term, rivalling_term, rivalling_usual_terms
from sprung.analysis.on_pads import has_pads
from sprung.analysis.preparation import preprocess
from sprung.analysis.settling import settle_corrections
from sprung.analysis.terms import flexible_body_given_up, select_finite_rotation
from sprung.errors import Fault
from sprung.estimation import NEAR, FitResult
from sprung.faults import (
    CandidateFit,
    Consistency,
    Hypothesis,
    consistency_of,
    correct_beside_terms,
    decays_without_wheel_sensors,
    isolate,
)
from sprung.preprocess import FreeDecay
from sprung.progress import Progress, Step, silent
from sprung.selection import (
    FAR,
    SEPARATE_TRACKS,
    ModelSearch,
    ModelStructure,
    find_sensor_error,
    fit_structure,
    furthest_from_stated,
    needed_terms,
    sensor_error_of_fit,
)
from sprung.vehicle import SensorQuantity

_SAME_MISFIT = 0.5
"""Part of a misfit of which no fault explained any; one that explains all that is left would have explained so much then."""

_IN_WORDS: Mapping[SensorQuantity, str] = {
    "gain": "gain",
    "x": "place",
    "y": "place",
    "tilt_x": "tilt",
    "tilt_y": "tilt",
    "delay": "delay",
}
"""Unknowns of a sensor in words."""


def isolate_evident_faults(run: Analysis, progress: Progress) -> Analysis:
    """Correct what explains the recordings wholly, before any further model term is tried."""
    consistency = _consistency(run)
    if consistency is None:
        return run
    first = explaining_term(run, consistency)
    if first is not None:
        return replace(run, first_term=first[0]).noted("isolate_evident_faults", f"{first[0]} is tried first", first[1])
    if consistency == "misfit" and _was_none_found(run):
        return run.noted(
            "isolate_evident_faults", "faults are not looked for again", "none explained any of the same misfit"
        )
    on_pads = _sensor_on_pads(run, wholly=True)
    if on_pads:
        return restart_corrected(run, on_pads, "isolate_evident_faults")
    run = _with_isolated(run, consistency, progress)
    if not _is_evident(run.found):
        return run
    # Every real vehicle turns by finite angles: drops in which it rolls far differ from all others without any fault.
    turned = select_finite_rotation(run, progress)
    if turned.fit is not run.fit:
        run = _with_isolated(turned, _consistency(turned), progress)
    return _restart_without_rival(run, progress) if _is_evident(run.found) else run


def _restart_without_rival(run: Analysis, progress: Progress) -> Analysis:
    """Correct evident faults and start again, unless a model term may explain more: it is tried first."""
    rival = rivalling_term(run) or rivalling_usual_terms(run) or _body_given_up(run, progress)
    if rival is not None:
        return run.noted("isolate_evident_faults", f"{rival[0]}: tried before anything is corrected", rival[1])
    again = restart_corrected(run, run.found, "isolate_evident_faults")
    last = run.found[-1].candidate
    if run.without_wheels is None or not last.is_explained:
        return again
    # What a model lacks is largest when the wheels have just landed: later, healthy sensors may seem to explain it.
    corrected = preprocess(again, progress)
    if explains_beginnings(corrected, progress):
        return replace(again, preparation=corrected.preparation, preparations=corrected.preparations)
    what, why = "terms are tried before anything is corrected", "the faults do not explain the beginnings of the decays"
    return run.noted("isolate_evident_faults", what, why)


def _body_given_up(run: Analysis, progress: Progress) -> tuple[str, str] | None:
    """Return the flexible body that explains samples which a rigid one gave up, and why it is tried; None where none does."""
    search = replace(run.model, progress=progress)
    found = flexible_body_given_up(run, search)
    bodies = [term for term in found.structure.terms if term not in search.structure.terms]
    return (bodies[0], "it explains samples that a rigid body gave up") if bodies else None


def isolate_faults(run: Analysis, progress: Progress) -> Analysis:
    """Correct what explains much of what no model term explains; what is ambiguous is only named."""
    run = _with_isolated(run, _consistency(run), progress)
    found = run.found or _sensor_of_fit(run) or _sensor_on_pads(run, wholly=False)
    named = tuple(one.fault for one in found if one.remedy == "named") or (
        () if found else _suspected_sensor(run.model)
    )
    run = replace(run, suspected=tuple(dict.fromkeys((*run.suspected, *named))))
    for fault in named:
        run = run.noted("isolate_faults", f"suspected {fault.code} of {fault.where}", fault.what)
    corrected = [one for one in found if one.remedy != "named"]
    return restart_corrected(run, corrected, "isolate_faults") if corrected else run


def _sensor_of_fit(run: Analysis) -> tuple[Hypothesis, ...]:
    """Return the one sensor that the fit takes far from what is stated of it, with what corrects that.

    What follows from its own statement alone is no fault of any hypothesis: the fit has allowed for it.
    """
    if len(run.corrected) >= MOST_RESTARTS or run.model.has_model_error:
        return ()
    error = sensor_error_of_fit(run.model)
    if error is None:
        return ()
    return tuple(correct_beside_terms(CandidateFit.of(run.model.structure, run.decays, run.fit), error))


def _sensor_on_pads(run: Analysis, *, wholly: bool) -> tuple[Hypothesis, ...]:
    """Return the one sensor that stands out in a misfit on pads, with what corrects that; or only one that explains it wholly.

    Pads drive the vehicle all the time, so that no channel is predicted from where the vehicle was at first: which sensor it is
    follows from what the recordings alone would say of each.
    """
    if len(run.corrected) >= MOST_RESTARTS or not has_pads(run):
        return ()
    base = CandidateFit.of(run.model.structure, run.decays, run.fit)
    error = None if base.is_explained else find_sensor_error(run.model)
    if error is None:
        return ()
    (wrong,) = correct_beside_terms(base, error)
    return (wrong,) if not wholly or base.refit(wrong.correction, run.fit).is_explained else ()


def _suspected_sensor(search: ModelSearch) -> tuple[Fault, ...]:
    """Return the sensor that a fit takes furthest from what is stated of it, as a fault, if it is far.

    Where a model is followed step by step or in the frequency domain, which of several sensors is at fault is not isolated,
    and what is stated is not corrected. A model that leaves much takes healthy sensors anywhere, and so does one that has to
    agree with a wrong mass.
    """
    if search.has_model_error:
        return ()
    ratio, channel, quantity = furthest_from_stated(search)
    if abs(ratio) < FAR:
        return ()
    # What is stated of the vehicle and its loads may be wrong instead, as the verdict then says.
    contradicted = search.fit.problem.conflicts(search.fit.iterate, search.fit.overdispersion)
    if max(contradicted.values(), default=0.0) > abs(ratio):
        return ()
    what = _IN_WORDS[quantity]
    text = f"the fit takes its {what} {abs(ratio):.0f} times as far from what is stated as its standard uncertainty"
    do = "Check this sensor and those near it; correct what is stated of it."
    return (Fault("unlike-others", channel, f"{text}; nothing was changed", do),)


def _consistency(run: Analysis) -> Consistency | None:
    """Test the present fit; None where faults were looked for in it, or corrected often enough."""
    if len(run.corrected) >= MOST_RESTARTS or (run.isolated is not None and run.isolated[0] is run.fit):
        return None
    return consistency_of(run.campaign, run.decays, run.fit)


def _explains(hypotheses: Sequence[Hypothesis]) -> bool:
    """Whether hypotheses that were isolated one after the other explain the recordings wholly."""
    return bool(hypotheses) and hypotheses[-1].is_sufficient


def _is_evident(hypotheses: Sequence[Hypothesis]) -> bool:
    """Whether hypotheses explain the recordings wholly, and say what is to be done."""
    return _explains(hypotheses) and all(one.remedy != "named" and one.is_specific for one in hypotheses)


def _was_none_found(run: Analysis) -> bool:
    """Whether no fault explained any of a misfit of which a good part is left: none will explain all of that."""
    if run.isolated is None or run.isolated[1]:
        return False
    return replace(run.model, fit=run.isolated[0]).leaves_misfit(run.fit, _SAME_MISFIT)


def _with_isolated(run: Analysis, consistency: Consistency | None, progress: Progress) -> Analysis:
    """Look for faults in the present fit as far as its test gives reason to; without a test there is nothing to do."""
    if consistency is None:
        return run
    if consistency == "consistent":
        settled = settle_corrections(run)
        run = run if settled is run else converged(settled, progress)
        checked = replace(run, isolated=(run.fit, ()))
        return checked.noted("isolate_faults", "no fault is indicated", "the residuals are consistent with the model")
    progress(Step("isolating faults"))
    run, base = _with_base(run, consistency)
    is_sound = base.fit is not run.fit and consistency_of(base.campaign, base.decays, base.fit) == "consistent"
    found, fits = ((), 0) if is_sound else isolate(base, progress)
    run = replace(run, isolated=(run.fit, found), fits=run.fits + fits)
    if is_sound and base.structure.tracks != run.model.structure.tracks:
        run = replace(run, first_term=SEPARATE_TRACKS)
    faults = ", ".join(f"{one.fault.code} of {one.fault.where}" for one in found) or "no fault"
    explains = "explains the recordings" if _explains(found) else "explains a part of the recordings at most"
    return run.noted("isolate_faults", f"{consistency}: {faults} {explains}", f"{fits} fits of hypotheses")


def _with_base(run: Analysis, consistency: Consistency) -> tuple[Analysis, CandidateFit]:
    """Return the fit against which hypotheses are held, with the larger of the models that are open.

    A wheel sensor at fault may have shown a wrong landing: where the fit does not describe the recordings, the decays begin
    where they would without any, unless too little of the motion is left then to show what is wrong. What is left shows
    whether the larger model is needed.
    """
    structure = run.model.structure
    linear = structure.with_terms(structure.linear_terms)
    is_open = structure.tracks_open and consistency == "misfit"
    larger = linear.with_terms(linear.terms, "separate" if is_open else None)
    if consistency == "misfit":
        decays = run.without_wheels
        if decays is None:
            decays = decays_without_wheel_sensors(run.campaign, run.prepared.decays)
            run = replace(run, without_wheels=decays, preparations=run.preparations + 1)
        if any(other.start > decay.start for other, decay in zip(decays, run.decays, strict=True)):
            run = replace(run, fits=run.fits + 1)
            base = _fit_of(larger, decays, run.fit)
            if not base.is_explained:
                whole = replace(CandidateFit.of(structure, run.decays, run.fit), structure=larger)
                return run, replace(base, whole=whole)
            if SEPARATE_TRACKS not in needed_terms(ModelSearch(larger, base.fit, decays)):
                larger = linear
        # A vehicle that is wrong may seem to be on the ground before it is: no hypothesis explains what it does in the air.
        decays = begun_no_earlier([decay for decay in run.prepared.decays if not decay.is_driven], run.decays)
        if any(other.start > decay.start for other, decay in zip(decays, run.decays, strict=True)):
            return replace(run, fits=run.fits + 1), _fit_of(larger, decays, run.fit)
    if larger.names == structure.names:
        return run, CandidateFit.of(structure, run.decays, run.fit)
    return replace(run, fits=run.fits + 1), _fit_of(larger, run.decays, run.fit)


def _fit_of(structure: ModelStructure, decays: Sequence[FreeDecay], before: FitResult) -> CandidateFit:
    """Fit a model to decays from nothing, or from a fit where it has coordinates that only a fitted vehicle shows."""
    if structure.needs_start:
        return CandidateFit.of(structure, decays, fit_structure(structure, decays, before, NEAR, silent))
    return CandidateFit.of(structure, decays)
