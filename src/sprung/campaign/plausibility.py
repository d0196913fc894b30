"""What a two-axle road vehicle and its tests may have: limits of every quantity that a campaign states, and the unit meant.

The limits hold from a quad bike of 100 kg to a truck or coach of 40 t, with room to spare on both sides. They are no prior of
the estimate: they only tell a value from a slip of the unit or of the pen.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from sprung.vehicle import AXLES, parameter_name, parameter_of

_OTHER_UNITS: Mapping[str, Mapping[str, float]] = {
    "kg": {"tonnes": 1e3, "g": 1e-3, "pounds": 0.45359237},
    "kg m^2": {"t m^2": 1e3, "kg cm^2": 1e-4, "kg mm^2": 1e-6},
    "m": {"mm": 1e-3, "cm": 1e-2, "inches": 0.0254, "feet": 0.3048},
    "N/m": {"N/mm": 1e3, "kN/mm": 1e6, "lbf/in": 175.12684},
    "N s/m": {"N s/mm": 1e3, "kN s/mm": 1e6, "lbf s/in": 175.12684},
    "N": {"kN": 1e3, "kgf": 9.80665},
    "m per m": {"percent": 1e-2},
    "m/s": {"km/h": 1 / 3.6, "mph": 0.44704, "mm/s": 1e-3},
}
"""By SI unit the others in which such a quantity is stated, and what one of them is in SI."""


class Limits(NamedTuple):
    """What a quantity may be, SI.

    Attributes
    ----------
    low, high
        The least and the most, inclusive.
    unit
        SI, a key of the other units.
    zero
        Whether it may be 0 as well: what a vehicle need not have.
    of
        What has such values.
    """

    low: float
    high: float
    unit: str
    zero: bool = False
    of: str = "road vehicles"

    def contain(self, value: float) -> bool:
        """Return whether a value, SI, is within the limits."""
        return self.low <= value <= self.high or (self.zero and value == 0)

    @property
    def expected(self) -> str:
        """What is expected, in words."""
        none = "0, or " if self.zero else ""
        return f"{none}{self.low:g} to {self.high:g} {self.unit}, the range of {self.of}"


_SYMMETRIC_LENGTH = Limits(-20.0, 20.0, "m")


def _of_axles(limits: Limits, *symbols: str) -> dict[str, Limits]:
    """Return the limits of parameters of every axle, by their symbols; what is behind a star follows the index of the axle."""
    return {
        parameter_name(symbol, axle, number): limits
        for symbol, _, number in (one.partition("*") for one in symbols)
        for axle in AXLES
    }


LIMITS: Mapping[str, Limits] = {
    "total_mass": Limits(50, 60e3, "kg"),
    "front_axle_mass": Limits(20, 40e3, "kg"),
    "rear_axle_mass": Limits(20, 40e3, "kg"),
    "m_s": Limits(40, 60e3, "kg"),
    **_of_axles(Limits(1, 2e3, "kg"), "m_u"),
    "I_yy": Limits(5, 2e6, "kg m^2"),
    "I_xx": Limits(1, 2e5, "kg m^2"),
    **_of_axles(Limits(1e3, 1e7, "N/m"), "k_s"),
    **_of_axles(Limits(8e3, 5e7, "N/m"), "k_t"),
    **_of_axles(Limits(25, 5e5, "N s/m", zero=True), "c_s"),
    **_of_axles(Limits(0, 5e5, "N s/m"), "c_t"),
    **_of_axles(Limits(50, 1e7, "N/m", zero=True), "k_a"),
    **_of_axles(Limits(1e3, 1e10, "N/m"), "s"),
    **_of_axles(Limits(500, 1e8, "N/m", zero=True), "k_b"),
    **_of_axles(Limits(5e3, 1e10, "N/m"), "k_d"),
    **_of_axles(Limits(0, 1e6, "N s/m"), "c_d"),
    **_of_axles(Limits(0, 1e7, "N/m"), "k_z", "k_x"),
    **_of_axles(Limits(1, 1e7, "N s/m"), "c_z"),
    **_of_axles(Limits(0, 1e5, "N"), "F"),
    "wheelbase": Limits(0.6, 12.0, "m"),
    **dict.fromkeys(("a", "b"), Limits(0.02, 12.0, "m")),
    **_of_axles(Limits(0.03, 2.0, "m"), "t", "t*1", "t*2"),
    "t_o": Limits(0.03, 2.0, "m"),
    **_of_axles(Limits(0, 1.0, "m"), "x_b"),
    **_of_axles(Limits(0.005, 5.0, "m/s"), "v_k"),
    **_of_axles(Limits(0.005, 5.0, "m/s"), "v_2", "v_3"),
    **_of_axles(Limits(0.05, 20.0, "1"), "b_k", "b_q"),
    **_of_axles(Limits(0, 5.0, "m/s"), "w_k"),
    **_of_axles(Limits(0.01, 10.0, "1"), "q", "q_2", "q_3"),
    **_of_axles(Limits(0, 1.0, "1"), "u"),
    **_of_axles(Limits(0, 50.0, "1/m"), "e", "e_l"),
    "w_l": Limits(10, 1e4, "1/s²"),
    "c_l": Limits(0, 1e3, "1/s"),
    **_of_axles(Limits(0, 1e4, "N/(m kg)"), "g"),
    "u_w": Limits(-1.0, 1.0, "1"),
    "e_w": Limits(-1.0, 1.0, "1"),
    "y_s": Limits(-1.5, 1.5, "m"),
    "x_e": _SYMMETRIC_LENGTH,
    "cg_height": Limits(0.1, 4.0, "m"),
    "wheel_height": Limits(0.05, 1.2, "m"),
    "roll_axis_height": Limits(-2.0, 3.0, "m"),
    "motion ratio": Limits(0.2, 3.0, "m per m"),
    "block height": Limits(0.002, 0.6, "m", of="blocks"),
    "speed over a bump": Limits(0.2, 15.0, "m/s", of="passes over a bump"),
    "bump height": Limits(0.002, 0.6, "m", of="bumps"),
    "bump length": Limits(0.02, 10.0, "m", of="bumps"),
    "push force": Limits(10, 1e6, "N", of="pushes"),
    "push frequency": Limits(0.05, 20.0, "Hz", of="pushes"),
    "x": _SYMMETRIC_LENGTH,
    "y": Limits(-3.0, 3.0, "m"),
    "z": Limits(-1.0, 6.0, "m"),
    "load mass": Limits(0.5, 40e3, "kg", zero=True, of="loads"),
    "load mass on a wheel": Limits(0.02, 2e3, "kg", zero=True, of="loads on a wheel"),
    "load inertia": Limits(0, 2e6, "kg m^2", of="loads"),
    "corner frequency": Limits(1e-4, 30.0, "Hz", of="AC-coupled sensors"),
    "full scale": Limits(1e-4, 1e6, "m/s^2", of="accelerometers"),
    "resolution": Limits(1e-9, 10.0, "m/s^2", of="accelerometers"),
}
"""By quantity: parameters and derived quantities by their names, everything else in words; x, y and z are places."""

_ANYTHING: Mapping[str, Limits] = {
    "kg": Limits(-1e6, 1e6, "kg"),
    "N/m": Limits(-1e10, 1e10, "N/m"),
    "N s/m": Limits(-1e9, 1e9, "N s/m"),
    "N": Limits(-1e8, 1e8, "N"),
    "N m s": Limits(-1e8, 1e8, "N m s"),
    "kg m^2": Limits(-1e8, 1e8, "kg m^2"),
    "N m": Limits(-1e8, 1e8, "N m"),
    "m": _SYMMETRIC_LENGTH,
    "m/s": Limits(-1e3, 1e3, "m/s"),
    "1/m": Limits(-1e3, 1e3, "1/m"),
    "1": Limits(0, 1e3, "1"),
}
"""By unit: the limits of the parameters that have none of their own."""


def find_limits(quantity: str) -> Limits:
    """Return the limits of a quantity.

    Parameters
    ----------
    quantity
        A key of `LIMITS`, or the name of any parameter.
    """
    return LIMITS[quantity] if quantity in LIMITS else _ANYTHING[parameter_of(quantity).unit]


def explain_implausible(quantity: str, *values: float) -> tuple[str, str] | None:
    """Return what is expected in place of an implausible value, and the unit in which it may have been stated.

    Parameters
    ----------
    quantity
        A key of `LIMITS`, or the name of a parameter.
    values
        SI; several of one kind, which were stated in one unit.

    Returns
    -------
    tuple of str or None
        What is expected, and what to do; None where all are plausible.

    Examples
    --------
    >>> explain_implausible("total_mass", 1551.8)
    >>> explain_implausible("total_mass", 1.5518)[1]
    'Write it in kg: 1551.8 if it was stated in tonnes.'
    """
    limits = find_limits(quantity)
    if all(map(limits.contain, values)):
        return None
    return limits.expected, suggest_unit(dict.fromkeys(values, limits))


def suggest_unit(stated: Mapping[float, Limits], first: Sequence[float] = ()) -> str:
    """Return what to write in place of implausible values.

    Parameters
    ----------
    stated
        The values, SI, and the limits of each; all of one unit.
    first
        Those of them that are written as they would be in SI; all where none is given.
    """
    unit = next(iter(stated.values())).unit
    meant = [
        (name, factor)
        for name, factor in _OTHER_UNITS.get(unit, {}).items()
        if all(limits.contain(value * factor) for value, limits in stated.items())
    ]
    if not meant:
        return f"Correct it; it is read in {unit}."
    shown = tuple(first) or tuple(stated)
    sizes = [f"{', '.join(f'{value * factor:.5g}' for value in shown)} if it was stated in {n}" for n, factor in meant]
    return f"Write it in {unit}: {', or '.join(sizes)}."
