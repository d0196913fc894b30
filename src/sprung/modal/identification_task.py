"""The input of a method of modal identification, its order, and the modes that are kept of its poles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.errors import Problems
from sprung.modal.decays import Decays
from sprung.modal.decimation import DecimatedRecords
from sprung.modal.likelihood import ModalObjective, Poles
from sprung.modal.mode_set import ModeSet, RejectedPole
from sprung.modal.record_checks import check_records
from sprung.modal.subspace import SignalSubspace
from sprung.vibration import make_modes

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_LEAST_SHARE = 1e-20
"""Part of a channel's energy below which a pole explains only rounding."""

MOST_POLES = 40
"""Largest number of poles that maximum likelihood looks for by itself."""

FIRST_POLES = 8
"""Poles of the first model, or twice the channels where these are more."""


@dataclass(frozen=True, eq=False)
class IdentificationTask:
    """Records and order of a modal identification.

    Attributes
    ----------
    decays
        The records.
    subspace
        Signal subspace of the decimated records.
    order
        Number of poles.
    method
        Name of the method, for messages.
    """

    decays: Decays
    subspace: SignalSubspace
    order: int
    method: str

    @classmethod
    def of(cls, records: Sequence[ArrayLike], rate: float, order: int | None, method: str) -> IdentificationTask:
        """Prepare records.

        Parameters
        ----------
        records, rate
            As the methods take them.
        order
            Number of poles; None for as many as exceed the noise, but no more than twice the channels: a nonlinearity adds
            directions that are no modes.
        method
            Name of the method.

        Raises
        ------
        InputError
            If the records cannot be used.
        """
        arrays = check_records(records, rate, method)
        decays = Decays.of(arrays, rate)
        subspace = SignalSubspace.of(arrays, decays.spectrum)
        number = min(subspace.significant, max(FIRST_POLES, 2 * decays.channels)) if order is None else order
        task = cls(decays, subspace, number, method)
        task.allow(subspace.most, given=order is not None)
        return task

    @property
    def decimated(self) -> DecimatedRecords:
        """The decimated records."""
        return self.subspace.decimated

    def allow(self, most: int, given: bool = True) -> None:
        """Raise an error for an order above the highest that the records allow.

        Raises
        ------
        InputError
            With the numbers.
        """
        problems = Problems()
        if given and not 1 <= self.order <= most:
            reason = f"1 to {most} for {self.decays.channels} channels and {self.decays.seconds.min():.3g} s"
            problems.add(f"{self.method}: order", f"{self.order}", reason, "Choose it in that range, or leave it out.")
        elif self.order < 1:
            problems.add(
                f"{self.method}: records",
                "nothing above the noise",
                "a free decay",
                "Check the recordings.",
            )
        problems.raise_if_any()

    def modes(self, poles: Poles) -> ModeSet:
        """Return as many modes as the order allows, those that explain most of the records; the others are rejected."""
        if not poles.count:
            return ModeSet((), (), self.method)
        weights = 1 / np.maximum(self.decays.energy.sum(axis=0), 1e-300)
        shares = ModalObjective.at(self.decays, poles, weights).shares.max(axis=0)
        rate, remaining = self.decays.rate, self.order
        kept, rejected = [], []
        for j in np.argsort(-shares).tolist():
            size = 2 if poles.exponent[j].imag else 1
            if size <= remaining and shares[j] > _LEAST_SHARE:
                kept.append(j)
                remaining -= size
            else:
                reason = f"{self.order} poles explain more: of no channel is it more than {100 * shares[j]:.2g} %"
                rejected.append(RejectedPole(complex(poles.exponent[j]) * rate, reason))
        both = np.concatenate([poles.exponent[kept], poles.exponent[kept].conj()]) * rate
        shapes = np.concatenate([poles.shapes[:, kept], poles.shapes[:, kept].conj()], axis=1)
        once = np.concatenate([np.ones(len(kept), dtype=np.bool_), poles.exponent[kept].imag != 0])
        return ModeSet(make_modes(both[once], shapes[:, once]), tuple(rejected), self.method)


def check_decay(poles: Poles, method: str) -> None:
    """Raise an error for records without a decaying pole.

    Raises
    ------
    InputError
        If there are no poles.
    """
    problems = Problems()
    if not poles.count:
        problems.add(f"{method}: records", "no decaying motion", "a free decay", "Check the recordings.")
    problems.raise_if_any()
