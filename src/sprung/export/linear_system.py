"""State space of the linear vehicle: road in, motions, travels and forces out; for python-control, SciPy and MATLAB."""

from __future__ import annotations

import importlib
import importlib.util
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.errors import InputError, Problem, did_you_mean
from sprung.export.equations import Equations
from sprung.export.equivalent_linear import Linearisation, linearised, stop_problems
from sprung.export.file import ExportedFile
from sprung.export.outputs import Output, Signal, identifier, outputs_of, road_inputs, sensor_problems
from sprung.export.requests import resolve_load
from sprung.vehicle import (
    Load,
    Matrices,
    PadInputs,
    Rows,
    Sensor,
    Vehicle,
    state_matrix,
    state_variables,
    with_tyre_rates_at_rest,
)

Array = NDArray[np.float64]

_LAW_NAMES = {
    "friction": "dry friction",
    "load-friction": "dry friction that grows with the load",
    "friction left": "dry friction of the left wheels",
    "friction right": "dry friction of the right wheels",
    "rebound": "dampers stiffer in rebound",
    "damper-curve": "damper curves with knees",
    "progressive": "progressive springs",
    "air": "air springs",
    "bump-stop": "bump stops",
}


@shown
@dataclass(frozen=True, slots=True, eq=False)
class StateSpace:
    """A linear vehicle ẋ = A x + B u, y = C x + D u, about its rest with a load.

    Attributes
    ----------
    A, B, C, D
        SI, shapes (state, state), (state, input), (output, state) and (output, input).
    states, inputs, outputs
        Names, units and meanings. States are displacements of the coordinates, then velocities of those with mass.
    name, load
        Of the vehicle, and of what is on it.
    linearisation
        Motion for which nonlinear elements were linearised; None where there are none.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    states: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    name: str
    load: str
    linearisation: Linearisation | None = None

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Eigenvalues of A, 1/s, shape (state,)."""
        return np.asarray(np.linalg.eigvals(self.A), dtype=np.complex128)

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader has to know, one sentence each."""
        return () if self.linearisation is None else (self.linearisation.text,)

    def response(self, frequencies: Array) -> NDArray[np.complex128]:
        """Return the frequency response C (jωI - A)⁻¹ B + D.

        Parameters
        ----------
        frequencies
            Hz, shape (frequency,).

        Returns
        -------
        ndarray
            Output over input, in the units of both, shape (frequency, output, input).
        """
        omega = 2j * np.pi * np.asarray(frequencies, dtype=float)[:, None, None]
        states = np.linalg.solve(
            omega * np.eye(len(self.A)) - self.A, np.broadcast_to(self.B, (len(omega), *self.B.shape))
        )
        return np.asarray(self.C @ states + self.D, dtype=np.complex128)

    def to_scipy(self) -> Any:
        """Return it as `scipy.signal.StateSpace`."""
        signal = importlib.import_module("scipy.signal")
        return signal.StateSpace(self.A, self.B, self.C, self.D)

    def to_control(self) -> Any:
        """Return it as `control.StateSpace` of python-control, with the names of states, inputs and outputs.

        Raises
        ------
        InputError
            If python-control is not installed.
        """
        if importlib.util.find_spec("control") is None:
            do = 'Run: python -m pip install "sprung[control]"'
            raise InputError([Problem("StateSpace.to_control", "no package control", "python-control installed", do)])
        control = importlib.import_module("control")
        names = {kind: [one.name for one in getattr(self, kind)] for kind in ("states", "inputs", "outputs")}
        return control.ss(self.A, self.B, self.C, self.D, name=identifier(self.name), **names)

    def mat(self) -> ExportedFile:
        """Return it as a MAT file (version 5) with A, B, C, D and cell arrays of names, units and meanings."""
        scipy_io = importlib.import_module("scipy.io")
        named = {
            f"{kind}_{part}s": np.array([getattr(one, part) for one in getattr(self, f"{kind}s")], dtype=object)
            for kind in ("state", "input", "output")
            for part in ("name", "unit", "meaning")
        }
        about: dict[str, Any] = {
            "vehicle": self.name,
            "load": self.load,
            "notes": np.array(self.notes, dtype=object),
        }
        if self.linearisation is not None:
            about |= {"amplitude": self.linearisation.amplitude, "frequency": self.linearisation.frequency}
        archive = io.BytesIO()
        scipy_io.savemat(
            archive, {"A": self.A, "B": self.B, "C": self.C, "D": self.D, **named, **about}, oned_as="column"
        )
        return ExportedFile(f"{identifier(self.name)}.mat", archive.getvalue(), self.notes)


def state_space(
    vehicle: Vehicle,
    load: Load | None = None,
    *,
    outputs: Sequence[str] | None = None,
    sensors: Sequence[Sensor] = (),
    amplitude: float | None = None,
    frequency: float | None = None,
) -> StateSpace:
    """Return a vehicle as a linear state space: from the road or pad under each wheel to motions, travels and forces.

    All tyres stay on the ground, and everything counts from rest. Inputs are the heights of the road; where tyres have damping
    also their rates, which the tyre dampers transmit. Nonlinear elements are replaced by their describing functions for one
    amplitude of travel; tyre rates that grow are those at the static load.

    Parameters
    ----------
    vehicle
        The vehicle, such as `Result.vehicle`.
    load
        What is on it; nothing unless given.
    outputs
        Names of those wanted, in this order; all unless given.
    sensors
        Sensors on body, wheels and force pads that are outputs too, SI, positive up.
    amplitude
        Amplitude of the travel of nonlinear elements, m.
    frequency
        Frequency of this motion, Hz; unless given the lowest natural frequency of the vehicle with its linear elements.

    Returns
    -------
    StateSpace

    Raises
    ------
    InputError
        If there are nonlinear elements but no amplitude, a bump stop is met within it, or an output does not exist.
    """
    equations, where = Equations.of(vehicle, resolve_load(load)), f"state space of {vehicle.name}"
    available = outputs_of(vehicle, sensors)
    chosen, problems = _chosen(available, outputs, where)
    problems += sensor_problems(sensors, available, where)
    problems += _amplitude_problems(equations, amplitude, frequency, where)
    if problems:
        raise InputError(problems)
    model = vehicle.linear_model(equations.load)
    values = with_tyre_rates_at_rest(model, equations.values)
    matrices, linearisation = model.matrices(values), None
    if equations.forces and amplitude is not None:
        frequency = _lowest_frequency(matrices) if frequency is None else frequency
        matrices, linearisation = linearised(equations, matrices, amplitude, frequency)
    A, B, Z = _system(equations, matrices, values)
    rows = [_output_rows(output, equations, values, Z) for output in chosen]
    C, D = np.split(np.array(rows).reshape(len(rows), -1), [len(A)], axis=1)
    return StateSpace(
        A, B, C, D, _states(equations), road_inputs(vehicle), tuple(one.signal for one in chosen), vehicle.name,
        equations.load.name, linearisation,
    )  # fmt: skip


def _chosen(
    available: Sequence[Output], wanted: Sequence[str] | None, where: str
) -> tuple[list[Output], list[Problem]]:
    """Return the outputs of these names, and the names that there are not."""
    by_name = {output.signal.name: output for output in available}
    names = list(by_name) if wanted is None else [identifier(name) for name in wanted]
    problems = [
        Problem(where, f"output '{name}'", "the name of an output", did_you_mean(name, by_name))
        for name in names
        if name not in by_name
    ]
    return [by_name[name] for name in names if name in by_name], problems


def _amplitude_problems(
    equations: Equations, amplitude: float | None, frequency: float | None, where: str
) -> list[Problem]:
    problems = [
        Problem(f"{where}: {name}", repr(value), f"a positive number, {unit}", "Correct it.")
        for name, value, unit in (("amplitude", amplitude, "m"), ("frequency", frequency, "Hz"))
        if value is not None and not (math.isfinite(value) and value > 0)
    ]
    if problems or not equations.forces:
        return problems
    if amplitude is not None:
        return stop_problems(equations, amplitude, where)
    terms = dict[str, list[str]]()
    for force in equations.forces:
        terms.setdefault(force.law, []).extend(force.element.parameters)
    return [
        Problem(
            where,
            f"{_LAW_NAMES[law]} ({', '.join(dict.fromkeys(names))})",
            "linear elements, or an amplitude for which to linearise",
            "State the amplitude of the suspension travel, such as amplitude=0.01 (m); or export to modelica or fmu.",
        )
        for law, names in terms.items()
    ]


def _lowest_frequency(matrices: Matrices) -> float:
    """Return the lowest natural frequency of a vibration, Hz."""
    poles = np.linalg.eigvals(matrices.state)
    vibrating = poles[np.abs(poles.imag) > 1e-6 * np.abs(poles)]
    return float(np.abs(vibrating if vibrating.size else poles).min() / (2 * np.pi))


def _system(equations: Equations, matrices: Matrices, values: Array) -> tuple[Array, Array, Array]:
    """Return A, B, and X, Ẋ and Ẍ as functions of states and inputs, shape (3, coordinate, state + input)."""
    n, m = len(matrices.M), matrices.massive
    by_height, by_rate = PadInputs.of(equations.wheels, (), equations.names).forces(values)
    forces = np.hstack([by_height, by_rate] if equations.has_tyre_damping else [by_height])
    known = np.hstack([-matrices.K, -matrices.C[:, :m], forces])
    highest = np.linalg.solve(matrices.leading, known)
    whole = state_matrix(highest, m)
    Z = np.zeros((3, *highest.shape))
    Z[0, :, :n] = np.eye(n)
    Z[1] = whole[:n]
    Z[2, :m] = highest[:m]
    return whole[:, : n + m], whole[:, n + m :], Z


def _output_rows(output: Output, equations: Equations, values: Array, Z: Array) -> Array:
    """Return an output as a function of states and inputs, shape (state + input,)."""
    if output.tyre is None:
        return np.asarray(
            sum(Rows.of([row], equations.names).at(values)[0] @ Z[order] for order, row in output.rows.items())
        )
    at = equations.wheels.index(output.tyre)
    tyre, place = equations.tyres[at], equations.vehicle.layout.wheels_at.start + at
    by_name = dict(zip(equations.names, values.tolist(), strict=True))
    stiffness, damping = (
        sum(factor * by_name[name] for name, factor in part) for part in (tyre.stiffness, tyre.damping)
    )
    row: Array = -stiffness * Z[0, place] - damping * Z[1, place]
    inputs = row[len(row) - len(road_inputs(equations.vehicle)) :]
    inputs[at] += stiffness
    if equations.has_tyre_damping:
        inputs[len(equations.wheels) + at] += damping
    return row


def _states(equations: Equations) -> tuple[Signal, ...]:
    states = []
    for coordinate, order in state_variables(equations.names):
        unit = "rad" if coordinate in ("theta", "phi") else {"q_w": "rad/m", "q_v": "1/m"}.get(coordinate, "m")
        if order:
            unit = f"{unit}/s" if "/" not in unit else unit.replace("/", "/(s ") + ")"
            states.append(Signal(f"rate_{coordinate}", unit, f"rate of the coordinate {coordinate}"))
        else:
            states.append(Signal(coordinate, unit, f"coordinate {coordinate}"))
    return tuple(states)
