"""Other programs on the records of the modal study, each with the settings that suited it best; none of them is needed to run.

`python -m pip install "sprung[peers]"` installs them.
"""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import decimate

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

DECIMATED = 10
"""Every how many samples are kept, after a filter: the peers' matrices would be ten times as large otherwise."""


def _decimated(records: Sequence[Real]) -> Real:
    """Filter and thin out records as a user of these programs would; shape (channel, drop, time)."""
    return np.stack([decimate(record, DECIMATED, ftype="fir") for record in records], axis=1)


def control_era(records: Sequence[Real], rate: float) -> Complex:
    """Poles by the eigensystem realisation of python-control, drops as inputs; 1/s."""
    control: Any = importlib.import_module("control")
    thin = _decimated(records)
    system, _ = control.eigensys_realization(thin, 14, m=60, n=300, dt=DECIMATED / rate)
    return np.asarray(np.log(np.linalg.eigvals(system.A).astype(complex)) * rate / DECIMATED)


def pyyeti_era(records: Sequence[Real], rate: float) -> Complex:
    """Poles by the eigensystem realisation of pyyeti, drops as inputs; 1/s."""
    era: Any = importlib.import_module("pyyeti.era")
    found = era.ERA(
        _decimated(records).swapaxes(1, 2), rate / DECIMATED, svd_tol=14, alpha=60, auto=True, verbose=False, show_plot=False,
        damp_range=(0.0, 1.0), MSV_lower_limit=0.0, EMAC_lower_limit=0.0, EMACO_lower_limit=0.0, MPC_lower_limit=0.0,
        CMIO_lower_limit=0.0, MAC_lower_limit=0.0,
    )  # fmt: skip
    frequency, ratio = 2 * np.pi * np.asarray(found.freqs_hz), np.asarray(found.zeta)
    return np.asarray(frequency * (-ratio + 1j * np.sqrt(1 - ratio**2)))


def pyoma_ssi(records: Sequence[Real], rate: float) -> Complex:
    """Poles by the covariance-driven subspace identification of pyOMA2, which takes one record; no criteria; 1/s."""
    ssi: Any = importlib.import_module("pyoma2.functions.ssi")
    thin = _decimated(records)[:, 0]
    hankel, _ = ssi.build_hank(Y=thin, Yref=thin, br=20, method="cov")
    transitions = ssi.SSI_fast(hankel, 20, 14)[1]
    return np.asarray(np.log(np.linalg.eigvals(transitions[-1]).astype(complex)) * rate / DECIMATED)


PEERS: Mapping[str, tuple[str, Callable[[Sequence[Real], float], Complex], int]] = {
    "python-control, ERA": ("control", control_era, 4),
    "pyyeti, ERA": ("pyyeti", pyyeti_era, 4),
    "pyOMA2, SSI-cov": ("pyoma2", pyoma_ssi, 1),
}
"""By label: the package, the function, and how many drops it takes."""


def installed() -> Mapping[str, tuple[Callable[[Sequence[Real], float], Complex], int]]:
    """Return the installed peers."""
    return {label: (run, drops) for label, (name, run, drops) in PEERS.items() if importlib.util.find_spec(name)}
