"""CommonRoad: its package loads the file, and its multi-body model moves vertically as ours does."""

from __future__ import annotations

import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scipy.optimize
from exported_vehicles import CASES, VEHICLES, case

from sprung import export
from sprung.errors import InputError, Problem
from sprung.vehicle import EMPTY, TABLE_1_CAR, Item, Load, Vehicle

models: Any = pytest.importorskip("vehiclemodels")

VERTICAL = [6, 7, 8, 9, 11, 12, 13, 14, 16, 17, 18, 19, 21, 22]
"""Of its states: roll, pitch and heave of the body, roll and heave of the axles, and their rates."""

SANDBAGS = Load(
    name="sandbags", items=(Item(mass=300, position=(-2.0, 0.0, 0.5)), Item(mass=20, on="fl"), Item(mass=20, on="fr"))
)


def loaded(text: str, folder: Path) -> Any:
    """Load a parameter file by the package; its tyre parameters are the package's own."""
    parameters = pytest.importorskip("vehiclemodels.vehicle_parameters")
    (folder / "parameters_vehicle5.yaml").write_text(text, encoding="utf-8")
    shutil.copy(Path(models.__file__).parent / "parameters" / "parameters_tire.yaml", folder)
    return parameters.setup_vehicle_parameters(5, folder)


def poles_of(parameters: Any, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Return the poles of the vertical motion of the multi-body model, 1/s.

    What a drop test does not determine is the package's second vehicle's, but without lateral and horizontal forces, which act
    on roll: the model then has the terms of ours only.
    """
    other = pytest.importorskip("vehiclemodels.vehicle_parameters").setup_vehicle_parameters(2)
    tyre = pytest.importorskip("vehiclemodels.utils.tire_model")
    dynamics = pytest.importorskip("vehiclemodels.vehicle_dynamics_mb").vehicle_dynamics_mb
    for name, value in (
        ("formula_longitudinal", 0.0),
        ("formula_lateral", [0.0, 1.0]),
        ("formula_longitudinal_comb", 0.0),
        ("formula_lateral_comb", 0.0),
    ):
        monkeypatch.setattr(tyre, name, lambda *_, value=value: value)
    known = {name: getattr(parameters, name) for name in parameters.__dataclass_fields__}
    filled = {name: getattr(other, name) if value is None else value for name, value in known.items()}
    nothing = dict.fromkeys(("K_ras", "K_rad", "K_lt", "I_xz_s", "R_w", "h_s", "h_raf", "h_rar"), 0.0)
    complete = SimpleNamespace(**{**filled, "steering": other.steering, "longitudinal": other.longitudinal, **nothing})

    def rates(vertical: Any) -> Any:
        state = np.zeros(29)
        state[VERTICAL] = vertical
        return np.array(dynamics(list(state), [0.0, 0.0], complete))[VERTICAL]

    start = np.zeros(len(VERTICAL))
    start[[8, 12]] = 0.02
    rest = scipy.optimize.root(rates, start, tol=1e-13).x
    assert np.abs(rates(rest)).max() < 1e-6
    step = 1e-6
    columns = [(rates(rest + change) - rates(rest - change)) / (2 * step) for change in step * np.eye(len(rest))]
    return np.linalg.eigvals(np.array(columns).T)


@pytest.mark.parametrize(
    ("vehicle", "load"),
    [
        (TABLE_1_CAR, EMPTY),
        (Vehicle({**TABLE_1_CAR.parameters, "k_af": 8e3, "k_ar": 4e3, "m_xr": 20.0}), EMPTY),
        (Vehicle({**TABLE_1_CAR.parameters, "t_r": 0.65, "c_sf": 1800.0}), SANDBAGS),
    ],
)
def test_its_model_moves_vertically_as_ours(
    vehicle: Vehicle, load: Load, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    poles = poles_of(loaded(export.commonroad(vehicle, load).text, tmp_path), monkeypatch)
    ours = export.state_space(vehicle, load).poles
    assert np.abs(poles[:, None] - ours).min(axis=1).max() < 1e-7 * np.abs(ours).max()  # differences of 1e-6


def test_only_what_is_known_is_in_it(tmp_path: Path) -> None:
    file = export.commonroad(TABLE_1_CAR)
    read = loaded(file.text, tmp_path)
    assert (read.m, read.m_s, read.m_uf) == (TABLE_1_CAR.total_mass, TABLE_1_CAR.m_s, 2 * TABLE_1_CAR.m_uf)
    assert (read.a, read.T_f, read.K_zt) == (TABLE_1_CAR.a, 2 * TABLE_1_CAR.t_f, TABLE_1_CAR.k_tf)
    missing = (
        "l",
        "w",
        "I_z",
        "I_xz_s",
        "K_ras",
        "K_rad",
        "I_y_w",
        "R_w",
        "K_lt",
        "T_sb",
        "D_f",
        "E_r",
        "h_s",
        "h_cg",
        "h_raf",
    )
    for name in missing:
        assert getattr(read, name) is None
        assert any(name in line for line in file.text.splitlines() if line.startswith("#   "))
    assert "steering.*" in file.text
    assert "tire.*" in file.text
    assert "not determined by a drop test" in file.notes[-1]


def test_heights_are_in_it_where_they_are_known(tmp_path: Path) -> None:
    read = loaded(export.commonroad(VEHICLES["roll-axis"]).text, tmp_path)
    assert (read.h_s, read.h_raf, read.h_rar) == (0.55, 0.2, 0.2)
    car = TABLE_1_CAR
    assert read.h_cg == pytest.approx((car.m_s * 0.55 + 2 * (car.m_uf + car.m_ur) * 0.3) / car.total_mass)


@pytest.mark.parametrize("name", CASES)
def test_it_is_exact_or_refused_or_says_what_is_approximated(name: str, tmp_path: Path) -> None:
    vehicle, load = case(name)
    refused: list[Problem] = []
    try:
        file = export.commonroad(vehicle, load)
    except InputError as error:
        refused = list(error.problems)
    if vehicle.model != "full":
        assert [problem.expected for problem in refused] == ["a whole vehicle"]
        return
    if refused:
        assert all("approximate=True" in problem.do for problem in refused)
        file = export.commonroad(vehicle, load, approximate=True)
    # One note is about what no drop test determines.
    assert len(file.notes) == 1 + len(refused)
    assert all(f"# {note}" in file.text for note in file.notes[:-1])
    assert loaded(file.text, tmp_path).m_s > 0


def test_approximations_are_what_they_say(tmp_path: Path) -> None:
    vehicle = Vehicle({**VEHICLES["curve"].parameters, "k_tr": 200000.0})
    read = loaded(export.commonroad(vehicle, approximate=True).text, tmp_path)
    assert read.K_sdf == pytest.approx((1 + 1.8) / 2 * 1500)  # the mean of compression and rebound
    assert read.K_zt == 196000.0
    at_rest = loaded(export.commonroad(VEHICLES["tyre-curve"], approximate=True).text, tmp_path)
    load = TABLE_1_CAR.total_mass * 9.80665 * 0.25  # of each wheel, within a tenth
    assert at_rest.K_zt == pytest.approx(192000 * (1 + 2 * 5.0 * load / 192000) ** 0.5, rel=0.02)
