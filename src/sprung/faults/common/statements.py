"""One statement about masses or loads that, being otherwise, explains the recordings: judged by one fit each."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from sprung.campaign import Campaign
from sprung.errors import Fault
from sprung.faults.bench import Bench, CandidateFit
from sprung.faults.changes import Change
from sprung.faults.hypotheses import Hypothesis
from sprung.faults.suspicion import SURE
from sprung.vehicle import DERIVED, PARAMETERS, Load

Place = tuple[float, float, float]

_MOST = 0.1
"""Part of what is unexplained that may remain."""

_NEAR = 0.02
"""Part by which a mass may miss that of the vehicle with a load to be taken for it."""


def wrong_statement(bench: Bench) -> Hypothesis | None:
    """Find the one statement about loads' places or known quantities that explains the recordings, being otherwise.

    Parameters
    ----------
    bench
        The campaign.

    Returns
    -------
    Hypothesis or None
        None where none explains them, or another explains them about as well.
    """
    base, found = bench.base, list[Hypothesis]()
    for fault, change, settled in (*_load_frames(bench.campaign), *_known(bench.campaign)):
        trial = bench.fit(change(bench.campaign))
        if (
            trial.unexplained <= _MOST * base.unexplained
            and base.tally.cost - trial.tally.cost > SURE * trial.inflation
        ):
            found.append(Hypothesis(settled(fault, trial), "repaired", change, trial.tally, trial))
    found.sort(key=lambda one: one.tally.cost)
    if not found or (len(found) > 1 and found[1].tally.cost - found[0].tally.cost < SURE * found[0].trial.inflation):
        return None
    return found[0]


Candidate = tuple[Fault, Change, Callable[[Fault, CandidateFit], Fault]]


def _as_it_is(fault: Fault, _: CandidateFit) -> Fault:
    return fault


def _load_frames(campaign: Campaign) -> Iterator[Candidate]:
    """Put the items of each load where they would be if they were measured otherwise."""
    length = None if campaign.wheelbase is None else campaign.wheelbase.value
    frames: list[tuple[str, str, Callable[[Place], Place]]] = [
        (
            "x has the wrong sign; x is positive forward of the front axle, negative behind it",
            "Change the sign of x of its items",
            lambda place: (-place[0], place[1], place[2]),
        ),
        (
            "y has the wrong sign; y is positive on the left",
            "Change the sign of y of its items",
            lambda place: (place[0], -place[1], place[2]),
        ),
        (
            "x and y are exchanged; x is forward of the front axle, y to the left",
            "Exchange x and y of its items",
            lambda place: (place[1], place[0], place[2]),
        ),
    ]
    if length is not None:
        frames.append(
            (
                f"x is measured from the rear axle; it counts from the front axle, {length:g} m further forward",
                f"Take the wheelbase, {length:g} m, off x of its items",
                lambda place: (place[0] - length, place[1], place[2]),
            )
        )
    for load in campaign.loads:
        for what, do, moved in frames:
            if not any(item.position is not None and moved(item.position) != item.position for item in load.items):
                continue
            fault = Fault(
                "load-position",
                f"load '{load.name}'",
                f"in its places {what}. That was put right",
                f"{do} in the campaign file.",
            )
            yield fault, _reframed(load, moved), _as_it_is


def _reframed(load: Load, moved: Callable[[Place], Place]) -> Change:
    items = tuple(
        item if item.position is None else replace(item, position=moved(item.position)) for item in load.items
    )
    other = replace(load, items=items)

    def change(campaign: Campaign) -> Campaign:
        return replace(campaign, loads=tuple(other if one.name == load.name else one for one in campaign.loads))

    return change


def _known(campaign: Campaign) -> Iterator[Candidate]:
    """Exchange the masses of the axles, and leave out each known quantity."""
    front, rear = (campaign.known.get(name) for name in ("front_axle_mass", "rear_axle_mass"))
    if front is not None and rear is not None:
        other = {**campaign.known, "front_axle_mass": rear, "rear_axle_mass": front}
        what = (
            f"the masses of the axles are exchanged: {rear.value:g} kg in front and {front.value:g} kg behind fit the "
            "recordings, not the other way round. They were exchanged"
        )
        fault = Fault(
            "known", "known.front_axle_mass, known.rear_axle_mass", what, "Exchange the two in the campaign file."
        )
        yield fault, lambda campaign: replace(campaign, known=other), _as_it_is
    for name, stated in campaign.known.items():
        unit = PARAMETERS[name].unit if name in PARAMETERS else "kg"

        def without(other: Campaign, name: str = name) -> Campaign:
            return replace(other, known={key: value for key, value in other.known.items() if key != name})

        def settled(
            fault: Fault, trial: CandidateFit, name: str = name, value: float = stated.value, unit: str = unit
        ) -> Fault:
            found = DERIVED[name].value(trial.optimum.parameters) if name in DERIVED else trial.optimum.parameters[name]
            what = (
                f"the recordings contradict the known {name}: {value:g} {unit} is stated, {found:.4g} {unit} fits them"
            )
            loads = [
                load.name
                for load in trial.campaign.loads
                if load.mass and abs(value - load.mass - found) < _NEAR * found
            ]
            if name.endswith("_mass") and loads:
                what += f", and the difference is the mass of load '{loads[0]}', which does not belong to it"
            return replace(fault, what=f"{what}. It was not used")

        do = f"Correct {name} under [known] in the campaign file, or give it its uncertainty, {{ value = ..., std = ... }}."
        yield Fault("known", f"known.{name}", "", do), without, settled
