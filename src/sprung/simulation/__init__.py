"""Campaigns from a vehicle: drops from blocks, free decays and bumps, measured with real sensors."""

from sprung.simulation.arguments import default_drops, default_sensors
from sprung.simulation.bump_passage import half_sine_bumps
from sprung.simulation.decay_campaign import free_decays
from sprung.simulation.drops import DEFAULT_HEIGHT, simulate
from sprung.simulation.setup import SimulationSetup

__all__ = [
    "DEFAULT_HEIGHT",
    "SimulationSetup",
    "default_drops",
    "default_sensors",
    "free_decays",
    "half_sine_bumps",
    "simulate",
]
