"""A campaign in memory, whoever put it together, held to the same limits as a campaign file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from sprung.errors import Problems
from sprung.vehicle import EMPTY

if TYPE_CHECKING:
    from sprung.campaign.campaign import Campaign
    from sprung.campaign.drop import Drop
    from sprung.uncertainty import KnownValue
    from sprung.vehicle import Heights, Load, Sensor, VehicleModel


def require_plausible(campaign: Campaign) -> None:
    """Check that the statements of a campaign are plausible for a road vehicle and do not contradict each other.

    Reading refuses it already in a file; a campaign made or changed in memory is refused by the same checks.

    Parameters
    ----------
    campaign
        The campaign.

    Raises
    ------
    InputError
        Every such statement at once, each with the likely unit where another one explains it.
    """
    problems = Problems()
    check_statements(
        f"campaign {campaign.name}",
        sensors=campaign.sensors,
        loads=campaign.loads,
        drops=campaign.drops,
        known=campaign.known,
        vehicle_model=campaign.vehicle_model,
        wheelbase=campaign.wheelbase,
        heights=campaign.heights,
        motion_ratio=campaign.motion_ratio,
        whole=not campaign.missing,
        problems=problems,
    )
    problems.raise_if_any()


def check_statements(
    name: str,
    *,
    sensors: Sequence[Sensor],
    loads: Sequence[Load],
    drops: Sequence[Drop],
    known: Mapping[str, KnownValue],
    vehicle_model: VehicleModel = "full",
    wheelbase: KnownValue | None,
    heights: Heights,
    motion_ratio: Mapping[str, KnownValue] | None = None,
    whole: bool = True,
    problems: Problems,
) -> None:
    """Check what is stated of a vehicle and its test, SI, as reading checks a campaign file.

    Parameters
    ----------
    name
        What to call the whole in a problem.
    sensors, loads, drops, known, vehicle_model, wheelbase
        As in a `Campaign`.
    heights
        Above the ground, m.
    motion_ratio
        As in a `Campaign`.
    whole
        Whether all sensors are there: only then too few of them is a mistake.
    problems
        Takes up what is wrong.
    """
    # The models of the files are not needed to hold a campaign, only to check it.
    from sprung.campaign.checks import check_body_sensors, check_quantities  # noqa: PLC0415
    from sprung.campaign.pad_checks import check_pads  # noqa: PLC0415
    from sprung.campaign.parsing import ParsedFile  # noqa: PLC0415
    from sprung.campaign.schema import CampaignFile, Measured, MotionRatioSection, VehicleSection  # noqa: PLC0415

    def measured(known: KnownValue) -> Measured:
        return Measured.model_construct(value=known.value, std=known.std)

    described = tuple(load for load in loads if load.name != EMPTY.name)
    file = CampaignFile.model_construct(
        vehicle=VehicleSection.model_construct(
            model=vehicle_model,
            wheelbase=None if wheelbase is None else measured(wheelbase),
            cg_height=heights.cg_height,
            wheel_height=heights.wheel_height,
            roll_axis_height=heights.roll_axis_height,
            motion_ratio=MotionRatioSection.model_construct(
                None, **{name: measured(ratio) for name, ratio in (motion_ratio or {}).items()}
            ),
        ),
        known={quantity: measured(value) for quantity, value in known.items()},
        sensor=tuple(sensors),
        load=described,
        drop=tuple(drops),
    )
    document = {
        "sensor": [{"channel": sensor.channel} for sensor in sensors],
        "load": [{"name": load.name} for load in described],
        "drop": [{"file": drop.label} for drop in drops],
    }
    parsed = ParsedFile(name, document, file, frozenset(), {})
    if whole:
        check_body_sensors(parsed, problems)
    check_pads(parsed, problems)
    check_quantities(parsed, problems)
