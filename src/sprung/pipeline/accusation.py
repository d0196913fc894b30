"""What is wrong with the campaign file or an instrument, where one thing being otherwise would explain the records."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sprung.errors import Fault
from sprung.identification import Summit, Suspect, suspects
from sprung.prepare import Decay
from sprung.recording import Campaign
from sprung.validation import Misfit

SURE = 25.0
"""Gain in twice the log-likelihood, in units of the inflation, from which chance is no explanation: five standard errors."""

_MATTERS = {"gain": 0.003, "late": 0.0003, "position": 0.01, "load-position": 0.02}
"""Below this nobody needs to be told: a part, s, m and m."""

_MOST_OF_IT = 0.5
"""Part of what the model leaves unexplained that one thing has to explain before it is accused."""

_CHANCE = 4.0
"""Standard errors up to which more noise in motion than at rest is none."""

_AS_GOOD = 0.6
"""Part of the best explanation's gain from which another one may be meant as well."""

_WAYS = {"position": (("back", "forward"), ("to the right", "to the left"))}
_WAYS["load-position"] = _WAYS["position"]

_DO = {
    "gain": "Check the sensor's calibration and the unit in the campaign file.",
    "late": "Check the delays of the logger and its filters, channel by channel.",
    "position": "Measure the sensor's place again, and the wheelbase.",
    "load-position": "Measure the load's place again, and its mass.",
}


def accuse(
    campaign: Campaign, decays: Sequence[Decay], summit: Summit, misfit: Misfit, inflation: float
) -> tuple[Fault, ...]:
    """Name the one thing that, being otherwise, would explain what the model does not.

    Parameters
    ----------
    campaign
        The campaign.
    decays
        What was fitted.
    summit
        Where the fit ended.
    misfit
        How far the model is from the records.
    inflation
        By how much the records tell less than white ones.

    Returns
    -------
    tuple of Fault
        One at most: what else looks wrong is mostly its shadow.
    """
    loads = {load.name: load for load in campaign.loads}
    listed = suspects(summit, campaign.sensors, loads, campaign.cg_height)
    serious = [one for one in listed if one.gain > SURE * inflation and abs(one.value) > _MATTERS[one.kind]]
    if not serious or serious[0] is not listed[0]:
        return ()
    best, others = serious[0], serious[1:]
    if best.gain < _MOST_OF_IT * _unexplained(decays, misfit):
        return ()
    also = next((one for one in others if one.where != best.where and one.gain > _AS_GOOD * best.gain), None)
    what = _sentence(best) + (f"; or {_sentence(also)}" if also is not None else "")
    sure = f"{(best.gain / inflation) ** 0.5:.0f} standard errors"
    where = f"load '{best.where}'" if best.kind == "load-position" else best.where
    return (Fault(best.kind, where, f"{what} ({sure}); nothing was changed", _DO[best.kind]),)


def _unexplained(decays: Sequence[Decay], misfit: Misfit) -> float:
    """Give what the residuals have beyond the noise at rest, in twice the log-likelihood, as far as it is no chance."""
    samples = np.maximum(np.sum([decay.usable * decay.samples for decay in decays], axis=0), 1)
    at_rest = max(sum(decay.rest.noise.shape[1] for decay in decays), 1)
    beyond = np.nan_to_num(misfit.ratio, nan=1.0) ** 2 - 1
    real = beyond > _CHANCE * np.sqrt(2 / samples + 2 / at_rest)
    return float(np.sum(np.where(real, samples * beyond / (1 + np.maximum(beyond, 0.0)), 0.0)))


def _sentence(suspect: Suspect) -> str:
    size = abs(suspect.value)
    if suspect.kind == "gain":
        return f"{suspect.where} reads {_figures(100 * size)} % too {'much' if suspect.value > 0 else 'little'}"
    if suspect.kind == "late":
        return f"{suspect.where} is {_figures(1000 * size)} ms {'late' if suspect.value > 0 else 'early'}"
    way = _WAYS[suspect.kind][suspect.axis][suspect.value > 0]
    what = suspect.where if suspect.kind == "position" else f"item {suspect.item + 1} of the load '{suspect.where}'"
    return f"{what} sits {_figures(100 * size)} cm further {way} than the campaign file says"


def _figures(number: float) -> str:
    return f"{float(f'{number:.2g}'):g}"
