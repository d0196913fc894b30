"""The campaigns whose results are frozen: what a change of the program's structure must not change.

Each is simulated from a seed; those that a nonlinear law or a fault makes are made as the studies make them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Literal
from zlib import crc32

import numpy as np
from campaigns import AXLES, ballast
from fleet import FLEET
from hysteresis import loads_of, measured
from outcomes import INJURIES
from wireless import wireless

import sprung
from sprung.uncertainty import KnownValue
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, Vehicle, evaluate_quantity

Agreement = Literal["linear", "nonlinear"]
"""How closely two programs must agree: to 1e-6 of each value, or to 0.02 standard errors (nonlinear laws, faults corrected)."""

_LOAD: Mapping[str, Any] = {"name": "ballast", "items": [{"mass": 140.0, "position": (-1.0, 0.3, 0.5)}]}
_HALF: Mapping[str, Any] = {"rate": 250.0, "noise": 0.02, "seed": 1, "loads": [_LOAD]}


@dataclass(frozen=True)
class FrozenCampaign:
    """One campaign and how it is identified.

    Attributes
    ----------
    name
        What it shows.
    make
        Returns the campaign.
    agreement
        How closely values and standard errors must agree.
    options
        Keyword arguments of `sprung.identify`.
    """

    name: str
    make: Callable[[], sprung.Campaign]
    agreement: Agreement = "linear"
    options: Mapping[str, Any] | None = None

    def identify(self) -> sprung.Result:
        """Identify the campaign."""
        return sprung.identify(self.make(), **(self.options or {}))


def _car(**more: float) -> sprung.Campaign:
    return sprung.simulate(Vehicle.from_parameters(TABLE_1_CAR.parameters | more), **_HALF)


def _weighed(name: str) -> float:
    parameters = TABLE_1_CAR.parameters
    return evaluate_quantity(name, tuple(parameters), np.array(list(parameters.values())))[0]


def _rubbing(vehicle: Vehicle, **more: float) -> sprung.Campaign:
    own = Vehicle.from_parameters(vehicle.parameters | more, name=vehicle.name)
    known = {"total_mass": KnownValue(own.total_mass)}
    return measured(own, seed=1, rate=250.0, duration=2.6, loads=loads_of(own), known=known)


def _fault(name: str, vehicle: int, seed: int = 1) -> sprung.Campaign:
    test = FLEET[vehicle]
    random = np.random.default_rng([vehicle, seed, crc32(name.encode())])
    injured = INJURIES[name].act(test, test.campaign(seed), random)
    if injured is None or injured.rewrite is not None:
        raise ValueError(f"the fault '{name}' cannot be made in memory for vehicle {vehicle}")
    return injured.campaign


def _total_mass_too_large() -> sprung.Campaign:
    campaign = _car()
    return replace(campaign, known={"total_mass": KnownValue(1.09 * TABLE_1_CAR.total_mass, 10.0)})


def _two_vehicles() -> sprung.Campaign:
    """Return drops of which every second one is another vehicle's."""
    one, other = FLEET[0].campaign(1), replace(FLEET[0], vehicle=_OTHER).campaign(1)
    pairs = zip(one.recordings, other.recordings, strict=True)
    return one.with_recordings(pair[i % 2] for i, pair in enumerate(pairs))


_OTHER = Vehicle.from_parameters(
    TABLE_1_CAR.parameters | {"k_sf": 26000.0, "c_sr": 900.0, "m_s": 1150.0, "I_yy": 1800.0}, name="another car"
)

_APART = {name: value for name, value in TABLE_1_CAR.parameters.items() if name not in ("t_f", "t_r")}
_TRACKS = {"t_f1": 0.66, "t_f2": 0.74, "t_r1": 0.62, "t_r2": 0.71}

