"""How far a fit has come: the campaign as it is used, its decays, and the model so far."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

from sprung.analysis.clocks import set_clocks
from sprung.campaign import Campaign
from sprung.errors import Fault, Problems
from sprung.estimation import (
    CONVERGED,
    NEAR,
    FitResult,
    FitStatistics,
    escape_local_optimum,
    fit_from_contact,
    fit_linear,
    uncertainty_of,
)
from sprung.faults import Hypothesis, Suspicion, suspicious
from sprung.preprocess import FreeDecay, Prepared, leave_out, prepare
from sprung.progress import Progress, Step
from sprung.selection import (
    ENGINE,
    ModelSearch,
    ModelStructure,
    SelectionStep,
    choose_structure,
    fit_forced_terms,
    fit_requested_terms,
    fit_structure,
    select_linear_terms,
    select_nonlinear_terms,
    select_roll_axis_height,
)
from sprung.vehicle import LINEAR_EXTRAS, Tracks


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
    accused
        What is probably wrong, though nothing was done about it.
    """

    campaign: Campaign
    choice: ModelStructure
    why: str
    prepared: Prepared
    optimum: FitResult
    fit: FitStatistics
    path: tuple[SelectionStep, ...] = ()
    accused: tuple[Fault, ...] = ()


class Stand(NamedTuple):
    """How far a fit has come.

    Attributes
    ----------
    campaign
        With what is wrong put right or left out.
    wanted, plain
        The model that the user wants, and that without anything the records ask for.
    prepared
        Its decays as they were found, before any fit.
    way
        Where the choice of the model stands.
    """

    campaign: Campaign
    wanted: ModelStructure
    plain: ModelStructure
    prepared: Prepared
    way: ModelSearch

    @property
    def open_to_forces(self) -> bool:
        """Whether forces with laws of their own will be looked for."""
        return any(extra not in LINEAR_EXTRAS for extra in self.wanted.open_terms)

    @property
    def suspicion(self) -> Suspicion:
        """Whether there is reason to look for what is wrong."""
        return suspicious(self.campaign, self.way.decays, self.way.fit)

    def with_forces(self) -> Stand:
        """Fit the forces that are wanted, or that the records ask for."""
        plain = replace(self.plain, carried_at=self.way.structure.carried_at)
        way = (
            fit_forced_terms(self.way, self.wanted)
            if self.wanted.is_nonlinear
            else select_nonlinear_terms(self.way, plain)
        )
        return self._replace(way=_from_contact(way) if way.structure.is_nonlinear else way)

    def judged(self) -> Fitted:
        """Say how sure the fit is."""
        way = self.way
        way.progress(Step("computing the uncertainties"))
        optimum, decays = escape_local_optimum(way.fit), tuple(way.decays)
        prepared = self.prepared._replace(decays=decays)
        return Fitted(self.campaign, way.structure, way.reason, prepared, optimum, uncertainty_of(optimum), way.steps)


def begun(
    campaign: Campaign,
    prepared: Prepared,
    tracks: Tracks | None,
    extras: Sequence[str] | None,
    mended: Sequence[Hypothesis],
    progress: Progress,
    unusable: Mapping[str, Fault] = MappingProxyType({}),
    guess: Mapping[str, float] = MappingProxyType({}),
) -> Stand:
    """Fit a campaign with what is wrong put right or left out, as far as matrices carry the vehicle.

    Drops that are unusable for a known reason, by the names of their recordings, are left out from the start. The campaign is
    prepared again only where what is put right changes it.
    """
    changes = [one for one in mended if one.drop is None]
    left_out = {**unusable, **{one.drop: one.fault for one in mended if one.drop is not None}}
    for one in changes:
        changed = one.change(campaign)
        campaign = replace(changed, faults=(*changed.faults, one.fault))
    wanted = choose_structure(campaign, tracks, None if extras is None else tuple(extras))
    # An engine that no sensor feels is put into a vehicle that is there already: nothing tells of it before.
    choice = wanted.with_terms(tuple(extra for extra in wanted.linear_terms if extra != ENGINE))
    prepared = leave_out(campaign, prepare(campaign, progress) if changes else prepared, left_out)
    _need_decays(campaign, prepared)
    prepared, first = set_clocks(
        campaign,
        prepared,
        lambda known: leave_out(campaign, prepare(known, progress), left_out),
        lambda decays: _ascend(campaign, choice, decays, None, NEAR, progress, guess),
    )
    start = None if first is None else first.parameters
    first = _ascend(campaign, choice, prepared.decays, start, NEAR, progress, guess)
    way = select_roll_axis_height(ModelSearch(choice, first, prepared.decays, (), progress))
    way = select_linear_terms(
        fit_requested_terms(way, [extra for extra in wanted.linear_terms if extra not in choice.terms])
    )
    way = _from_contact(way)
    return Stand(campaign, wanted, choice, prepared, way)


def _from_contact(way: ModelSearch) -> ModelSearch:
    """Let the fitted vehicle say where each decay begins, and fit to the end."""
    decays, optimum = fit_from_contact(
        way.decays,
        way.structure.linear_models,
        way.fit,
        lambda decays, found, states: fit_structure(way.structure, decays, found, CONVERGED, way.progress, states),
    )
    return replace(way, decays=decays, fit=optimum)


def _ascend(
    campaign: Campaign,
    choice: ModelStructure,
    decays: Sequence[FreeDecay],
    start: Mapping[str, float] | None,
    enough: float,
    progress: Progress,
    guess: Mapping[str, float],
) -> FitResult:
    models, sensors, known = choice.linear_models, campaign.sensors, choice.known
    return fit_linear(decays, models, sensors, known, start=start, guess=guess, enough=enough, progress=progress)


def _need_decays(campaign: Campaign, prepared: Prepared) -> None:
    if prepared.decays:
        return
    problems = Problems()
    where = "campaign" if campaign.path is None else campaign.path.name
    problems.add(where, "no drop that can be used", "at least one", "Read the reasons below and record again.")
    for _, faults in prepared.left_out:
        for fault in faults:
            problems.add(fault.where, fault.what, "a usable decay", fault.do)
    problems.raise_if_any()
