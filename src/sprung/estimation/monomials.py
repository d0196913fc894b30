"""M, C and K as linear functions of products of parameters, and parameters from such products.

An element adds κ g gᵀ with κ a parameter and g affine in the geometry, so every entry of M, C and K is a sum of
products of at most three parameters: k_sf, k_sf a, k_sf a². Every equation that is linear in the matrices is linear in
these products, and the parameters follow as the products of one factor and as ratios: a = (k_sf a) / k_sf.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle import (
    LINEAR_LAWS,
    LinearLaw,
    LinearModel,
    Matrices,
    Tracks,
    linear_elements,
    parameter_names,
)

Real = NDArray[np.float64]
Key = tuple[int, int, int]
"""A product of parameters: their positions in the list of names counted from 1, in order, filled up with 0 for 1."""


_ZERO = 1e-100
"""Sums below this are zero, in any unit."""


def expand(model: LinearModel, law: LinearLaw) -> dict[Key, Real]:
    """Write M, C or K as a linear combination of products of parameters.

    Parameters
    ----------
    model
        Equations of motion.
    law
        Which of the three.

    Returns
    -------
    dict
        For each product the matrix that it multiplies, shape (7, 7).
    """
    terms = model.terms[:, LINEAR_LAWS.index(law), : model.size, : model.size]
    keyed = zip(model.products.tolist(), terms, strict=True)
    return {(one, two, three): term for (one, two, three), term in keyed if term.any()}


def parameters_of(products: dict[Key, float], laws: Sequence[dict[Key, Real]], names: Sequence[str]) -> Real:
    """Find the parameters from products of them.

    A length t stands beside the rates that it multiplies. Several rates may multiply it in one place, as a spring and
    an anti-roll bar do, so that only the sum of their products is known: the lengths that give these sums best are
    taken.

    Parameters
    ----------
    products
        Value of each product; those of one and of two factors are used.
    laws
        For each of the matrices that the products were found from, what `expand` gives.
    names
        The parameters.

    Returns
    -------
    ndarray
        Shape (parameter,); NaN for one that no product determines.
    """
    values = np.full(len(names), np.nan)
    for (one, two, three), value in products.items():
        if one == two == 0 < three:
            values[three - 1] = value
    design: list[Real] = []
    observed: list[Real] = []
    lengths = np.flatnonzero(np.isnan(values)).tolist()
    if not lengths:
        return values
    for law in laws:
        pairs = {key: term for key, term in law.items() if key[0] == 0 < key[1] < key[2]}
        shape = next(iter(law.values())).shape if law else (0, 0)
        sums = np.zeros((len(lengths), *shape))
        for (_, two, three), term in pairs.items():
            for length, rate in ((two - 1, three - 1), (three - 1, two - 1)):
                if length in lengths and np.isfinite(values[rate]):
                    sums[lengths.index(length)] += values[rate] * term
        largest = float(np.abs(sums).max(initial=0.0))
        size = largest if largest > _ZERO else 1.0
        design.append(sums.reshape(len(lengths), -1).T / size)
        observed.append(sum((products[key] * term for key, term in pairs.items()), np.zeros(shape)).ravel() / size)
    stacked = np.vstack(design)
    found = np.linalg.lstsq(stacked, np.concatenate(observed), rcond=1e-12)[0]
    values[lengths] = np.where(stacked.any(axis=0), found, np.nan)
    return values


def parameters_from_matrices(matrices: Matrices, tracks: Tracks = "shared") -> dict[str, float]:
    """Find the parameters from identified M, C and K by least squares, the step from (21)-(23) to Table 2.

    Parameters
    ----------
    matrices
        M, C and K, each of shape (7, 7); they need not be symmetric.
    tracks
        Whether springs and dampers of an axle share their half-distance.

    Returns
    -------
    dict
        Value of each parameter by name; noisy matrices may give negative ones.
    """
    names = parameter_names(tracks)
    model = LinearModel.of(linear_elements(tracks), names)
    products: dict[Key, float] = {}
    laws = [expand(model, law) for law in LINEAR_LAWS]
    for identified, terms in zip(matrices, laws, strict=True):
        design = np.stack([term.ravel() for term in terms.values()], axis=1)
        found = np.linalg.lstsq(design, np.asarray(identified, dtype=float).ravel(), rcond=None)[0]
        products.update(zip(terms, found.tolist(), strict=True))
    return dict(zip(names, parameters_of(products, laws, names).tolist(), strict=True))


def shape_of(A: Real, model: LinearModel) -> Real:
    """Find the parameters of one unloaded state up to their scale, from M A₂₁ + K = 0 and M A₂₂ + C = 0 with m_s = 1.

    One state determines every ratio of masses and rates, because K is symmetric and M has the pattern of eq. (2); only
    the common factor is free.

    Parameters
    ----------
    A
        State matrix, SI, shape (14, 14).
    model
        Without a load.

    Returns
    -------
    ndarray
        Parameters with m_s = 1 kg, shape (parameter,); NaN where nothing was found.
    """
    mass, damping, stiffness = (expand(model, law) for law in LINEAR_LAWS)
    keys = list(dict.fromkeys([*mass, *damping, *stiffness]))
    nothing = np.zeros((7, 7))
    columns = [
        np.hstack(
            [
                mass.get(key, nothing) @ A[7:, :7] + stiffness.get(key, nothing),
                mass.get(key, nothing) @ A[7:, 7:] + damping.get(key, nothing),
            ]
        )
        for key in keys
    ]
    # Every equation is divided by its coordinate's own squared frequency or damping: relative errors count alike.
    size = np.abs(np.hstack([np.tile(np.diag(A[7:, i : i + 7])[:, None], 7) for i in (0, 7)]))
    design = np.stack([(column / np.where(size > 0, size, 1.0)).ravel() for column in columns], axis=1)
    sprung = keys.index((0, 0, 1 + model.names.index("m_s")))
    others = [i for i in range(len(keys)) if i != sprung]
    norms = np.linalg.norm(design, axis=0)
    found = np.linalg.lstsq(design[:, others] / norms[others], -design[:, sprung], rcond=1e-12)[0] / norms[others]
    products = dict(zip([keys[i] for i in others], found.tolist(), strict=True))
    return parameters_of({**products, keys[sprung]: 1.0}, (damping, stiffness), model.names)
