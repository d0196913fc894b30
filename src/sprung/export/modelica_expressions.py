"""Force laws and linear functions as expressions of Modelica."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from sprung.export.equations import RowForce, Tyre
from sprung.export.outputs import of_wheel
from sprung.vehicle import CurveParameters, CurveParts, Row

_POLYTROPIC = 1.3
"""Exponent of the gas in an air spring, as in the vehicle room."""


def _progressive(parameters: Sequence[str], x: str, _: str) -> str:
    growth, rate = parameters
    return f"-0.5*{growth}*{rate}*({x})^2"


def _air(parameters: Sequence[str], x: str, _: str) -> str:
    inverse, rate = parameters
    strain, n = f"{inverse}*({x})", _POLYTROPIC
    exact = f"({x})*((1 - max(1 + {strain}, 0.05)^(-{n}))/({n}*{strain}) - 1)"
    series = f"({x})*{n + 1}*{strain}*(-0.5 + {n + 2}*{strain}/6)"
    return f"{rate}*(if noEvent(abs({strain}) < 1e-4) then {series} else {exact})"


def _bump_stop(parameters: Sequence[str], x: str, _: str) -> str:
    stiffness, clearance = parameters
    return f"-{stiffness}*max(-({x}) - {clearance}, 0)"


def _rebound(parameters: Sequence[str], _: str, v: str) -> str:
    ratio, damping = parameters
    return f"({ratio} - 1)*{damping}*max({v}, 0)"


def _damper_curve(parameters: Sequence[str], v: str, parts: CurveParts) -> str:
    """Return what the knots of a damper's curve add to its force."""
    curve = CurveParameters.of(parts, parameters, "1")
    rounding, (first, *others) = curve.rounding or "", curve.ratios
    compression = _missing(v, rounding, curve.velocities, curve.ratios)
    if not parts.has_rebound_knee:
        return f"-{curve.damping}*(if noEvent({v} > 0) then {curve.ratio} else -1)*({compression})"
    velocities = [f"({curve.velocity_ratio}*{velocity})" for velocity in curve.velocities]
    slopes = [f"({curve.slope_ratio}*{first})", *others]
    rebound = _missing(v, rounding and f"({curve.velocity_ratio}*{rounding})", velocities, slopes)
    return f"-{curve.damping}*(if noEvent({v} > 0) then {curve.ratio}*({rebound}) else -({compression}))"


def _missing(v: str, rounding: str, velocities: Sequence[str], slopes: Sequence[str]) -> str:
    """Return what knots take off the velocity of a damper of constant rate."""
    knots, before = [], "1"
    for velocity, slope in zip(velocities, slopes, strict=True):
        above = f"(abs({v}) - {velocity})"
        excess = f"max({above}, 0)"
        if rounding:
            at_rest = f"sqrt({velocity}^2 + {rounding}^2) - {velocity}"
            excess = f"0.5*({above} + sqrt({above}^2 + {rounding}^2) - ({at_rest}))"
        knots.append(f"{before}*(1 - {slope})*{excess}")
        before = f"{before}*{slope}"
    return " + ".join(knots)


BY_TRAVEL: Mapping[str, Callable[[Sequence[str], str, str], str]] = {
    "progressive": _progressive,
    "air": _air,
    "bump-stop": _bump_stop,
}
"""Force by the name of its law, of the travel of a spring."""


def law_expression(force: RowForce, position: int) -> str:
    """Return the force of a nonlinear element."""
    parameters, travel, rate = force.element.parameters, f"travel{force.row}", f"rate{force.row}"
    match force.law:
        case "friction":
            return f"{parameters[0]}*memory{position}"
        case "load-friction":
            return product(force.element.weight or 0.0, parameters[0], f"memory{position}")
        case "friction left" | "friction right":
            return f"({parameters[1]} + {product(force.side, parameters[0])})*memory{position}"
        case "rebound":
            return _rebound(parameters, travel, rate)
        case "damper-curve":
            return _damper_curve(parameters, rate, force.curve_parts)
        case law:
            return BY_TRAVEL[law](parameters, f"{travel} - travel_at_rest{position}", rate)


def tyre_expression(tyre: Tyre) -> str:
    """Return the force of the ground on a tyre, N."""
    road = of_wheel("road", tyre.wheel)
    rise = f"({tyre.coordinate} - {road})"
    tension = [product(factor, name, rise) for name, factor in tyre.stiffness]
    rate = f"(vel_{tyre.coordinate} - {of_wheel('road_rate', tyre.wheel)})"
    tension += [product(factor, name, rate) for name, factor in tyre.damping]
    pressing = f"max(0, -({joined(tension)}))"
    if tyre.growth is None:
        return pressing
    growth, stiffness = tyre.growth
    return f"{pressing} + 0.5*{growth}*{stiffness}*min({rise}, 0)^2"


def row_expression(row: Row, prefix: str) -> str:
    """Return the displacement of a row, or its derivative with a prefix."""
    known = dict.fromkeys((*row.constant, *(name for slope in row.slopes.values() for name in slope)))
    parts = []
    for coordinate in known:
        parts.append(times(row_coefficient(row, coordinate), f"{prefix}{coordinate}"))
    return joined(parts)


def row_coefficient(row: Row, coordinate: str) -> str:
    """Return the entry of a row for a coordinate; empty where there is none."""
    parts = [number(row.constant[coordinate])] if row.constant.get(coordinate) else []
    parts += [product(slope[coordinate], name) for name, slope in row.slopes.items() if slope.get(coordinate)]
    return joined(parts) if parts else ""


def product(factor: float, *names: str) -> str:
    """Return a product, a factor of 1 left out."""
    written = "*".join(names)
    return {1.0: written, -1.0: f"-{written}"}.get(factor, f"{number(factor)}*{written}")


def times(coefficient: str, name: str) -> str:
    """Return a coefficient, itself an expression, times a variable."""
    return {"1": name, "-1": f"-{name}"}.get(coefficient, f"({coefficient})*{name}")


def joined(parts: Sequence[str]) -> str:
    """Return a sum; 0 without parts."""
    return " + ".join(parts).replace("+ -", "- ") if parts else "0"


def number(value: float) -> str:
    """Return a number with all its digits; whole numbers without a point."""
    return str(int(value)) if float(value).is_integer() and abs(value) < 1e15 else repr(float(value))
