"""Which model is fitted: what the user says, and what follows from what is known."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from sprung.errors import Problems, did_you_mean
from sprung.estimate import Known
from sprung.recording import Campaign
from sprung.vehicle import LINEAR_EXTRAS, LinearModel, Tracks, parameter_names, seven_degrees_of_freedom

_SEPARATE = ("t_f1", "t_f2", "t_r1", "t_r2")
_SHARED = ("t_f", "t_r")


class Choice(NamedTuple):
    """The model to fit.

    Attributes
    ----------
    tracks
        Whether springs and dampers of an axle share their half-distance.
    extras
        What it carries beyond the paper's seven degrees of freedom.
    known
        Everything known beforehand about its parameters, the wheelbase included.
    models
        Equations of motion by load name.
    open
        Whether neither the user nor what is known says anything about the tracks, so that the records are to decide.
    """

    tracks: Tracks
    extras: tuple[str, ...]
    known: Mapping[str, Known]
    models: Mapping[str, LinearModel]
    open: bool


def choose_model(campaign: Campaign, tracks: Tracks | None = None, extras: tuple[str, ...] | None = None) -> Choice:
    """Choose the model for a campaign.

    Parameters
    ----------
    campaign
        The campaign.
    tracks, extras
        Override what the campaign's own ``[model]`` says.

    Returns
    -------
    Choice

    Raises
    ------
    InputError
        If an extra is unknown or forbidden, or known half-distances contradict the choice of tracks.
    """
    problems = Problems()
    where = "campaign" if campaign.path is None else campaign.path.name
    chosen_extras = tuple(extras if extras is not None else campaign.model.extras or ())
    for extra in chosen_extras:
        if extra not in LINEAR_EXTRAS:
            problems.add(
                f"{where}: model.extras",
                f"'{extra}'",
                "an extra of the linear model",
                did_you_mean(extra, LINEAR_EXTRAS),
            )
        elif extra in campaign.model.forbid and extras is None:
            problems.add(f"{where}: model", f"'{extra}' both wanted and forbidden", "one of the two", "Remove one.")

    apart = [name for name in _SEPARATE if name in campaign.known]
    together = [name for name in _SHARED if name in campaign.known]
    chosen: Tracks = tracks or campaign.model.tracks or ("separate" if apart else "shared")
    clash = apart if chosen == "shared" else together
    if clash:
        problems.add(
            f"{where}: known.{clash[0]}",
            f'{", ".join(clash)} with tracks = "{chosen}"',
            "t_f and t_r where springs and dampers share their half-distance, t_f1, t_r1, t_f2 and t_r2 where not",
            'Set tracks = "separate" in [model] or rename the known half-distances.',
        )
    names = parameter_names(chosen, chosen_extras) if not problems else ()
    for name in campaign.known:
        if name in ("c_tf", "c_tr", "k_af", "k_ar") and names and name not in names:
            extra = "tyre-damping" if name.startswith("c") else "anti-roll"
            problems.add(
                f"{where}: known.{name}", "a parameter that the model does not have", f"the extra '{extra}'",
                f'Add extras = ["{extra}"] to [model], or remove it.',
            )  # fmt: skip
    problems.raise_if_any()

    known = dict(campaign.known)
    if campaign.wheelbase is not None:
        known["wheelbase"] = campaign.wheelbase
    elements = seven_degrees_of_freedom(chosen, chosen_extras)
    models = {load.name: LinearModel.of(elements + load.elements(campaign.cg_height), names) for load in campaign.loads}
    undecided = tracks is None and campaign.model.tracks is None and not apart and not together
    return Choice(chosen, chosen_extras, known, models, undecided)
