"""Ride numbers of identified vehicles: their uncertainties, absolute scale, and what is refused."""

from __future__ import annotations

import json
from functools import cache

import numpy as np
import pytest

import sprung
from sprung.errors import InputError
from sprung.results import Result
from sprung.ride import Road, ride_numbers
from sprung.ride.distribution import ParameterDistribution
from sprung.uncertainty import NORMAL_95
from sprung.vehicle import EMPTY, TABLE_1_CAR, Item, Load, Vehicle

CAR = TABLE_1_CAR


@cache
def identified(weighed: bool = True, noise: float = 0.2) -> Result:
    """The linear car, in ten times the usual noise: uncertainties of several percent show whether the first order is enough."""
    known = {"total_mass": CAR.total_mass} if weighed else {}
    campaign = sprung.simulate(CAR, noise=noise, seed=4, known=known)
    return sprung.identify(campaign, extras=(), tracks="shared", fall=False)


@pytest.mark.parametrize(("draws", "tolerance"), [(50, 0.4), pytest.param(400, 0.15, marks=pytest.mark.long)])
@pytest.mark.slow
def test_uncertainties_are_those_of_draws(draws: int, tolerance: float) -> None:
    """Vehicles drawn from the joint distribution: their spread, which has a statistical error of 10 and 3.5 %."""
    result = identified()
    found = dict(ride_numbers(result, roads="C").items())
    distribution = ParameterDistribution.of_result(result, EMPTY)
    drawn: dict[str, list[float]] = {name: [] for name in found}
    for values in distribution.draw(draws, seed=1):
        car = Vehicle.from_parameters(dict(zip(distribution.names, values.tolist(), strict=True)))
        for name, estimate in ride_numbers(car, roads="C").items():
            drawn[name].append(estimate.value or 0.0)
    for name, estimate in found.items():
        assert estimate.std == pytest.approx(float(np.std(drawn[name])), rel=tolerance), name


def test_quarter_car_has_the_uncertainty_of_its_parameters() -> None:
    result = identified()
    axle = ride_numbers(result, roads="C").axles["front"]
    for number, parameter in (("k_s", "k_sf"), ("k_t", "k_tf"), ("m_u", "m_uf"), ("c_s", "c_sf")):
        estimate, own = axle[number], result.parameters[parameter]
        assert estimate.value == pytest.approx(own.value, rel=1e-9)
        assert estimate.std == pytest.approx(own.std, rel=1e-5)
        assert estimate.interval95 == pytest.approx(own.interval95, rel=1e-5)
    derived = result.derived["front_wheel_load"]
    load = ride_numbers(result, roads="C").plates["fl"]["static_load"]
    assert (load.value, load.std) == pytest.approx((derived.value, derived.std), rel=1e-4)


def test_truth_is_within_the_intervals() -> None:
    """Of some sixty numbers, strongly correlated, hardly any is three standard uncertainties off."""
    truth = dict(ride_numbers(CAR, roads="C").items())
    for name, estimate in ride_numbers(identified(), roads="C").items():
        assert estimate.value is not None
        assert estimate.std
        assert abs(estimate.value - (truth[name].value or 0.0)) < 4 * estimate.std, name
        low, high = estimate.interval95 or (0.0, 0.0)
        assert low is not None
        assert high is not None
        assert low < estimate.value < high
        if name.endswith("body_frequency"):
            assert np.log(high / low) == pytest.approx(2 * NORMAL_95 * estimate.std / estimate.value, rel=1e-6)


SCALED = ("m_s", "m_u", "k_s", "k_t", "c_s", "static_load", "load", "I_yy", "I_xx")
"""Numbers that need the absolute scale."""


