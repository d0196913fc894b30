"""Sizes of pushes and bumps that none has: another unit, or a slip of the pen."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sprung.campaign.excitation import Bump, Push
from sprung.campaign.plausibility import explain_implausible

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sprung.campaign.schema_problems import Place
    from sprung.errors import Problems

_QUANTITIES = {
    "height": "bump height",
    "length": "bump length",
    "edge": "bump length",
    "force": "push force",
    "frequency": "push frequency",
}
"""By key of the sections ``[bump]`` and ``[push]``."""


def excitation_sizes(excitation: Push | Bump) -> Iterator[tuple[Place, str, float]]:
    """Yield every size of a push or a bump.

    Parameters
    ----------
    excitation
        How the body is pushed, or what is driven over.

    Yields
    ------
    tuple
        Place in a vehicle file, quantity, and value in SI.
    """
    section = "push" if isinstance(excitation, Push) else "bump"
    for key, quantity in _QUANTITIES.items():
        value = getattr(excitation, key, None)
        if value is not None:
            yield (section, key), quantity, value
    for name, value in zip("xy", getattr(excitation, "position", None) or (), strict=False):
        yield (section, "position"), name, value


def check_excitation(excitation: Push | Bump, where: str, problems: Problems) -> None:
    """Check the sizes of a push or a bump in memory, as those of a vehicle file.

    Parameters
    ----------
    excitation
        How the body is pushed, or what is driven over.
    where
        Name of the whole in a problem.
    problems
        Takes up the sizes that none has.
    """
    for place, quantity, value in excitation_sizes(excitation):
        found = explain_implausible(quantity, value)
        if found is not None:
            problems.add(f"{where}: {'.'.join(map(str, place))}", f"{value:g}", *found)
