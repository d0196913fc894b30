"""The page of the real half-car rig: tables of what was found, and what follows from them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from pages import table

MASS = 433.0
"""Sprung mass, kg, of the rig's data sheet: the scale of everything, which no recording of it shows."""

SHEET: Mapping[str, float] = {"k_s": 20.5e3, "k_t": 147.2e3, "I_xx": 82.7, "m_u": 56.1}
"""What the data sheet states beside, SI."""

SHOWN: Mapping[str, tuple[str, float]] = {
    "k_s": ("kN/m", 1e3),
    "k_t": ("kN/m", 1e3),
    "I_xx": ("kg m²", 1.0),
    "m_u": ("kg", 1.0),
    "c_s": ("N s/m", 1.0),
    "t": ("m", 1.0),
    "F": ("N", 1.0),
    "d_F": ("N", 1.0),
    "k_x": ("kN/m", 1e3),
    "c_x": ("kN s/m", 1e3),
}
"""Columns of the table: unit, and SI units in it."""

SAME = ("k_s", "k_t", "I_xx", "m_u")
"""What has to be the same in all settings."""

Outcomes = Mapping[str, Mapping[str, Any]]
"""By setting, then by load: what was found."""


class Agreement(NamedTuple):
    """How far values agree: weighted mean and its standard error, largest difference from it, and chi-square.

    Attributes
    ----------
    mean, std
        As the values.
    part
        Largest difference from the mean, %.
    errors
        Largest difference from the mean, in the standard errors of the value.
    chi_square
        Sum of squared differences in standard errors; as large as `freedom` by chance.
    freedom
        Number of values less one.
    """

    mean: float
    std: float
    part: float
    errors: float
    chi_square: float
    freedom: int


def agreement(pairs: list[tuple[float, float]]) -> Agreement:
    """Return how far values with standard errors agree."""
    values, stds = np.array(pairs, dtype=float).T
    mean = float(np.sum(values / stds**2) / np.sum(stds**-2.0))
    apart = np.abs(values - mean)
    squared = float(np.sum((apart / stds) ** 2))
    return Agreement(
        mean,
        float(np.sum(stds**-2.0) ** -0.5),
        100 * float(apart.max() / mean),
        float((apart / stds).max()),
        squared,
        len(values) - 1,
    )


