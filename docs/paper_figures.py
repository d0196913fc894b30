"""Draw figures 4 to 9 of the paper from simulated drops: the paper's recordings are not published.

Needs matplotlib. Figures 4 to 6: the linear bus of Tables 4 and 5. Figures 7 to 9: the same bus with dry friction in its
springs, once fitted by the linear model as in the paper, once with friction.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

import sprung
from sprung.campaign import Campaign
from sprung.vehicle import SCHOOL_BUS, Vehicle

HERE = Path(__file__).parent
MOTIONS = {
    "vertical": (("fl", "fr", "rl", "rr"), "m/s²"),
    "pitch": (("rl", "rr"), "rad/s²"),
    "roll": (("fl", "rl"), "rad/s²"),
}
"""Channels and unit of the motion shown, by the drop that excites it."""

DRAWN = {"font.size": 9, "svg.fonttype": "none", "svg.hashsalt": "sprung", "axes.spines.top": False}

BUS_WITH_FRICTION = Vehicle.from_parameters(
    SCHOOL_BUS.parameters | {"t_f1": 0.5, "t_r1": 0.5, "t_f2": 0.5, "t_r2": 0.5}
    | {"F_f": 1000.0, "F_r": 1500.0, "s_f": 2e6, "s_r": 3e6},
    name="school bus with friction",
)  # fmt: skip


def main() -> None:
    """Write paper-spectra.svg and paper-decays.svg."""
    plt.rcParams.update(DRAWN)
    drops = [{"wheels": wheels, "height": 0.06} for wheels, _ in MOTIONS.values()]
    known = {"total_mass": SCHOOL_BUS.total_mass, "a": SCHOOL_BUS.a, "b": SCHOOL_BUS.b}
    usual: dict[str, Any] = {"drops": drops, "noise": 0.02, "seed": 1, "duration": 4.0, "rate": 250}
    spectra(sprung.simulate(SCHOOL_BUS, **usual, known=known))
    decays(sprung.simulate(BUS_WITH_FRICTION, **usual, known=known))


def motion(
    campaign: Campaign, values: np.ndarray[Any, Any], channels: tuple[str, ...], of: str
) -> np.ndarray[Any, Any]:
    """Return vertical, pitch or roll acceleration of the body at its centre of gravity, from its corners; shape (time,)."""
    placed = {sensor.channel: sensor.position for sensor in campaign.sensors if sensor.position is not None}
    rows = np.array([(1.0, -(x + SCHOOL_BUS.a), y) for x, y, _ in placed.values()])
    body = np.linalg.pinv(rows) @ values[[channels.index(name) for name in placed]]
    return np.asarray(body[list(MOTIONS).index(of)])


def spectra(campaign: Campaign) -> None:
    """Draw the amplitude spectra of figures 4 to 6."""
    result = sprung.identify(campaign, tracks="separate", extras=())
    figure, panels = plt.subplots(1, 3, figsize=(11, 3.0), layout="constrained")
    for axes, (of, (_, unit)), series in zip(panels, MOTIONS.items(), result.series.values(), strict=True):
        values = motion(campaign, series.measured, series.channels, of)
        step = float(series.time[1] - series.time[0])
        amplitude = 2 * np.abs(np.fft.rfft(values - values.mean(), 8 * len(values))) / len(values)
        frequency = np.fft.rfftfreq(8 * len(values), step)
        shown = (frequency > 0.3) & (frequency < 20)
        axes.plot(frequency[shown], amplitude[shown], color="#444444", lw=0.9)
        for mode in result.modes["empty"]:
            axes.axvline(mode.damped_frequency, color="#d1495b", lw=0.7, ls=":")
        axes.set(
            xlabel="frequency, Hz", ylabel=f"amplitude, {unit}", title=f"{of}: as figure {4 + list(MOTIONS).index(of)}"
        )
        axes.spines["right"].set_visible(False)
    figure.savefig(HERE / "paper-spectra.svg", metadata={"Date": None})


def decays(campaign: Campaign) -> None:
    """Draw measured and fitted accelerations of figures 7 to 9, by the linear model and with friction."""
    fits: Mapping[str, sprung.Result] = {
        "linear": sprung.identify(campaign, tracks="shared", extras=(), fall=False),
        "with friction": sprung.identify(campaign, tracks="shared", extras=("friction",), fall=False),
    }
    for name, fit in fits.items():
        print(name, fit.verdict.state, max(fit.fit.misfit.values()))  # noqa: T201 (progress)
    figure, panels = plt.subplots(2, 3, figsize=(11, 5.0), layout="constrained", sharex=True)
    for row, (name, fit) in zip(panels, fits.items(), strict=True):
        for axes, (of, (_, unit)), series in zip(row, MOTIONS.items(), fit.series.values(), strict=True):
            for values, style in (
                (series.measured, ("#444444", "-", 0.8)),
                (series.fitted, ("#d1495b", (0, (4, 2)), 1.2)),
            ):
                colour, dashes, width = style
                seen = motion(campaign, values, series.channels, of)
                axes.plot(series.time, seen - seen.mean(), color=colour, ls=dashes, lw=width)
            axes.set(xlim=(series.time[0], series.time[0] + 3.0), ylabel=unit)
            axes.set_title(f"{of}, fitted {name}: as figure {7 + list(MOTIONS).index(of)}", fontsize=9)
            axes.spines["right"].set_visible(False)
    for axes in panels[1]:
        axes.set_xlabel("time, s")
    figure.savefig(HERE / "paper-decays.svg", metadata={"Date": None})


if __name__ == "__main__":
    main()
