"""What may be wrong with a whole campaign: exchanged channels and loads, places of loads, high-passes, several vehicles.

One hypothesis per file. Where no closed form tells the residuals, they follow from one Gauss-Newton step; `confirm` fits.
"""

from sprung.faults.campaign.exchanged_channels import exchanged_channels
from sprung.faults.campaign.exchanged_loads import exchanged_loads
from sprung.faults.campaign.high_passes import high_passes
from sprung.faults.campaign.known_quantity import known_quantities
from sprung.faults.campaign.load_frame import load_frames
from sprung.faults.campaign.load_position import load_position
from sprung.faults.campaign.loosened_statement import loosened_statements
from sprung.faults.campaign.several_vehicles import several_vehicles
from sprung.faults.campaign.torsion import torsion_test

__all__ = [
    "exchanged_channels",
    "exchanged_loads",
    "high_passes",
    "known_quantities",
    "load_frames",
    "load_position",
    "loosened_statements",
    "several_vehicles",
    "torsion_test",
]
