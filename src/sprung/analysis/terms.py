"""The stages in which model terms are selected."""

from __future__ import annotations

from dataclasses import replace

from sprung.analysis.analysis import MOST_RESTARTS, Analysis
from sprung.analysis.baseline import described, structures
from sprung.analysis.correcting import restart_corrected
from sprung.analysis.first_term import explaining_term
from sprung.analysis.on_pads import NOT_STEPPED, has_pads
from sprung.faults import CandidateFit, consistency_of, correct_beside_terms
from sprung.progress import Progress
from sprung.selection import (
    FLEXIBLE_BODIES,
    REQUIRED_OF_ROTATION,
    TERMS,
    ModelSearch,
    SelectionStep,
    begin_no_later,
    corner_of,
    fit_forced_terms,
    from_contact,
    is_likelier,
    is_ordinary,
    leave_out_refused,
    leave_out_unneeded,
    may_be_astray,
    or_from_ordinary_vehicle,
    or_with_usual_linear_terms,
    select_flexible_body,
    select_further_terms,
    try_term,
    with_short_steps,
)
from sprung.selection import select_finite_rotation as select_rotation
from sprung.selection import select_linear_terms as select_linear
from sprung.selection import select_nonlinear_terms as select_nonlinear

_NO_TERM = "no term is tried", "no vehicle recorded all drops, whatever terms its model has"
"""What is noted of recordings of several vehicles."""


def select_first_term(run: Analysis, progress: Progress) -> Analysis:
    """Try what explains much of the misfit, one term after the other; a body that is flexible is looked for otherwise."""
    before, term = run.model, run.first_term
    found = replace(run, search=replace(before, progress=progress), first_term=None)
    while term is not None and not TERMS[term].explains_all:
        search = try_term(found.model, term)
        is_refused = search.structure.names == found.model.structure.names
        found = replace(found, search=search)
        if is_refused:
            break
        explaining = explaining_term(found, consistency_of(found.campaign, found.decays, found.fit))
        term = None if explaining is None else explaining[0]
    if len(found.model.steps) == len(before.steps):
        return run
    search = found.model
    if search.structure.names != before.structure.names:
        # Without the term wheels may have seemed to be nowhere, and the fit with it have begun there.
        search = from_contact(or_from_ordinary_vehicle(search) if may_be_astray(search) else search)
    return _with_search(replace(run, first_term=None), before, search, "select_first_term")


def select_linear_terms(run: Analysis, progress: Progress) -> Analysis:
    """Select the terms that the matrices M, C and K hold."""
    before = run.model
    if run.refuting:
        return run.noted("select_linear_terms", *_NO_TERM)
    search = or_with_usual_linear_terms(_rigid_or_flexible(run, replace(before, progress=progress)))
    if search.structure.names != before.structure.names:
        # The fit has moved since a term was accepted: it may speak against it now, and what it explained be another one's.
        moved = from_contact(search)
        search = leave_out_refused(moved)
        if search.structure.names != moved.structure.names:
            # What was refused beside a term that is gone may be what that one was taken for.
            gone = [term for term in moved.selected if term not in search.selected]
            search = from_contact(select_linear(search, refused=gone))
    return _with_search(run, before, search, "select_linear_terms")


def _rigid_or_flexible(run: Analysis, before: ModelSearch) -> ModelSearch:
    """Select terms beside a flexible body if there is one; beside a rigid one, too, if another term than that explains most."""
    search = _with_flexible_body(run, before)
    has_body = search.structure.names != before.structure.names
    if search.fit is not before.fit or not has_flexible_body(run):
        search = select_linear(search, refused=before.refused)
    if not has_body or run.first_term in (None, *FLEXIBLE_BODIES):
        return search
    # By its first steps it does: a flexible body takes up a part of that.
    rigid = select_linear(replace(before, steps=search.steps), refused=before.refused)
    return rigid if is_likelier(rigid, search) else replace(search, steps=rigid.steps)


def _with_flexible_body(run: Analysis, search: ModelSearch) -> ModelSearch:
    """Return the search with a body that twists or bends, if it explains what a rigid one leaves or gave up."""
    found = select_flexible_body(search)
    return found if found is not search or not search.is_overdispersed else flexible_body_given_up(run, search)


def flexible_body_given_up(run: Analysis, search: ModelSearch) -> ModelSearch:
    """Return the search with a flexible body that explains samples which a rigid one gave up, or as given.

    To a rigid body that has to explain a flexible one wheels seem to hop until the vibration of this one has decayed.

    Parameters
    ----------
    run
        With its decays as they were prepared.
    search
        Of decays that begin later.
    """
    early = begin_no_later(search, run.prepared.decays)
    found = select_flexible_body(early)
    return search if found.structure.names == early.structure.names else found