def page(outcomes: Outcomes) -> str:
    """Write the page."""
    empty = {setting: loads["empty"] for setting, loads in outcomes.items()}
    usable = [one for one in empty.values() if one["verdict"] != "reject"]
    head = ["setting", "verdict", "faults", *(f"{name}, {unit}" for name, (unit, _) in SHOWN.items()), "relaxes in, s"]
    agreeing = {name: agreement([one["parameters"][name] for one in usable]) for name in SAME}
    same = [
        [
            name,
            f"{found.mean / SHOWN[name][1]:.4g} ± {found.std / SHOWN[name][1]:.2g} {SHOWN[name][0]}",
            f"{found.part:.1f}",
            f"{found.errors:.1f}",
            f"{found.chi_square:.1f} ({found.freedom})",
            f"{SHEET[name] / SHOWN[name][1]:.4g}",
        ]
        for name, found in agreeing.items()
    ]
    sensors = max((list(one["gains"]) for one in empty.values()), key=len)
    gains = [
        [setting, *(_with_std(*one["gains"].get(c, (None, None)), 0.01) for c in sensors)]
        for setting, one in empty.items()
    ]
    channels = list(next(iter(empty.values()))["residual"])
    drops = sum(one["drops"] for one in empty.values())
    masses, summary = _added_masses(outcomes)
    hop = (agreeing["k_t"].mean + agreeing["k_s"].mean) / agreeing["m_u"].mean
    on_sheet = (SHEET["k_t"] + SHEET["k_s"]) / SHEET["m_u"]
    return f"""# A real half-car rig

The first recordings here that nature made and not a program: a full-size half-car rig (a body on two wheels, in the roll plane)
that is lifted in the middle or on its left side and let go, with four displacement sensors, in five settings, without and with
two added masses. Springs, tyres and masses are the same in all settings. Does the program find them so?

## Recordings

They are public ("LAB TEST FOLDER" of the repository DARKMOONlite/DS-C_B-Half-Car-Rig-Analysis on GitHub) and without a
licence, so that nothing of them is in this project. `sprung new FOLDER` drafts one campaign for each setting from the folder as
it is. {drops} lifts are without added masses. What the folder does not say was filled in: the sprung mass, {MASS:g} kg, which
gives the scale of everything, and the half-distances of the sensors, 0.75 m, and of the springs, (0.75 ± 0.03) m, from the
rig's data sheet; an unsprung mass of (80 ± 40) kg; and that both sides are alike within some 1 %, tyres within 3 %. Four
seconds of every recording are used.

What `sprung check` says of every recording: it is spliced from two parts. In the first half second to second all channels
passed a low-pass of some 50 Hz, and are 8.3 ms late; that part is advanced (fault `splice`). In four of the recordings, as they
are with 5000 samples per second, the sensor of the left wheel jumps by 0.06 mm for two samples, once or twice, and in a fifth
it does so where both parts meet (`spike`); these samples are replaced.

No free vibration shows the gain that all sensors of the body have, or all of the wheels: with a gain {{math}}`g` of the
wheels' sensors, {{math}}`k_t/g` and {{math}}`m_u/g` fit alike. The left sensors are therefore taken to be right, and the
gains of the right ones are found.

## What the rig has that the plain model has not

- **Dry friction that differs between left and right** (`uneven-friction`): on the left it is about twice that on the right.
  With equal frictions the undamped rig (`damped_0`) was rejected: the reversals of the left friction excite the hop of the
  left wheel, to 0.25 mm at 10 Hz over the first second, while the right wheel hardly hops (0.05 mm). No model that is alike
  on both sides does that.
- **A right wheel sensor that reads 10 to 15 % less than the left one.** An earlier version of this study held both to be right
  within 1 %: no tyre rate suited both wheels, the gains of the body's sensors took up what was left, and k_t differed by 12 %,
  m_u by 42 % between settings.
- **An interconnection of left and right.** The settings, which the recordings' names call damped, hardly change the damping of
  bounce. They change a rate against roll that relaxes in some tenths of a second, as a fluid line between both sides does.
- **A rate against roll that does not relax and differs between settings.** The half-distance t of the springs, left open
  to some centimetres, stands for it: it is larger without damping than with it. An earlier version of this study held 0.75 m,
  which damped_500 contradicted by 4.7 standard errors; I_xx then differed by 13 % from its mean.
- Tyre damping, and sides that differ somewhat (`asymmetry`).

## Results

{table(head, [_row(setting, one) for setting, one in empty.items()])}

After ± one standard error, which contains what the model leaves and how far the lifts disagree. d_F is by how much the left
friction is above the mean of both. What has to be the same, over the settings that are not rejected:

{table(["", "weighted mean", "farthest from it, %", "in standard errors", "chi-square (degrees)", "data sheet"], same)}

Gains of the sensors, part by which they read too much, %:

{table(["setting", *sensors], gains)}

## Added masses

The recordings' names call them "100" and "200" and do not say of what. Every setting was identified with each of them, its
springs, tyres and wheels known from the lifts without: what remains is the sprung mass, its inertia, frictions and damping.

{table(["setting", "added", "verdict", "m_s, kg", "added mass, kg", "I_xx, kg m²"], masses)}

{summary}

## What is left

mm root-mean-square (and as a part of the range of the motion, %), without added masses:

{table(["setting", *channels], [_left(setting, one, channels) for setting, one in empty.items()])}

Reasons of the verdicts:

{_reasons(outcomes)}

## What is not explained

- What is left of the wheels' motion is 0.02 to 0.04 mm. On the right wheel in the middle lifts it is mostly at the 10 Hz at
  which the left wheel hops, as if a frame or floor carried that over; no sensor shows which.
- The heave of the body alone, as one mass on one spring with friction and damping, has a natural frequency that differs between
  settings by as much as k_s does (0.6 % in frequency between damped_0 and damped_1000): what the lines between both sides
  contribute to the rate is not the same in all settings, or k_s makes up for something else that is not.
- The lifts of one kind leave nearly the same residuals (coefficients of correlation of 0.8 to 0.98), those of different kinds
  different ones. The standard errors therefore count lifts that repeat each other as one. Before, k_s was 7.6 standard errors
  from its mean at the most.
- **Dampers that steepen.** The force of each strut follows from the motion of its wheel alone, as that of its tyre: in the
  middle lifts the left one shows dry friction and hardly any damping up to 0.1 m/s, and a force that grows faster and faster
  beyond, as an orifice makes it; the right one shows damping from the slowest motion on. In an earlier version of this study a
  `damper-curve`, alike on both sides, took a sixth off what is left of the body's motion in damped_1000, with 3.3 ± 1 times the
  rate beyond 0.1 m/s, and moved k_s by 0.2 %; the other settings hardly determined it, or not at all: it is not in the model.
- The undamped rig has an m_u that is 10 kg below that of the other settings, and a quarter of their tyre damping.
- An added mass is a small difference: 0.1 % of the whole mass is 2.4 % of the lighter one.
- The wheels hop at {_frequency(hop):.1f} Hz by these numbers, and at {_frequency(on_sheet):.1f} Hz by the data sheet's,
  whose masses and rates are not those of the recordings.
- Absolute masses, rates and forces are as right as the data sheet's sprung mass, and k_t and m_u as right as the ratio of the
  gains of the left sensors.

## Reproduction

    python docs/studies/half_car_rig.py "LAB TEST FOLDER" --processes 2
"""


