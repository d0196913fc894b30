"""What goes wrong at the test or in the campaign file, done to a campaign that was sound."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from fleet import VehicleTest
from injuries import Act, Injured, Injury

import sprung
from sprung.campaign import Drop
from sprung.vehicle import WHEELS, Item, Load, Sensor, Vehicle

Place = tuple[float, float, float]


def described(kind: str, how: Callable[[Sensor, sprung.Campaign, np.random.Generator], Sensor]) -> Act:
    """Describe a sensor on the ``body`` or a ``wheel`` otherwise than it is."""

    def act(_: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured:
        chosen = [i for i, one in enumerate(campaign.sensors) if (one.on == "body") == (kind == "body")]
        i = int(random.choice(chosen))
        sensors = list(campaign.sensors)
        sensors[i] = how(sensors[i], campaign, random)
        return Injured(replace(campaign, sensors=tuple(sensors)), (sensors[i].channel,))

    return act


def placed(where: Callable[[Place, np.random.Generator], Place]) -> Act:
    """Write another place of a body's sensor."""

    def how(sensor: Sensor, _: sprung.Campaign, random: np.random.Generator) -> Sensor:
        return replace(sensor, position=where(sensor.position or (0.0, 0.0, 0.0), random))

    return described("body", how)


def swapped_digits(place: Place, _: np.random.Generator) -> Place:
    """Swap the first two different neighbouring figures of y, or else of x: 0.69 becomes 0.96."""
    for axis in (1, 0):
        text = f"{place[axis]:.2f}"
        for i in range(len(text) - 2, 0, -1):
            one, other = text[i], text[i + 1]
            if one.isdigit() and other.isdigit() and one != other:
                changed = float(text[:i] + other + one + text[i + 2 :])
                return (changed, *place[1:]) if axis == 0 else (place[0], changed, place[2])
    return (place[0], -place[1], place[2])


def other_wheel(sensor: Sensor, _: sprung.Campaign, random: np.random.Generator) -> Sensor:
    """Put a wheel's sensor on another wheel."""
    others = [one for one in WHEELS if one != sensor.on]
    return replace(sensor, on=others[int(random.integers(len(others)))])


