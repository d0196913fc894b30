"""Drafts from sensors of displacement, velocity, angular rate and force, of vehicles and of parts of them."""

from __future__ import annotations

import shutil
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import sprung
from held import CHANNELS, RATE, half_car, let_go, lifted, rig_readings, write_rig
from layouts import check_view_is_whole
from sessions import NEUTRAL, write_table
from sprung.campaign import read_document
from sprung.drafting import DraftCampaign
from sprung.drafting.layout_names import wheels_named_anywhere
from sprung.drafting.named_settings import conditions_named
from sprung.drafting.quantity_names import is_travel_named, quantity_named, rotation_named
from sprung.drafting.recording_files import find_copies
from sprung.drafting.release_detection import average_pieces, detect_releases
from sprung.errors import InputError
from sprung.report import draft_view
from sprung.simulation import simulate
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, WHEELS, Sensor, Vehicle, Wheel

SOFT, HARD = half_car(), half_car(damping=2.0)
SOFT_LOADED = half_car(added=60.0)
RIG = {
    "Centre/Damped/run 1_1, damped_300.csv": (SOFT, 0.0),
    "Centre/Damped/run 1_2, damped_300.csv": (SOFT, 0.0),
    "Centre/Damped-Balanced/run 7_1, damped_300_50.csv": (SOFT_LOADED, 0.0),
    "Centre/Damped-Balanced/run 7_2, damped_300_50_1.csv": (SOFT_LOADED, 0.0),
    "Centre/Damped/run 2_1, damped_700.csv": (HARD, 0.0),
    "LHS/Damped/Run 11_1,Damped_300.csv": (SOFT, 0.6),
    "LHS/Damped/Run 12_1,Damped_700.csv": (HARD, 0.6),
    "LHS/Undamped/Run 10_1, undamped-8s.csv": (half_car(damping=0.2), 0.6),
}


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A half car that was lifted in the middle or at its left side and let go, at three settings of its damper."""
    folder = tmp_path_factory.mktemp("rig")
    write_rig(folder, RIG)
    shutil.copy(folder / "Centre/Damped/run 1_2, damped_300.csv", folder / "try.csv")
    return folder


@pytest.fixture(scope="module")
def drafts(rig: Path) -> dict[str | None, DraftCampaign]:
    return {draft.setting: draft for draft in sprung.draft_campaigns(rig)}


def test_each_setting_of_the_vehicle_has_a_campaign(rig: Path, drafts: dict[str | None, DraftCampaign]) -> None:
    assert list(drafts) == ["damped_0", "damped_300", "damped_700"]
    assert [len(draft.drops) for draft in drafts.values()] == [1, 5, 2]
    assert [draft.path for draft in drafts.values()] == [rig / str(name) / "campaign.toml" for name in drafts]
    assert drafts["damped_300"].drops[0].files == ("Centre/Damped/run 1_1, damped_300.csv",)
    (first, *_) = tomllib.loads(drafts["damped_300"].text)["drop"]
    assert first["file"] == "../Centre/Damped/run 1_1, damped_300.csv"
    check_view_is_whole(draft_view(*drafts.values()), tables=5)


def test_a_half_car_is_recognised_by_its_sides(drafts: dict[str | None, DraftCampaign]) -> None:
    for draft in drafts.values():
        assert draft.model == "roll-plane"
        assert [(sensor.channel, sensor.quantity, sensor.on) for sensor in draft.sensors] == [
            (channel, "displacement", on)
            for channel, on in zip(CHANNELS, ("body", "body", "left", "right"), strict=True)
        ]
        written = tomllib.loads(draft.text)
        assert written["vehicle"].keys() == {"name", "model"}
        assert [where for where, _ in draft.missing][:3] == [
            "known.total_mass", *(f"sensor[{i}].position ({CHANNELS[i - 1]})" for i in (1, 2)),
        ]  # fmt: skip
        assert "front" not in draft.text.partition("[[sensor]]")[0].partition("[known]")[2]
        assert max(map(len, draft.text.splitlines())) <= 130


def test_what_is_held_and_let_go_is_a_push_of_the_sides_that_were_held(
    drafts: dict[str | None, DraftCampaign],
) -> None:
    drops = [drop for draft in drafts.values() for drop in draft.drops]
    assert {drop.excitation for drop in drops} == {"push"}
    for drop in drops:
        assert drop.wheels == (("left",) if drop.files[0].startswith("LHS") else ("left", "right"))
        assert drop.window is None
        assert drop.found.release == pytest.approx(0.3, abs=0.03)
        assert "no wheel falls off a block" in drop.notes[1]


def test_a_second_number_is_a_load_and_no_mass(drafts: dict[str | None, DraftCampaign]) -> None:
    draft = drafts["damped_300"]
    assert draft.loads == ("50",)
    assert {drop.files[0]: drop.load for drop in draft.drops} == {
        name: "50" if "_50" in name else "empty" for name in RIG if "300" in name
    }
    (load,) = tomllib.loads(draft.text)["load"]
    assert load.keys() == {"name", "items"}
    assert load["items"].startswith("TODO:")


def test_a_copy_is_named_and_left_out(drafts: dict[str | None, DraftCampaign]) -> None:
    copy, original = "try.csv", "Centre/Damped/run 1_2, damped_300.csv"
    assert [draft.copies for draft in drafts.values()] == [{}, {copy: original}, {}]
    assert f"# Left out: {copy}: identical to {original}." in drafts["damped_300"].text


def test_the_recordings_of_a_draft_with_gaps_can_be_checked(rig: Path, tmp_path: Path) -> None:
    folder = tmp_path / "rig"
    shutil.copytree(rig, folder)
    for draft in sprung.draft_campaigns(folder):
        draft.write()
    found = sprung.check(folder / "damped_300")
    assert len(found.drops) == 5
    assert {missing.item for missing in found.missing} == {"total mass", "sensor positions", "load items"}
    with pytest.raises(InputError, match="a campaign file"):
        sprung.draft_campaigns(folder)


def test_without_settings_there_is_one_campaign(rig: Path, tmp_path: Path) -> None:
    (draft,) = sprung.draft_campaigns(rig, tmp_path / "out", settings=False)
    assert draft.setting is None
    assert len(draft.drops) == len(RIG)
    path = draft.write()
    assert path == tmp_path / "out" / "campaign.toml"
    read = sprung.read(path, complete=False)
    assert len(read.recordings) == len(RIG)


def drafted(folder: Path, readings: Mapping[str, NDArray[np.float64]]) -> DraftCampaign:
    """Draft one recording, its readings by channel."""
    write_table(folder / "one.csv", np.array(list(readings.values())), RATE, list(readings))
    return sprung.draft(folder)


def test_wheels_that_fall_as_far_as_the_body_were_dropped_from_blocks(tmp_path: Path) -> None:
    values = rig_readings(let_go(SOFT, [0.05, 0.0, 0.05, 0.05]))
    draft = drafted(tmp_path, dict(zip((f"{name} [mm]" for name in CHANNELS), values, strict=True)))
    (drop,) = draft.drops
    assert (drop.excitation, drop.wheels) == ("drop", ("left", "right"))
    assert "excitation" not in tomllib.loads(draft.text)["drop"][0]


@pytest.mark.parametrize(("held", "moved"), [((0.03, 0.0), ("left", "right")), ((0.018, 0.02), ("left",))])
def test_travel_that_differs_before_the_release_is_a_push(
    tmp_path: Path, held: tuple[float, float], moved: tuple[str, ...]
) -> None:
    force = SOFT.matrices()[2] @ [*held, 0.0, 0.0]
    coordinates = let_go(SOFT, np.linalg.solve(SOFT.matrices()[2], [force[0], force[1], 0.0, 0.0]).tolist())
    left, right = coordinates[0] + 0.6 * coordinates[1], coordinates[0] - 0.6 * coordinates[1]
    readings = {"Susp travel left [mm]": left - coordinates[2], "Susp travel right [mm]": right - coordinates[3]}
    draft = drafted(tmp_path, readings)
    assert [(sensor.on, sensor.is_travel, sensor.relative_to) for sensor in draft.sensors] == [
        ("body", True, "left"), ("body", True, "right"),
    ]  # fmt: skip
    assert (draft.drops[0].excitation, draft.drops[0].wheels) == ("push", moved)
    assert "position" not in draft.text.partition("[[sensor]]")[2].partition("# One [[load]]")[0]


def test_what_excited_a_vehicle_that_shows_it_not_is_asked(tmp_path: Path) -> None:
    coordinates = let_go(SOFT, lifted(SOFT, 900.0, 0.0).tolist())
    draft = drafted(tmp_path, {"chassis left [mm]": coordinates[0], "chassis right [mm]": coordinates[0]})
    assert draft.drops[0].excitation is None
    assert any(where.startswith("drop[1].excitation") for where, _ in draft.missing)
    campaign = read_document(tomllib.loads(draft.text), tmp_path / "campaign.toml", complete=False)
    assert len(campaign.recordings) == 1


def test_a_quarter_car_is_recognised_by_one_wheel_and_one_body(tmp_path: Path) -> None:
    quarter = Vehicle(model="quarter", m_s=350.0, m_u=40.0, k_s=2e4, k_t=2e5, c_s=900.0)
    held = np.linalg.solve(quarter.matrices()[2], [800.0, 0.0]).tolist()
    body, wheel = let_go(quarter, held)
    draft = drafted(tmp_path, {"LVDT sprung mass [mm]": body, "LVDT wheel hub [mm]": wheel})
    assert draft.model == "quarter"
    assert [sensor.on for sensor in draft.sensors] == ["body", "wheel"]
    assert (draft.drops[0].excitation, draft.drops[0].wheels) == ("push", ("wheel",))
    assert "TODO" not in draft.text.partition("LVDT wheel hub")[2]


def test_a_pitch_plane_is_recognised_by_its_ends(tmp_path: Path) -> None:
    bounce, _, _, wheel = let_go(SOFT, lifted(SOFT, 900.0, 0.0).tolist())
    names = ("Aufbau vorne Weg", "Aufbau hinten Weg", "Rad vorne Weg", "Rad hinten Weg")
    draft = drafted(
        tmp_path, dict(zip((f"{name} [mm]" for name in names), (bounce, bounce, wheel, wheel), strict=True))
    )
    assert draft.model == "pitch-plane"
    assert [sensor.on for sensor in draft.sensors] == ["body", "body", "front", "rear"]
    assert "wheelbase" in tomllib.loads(draft.text)["vehicle"]


def test_an_unknown_place_and_an_unknown_unit_are_asked(tmp_path: Path) -> None:
    bounce, _, _, wheel = let_go(SOFT, lifted(SOFT, 900.0, 0.0).tolist())
    draft = drafted(tmp_path, {"LVDT 1 [mm]": bounce, "LVDT 2": wheel, "gyro": 0.01 * np.gradient(bounce)})
    asked = {where.partition(" ")[0].rpartition(".")[2] for where, _ in draft.missing}
    assert {"on", "unit", "axis"} <= asked
    assert [sensor.on for sensor in draft.sensors] == [None, None, "body"]
    with pytest.raises(InputError, match="LVDT 2: found no unit"):
        read_document(tomllib.loads(draft.text), tmp_path / "campaign.toml", complete=False)


def test_other_sensors_stand_beside_accelerometers(tmp_path: Path) -> None:
    recording = simulate(TABLE_1_CAR, drops=[{"wheels": ["fl", "fr"]}], noise=0.02, seed=1).recordings[0]
    alone, beside = tmp_path / "alone", tmp_path / "beside"
    write_table(alone / "front.csv", recording.values, recording.rate)
    samples = recording.values.shape[1]
    noise = np.random.default_rng(1).standard_normal((6, samples))
    others = (
        "Nickrate [deg/s]",
        "Gierrate [deg/s]",
        "Federweg VL [mm]",
        "Force pad RR [N]",
        "road speed [km/h]",
        "hub vel HL [mm/s]",
    )
    write_table(beside / "front.csv", np.vstack([recording.values, noise]), recording.rate, (*NEUTRAL, *others))
    plain, draft = sprung.draft(alone), sprung.draft(beside)
    assert [sensor for sensor in draft.sensors if sensor.quantity == "acceleration"] == list(plain.sensors)
    described = {sensor.channel: sensor for sensor in draft.sensors if sensor.quantity != "acceleration"}
    assert {name: (own.quantity, own.axis, own.relative_to, own.on) for name, own in described.items()} == {
        "Nickrate": ("angular-rate", "pitch", None, "body"),
        "Federweg VL": ("displacement", None, "fl", "body"),
        "hub vel HL": ("velocity", None, None, "rl"),
    }
    assert set(draft.files[0].left_out) == {"Gierrate", "road speed", "Force pad RR"}
    assert draft.drops[0].wheels == plain.drops[0].wheels
    assert draft.model == "full"
    read_document(tomllib.loads(draft.text), beside / "campaign.toml", complete=False)


def test_lifting_and_lowering_are_no_release() -> None:
    ramp = np.concatenate([np.zeros(500), np.linspace(0, 0.04, 800), np.full(1000, 0.04)])
    swing = 1e-3 * let_go(SOFT, lifted(SOFT, 900.0, 0.0).tolist(), noise=0.0)[0]
    held = np.concatenate([ramp, 0.04 - swing[0] + swing, np.full(500, 0.04 - swing[0])])
    noisy = held + 2e-5 * np.random.default_rng(1).standard_normal(held.size)
    releases, rejected = detect_releases(average_pieces([(0, noisy[None, :])], RATE, 10.0), ("body",))
    assert [release.release for release in releases] == pytest.approx([10.0 + (ramp.size + 150) / RATE], abs=0.03)
    assert ["lifted or lowered" in event.why for event in rejected] == [True]
    assert releases[0].fall == pytest.approx([swing[0]], abs=1e-3)


@pytest.mark.parametrize(
    ("name", "quantity"),
    [
        ("Disp Sprung LH (Filtered)", "displacement"),
        ("StringPot_3", "displacement"),
        ("Weg VL", "displacement"),
        ("GyroX", "angular-rate"),
        ("pitch rate", "angular-rate"),
        ("Kraft Platte HL", "force"),
        ("load cell 2", "force"),
        ("wheel velocity", "velocity"),
        ("acc_travel", "acceleration"),
        ("Rad VL", None),
        ("ch1", None),
    ],
)
def test_names_of_quantities(name: str, quantity: str | None) -> None:
    assert quantity_named(name) == quantity


def test_names_of_travels_rotations_and_folders() -> None:
    assert [is_travel_named(name) for name in ("stroke FL", "Einfederung VL", "Disp body FL")] == [True, True, False]
    assert [rotation_named(name) for name in ("roll gyro", "gyro y", "yaw rate", "gyro")] == [
        "roll",
        "pitch",
        "yaw",
        None,
    ]
    assert wheels_named_anywhere("RHS/set 3/left out.csv") == ("fl", "rl")
    assert wheels_named_anywhere("RHS/set 3/run.csv") == ("fr", "rr")


@pytest.mark.parametrize(
    ("names", "stated"),
    [
        (("empty_bounce.csv", "empty_front.csv"), [(None, None)] * 2),
        (("damper_test_1.csv", "damper_test_2.csv"), [(None, None)] * 2),
        (("drop_damped_1.csv", "drop_damped_2.csv", "drop_damped_3.csv"), [(None, None)] * 3),
        (("clicks 1/a.csv", "clicks 2/a.csv"), [("clicks_1", None), ("clicks_2", None)]),
        (("2.5bar/a.csv", "3bar/a.csv"), [("2.5bar", None), ("3bar", None)]),
        (("Druck_3_01.csv", "Druck_5_02.csv"), [("druck_3", None), ("druck_5", None)]),
        (("ungedämpft.csv", "gedämpft_30.csv", "gedämpft_30_2.csv"),
         [("gedämpft_0", None), ("gedämpft_30", None), ("gedämpft_30", None)]),
        (("p damped_5_2023-05-17.csv", "p damped_8_2023-05-17.csv"), [("damped_5", None), ("damped_8", None)]),
        (("damped_5_40.csv", "damped_5_80.csv", "damped_5.csv"), [(None, "40"), (None, "80"), (None, "empty")]),
        (("no damper.csv", "damper 4.csv", "damper 4 b.csv", "rust.csv"),
         [("damper_0", None), ("damper_4", None), ("damper_4", None), ("other", None)]),
    ],
)  # fmt: skip
def test_names_of_settings_and_loads(names: tuple[str, ...], stated: list[tuple[str | None, str | None]]) -> None:
    assert [(own.setting, own.load) for own in conditions_named(names).values()] == stated


def test_pads_that_move_need_no_release(tmp_path: Path) -> None:
    time = np.arange(2000) / RATE
    swept = 5 * np.sin(2 * np.pi * (0.5 + 2 * time) * time)
    readings = {"body L [mm]": 2 * swept, "body R [mm]": 2 * swept, "pad L [mm]": swept, "pad R [mm]": swept}
    draft = drafted(tmp_path, readings)
    assert [sensor.on for sensor in draft.sensors] == ["body", "body", "pad left", "pad right"]
    assert [(drop.excitation, drop.wheels) for drop in draft.drops] == [("pads", ("left", "right"))]
    read_document(tomllib.loads(draft.text), tmp_path / "campaign.toml", complete=False)


def test_pads_that_rest_are_left_out(tmp_path: Path) -> None:
    bounce, _, _, wheel = let_go(SOFT, lifted(SOFT, 900.0, 0.0).tolist())
    noise = 0.01 * np.random.default_rng(3).standard_normal((2, bounce.size))
    draft = drafted(
        tmp_path,
        {"body L [mm]": bounce, "wheel L [mm]": wheel, "pad L [mm]": noise[0], "load cell pad L [N]": noise[1]},
    )
    assert draft.drops[0].excitation == "push"
    assert set(draft.files[0].left_out) == {"pad L", "load cell pad L"}
    assert draft.model == "quarter"


def displacement_sensors(kinds: Sequence[str]) -> list[Sensor]:
    """Sensors of the bodies' corners, of wheels and across suspensions of the paper's car, in mm."""
    made = []
    for wheel in WHEELS:
        places: dict[str, dict[str, Any]] = {
            "body": {
                "on": "body",
                "position": (0.0 if wheel[0] == "f" else -2.76, 0.7 if wheel[1] == "l" else -0.7, 0.5),
            },
            "wheel": {"on": wheel},
            "travel": {"on": "body", "relative_to": wheel},
        }
        made += [
            Sensor(channel=f"disp {kind} {wheel}", quantity="displacement", unit="mm", **places[kind]) for kind in kinds
        ]
    return made


@pytest.mark.parametrize("kinds", [("body", "wheel"), ("travel",)])
@pytest.mark.parametrize("excitation", ["drop", "push", "pass"])
@pytest.mark.parametrize("wheels", [WHEELS, ("fl", "fr"), ("fl", "rl")])
def test_displacements_show_what_excited_a_vehicle(
    tmp_path: Path, kinds: tuple[str, ...], excitation: str, wheels: tuple[Wheel, ...]
) -> None:
    drop = {"wheels": list(wheels), "excitation": excitation}
    campaign = simulate(
        TABLE_1_CAR, sensors=displacement_sensors(kinds), drops=[drop], noise=1e-4, duration=6.0, seed=1
    )
    (recording,) = campaign.recordings
    readings = {f"{name} [mm]": 1e3 * own for name, own in zip(recording.channels, recording.values, strict=True)}
    write_table(tmp_path / "one.csv", np.array(list(readings.values())), recording.rate, list(readings))
    draft = sprung.draft(tmp_path)
    assert [found.excitation for found in draft.drops] == [excitation]
    assert draft.model == "full"
    if excitation == "drop":
        assert draft.drops[0].wheels == wheels
    else:  # how far the vehicle swings shows them only roughly
        assert set(draft.drops[0].wheels) >= set(wheels)


def test_the_name_knows_better_which_wheels_were_pushed(tmp_path: Path) -> None:
    drop = {"wheels": ["fl", "fr"], "excitation": "push"}
    campaign = simulate(SCHOOL_BUS, sensors=displacement_sensors(["travel"]), drops=[drop], noise=1e-4, seed=1)
    (recording,) = campaign.recordings
    names = [f"{name} [mm]" for name in recording.channels]
    for name, start in (("one", 0.0), ("push front", 1.0)):
        write_table(tmp_path / f"{name}.csv", 1e3 * recording.values, recording.rate, names, start)
    plain, named = sprung.draft(tmp_path).drops
    assert "wheels by how far the vehicle swings" in plain.notes
    assert (named.wheels, "wheels by the name of the recording" in named.notes) == (("fl", "fr"), True)


def test_a_push_of_which_only_accelerations_tell_is_one_by_its_name(tmp_path: Path) -> None:
    drops: list[dict[str, Any]] = [{"wheels": ["fl", "fr"], "excitation": "push"}, {"wheels": list(WHEELS)}]
    campaign = simulate(TABLE_1_CAR, drops=drops, noise=0.02, seed=1)
    names = [sensor.channel for sensor in campaign.sensors]
    for name, recording in zip(("push front", "drop"), campaign.recordings, strict=True):
        write_table(tmp_path / f"{name}.csv", recording.values, recording.rate, names)
    draft = sprung.draft(tmp_path)
    assert [(drop.excitation, drop.wheels) for drop in draft.drops] == [("drop", WHEELS), ("push", ("fl", "fr"))]
    assert [sensor.on for sensor in draft.sensors] == ["body"] * 4 + list(WHEELS)
    (tmp_path / "drop.csv").unlink()
    alone = sprung.draft(tmp_path)
    assert [drop.excitation for drop in alone.drops] == ["push"]
    assert [sensor.on for sensor in alone.sensors] == ["body"] * 4 + list(WHEELS)


def test_a_pass_by_its_name_is_no_drop_though_wheels_fall_behind_the_bump(tmp_path: Path) -> None:
    drops: list[dict[str, Any]] = [
        {"wheels": list(WHEELS), "excitation": "pass"},
        {"wheels": ["fl", "rl"], "excitation": "pass"},
        {"wheels": ["fl", "fr"], "excitation": "push"},
    ]
    campaign = simulate(TABLE_1_CAR, drops=drops, noise=0.02, seed=1)
    names = [sensor.channel for sensor in campaign.sensors]
    for name, recording in zip(("empty pass", "left pass", "front push"), campaign.recordings, strict=True):
        write_table(tmp_path / f"{name}.csv", recording.values, recording.rate, names)
    draft = sprung.draft(tmp_path)
    found = {drop.files[0]: (drop.excitation, drop.wheels) for drop in draft.drops}
    assert found == {
        "empty pass.csv": ("pass", ()),
        "front push.csv": ("push", ("fl", "fr")),
        "left pass.csv": ("pass", ("fl", "rl")),
    }
    assert any(
        "a pass by the name of the recording, in which the accelerations show" in " ".join(drop.notes)
        for drop in draft.drops
    )


def test_copies_of_what_cannot_be_read_are_not_read(tmp_path: Path) -> None:
    coordinates = let_go(SOFT, lifted(SOFT, 900.0, 0.0).tolist())
    for name in ("a.txt", "b.txt"):
        (tmp_path / name).write_text("It rained.\n")
    draft = drafted(tmp_path, {"body L [mm]": coordinates[0], "wheel L [mm]": coordinates[3]})
    assert (set(draft.unreadable), draft.copies) == ({"a.txt", "b.txt"}, {})


def test_of_copies_whose_paths_say_nothing_else_the_shortest_is_kept(tmp_path: Path) -> None:
    for name in ("bounce.csv", "bounce (copy).csv", "sub/bounce.csv"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("time,a\n0,1\n")
    names = ["bounce (copy).csv", "bounce.csv", "sub/bounce.csv"]
    assert find_copies(tmp_path, names) == {"bounce (copy).csv": "bounce.csv", "sub/bounce.csv": "bounce.csv"}
