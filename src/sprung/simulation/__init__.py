"""Campaigns from a vehicle: drops from blocks, free decays and bumps, measured with real sensors."""

from sprung.simulation.bumps import half_sine_bumps
from sprung.simulation.decays import free_decays
from sprung.simulation.drops import DEFAULT_HEIGHT, simulate
from sprung.simulation.records import default_drops, default_sensors
from sprung.simulation.setup import Setup

__all__ = [
    "DEFAULT_HEIGHT",
    "Setup",
    "default_drops",
    "default_sensors",
    "free_decays",
    "half_sine_bumps",
    "simulate",
]