FROZEN: tuple[FrozenCampaign, ...] = (
    *(FrozenCampaign(f"sound: {test.vehicle.name}", partial(test.campaign, 1)) for test in FLEET),
    FrozenCampaign("separate tracks", lambda: sprung.simulate(Vehicle.from_parameters(_APART | _TRACKS), **_HALF)),
    FrozenCampaign(
        "axle masses known",
        lambda: replace(_car(), known={name: KnownValue(_weighed(name), 1.0) for name in AXLES}),
    ),
    FrozenCampaign("no load, nothing weighed", lambda: sprung.simulate(TABLE_1_CAR, **{**_HALF, "loads": []})),
    FrozenCampaign("eight loggers", lambda: wireless(loads=()).campaign),
    FrozenCampaign(
        "from the release on",
        lambda: sprung.simulate(SCHOOL_BUS, **{**_HALF, "loads": [ballast(SCHOOL_BUS)]}),
        "nonlinear",
        {"fall": True},
    ),
    FrozenCampaign("friction", lambda: _rubbing(TABLE_1_CAR, F_f=90.0, F_r=70.0, s_f=250e3, s_r=250e3), "nonlinear"),
    FrozenCampaign(
        "friction and rebound",
        lambda: _rubbing(TABLE_1_CAR, F_f=90.0, F_r=70.0, s_f=250e3, s_r=250e3, r_f=2.0, r_r=1.6),
        "nonlinear",
    ),
    FrozenCampaign("bump stop", lambda: _car(k_bf=30e3, k_br=25e3, x_bf=0.02, x_br=0.025), "nonlinear"),
    FrozenCampaign("asymmetry", lambda: _car(y_s=0.03, d_ksf=800.0, d_csr=400.0, d_ktr=-5000.0)),
    FrozenCampaign("rigid axle", lambda: _car(n_r=0.7, m_xr=-12.0)),
    FrozenCampaign("engine", lambda: _car(m_e=180.0, k_e=700e3, c_e=3000.0, x_e=0.1)),
    *(
        FrozenCampaign(f"fault: {name}, {FLEET[vehicle].vehicle.name}", partial(_fault, name, vehicle), "nonlinear")
        for name, vehicle in (
            ("exchanged, wheels", 0),
            ("gain", 2),
            ("sign, AC", 1),
            ("unit, g as m/s²", 3),
            ("late", 4),
            ("wrong wheel", 0),
            ("position, mirrored", 2),
            ("load exchanged, one", 1),
            ("brake", 0),
            ("other wheels", 3),
        )
    ),
    FrozenCampaign("doubtful: total mass 9 % too large", _total_mass_too_large),
    FrozenCampaign("doubtful: load item 0.2 m off", lambda: _fault("load position", 0)),
    FrozenCampaign("rejected: two vehicles", _two_vehicles),
    FrozenCampaign(
        "rejected: friction forbidden",
        lambda: _rubbing(TABLE_1_CAR, F_f=180.0, F_r=140.0, s_f=250e3, s_r=250e3),
        "nonlinear",
        {"extras": []},
    ),
)
"""All campaigns that are frozen."""

_WEIGHED = (
    "records whose residuals are coloured count less by their overdispersion, as the statement of a weighing does not: without "
    "that, values agree to 4e-9"
)
_ANOTHER_WAY = "the fit ends at the same optimum from another side, within 2e-4 of a standard error"

WANTED: Mapping[str, str] = {
    "doubtful: total mass 9 % too large": (
        "9 % is by chance the mass of the load, which is taken out of it: within a standard error of the truth, and accepted"
    ),
    "sound: Small car": _WEIGHED,
    "sound: School bus": _WEIGHED,
    "fault: sign, AC, Small car": _WEIGHED,
    "fault: unit, g as m/s², School bus": _WEIGHED,
    "fault: load exchanged, one, Small car": _WEIGHED,
    "eight loggers": _ANOTHER_WAY,
    "asymmetry": _ANOTHER_WAY,
    "from the release on": (
        "a tyre's contact within a time step is followed: the frozen values carry the error of steps of 1 ms, and at half of "
        "that the older program comes within 0.25 of a standard error of these"
    ),
    "friction": (
        "decays of vehicles with nonlinear forces also begin where the fitted vehicle last touches the ground: one to three "
        "samples earlier, with standard errors 3 to 8 % smaller"
    ),
    "friction and rebound": (
        "the model is found from an ordinary vehicle, whose fit lets decays begin later: some nine samples fewer of each, and "
        "values within 1.5 of the frozen standard errors"
    ),
    "bump stop": "the bump stops are found, where no model described the recordings",
    "fault: other wheels, School bus": (
        "the drop is corrected before model terms are selected, so that none makes up for it; the campaign is accepted"
    ),
    "doubtful: load item 0.2 m off": (
        "drops that repeat each other's errors of the model count as one: standard errors are 6 % larger, values as they were"
    ),
    "rejected: friction forbidden": (
        "a term has to explain a part of what is left: half-distances apart, which explain next to nothing of friction, are "
        "not taken; nothing is stated of a rejected model"
    ),
    "rejected: two vehicles": "the drops of each vehicle are named, where nothing was",
}
"""Campaigns of which another result than the frozen one is wanted, and why."""
