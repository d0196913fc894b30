"""Intervals from profiles: names checked before anything is fitted, and found again in the model that was chosen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sprung.campaign import Campaign
from sprung.errors import Problems, did_you_mean
from sprung.estimation import FitResult, FitStatistics, estimate_of, profiled
from sprung.progress import Progress, counted
from sprung.selection import choose_structure
from sprung.uncertainty import Estimate, KnownValue
from sprung.vehicle import DERIVED, Tracks, half_distances, parameter_names

ALL = "all"
"""Stands for every parameter of the model."""

_HALF_DISTANCES = tuple(half_distances("shared").values())


def check_asked(
    profile: str | Sequence[str], campaign: Campaign, tracks: Tracks | None, extras: Sequence[str] | None
) -> tuple[str, ...]:
    """Check the names of what is to be profiled.

    Parameters
    ----------
    profile
        One name, or several; ``all`` for every parameter.
    campaign, tracks, extras
        As for `identify`.

    Returns
    -------
    tuple of str
        The names.

    Raises
    ------
    InputError
        If the model will have no such quantity, or the model itself cannot be chosen.
    """
    names = (profile,) if isinstance(profile, str) else tuple(profile)
    if not names:
        return ()
    choice = choose_structure(campaign, tracks, None if extras is None else tuple(extras))
    # Where the records are to decide about the half-distances, either names will do.
    either: tuple[Tracks, ...] = ("shared", "separate") if choice.tracks_open else (choice.tracks,)
    allowed = {ALL, *DERIVED, *(name for one in either for name in parameter_names(one, choice.terms, choice.layout))}
    problems = Problems()
    for name in names:
        if name not in allowed:
            where = f"profile: {name}"
            problems.add(
                where, f"'{name}'", "a parameter of the model, or a quantity derived", did_you_mean(name, allowed)
            )
    problems.raise_if_any()
    return names


def profiles_of(
    asked: Sequence[str], optimum: FitResult, fit: FitStatistics, known: Mapping[str, KnownValue], progress: Progress
) -> dict[str, Estimate]:
    """Estimate what was asked for, with intervals from profiles.

    Parameters
    ----------
    asked
        From `check_asked`.
    optimum, fit, known
        Where the fit ended, how sure it is, and what was known beforehand.
    progress
        Called with each step that begins.

    Returns
    -------
    dict
        By name, parameters first.
    """
    found = {}
    for name in counted(progress, "following the likelihood for an interval", _named(asked, fit.names)):
        found[name] = profiled(optimum, fit, name, estimate_of(fit, known, name))
    return found


def _named(asked: Sequence[str], names: Sequence[str]) -> tuple[str, ...]:
    """Find names among the model's; half-distances by the axle where they are shared otherwise than was thought."""
    axles = {name[:3] for name in asked if name.startswith(_HALF_DISTANCES) and name not in names}
    chosen = [name for name in names if ALL in asked or name in asked or name[:3] in axles]
    return (*chosen, *(name for name in DERIVED if name in asked))
