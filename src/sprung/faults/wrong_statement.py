"""The one statement about masses or loads that is wrong: it explains the recordings wholly, being otherwise."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain

from sprung.faults.campaign.known_quantity import known_quantities, none_of, restated
from sprung.faults.campaign.load_frame import load_frames
from sprung.faults.campaign.loosened_statement import loosened_statements
from sprung.faults.candidate_fit import CandidateFit
from sprung.faults.consistency import SHARE, SIGNIFICANT
from sprung.faults.hypothesis import Hypothesis

WHOLLY = 0.1
"""Share of a misfit that may be left where the recordings are explained wholly, as a wrong statement does or is none."""

_MOST = 3
"""Statements that are fitted otherwise, at the most."""


def wrong_statement(base: CandidateFit) -> tuple[Hypothesis | None, int]:
    """Return the one statement about loads or masses that explains the recordings wholly, being otherwise.

    Where one of several known quantities may be wrong, none of them is used.

    Parameters
    ----------
    base
        The fit of the campaign as it is.

    Returns
    -------
    hypothesis
        None where no statement explains them so, or several do of which not all are known quantities.
    fits
        How many were made.
    """
    # What has no number of its own, or stands under what is known, is likelier than the mass of a load or the wheelbase.
    fits, confirmed = 0, list[Hypothesis]()
    for statements in (chain(load_frames(base), known_quantities(base)), loosened_statements(base)):
        promising = _promising(base, statements)
        confirmed = sorted(_confirmed_wholly(base, promising), key=lambda hypothesis: hypothesis.score())
        fits += len(promising)
        if confirmed:
            break
    if not confirmed:
        return None, fits
    best, alike = confirmed[0], SIGNIFICANT * confirmed[0].candidate.fit.overdispersion
    rivals = [one for one in confirmed[1:] if one.free <= best.free and one.score() - best.score() < alike]
    if not rivals:
        return restated(base, best), fits
    none = none_of(base, [best, *rivals])
    if none is None:
        return None, fits
    found = _confirmed_wholly(base, [none])
    return (restated(base, found[0]) if found else None), fits + 1


def _promising(base: CandidateFit, hypotheses: Iterable[Hypothesis]) -> list[Hypothesis]:
    """Return the likeliest of some hypotheses that may explain the recordings wholly, by some steps of their fits."""
    promising = (
        hypothesis
        for hypothesis in hypotheses
        if _leaves_little(base, hypothesis, SHARE) and base.table.cost - hypothesis.table.cost > SIGNIFICANT
    )
    return sorted(promising, key=lambda hypothesis: hypothesis.score())[:_MOST]


def _confirmed_wholly(base: CandidateFit, hypotheses: Sequence[Hypothesis]) -> list[Hypothesis]:
    """Return those of some hypotheses that explain the recordings wholly, by their fits."""
    confirmed: list[Hypothesis] = []
    for hypothesis in hypotheses:
        other, _ = hypothesis.confirm(base)
        if other is None or not _leaves_little(base, other, WHOLLY):
            continue
        if base.table.cost - other.table.cost > SIGNIFICANT * other.candidate.fit.overdispersion:
            confirmed.append(other)
    return confirmed


def _leaves_little(base: CandidateFit, hypothesis: Hypothesis, part: float) -> bool:
    """Whether a hypothesis leaves at most a part of the misfit; noise, where nothing else is left without it."""
    left = hypothesis.candidate
    return left.is_explained if base.is_explained else left.misfit <= part * base.misfit
