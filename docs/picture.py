"""Draw the README's picture: one drop of the demo, measured and fitted, and the estimates. Needs matplotlib."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt

import sprung
from sprung.uncertainty import round_by_uncertainty
from sprung.vehicle import PARAMETERS

SHOWN = ("m_s", "I_yy", "I_xx", "m_uf", "m_ur", "k_sf", "k_sr", "k_tf", "k_tr", "c_sf", "c_sr", "t_f1", "t_r1")


def main() -> None:
    """Write docs/first-look.svg."""
    campaign = sprung.study.demo_campaign()
    result = sprung.identify(campaign)
    series = result.series["empty_roll_left"]
    recording = next(r for r in campaign.recordings if r.name.startswith("empty_roll_left"))

    plt.rcParams.update({"font.size": 9, "svg.fonttype": "none", "svg.hashsalt": "sprung", "axes.spines.top": False})
    figure, (body, wheel, text) = plt.subplots(1, 3, figsize=(11, 3.4), width_ratios=(3, 3, 2.6), layout="constrained")
    for axes, channel, title in ((body, "body_fl", "body, front left"), (wheel, "wheel_fl", "wheel, front left")):
        measured = recording.values[recording.channels.index(channel)]
        fitted = series.fitted[series.channels.index(channel)]
        axes.axvspan(series.time[0], 2.0, color="#2a6f97", alpha=0.07, lw=0)
        axes.plot(recording.time, measured, color="#444444", lw=0.8, label="measured")
        axes.plot(series.time, fitted, color="#d1495b", lw=1.3, ls=(0, (4, 2)), label="fitted")
        axes.set(xlim=(0.3, 1.6), xlabel="time, s", ylabel="acceleration, m/s²", title=title)
        axes.spines["right"].set_visible(False)
    body.legend(frameon=False, loc="lower right")
    thin = {"arrowstyle": "-", "lw": 0.6}
    wheel.annotate("release", (0.4, 9), (0.32, 60), arrowprops=thin)
    wheel.annotate("landing: the decay\nis fitted from here", (series.time[0], 40), (0.75, 48), arrowprops=thin)

    text.axis("off")
    lines = []
    for name in SHOWN:
        one = result.parameters[name]
        if one.value is not None and one.std is not None:
            value, std = round_by_uncertainty(one.value, one.std)
            lines.append(f"{name:<5}{value:>9} ± {std:<6} {PARAMETERS[name].unit}")
    text.text(0, 0.97, "\n".join(lines), va="top", family="monospace", fontsize=8.5, linespacing=1.45)
    figure.savefig(Path(__file__).with_name("first-look.svg"), metadata={"Date": None})


if __name__ == "__main__":
    main()