def loads_exchanged(every: bool) -> Act:
    """Take an empty drop for a loaded one and the other way round, or all of them."""

    def act(_: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured | None:
        loaded = [drop for drop in campaign.drops if drop.load != "empty"]
        if not loaded:
            return None
        load = loaded[0].load
        drop = loaded[int(random.integers(len(loaded)))]
        empty = [one for one in campaign.drops if one.load == "empty"]
        twin = next((one for one in empty if one.wheels == drop.wheels), empty[0])
        other = {
            one.file: load if one.load == "empty" else "empty"
            for one in ((drop, twin) if not every else campaign.drops)
        }
        drops = tuple(replace(one, load=other.get(one.file, one.load)) for one in campaign.drops)
        names = () if every else (str(drop.file), str(twin.file))
        return Injured(replace(campaign, drops=drops), names)

    return act


def load_moved(_: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured | None:
    """Write an item of the load 0.2 m from where it was, forward or left or the other ways."""
    load = campaign.loads[-1]
    if not load.items:
        return None
    i, axis = int(random.integers(len(load.items))), int(random.integers(2))
    x, y, z = load.items[i].position or (0.0, 0.0, 0.0)
    by = float(0.2 * random.choice([-1.0, 1.0]))
    items = list(load.items)
    items[i] = replace(items[i], position=(x + by, y, z) if axis == 0 else (x, y + by, z))
    wrong = replace(load, items=tuple(items))
    return Injured(replace(campaign, loads=(*campaign.loads[:-1], wrong)), (load.name,))


Other = Callable[[VehicleTest, Drop, Load, np.random.Generator], tuple[Vehicle, Load, Drop]]


def one_drop(how: Other) -> Act:
    """Let one drop happen otherwise than the campaign file says."""

    def act(test: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured:
        i = int(random.integers(len(campaign.drops)))
        drop = campaign.drops[i]
        vehicle, load, dropped = how(test, drop, campaign.load(drop.load), random)
        happened = test.simulated(vehicle, [load] if load.name != "empty" else [], [dropped]).recordings[0].values
        recordings = list(campaign.recordings)
        noise = recordings[i].values - test.exact.recordings[i].values
        recordings[i] = replace(recordings[i], values=happened + noise)
        return Injured(campaign.with_recordings(recordings), (recordings[i].name,))

    return act


def brake(test: VehicleTest, drop: Drop, load: Load, random: np.random.Generator) -> tuple[Vehicle, Load, Drop]:
    """Brake one axle: its dampers 1.6 times as strong, its springs 1.15 times as stiff."""
    axle = str(random.choice(["f", "r"]))
    stronger = {f"c_s{axle}": 1.6, f"k_s{axle}": 1.15}
    parameters = {name: value * stronger.get(name, 1.0) for name, value in test.vehicle.parameters.items()}
    return Vehicle.from_parameters(parameters, name=test.vehicle.name), load, drop


def passenger(test: VehicleTest, drop: Drop, load: Load, random: np.random.Generator) -> tuple[Vehicle, Load, Drop]:
    """Put 15 % more mass on the body, left or right ahead of its middle."""
    vehicle = test.vehicle
    side = random.choice([-0.3, 0.3])
    more = Item(mass=0.15 * vehicle.m_s, position=(-0.4 * vehicle.wheelbase, side, 0.6))
    return vehicle, Load(name="more", items=(*load.items, more)), replace(drop, load="more")


def fewer_wheels(test: VehicleTest, drop: Drop, load: Load, random: np.random.Generator) -> tuple[Vehicle, Load, Drop]:
    """Drop the front or the rear wheels only, whatever is stated; all where these are stated."""
    ways = [way for way in (WHEELS[:2], WHEELS[2:], WHEELS) if set(way) != set(drop.wheels)]
    return test.vehicle, load, replace(drop, wheels=ways[int(random.integers(len(ways)))])


def mirrored(place: Place, _: np.random.Generator) -> Place:
    """Take left for right."""
    return place[0], -place[1], place[2]


def forward(place: Place, random: np.random.Generator) -> Place:
    """Be off by 0.3 m, forward or back."""
    return place[0] + 0.3 * random.choice([-1.0, 1.0]), place[1], place[2]


OF_TESTS: Sequence[Injury] = (
    Injury("position, mirrored", ("position",), "the lateral position of a body sensor has the wrong sign", placed(mirrored)),
    Injury("position, 0.3 m", ("position",),
           "the stated position of a body sensor is 0.3 m too far forward or back", placed(forward)),
    Injury("position, figures", ("position",),
           "two digits of the lateral position of a body sensor are exchanged", placed(swapped_digits)),
    Injury("wrong wheel", ("wrong-wheel",), "a wheel sensor is stated on another wheel", described("wheel", other_wheel)),
    Injury("load exchanged, one", ("load-exchanged",),
           "the recordings of a loaded and an empty drop are exchanged", loads_exchanged(False)),
    Injury("load exchanged, all", ("load-exchanged",),
           "the recordings of all loaded and empty drops are exchanged", loads_exchanged(True)),
    Injury("load position", ("load-position",), "the stated position of an item of the load has an error of 0.2 m", load_moved),
    Injury("brake", ("brake", "unlike-repeats"),
           "in one drop the dampers of an axle have 1.6 times, its springs 1.15 times their rate", one_drop(brake)),
    Injury("passenger", ("unlike-repeats",), "in one drop the body has 15 % more mass", one_drop(passenger)),
    Injury("other wheels", ("wheels", "unlike-repeats"),
           "in one drop other wheels were dropped than stated", one_drop(fewer_wheels)),
)  # fmt: skip
"""Of the test and the campaign file."""