def _frequency(ratio: float) -> float:
    """Return the natural frequency, Hz, of a rate over a mass, 1/s²."""
    return float(np.sqrt(ratio)) / (2 * np.pi)


def _added_masses(outcomes: Outcomes) -> tuple[list[list[str]], str]:
    """Return the rows of the table of added masses, and how far they agree."""
    rows, lines = [], []
    added: dict[str, list[tuple[float, float]]] = {}
    for setting, loads in outcomes.items():
        for load, one in loads.items():
            mass, std = one["parameters"]["m_s"]
            if load == "empty":
                continue
            cells = [setting, load, one["verdict"]]
            if mass is None or std is None:
                rows.append([*cells, "-", "-", "-"])
                continue
            rate, its_std = loads["empty"]["parameters"]["k_s"]
            std = float(np.hypot(std, mass * its_std / rate))
            added.setdefault(load, []).append((mass, std))
            inertia = _with_std(*one["parameters"]["I_xx"], 1.0)
            rows.append([*cells, _with_std(mass, std, 1.0), _with_std(mass - MASS, std, 1.0), inertia])
    for load, pairs in added.items():
        found, masses = agreement(pairs), np.array(pairs)[:, 0] - MASS
        mean = float(masses.mean())
        apart = 100 * float(np.abs(masses - mean).max()) / mean
        lines.append(
            f'With "{load}" m_s is {found.mean:.4g} kg in the mean, and {found.part:.2f} % from it at most. The added mass is '
            f"{mean:.3g} kg in the plain mean, {100 * mean / MASS:.3g} % of the sprung mass, and {apart:.1f} % from it at most "
            f"({found.errors:.1f} standard errors from the weighted mean)."
        )
    if {"100", "200"} <= added.keys():
        light, heavy = (np.mean([mass for mass, _ in added[load]]) - MASS for load in ("100", "200"))
        lines.append(f'"200" is {heavy / light:.3g} times "100".')
    return rows, " ".join(lines)


def _reasons(outcomes: Outcomes) -> str:
    return "\n".join(
        f"- {setting}{'' if load == 'empty' else f', {load}'}: {'; '.join(one['reasons'])}"
        for setting, loads in outcomes.items()
        for load, one in loads.items()
    )


def _left(setting: str, outcome: Mapping[str, Any], channels: list[str]) -> list[str]:
    left, span = outcome["residual"], outcome["span"]
    return [setting, *(f"{1e3 * left[c]:.3f} ({100 * left[c] / span[c]:.2f})" for c in channels)]


def _row(setting: str, outcome: Mapping[str, Any]) -> list[str]:
    found = outcome["parameters"]
    cells = [_with_std(*found.get(name, (None, None)), factor) for name, (_, factor) in SHOWN.items()]
    rate, damping = (found.get(name, (None, None))[0] for name in ("k_x", "c_x"))
    relaxes = f"{damping / rate:.2f}" if rate and damping else "-"
    return [setting, outcome["verdict"], ", ".join(outcome["faults"]), *cells, relaxes]


def _with_std(value: float | None, std: float | None, factor: float) -> str:
    return "-" if value is None or std is None else f"{value / factor:.4g} ± {std / factor:.2g}"
