"""The sketch of the vehicle: where axles, sensors, loads and the centre of gravity are."""

from __future__ import annotations

from sprung.pipeline import Result
from sprung.report.sections.context import Context
from sprung.report.sketch import vehicle_sketch


def geometry(result: Result) -> Context | None:
    """Show the vehicle from above and from the side."""
    if result.setup is None:
        return None
    sketch = vehicle_sketch(result)
    return {"drawings": sketch.drawings, "key": sketch.key, "unknown": ", ".join(sketch.unknown)}