def select_finite_rotation(run: Analysis, progress: Progress) -> Analysis:
    """Take into account that the body turns by finite angles, if the recordings show it."""
    before = replace(run.model, progress=progress)
    if run.refuting:
        return run.noted("select_finite_rotation", *_NO_TERM)
    _, plain = structures(run)
    search = select_rotation(before, plain)
    if search is before:
        return run
    gain = search.gain_over(before)
    run = _with_search(replace(run, fits=run.fits + 1), run.model, search, "select_finite_rotation")
    what = "finite rotation and the sinking of the body under its loads: included"
    return run.noted("select_finite_rotation", what, f"Δ2lnL = {gain:.0f}, required {REQUIRED_OF_ROTATION:.0f}")


def select_nonlinear_terms(run: Analysis, progress: Progress) -> Analysis:
    """Fit the nonlinear terms that are requested, or select those that the recordings support."""
    if has_pads(run):
        return run.noted("select_nonlinear_terms", "no nonlinear term is tried", NOT_STEPPED)
    before, requested = replace(run.model, progress=progress), run.requested
    if requested is not None and requested.is_nonlinear:
        search = fit_forced_terms(before, requested)
    elif run.refuting:
        return run.noted("select_nonlinear_terms", *_NO_TERM)
    elif has_flexible_body(run):
        search = before
    else:
        wanted, _ = structures(run)
        found, plain = before.structure, wanted.with_terms(wanted.linear_terms)
        plain = replace(
            plain, carried_at=found.carried_at, assumed_heights=found.assumed_heights, sinking=found.sinking
        )
        before = replace(before, seeks_faults=len(run.corrected) < MOST_RESTARTS)
        early = begin_no_later(before, run.prepared.decays)
        search = select_nonlinear(early, plain)
        is_wanting = search.has_model_error or search.structure.names == found.names
        if early is not before and is_wanting and search.fault is None:
            search = select_nonlinear(replace(before, steps=search.steps), plain)
        if search.fault is not None:
            run = _noted_steps(run, run.model, search, "select_nonlinear_terms")
            wrong = correct_beside_terms(CandidateFit.of(found, run.decays, run.fit), search.fault)
            if any(one.is_refuting for one in wrong):
                return replace(run, isolated=(run.fit, tuple(wrong)))
            return restart_corrected(run, wrong, "select_nonlinear_terms")
    if search.structure.names != before.structure.names:
        search = _at_the_optimum(run, search)
    run = _with_search(run, run.model, search, "select_nonlinear_terms")
    if search.structure.low_pass is None:
        return run
    remark = f"recorded behind a low-pass of the loggers at {corner_of(search):.0f} Hz, as the recordings show"
    return replace(run, remarks=(*run.remarks, remark)).noted("select_nonlinear_terms", remark)


def _at_the_optimum(run: Analysis, search: ModelSearch) -> ModelSearch:
    """Fit a nonlinear model that was found to the end, and leave out the terms that turn out to be nothing there."""
    # A term that explained what another one makes may have led the fit away, to wheels that are nowhere.
    search = search if is_ordinary(search) else or_from_ordinary_vehicle(search)
    # The search compares fits to beginnings, or to a standard error.
    last = from_contact(search)
    needed, _ = leave_out_unneeded(last, run.model)
    if needed is not last:
        # Where a wheel last touched, a model with more than the vehicle has did not know.
        last = from_contact(search.refit_as(needed))
        if last.is_overdispersed:
            # What was refused beside a term that is gone may be what that one was taken for.
            last = from_contact(select_further_terms(last, whole=True))
    return with_short_steps(last)


def has_flexible_body(run: Analysis) -> bool:
    """Whether nothing but a flexible body explains what the present fit leaves, so that no further term is to be tried."""
    return any(hypothesis.fault.code == "twist" for hypothesis in run.found)


def _with_search(run: Analysis, before: ModelSearch, search: ModelSearch, stage: str) -> Analysis:
    noted = replace(_noted_steps(run, before, search, stage), search=search)
    return noted.noted(stage, described(search), f"{noted.fits - run.fits} fits")


def _noted_steps(run: Analysis, before: ModelSearch, search: ModelSearch, stage: str) -> Analysis:
    """Count the fits of a search, and note what it tried."""
    steps = search.steps[len(before.steps) :]
    fits = sum(step.fitted and not step.joint for step in steps) + (search.structure.names != before.structure.names)
    run = replace(run, fits=run.fits + fits)
    for step in steps:
        run = run.noted(stage, f"{step.extra}: {_outcome(step)}", step.text)
    return run


def _outcome(step: SelectionStep) -> str:
    if step.taken:
        return "included"
    return "fitted and not included" if step.fitted else "scored and not fitted"
