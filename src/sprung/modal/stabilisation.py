"""The stabilisation diagram: poles over the order of the model, and which of them are stable."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.display import shown
from sprung.modal.criteria import modal_phase_collinearity
from sprung.modal.decays import Decays
from sprung.modal.mode_set import RejectedPole
from sprung.modal.record_checks import check_records
from sprung.modal.subspace import SignalSubspace
from sprung.vibration import modal_assurance_criterion

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

HIGHEST_ORDER = 40
"""Highest order of the diagram by default."""

_LEAST_ORDERS = 4
"""Orders at which a pole must be present, however late it appears."""

_DIED_AWAY = 10.0
"""Factor by which a mode has decayed, at the most, in the block row whose amplitude is compared with that of the first one."""


@shown
@dataclass(frozen=True)
class StabilityCriteria:
    """Largest changes of a stable pole from one order to the next, and how many orders must have it.

    Attributes
    ----------
    frequency, damping
        Largest change of frequency and damping ratio, as a part of them.
    similarity
        Least modal assurance criterion of its shape with the one before, dimensionless.
    coherence
        Least extended modal amplitude coherence, dimensionless.
    orders
        Part of the orders, from its first one on, at which it must be present.
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
        Whether the order before has the same pole.
    coherence
        Extended modal amplitude coherence: how well its amplitude at the first block row predicts that at the last, or at the
        one until which it has decayed to a tenth.
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
class PoleCluster:
    """Stable poles of successive orders.

    Attributes
    ----------
    pole
        Their median, 1/s.
    scatter
        Standard deviation over the orders, as a part of it.
    first, count
        First order, and number of orders.
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
    chosen: tuple[PoleCluster, ...]
    rejected: tuple[RejectedPole, ...]
    criteria: StabilityCriteria


def stabilisation_diagram(
    records: Sequence[ArrayLike], rate: float, highest: int = HIGHEST_ORDER, criteria: StabilityCriteria | None = None
) -> StabilisationDiagram:
    """Return the poles of models of all even orders, and those that are stable.

    Parameters
    ----------
    records
        Shape (channel, time) each.
    rate
        Samples per second.
    highest
        Order; less where the records do not allow it.
    criteria
        For stable poles, and for clusters that are modes.

    Returns
    -------
    StabilisationDiagram

    Raises
    ------
    InputError
        If the records cannot be used.
    """
    arrays = check_records(records, rate, "diagram")
    subspace = SignalSubspace.of(arrays, Decays.of(arrays, rate).spectrum)
    limits = criteria or StabilityCriteria()
    orders = tuple(range(2, min(highest, subspace.most) + 1, 2))
    chains: list[list[DiagramPole]] = []
    points: list[DiagramPole] = []
    before: list[tuple[DiagramPole, list[DiagramPole]]] = []
    for order in orders:
        now = []
        for point in _poles(subspace, order, rate):
            linked, chain = _link(point, before, limits)
            if chain is None:
                chain = []
                chains.append(chain)
            chain.append(linked)
            points.append(linked)
            now.append((linked, chain))
        before = now
    chosen, rejected = [], []
    for chain in chains:
        cluster, reason = _cluster(chain, orders, limits)
        if reason is None:
            chosen.append(cluster)
        else:
            rejected.append(RejectedPole(cluster.pole, reason))
    chosen.sort(key=lambda cluster: abs(cluster.pole))
    return StabilisationDiagram(orders, tuple(points), tuple(chosen), tuple(rejected), limits)


def _poles(subspace: SignalSubspace, order: int, rate: float) -> list[DiagramPole]:
    """Return the poles of a model of some order."""
    poles, channels = subspace.poles(order), subspace.decimated.channels
    observability = subspace.left[:, :order]
    block = observability.shape[0] // channels - 1
    lag = subspace.decimated.step * subspace.decimated.every
    seen = poles.shapes / subspace.decimated.scale[:, None]
    # The contributions of each mode to all block rows of the observability matrix.
    wide = np.vstack([seen * np.exp(poles.exponent * lag * i) for i in range(block + 1)])
    parts = observability @ (observability.T @ wide)
    # Of a mode that has died away before, the last row tells nothing.
    decay = np.maximum(-poles.exponent.real * lag, np.finfo(float).tiny)
    last = np.clip(np.floor(np.log(_DIED_AWAY) / decay), 1, block).astype(np.int64)
    found = []
    for j in range(poles.count):
        row = slice(last[j] * channels, (last[j] + 1) * channels)
        there, predicted = parts[row, j], wide[row, j]
        size = float(np.linalg.norm(there) * np.linalg.norm(predicted))
        along = abs(complex(there.conj() @ predicted)) / size if size > 0 else 0.0
        ratio = float(np.linalg.norm(there)) / max(float(np.linalg.norm(predicted)), 1e-300)
        shape = poles.shapes[:, j]
        coherence = along * min(ratio, 1 / max(ratio, 1e-300))
        found.append(
            DiagramPole(
                order, complex(poles.exponent[j]) * rate, shape, False, coherence, modal_phase_collinearity(shape)
            )
        )
    return found


def _link(
    point: DiagramPole, before: list[tuple[DiagramPole, list[DiagramPole]]], criteria: StabilityCriteria
) -> tuple[DiagramPole, list[DiagramPole] | None]:
    """Return a pole and the chain of the same pole at the orders before, or None."""
    best, chain = np.inf, None
    for earlier, members in before:
        frequency = abs(abs(point.pole) / abs(earlier.pole) - 1)
        ratios = [-pole.pole.real / abs(pole.pole) for pole in (point, earlier)]
        alike = float(modal_assurance_criterion(point.shape[:, None], earlier.shape[:, None])[0, 0])
        near = frequency <= criteria.frequency and abs(ratios[0] - ratios[1]) <= criteria.damping * abs(ratios[1])
        # A chain goes on with one pole of each order only.
        if near and alike >= criteria.similarity and frequency < best and members[-1] is earlier:
            best, chain = frequency, members
    stable = chain is not None
    return DiagramPole(point.order, point.pole, point.shape, stable, point.coherence, point.collinearity), chain


def _cluster(
    chain: list[DiagramPole], orders: Sequence[int], criteria: StabilityCriteria
) -> tuple[PoleCluster, str | None]:
    poles = np.array([point.pole for point in chain])
    middle = complex(np.median(poles.real), np.median(poles.imag))
    scatter = float(np.sqrt(np.mean(np.abs(poles - middle) ** 2)) / abs(middle))
    first = chain[0].order
    room = len([order for order in orders if order >= first])
    cluster = PoleCluster(middle, scatter, first, len(chain))
    coherence = float(np.median([point.coherence for point in chain]))
    if middle.real >= 0:
        return cluster, f"it grows, by {middle.real:.2g} 1/s"
    if len(chain) < max(criteria.orders * room, min(_LEAST_ORDERS, len(orders))):
        required = f"{criteria.orders:.0%}, and at least {_LEAST_ORDERS}, are required"
        return cluster, f"it is present at {len(chain)} of {room} orders from {first} on; {required}"
    if coherence < criteria.coherence:
        reason = f"its amplitude coherence is {coherence:.2f}; {criteria.coherence:g} is required"
        return cluster, reason
    return cluster, None
