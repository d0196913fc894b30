"""Section with the sketch of the vehicle: axles, sensors, loads, centre of gravity."""

from __future__ import annotations

from sprung.report.page.sections.context import Context
from sprung.report.sketch.sketch import vehicle_sketch
from sprung.results import Result


def geometry(result: Result) -> Context:
    """Return the sketch of the vehicle from above and from the side."""
    sketch = vehicle_sketch(result)
    return {"drawings": sketch.drawings, "key": sketch.key, "unknown": ", ".join(sketch.unknown)}