def test_without_absolute_scale_ratios_are_what_they_are_with_it() -> None:
    """Masses, rates and forces have no value; everything else has the same value and uncertainty as of the weighed vehicle."""
    weighed, free = (ride_numbers(identified(weighed=weighed), roads="C") for weighed in (True, False))
    assert not identified(weighed=False).scale.known
    other = dict(free.items())
    assert any("absolute scale" in note for note in free.notes)
    for name, estimate in weighed.items():
        if name.rpartition(".")[2] in SCALED:
            assert other[name].value is None, name
            assert other[name].status == "unidentifiable"
        else:
            assert other[name].value == pytest.approx(estimate.value, rel=1e-3), name
            assert other[name].std == pytest.approx(estimate.std, rel=0.02), name


def test_load_needs_the_scale() -> None:
    load = Load(name="driver", items=(Item(mass=75.0, position=(-1.3, 0.35, 0.7)),))
    with pytest.raises(InputError, match="a known scale"):
        ride_numbers(identified(weighed=False), load=load)
    with_driver = ride_numbers(identified(), roads="C", load=load)
    plates = with_driver.plates
    assert plates["fl"]["static_load"].value > plates["fr"]["static_load"].value  # type: ignore[operator]


def test_uncertain_mass_of_a_load_counts() -> None:
    exact, uncertain = (
        Load(name="boot", items=(Item(mass=150.0, mass_std=std, position=(-2.5, 0.0, 0.6)),)) for std in (0.0, 15.0)
    )
    one, other = (
        ride_numbers(identified(), roads="C", load=load).plates["rl"]["static_load"] for load in (exact, uncertain)
    )
    assert one.value == pytest.approx(other.value, rel=1e-9)
    # It is 2.5 of 2.76 m behind the front axle, on two wheels: a standard uncertainty of 15 kg · 9.81 m/s² · 0.906/2.
    added = np.sqrt((other.std or 0.0) ** 2 - (one.std or 0.0) ** 2)
    assert added == pytest.approx(15 * 9.80665 * 2.5 / 2.76 / 2, rel=0.02)


@pytest.mark.slow
def test_saved_and_read_again_it_is_the_same(tmp_path: object) -> None:
    result = identified(weighed=False)
    again = sprung.load(result.save(f"{tmp_path}/results"))
    assert ride_numbers(again, roads="B").document() == ride_numbers(result, roads="B").document()


def test_document_is_json_with_every_number() -> None:
    found = ride_numbers(
        identified(), roads=["A", Road("our track", 50e-6)], speeds=[10.0, 25.0], places={"seat": (-1.4, 0.4)}
    )
    text = json.dumps(found.document(), allow_nan=False)
    document = json.loads(text)
    assert [one["road"] for one in document["roads"]] == ["A", "our track", "A", "our track"]
    weighted = document["roads"][1]["places"]["seat"]["weighted"]
    assert weighted["unit"] == "m/s^2"
    assert weighted["interval95"][0] < weighted["value"] < weighted["interval95"][1]
    curve = document["transmissibility"]["body_front"]
    assert len(curve["frequency"]) == len(curve["gain"]) == len(curve["std"]) > 100
    assert found.on("A", 25.0).speed == 25.0
    with pytest.raises(InputError, match="road C"):
        found.on("C")


