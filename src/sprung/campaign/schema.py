"""The campaign file and the vehicle file, key by key."""

from __future__ import annotations

from collections.abc import Mapping

from pydantic import BaseModel, ConfigDict, Field, model_validator

from sprung.campaign.campaign import ModelChoice, TestRecord
from sprung.campaign.drop import Drop
from sprung.campaign.excitation import Bump, Push
from sprung.campaign.schema_file import SCHEMA
from sprung.uncertainty import KnownValue
from sprung.vehicle import (
    DERIVED,
    MOTION_RATIOS,
    PARAMETERS,
    Finite,
    Heights,
    Load,
    NotNegative,
    Positive,
    Sensor,
    VehicleModel,
)

KNOWABLE = (*PARAMETERS, *(name for name in DERIVED if name != "wheelbase"))
"""What ``[known]`` may hold; the wheelbase has its place in ``[vehicle]``."""


class Measured(BaseModel):
    """A number, or { value = ..., std = ... }."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    value: Finite
    """SI."""
    std: NotNegative = 0.0
    """Standard uncertainty; 0 means exact."""

    @model_validator(mode="before")
    @classmethod
    def _number(cls, given: object) -> object:
        return {"value": given} if isinstance(given, int | float) and not isinstance(given, bool) else given

    @property
    def known(self) -> KnownValue:
        """The same as the record of the estimate room."""
        return KnownValue(self.value, self.std)


class MotionRatioSection(BaseModel):
    """``motion_ratio``: travel of a spring or damper per travel of its wheel; below 1 for most of them."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    spring_front: Measured | None = None
    """Travel of the front springs per wheel travel."""
    spring_rear: Measured | None = None
    """Travel of the rear springs per wheel travel."""
    damper_front: Measured | None = None
    """Travel of the front dampers per wheel travel."""
    damper_rear: Measured | None = None
    """Travel of the rear dampers per wheel travel."""
    spring: Measured | None = None
    """Travel of the springs of a vehicle with one axle per wheel travel."""
    damper: Measured | None = None
    """Travel of the dampers of a vehicle with one axle per wheel travel."""

    @property
    def known(self) -> dict[str, KnownValue]:
        """The ratios that are stated, by name."""
        return {name: ratio.known for name in MOTION_RATIOS if (ratio := getattr(self, name)) is not None}


class VehicleSection(BaseModel):
    """``[vehicle]``: what is measured on the vehicle with a tape."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    name: str | None = Field(default=None, min_length=1)
    """Name of the vehicle, for display; default: the name of the folder."""
    identification: str | None = Field(default=None, min_length=1)
    """Chassis number, registration or test number, for the record."""
    model: VehicleModel = "full"
    """Part of a vehicle that is tested: all of it, what moves in the pitch plane, in the roll plane, or only up and down."""
    wheelbase: Measured | None = None
    """Front axle to rear axle, m."""
    cg_height: Positive | None = None
    """Centre of gravity of the sprung mass above the ground, m; without it, loads are assumed to be at its height."""
    wheel_height: Positive | None = None
    """Wheel centres above the ground, m."""
    roll_axis_height: Finite | None = None
    """Roll axis above the ground, m."""

    motion_ratio: MotionRatioSection = MotionRatioSection()
    """Travel of springs and dampers per wheel travel; the result then has their rates at the spring and at the damper too."""

    @property
    def heights(self) -> Heights:
        """The same as the record of the vehicle room."""
        return Heights(self.cg_height, self.wheel_height, self.roll_axis_height)


class CampaignFile(BaseModel):
    """campaign.toml."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    number: int = Field(default=SCHEMA, alias="schema")
    """Version of the keys in this file."""
    vehicle: VehicleSection = VehicleSection()
    """What is measured on the vehicle with a tape."""
    test: TestRecord = TestRecord()
    """When, where and by whom the vehicle was tested."""
    known: Mapping[str, Measured] = Field(default_factory=dict)
    """Measured beforehand: any parameter, or a weighed mass; the names are those of `KNOWABLE`."""
    model: ModelChoice = ModelChoice()
    """What the model has; what is left out, sprung decides and says why."""
    sensor: tuple[Sensor, ...] = ()
    """One accelerometer each."""
    load: tuple[Load, ...] = ()
    """One known load each; the load `empty` always exists."""
    drop: tuple[Drop, ...] = ()
    """One release off the blocks each."""


class VehicleFileSchema(CampaignFile):
    """VEHICLE.toml of ``sprung simulate``: a campaign file with the vehicle's parameters and without recordings."""

    parameters: Mapping[str, Finite] = Field(default_factory=dict)
    """By the names of `sprung.vehicle.PARAMETERS`, SI."""
    push: Push = Push()
    """How the body is pushed in every push."""
    bump: Bump = Bump()
    """What is driven over in every pass."""
