"""Section about ride and inspection: transmissibility, comfort on roads, suspension testers, quarter cars."""

from __future__ import annotations

from sprung.errors import InputError
from sprung.report.page.sections.context import Context
from sprung.report.pictures.transmissibility import transmissibility_picture
from sprung.results import Result
from sprung.ride import ride_numbers, ride_tables


def riding(result: Result) -> Context | None:
    """Return ride and inspection numbers on a usual road; none of a rejected result."""
    if result.verdict.state == "reject":
        return None
    text = (
        "What follows from the vehicle for ride and inspection, ± one standard uncertainty from the joint covariance of all "
        "parameters. Transmissibility with its 95 % band, all wheels moving alike. sprung ride computes other roads, speeds, "
        "loads and places."
    )
    try:
        numbers = ride_numbers(result, roads=("A", "C"))
    except InputError as error:
        reasons = [f"{problem.found}: {problem.expected} is needed." for problem in error.problems]
        return {"text": "Ride numbers cannot be given.", "pictures": [], "tables": [], "notes": reasons}
    pictures = [transmissibility_picture(numbers)] if numbers.curves else []
    return {"text": text, "pictures": pictures, "tables": ride_tables(numbers), "notes": numbers.notes}