def test_transmissibility_has_its_uncertainty() -> None:
    """At the peak, that of the peak; at low frequencies the body follows the road exactly."""
    found = ride_numbers(identified(), roads="C")
    curve, peak = found.curves["body_front"], found.peaks["body_front"]
    at = int(np.argmax(curve.gain))
    assert curve.gain[at] == pytest.approx(peak["gain"].value, rel=1e-3)
    assert curve.std[at] == pytest.approx(peak["gain"].std, rel=0.1)
    assert curve.std[0] < 0.2 * curve.std[at]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"roads": "X"}, "a class of ISO 8608"),
        ({"roads": ()}, "at least one"),
        ({"speeds": ()}, "at least one speed"),
        ({"speeds": [300.0]}, "speeds in Python are in m/s"),
        ({"places": {"seat": (1.0,)}}, "forward of the front axle"),
        ({"places": {"seat": (-1.0, 0.0, 0.5)}}, "Leave z out"),
        ({"tracks": "alike"}, "isotropic"),
        ({"duration": -1800.0}, r"found -0.5 h \(-1800 s\); expected a positive duration"),
        ({"load": "trailer"}, "a load of the campaign. Allowed: empty"),
        ({"places": {"seat": (1400.0, 400.0)}}, "coordinates of -20 to 20 m"),
    ],
)
def test_impossible_options_are_refused(options: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        ride_numbers(CAR, **options)  # type: ignore[arg-type]


def test_all_faults_are_in_one_error() -> None:
    with pytest.raises(InputError) as raised:
        ride_numbers(CAR, roads="XY", speeds=[0.0], tracks="alike", load="trailer")
    assert len(raised.value.problems) == 5


def test_rejected_and_undetermined_results_are_refused() -> None:
    from dataclasses import replace  # noqa: PLC0415

    from sprung.assessment import Verdict  # noqa: PLC0415

    result = identified()
    with pytest.raises(InputError, match="the verdict reject"):
        ride_numbers(replace(result, verdict=Verdict(state="reject", reasons=("no",))))
    unknown = replace(result.parameters["k_sf"], value=None, std=None, interval95=None, status="unidentifiable")
    with pytest.raises(InputError, match="no value of k_sf"):
        ride_numbers(replace(result, parameters={**result.parameters, "k_sf": unknown}))


def test_without_roll_there_is_what_needs_no_roll() -> None:
    """Drops of both sides at once say nothing of roll: on one profile left and right the rest is that of the whole vehicle."""
    from dataclasses import replace  # noqa: PLC0415

    result = identified()
    unknown = replace(result.parameters["I_xx"], value=None, std=None, interval95=None, status="unidentifiable")
    lost = dict.fromkeys(("I_xx", "t_f", "t_r"), unknown)
    found = ride_numbers(replace(result, parameters={**result.parameters, **lost}), roads="C")
    assert any("I_xx, t_f, t_r" in note for note in found.notes)
    assert found.options.tracks == "same"
    whole = ride_numbers(result, roads="C", tracks="same")
    for place, own in whole.on("C").places.items():
        for name, estimate in own.items():
            assert found.on("C").places[place][name].value == pytest.approx(estimate.value, rel=1e-6)
    assert found.axles["front"]["hop_damping"].value == pytest.approx(
        whole.axles["front"]["hop_damping"].value, rel=1e-9
    )
    assert found.plates["fl"]["least_load"].value is None
    assert found.half_cars["roll"]["I_xx"].value is None
    assert found.half_cars["pitch"]["I_yy"].value == pytest.approx(whole.half_cars["pitch"]["I_yy"].value, rel=1e-9)
    isotropic = ride_numbers(replace(result, parameters={**result.parameters, **lost}), roads="C", tracks="isotropic")
    assert isotropic.on("C").places["front"]["weighted"].value is None


def test_results_of_earlier_versions_lack_a_correlation() -> None:
    """They can be read, and their ride numbers are refused with the remedy."""
    from dataclasses import replace  # noqa: PLC0415

    from sprung.estimation import Scale  # noqa: PLC0415
    from sprung.results.plain import plain_document, record_from  # noqa: PLC0415

    result = identified(weighed=False)
    document = plain_document(result.scale)
    del document["correlation"]
    earlier = record_from(Scale, document)
    assert earlier.per_total_mass == result.scale.per_total_mass
    with pytest.raises(InputError, match="Identify the campaign again"):
        ride_numbers(replace(result, scale=earlier))


def test_notes_give_speeds_as_the_options_do() -> None:
    rubbing = TABLE_1_CAR.with_values(F_f=60.0, F_r=60.0, s_f=1.5e5, s_r=1.5e5)
    found = ride_numbers(rubbing, roads=("E",), speeds=(100 / 3.6,))
    notes = [note for note in found.notes if "road E" in note]
    assert len(notes) == 2
    assert all("E at 100 km/h" in note for note in notes)
