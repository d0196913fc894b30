"""Campaigns from a vehicle: drops from blocks, pushes, passes over a bump and free decays, measured with real sensors."""

from sprung.campaign import Bump as Bump
from sprung.campaign import Push as Push
from sprung.simulation.acting import Acting, Excited
from sprung.simulation.arguments import default_drops, default_sensors
from sprung.simulation.bump_passage import half_sine_bumps
from sprung.simulation.contact_motion import DropMotion
from sprung.simulation.decay_campaign import free_decays
from sprung.simulation.drops import simulate
from sprung.simulation.excited_motion import DEFAULT_SPEED, drive_over_bump, push_body
from sprung.simulation.ground import static_wheel_loads, tyre_rates
from sprung.simulation.half_sine_bump import drive_over_half_sine_bump
from sprung.simulation.linear_drop import drop_from_blocks
from sprung.simulation.nonlinear_motion import BlockSupport, simulate_nonlinear_drops
from sprung.simulation.pads import DrivenMotion, PadMotion, drive_on_pads
from sprung.simulation.sensor_model import USUAL_NOISE
from sprung.simulation.setup import SimulationSetup

__all__ = [
    "DEFAULT_SPEED",
    "USUAL_NOISE",
    "Acting",
    "BlockSupport",
    "DrivenMotion",
    "DropMotion",
    "Excited",
    "PadMotion",
    "SimulationSetup",
    "default_drops",
    "default_sensors",
    "drive_on_pads",
    "drive_over_bump",
    "drive_over_half_sine_bump",
    "drop_from_blocks",
    "free_decays",
    "half_sine_bumps",
    "push_body",
    "simulate",
    "simulate_nonlinear_drops",
    "static_wheel_loads",
    "tyre_rates",
]
