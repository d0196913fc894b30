"""A body that twists, which no rigid body does."""

from __future__ import annotations

import numpy as np

from sprung.errors import Fault
from sprung.faults.candidate_fit import CandidateFit

_SHARE = 0.7
"""Share of the residual of the body's channels in the shape of a twist, from which it is one."""

_PARTICIPATION = 0.05
"""Share of a twist, squared, that a sensor has to show for it to count."""


def torsion_test(base: CandidateFit) -> Fault | None:
    """Test whether the body twists.

    Parameters
    ----------
    base
        The fit that does not explain the recordings.

    Returns
    -------
    Fault or None
        A fault where the wheels are explained, no sensor of the body is, and the residual of these has the shape of a twist
        about the longitudinal axis. Four and more of them show what no rigid body can do.
    """
    sensors = base.campaign.sensors
    placed = [sensor.position is not None and sensor.relative_to is None for sensor in sensors]
    body = [i for i, sensor in enumerate(sensors) if placed[i] and base.table.counts[:, i].any()]
    wheels = [i for i, sensor in enumerate(sensors) if sensor.wheel is not None]
    if len(body) < 3:
        return None
    places = np.array([sensors[i].position for i in body], dtype=float)
    wheelbase = base.campaign.wheelbase
    middle = float(places[:, 0].mean()) if wheelbase is None else -wheelbase.value / 2
    shape = (places[:, 0] - middle) * places[:, 1]
    shape /= max(float(np.linalg.norm(shape)), np.finfo(float).tiny)
    explained = base.table.explained_channels(base.noise)
    participating = np.array(body)[shape**2 > _PARTICIPATION]
    if not explained[wheels].all() or explained[participating].any():
        return None
    excess = -np.diag(base.noise.level[body] ** 2 * base.table.counts[:, body].sum(axis=0))
    for record in base.fit.residuals:
        residual = np.nan_to_num(record[body])
        excess += residual @ residual.T
    share = float(shape @ excess @ shape) / max(float(np.trace(excess)), np.finfo(float).tiny)
    if share < _SHARE:
        return None
    what = (
        f"{100 * min(share, 1.0):.0f} % of the residual of the body's channels has the shape of a twist, which no rigid body "
        "shows; nothing was changed"
    )
    return Fault("twist", "body", what, "Put the body sensors where the body is stiff, or stiffen it.")
