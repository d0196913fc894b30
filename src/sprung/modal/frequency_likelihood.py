"""Maximum likelihood in the frequency domain: the lines of a band, instead of all samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.modal.decays import Decays
from sprung.modal.identification_task import IdentificationTask, check_decay
from sprung.modal.mode_set import ModeSet
from sprung.modal.refinement import maximise_likelihood
from sprung.modal.uncertainty import cramer_rao_bounds
from sprung.vibration import Mode, exponential_moments, sort_modes

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_WIDER = 1.5
"""Times the highest frequency of the motion up to which lines are used."""


def frequency_domain_likelihood(records: Sequence[ArrayLike], rate: float, order: int | None = None) -> ModeSet:
    """Identify modes by maximum likelihood on the spectral lines of a band.

    The transform of each whole record, on the lines of the discrete Fourier transform up to a little above the motion, is
    fitted with those of damped sinusoids, which are known in closed form for a finite record. White noise in that band is
    enough; what lies above does not matter.

    Parameters
    ----------
    records, rate, order
        As for `eigensystem_realisation`.

    Returns
    -------
    ModeSet
        Exact without noise, repeated and real poles too; with uncertainties for noise that is white in the band.

    Raises
    ------
    InputError
        As `eigensystem_realisation`.

    References
    ----------
    P. Guillaume, P. Verboven and S. Vanlanduit, Proc. ISMA 23 (1998) 359, here for the transform of free decays.
    """
    task = IdentificationTask.of(records, rate, order, "ml-frequency")
    high = task.decays.spectrum.band[1]
    lines = SpectralLines.up_to(task.decays, _WIDER * high)
    start = task.subspace.poles(task.order)
    check_decay(start, "ml-frequency")
    objective = maximise_likelihood(lines, start)
    lost = lines.sample_count / max(lines.sample_count - objective.parameters / lines.channels, 1.0)
    uncertainties = cramer_rao_bounds(objective.weighted(1 / (objective.variance * lost)))
    found = zip(objective.poles.exponent * rate, objective.poles.shapes.T, uncertainties, strict=True)
    return ModeSet(
        sort_modes([Mode(complex(pole), shape, uncertainty=uncertainty) for pole, shape, uncertainty in found]),
        (),
        "ml-frequency",
    )


@dataclass(frozen=True, eq=False)
class SpectralLines(Decays):
    """Records as their Fourier transforms on the lines of a band; the line at 0 Hz, and with it the offsets, left out.

    Attributes
    ----------
    angles
        2π times the lines and their negatives, per sample, of each record, shape (line,).
    transforms
        Of the records there, over the root of the number of samples; shape (channel, line) each.
    """

    angles: tuple[Real, ...]
    transforms: tuple[Complex, ...]

    @classmethod
    def up_to(cls, decays: Decays, highest: float) -> Self:
        """Transform records up to some frequency, Hz."""
        angles, transforms = [], []
        for values in decays.values:
            count = values.shape[1]
            last = min(max(int(highest / decays.rate * count), 2), (count - 1) // 2)
            lines = np.fft.rfft(values)[:, 1 : last + 1] / np.sqrt(count)
            positive = 2 * np.pi * np.arange(1, last + 1) / count
            angles.append(np.concatenate([positive, -positive]))
            transforms.append(np.concatenate([lines, lines.conj()], axis=1))
        energy = np.array([(np.abs(lines) ** 2).sum(axis=1) for lines in transforms])
        return cls(
            decays.values, decays.rate, decays.samples, energy, decays.padded_blocks, tuple(angles), tuple(transforms)
        )

    @property
    def sample_count(self) -> float:
        """Number of lines of each channel, all records together."""
        return float(sum(len(angles) for angles in self.angles))

    def gram(self, exponent: Complex) -> Complex:
        """Return the Gram matrices of the transforms of (e^{λk}, k e^{λk})."""
        transforms = self._transformed_exponentials(exponent)
        return np.array([transform.conj() @ transform.T for transform in transforms])

    def correlate(self, exponent: Complex) -> Complex:
        """Return the inner products of the transforms of (e^{λk}, k e^{λk}) with those of the records."""
        pairs = zip(self._transformed_exponentials(exponent), self.transforms, strict=True)
        return np.array([lines @ transform.conj().T for transform, lines in pairs])

    def _transformed_exponentials(self, exponent: Complex) -> list[Complex]:
        """Transform e^{λk} and k e^{λk}, for each record; shape (2 pole, line)."""
        found = []
        for angles, count in zip(self.angles, self.samples.tolist(), strict=True):
            apart = (exponent[:, None] - 1j * angles)[None]
            last = np.repeat(np.exp(exponent * count)[None, :, None], len(angles), axis=2)
            both = exponential_moments(apart, np.zeros(1, dtype=np.int64), last, np.full((1, 1, 1), count), powers=2)
            found.append(np.concatenate([part[0] for part in both]) / np.sqrt(count))
        return found
