"""The stabilisation diagram: poles over the model's order, what stays, and why the rest does not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.display import shown
from sprung.modal.criteria import modal_phase_collinearity
from sprung.modal.decays import Decays
from sprung.modal.identified import RejectedPole
from sprung.modal.records import as_records
from sprung.modal.subspace import Span
from sprung.vibration import modal_assurance_criterion

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

HIGHEST_ORDER = 40
"""Of the diagram, unless told otherwise."""

_LEAST_ORDERS = 4
"""At which a pole must be there, however late it appears."""


@shown
@dataclass(frozen=True)
class StabilityCriteria:
    """By how much a pole may change from one order to the next, and how long it must stay.

    Attributes
    ----------
    frequency, damping
        Of its frequency and damping ratio, as a part of them.
    similarity
        Least modal assurance criterion of its shape with the one before, dimensionless.
    coherence
        Least extended modal amplitude coherence, dimensionless.
    orders
        Part of the orders, from its first one on, at which it must be there.
    """

    frequency: float = 0.02
    damping: float = 0.1
    similarity: float = 0.9
    coherence: float = 0.5
    orders: float = 0.6


@dataclass(frozen=True, eq=False)
class DiagramPole:
    """One pole at one order.

    Attributes
    ----------
    order
        Of the model.
    pole
        1/s, imaginary part not negative.
    shape
        At the channels, largest entry 1.
    stable
        Whether the order before has it too.
    coherence
        Extended modal amplitude coherence: how well its amplitude at the first block row foretells that at the last.
    collinearity
        Modal phase collinearity of its shape.
    """

    order: int
    pole: complex
    shape: Complex
    stable: bool
    coherence: float
    collinearity: float


@dataclass(frozen=True, eq=False)
class Cluster:
    """Poles of several orders that are one.

    Attributes
    ----------
    pole
        Their median, 1/s.
    scatter
        Standard deviation over the orders, as a part of it.
    first, count
        The order at which it first appears, and at how many it is there.
    """

    pole: complex
    scatter: float
    first: int
    count: int


@shown
@dataclass(frozen=True, eq=False)
class StabilisationDiagram:
    """Poles over order.

    Attributes
    ----------
    orders
        The orders.
    poles
        All poles at all orders.
    chosen
        Clusters that meet the criteria, by frequency.
    rejected
        Those that do not, with the reason.
    criteria
        The criteria.
    """

    orders: tuple[int, ...]
    poles: tuple[DiagramPole, ...]
    chosen: tuple[Cluster, ...]
    rejected: tuple[RejectedPole, ...]
    criteria: StabilityCriteria


def stabilisation_diagram(
    records: Sequence[ArrayLike], rate: float, highest: int = HIGHEST_ORDER, criteria: StabilityCriteria | None = None
) -> StabilisationDiagram:
    """Realise models of all even orders, and see which poles stay.

    Parameters
    ----------
    records
        Shape (channel, time) each.
    rate
        Samples per second.
    highest
        Order; less where the records do not allow it.
    criteria
        When a pole counts as the one before, and a cluster as a mode.

    Returns
    -------
    Diagram

    Raises
    ------
    InputError
        If the records cannot be used.
    """
    arrays = as_records(records, rate, "diagram")
    span = Span.of(arrays, Decays.of(arrays, rate).spectrum)
    wanted = criteria or StabilityCriteria()
    orders = tuple(range(2, min(highest, span.most) + 1, 2))
    chains: list[list[DiagramPole]] = []
    points: list[DiagramPole] = []
    before: list[tuple[DiagramPole, list[DiagramPole]]] = []
    for order in orders:
        now = []
        for point in _poles(span, order, rate):
            own, chain = _linked(point, before, wanted)
            if chain is None:
                chain = []
                chains.append(chain)
            chain.append(own)
            points.append(own)
            now.append((own, chain))
        before = now
    chosen, rejected = [], []
    for chain in chains:
        cluster, reason = _cluster(chain, orders, wanted)
        if reason is None:
            chosen.append(cluster)
        else:
            rejected.append(RejectedPole(cluster.pole, reason))
    chosen.sort(key=lambda one: abs(one.pole))
    return StabilisationDiagram(orders, tuple(points), tuple(chosen), tuple(rejected), wanted)


def _poles(span: Span, order: int, rate: float) -> list[DiagramPole]:
    """Give the poles of a model of some order."""
    poles, channels = span.poles(order), span.thinned.channels
    observability = span.left[:, :order]
    block = observability.shape[0] // channels - 1
    lag = span.thinned.step * span.thinned.every
    seen = poles.shapes / span.thinned.scale[:, None]
    # What each mode puts into the first and into the last block row of the span.
    wide = np.vstack([seen * np.exp(poles.exponent * lag * i) for i in range(block + 1)])
    last = wide[-channels:]
    parts = observability @ (observability.T @ wide)
    found = []
    for j in range(poles.count):
        there, foretold = parts[-channels:, j], last[:, j]
        size = float(np.linalg.norm(there) * np.linalg.norm(foretold))
        along = abs(complex(there.conj() @ foretold)) / size if size > 0 else 0.0
        ratio = float(np.linalg.norm(there)) / max(float(np.linalg.norm(foretold)), 1e-300)
        shape = poles.shapes[:, j]
        coherence = along * min(ratio, 1 / max(ratio, 1e-300))
        found.append(
            DiagramPole(
                order, complex(poles.exponent[j]) * rate, shape, False, coherence, modal_phase_collinearity(shape)
            )
        )
    return found


def _linked(
    point: DiagramPole, before: list[tuple[DiagramPole, list[DiagramPole]]], criteria: StabilityCriteria
) -> tuple[DiagramPole, list[DiagramPole] | None]:
    """Find the pole of the order before that this one is, and the chain that one belongs to."""
    best, chain = np.inf, None
    for other, own in before:
        frequency = abs(abs(point.pole) / abs(other.pole) - 1)
        ratios = [-one.pole.real / abs(one.pole) for one in (point, other)]
        alike = float(modal_assurance_criterion(point.shape[:, None], other.shape[:, None])[0, 0])
        near = frequency <= criteria.frequency and abs(ratios[0] - ratios[1]) <= criteria.damping * abs(ratios[1])
        # A chain goes on with one pole of each order only.
        if near and alike >= criteria.similarity and frequency < best and own[-1] is other:
            best, chain = frequency, own
    stable = chain is not None
    return DiagramPole(point.order, point.pole, point.shape, stable, point.coherence, point.collinearity), chain


def _cluster(
    chain: list[DiagramPole], orders: Sequence[int], criteria: StabilityCriteria
) -> tuple[Cluster, str | None]:
    poles = np.array([one.pole for one in chain])
    middle = complex(np.median(poles.real), np.median(poles.imag))
    scatter = float(np.sqrt(np.mean(np.abs(poles - middle) ** 2)) / abs(middle))
    first = chain[0].order
    room = len([order for order in orders if order >= first])
    cluster = Cluster(middle, scatter, first, len(chain))
    coherence = float(np.median([one.coherence for one in chain]))
    if middle.real >= 0:
        return cluster, f"it grows, by {middle.real:.2g} 1/s"
    if len(chain) < max(criteria.orders * room, min(_LEAST_ORDERS, len(orders))):
        asked = f"{criteria.orders:.0%}, and at least {_LEAST_ORDERS}, are asked for"
        return cluster, f"it is there at {len(chain)} of {room} orders from {first} on; {asked}"
    if coherence < criteria.coherence:
        said = f"its amplitude coherence is {coherence:.2f}; {criteria.coherence:g} is asked for"
        return cluster, said
    return cluster, None
