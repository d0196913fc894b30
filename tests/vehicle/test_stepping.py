"""Steps of the vehicle with nonlinear forces: against exact responses, an independent solver and finite differences."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from sprung.vehicle import (
    EMPTY,
    EXTRAS,
    LINEAR_EXTRAS,
    TABLE_1_CAR,
    Load,
    Matrices,
    NonlinearModel,
    Rows,
    Stepper,
    Vehicle,
    differentiate_motion,
    free_decay,
    ground_contact_elements,
    linear_elements,
    nonlinear_elements,
    parameter_names,
    parse_record,
    stiffened_air_springs,
)
from sprung.vehicle.compiled_changes import solve
from sprung.vehicle.damper_curve import CurveParts, damper_curve
from sprung.vehicle.force_laws import (
    AIR,
    BUMP_STOP,
    FRICTION,
    GROUND,
    PROGRESSIVE,
    REBOUND,
    ElementInput,
    ForceLaw,
)

Array = NDArray[np.float64]

CAR = Vehicle.from_parameters(
    TABLE_1_CAR.parameters
    | {"F_f": 100.0, "F_r": 130.0, "s_f": 2e5, "s_r": 3e5, "r_f": 2.0, "r_r": 1.5, "p_f": 3.0, "p_r": 1.0}
    | {"k_bf": 3e4, "k_br": 2e4, "x_bf": 0.01, "x_br": 0.015}
    | {"v_kf": 0.1, "v_kr": 0.15, "q_f": 0.4, "q_r": 0.6, "e_f": 6.0, "e_r": 4.0, "h_tf": 6.0, "h_tr": 4.0}
    | {"d_Ff": 20.0, "d_Fr": -40.0}
    | {"u_f": 0.05, "u_r": 0.08, "v_2f": 0.25, "v_2r": 0.3, "q_2f": 0.7, "q_2r": 1.4}
    | {"v_3f": 0.5, "v_3r": 0.45, "q_3f": 0.5, "q_3r": 0.8}
    | {"b_kf": 0.9, "b_kr": 1.2, "b_qf": 1.3, "b_qr": 0.8}
    | {"w_kf": 0.03, "w_kr": 0.02, "e_lf": 5.0, "e_lr": 7.0, "g_f": 60.0, "g_r": 80.0}
)
WITH_GROUND = ("m_s", "m_uf", "k_sf", "c_sf", "k_tf", "h_tf", "F_f", "a", "t_f1")
"""Parameters of each kind that the force of the ground depends on, directly or by the motion."""

BALLAST = parse_record(Load, {"name": "ballast", "items": [{"mass": 150.0, "position": (-1.0, 0.3, 0.5)}]})


def values_of(extras: tuple[str, ...]) -> tuple[tuple[str, ...], Array]:
    names = parameter_names("separate", extras)
    return names, np.array([getattr(CAR, name) for name in names])


@cache  # many steppers of one model differ in their values alone
def model_of(extras: tuple[str, ...], load: Load = EMPTY, ground: bool = False) -> NonlinearModel:
    names, _ = values_of(extras)
    forces = nonlinear_elements("separate", extras, load=load.mass_at_wheels(CAR.wheelbase))
    forces += ground_contact_elements(extras) if ground else ()
    elements = linear_elements("separate", extras)
    elements += stiffened_air_springs(load.mass_at_wheels(CAR.wheelbase), "separate", extras)
    return NonlinearModel.of(elements, forces, names, load)


def linear_part(load: Load = EMPTY) -> Matrices:
    """Return the matrices of the elements that have one."""
    return CAR.linear_model(load).matrices(list(CAR.parameters.values()))


def some_states(drops: int, seed: int = 0) -> Array:
    sizes = np.r_[0.03, 0.02, 0.02, np.full(4, 0.01), 0.3, 0.2, 0.2, np.full(4, 0.3)]
    states: Array = np.random.default_rng(seed).standard_normal((drops, 14)) * sizes
    return states


def stepper(
    extras: tuple[str, ...], step: float, values: Array | None = None, ground: bool = False, pairs: int = 1
) -> Stepper:
    """Return what steps pairs of drops, of the empty vehicle and with ballast."""
    models, kinds = [model_of(extras, load, ground) for load in (EMPTY, BALLAST)], np.tile([0, 1], pairs)
    return Stepper.of(models, [step, step], kinds, values_of(extras)[1] if values is None else values)


def test_without_any_force_the_steps_are_exact() -> None:
    """A spring that is not progressive, p = 0: the response is that of the linear vehicle, at any step."""
    names, values = values_of(("progressive",))
    values = np.where([name.startswith("p_") for name in names], 0.0, values)
    states = some_states(2)
    trajectory = stepper(("progressive",), 0.01, values).integrate(states, np.zeros((2, 0)), 100)
    exact = free_decay(linear_part(), states[0], 0.01, 101)
    np.testing.assert_allclose(trajectory.states[:, 0, :7].T, exact.displacement, atol=1e-12)
    np.testing.assert_allclose(trajectory.states[:, 0, 7:].T, exact.velocity, atol=1e-11)


def test_a_load_pushes_with_its_weight() -> None:
    """From rest without the load, the loaded vehicle comes to rest where K X = -ΔM g (1, 0, 0, 1, 1, 1, 1)."""
    names, values = values_of(("progressive",))
    values = np.where([name.startswith("p_") for name in names], 0.0, values)
    trajectory = stepper(("progressive",), 0.05, values).integrate(np.zeros((2, 14)), np.zeros((2, 0)), 400)
    heave = np.array([1.0, 0, 0, 1, 1, 1, 1])
    added = linear_part(BALLAST).M - linear_part().M
    rest = np.linalg.solve(linear_part().K, -9.80665 * added @ heave)
    np.testing.assert_allclose(trajectory.states[-1, 1, :7], rest, atol=1e-6)
    np.testing.assert_allclose(trajectory.states[-1, 0], 0.0, atol=1e-12)


@pytest.mark.parametrize(
    "extras",
    [
        ("friction",), ("friction", "uneven-friction"), ("rebound",), ("friction", "rebound", "progressive"),
        ("damper-curve", "tyre-curve"), ("rebound", "damper-curve", "air", "bump-stop"),
        ("rebound", "damper-curve", "rounded-knee"), ("rebound", "damper-curve", "rebound-knee", "second-knee", "third-knee"),
        ("damper-curve", "second-knee", "third-knee"),
    ],
)  # fmt: skip
def test_against_another_solver(extras: tuple[str, ...]) -> None:
    """The same equations, written out and left to a solver of eighth order with a tight tolerance."""
    matrices, state, elements = linear_part(), some_states(1, 3)[0], nonlinear_elements("separate", extras)
    names, values = values_of(extras)
    G = Rows.of([element.row for element in elements], names).at(values)
    kinds = [element.law.name for element in elements]
    axles = [element.parameters[0][-1] for element in elements]
    inverse = np.linalg.inv(matrices.M)
    parameters = CAR.parameters
    of_axle = {axle: {name[:-1]: value for name, value in parameters.items() if name[-1] == axle} for axle in "fr"}
    sag = -G @ matrices.deflection(matrices.M @ np.array([1.0, 0, 0, 1, 1, 1, 1]) * 9.80665)

    def slope(_: float, y: Array) -> Array:
        X, V, memory = y[:7], y[7:14], y[14:]
        travel, rate = G @ X, G @ V
        force, grown, kept = np.zeros(len(G)), [], iter(memory)
        for i, (kind, axle) in enumerate(zip(kinds, axles, strict=True)):
            own = of_axle[axle]
            x, v, k, c = travel[i], rate[i], own["k_s"], own["c_s"]
            if kind.startswith("friction"):
                friction, stiffness, m = own["F_"], own["s_"], next(kept)
                above = {"friction": 0.0, "friction left": own["d_F"], "friction right": -own["d_F"]}[kind]
                force[i] = (friction + above) * m
                grown.append((stiffness * v - stiffness * abs(v) * m) / friction)
            elif kind == "rebound":
                force[i] = (own["r_"] - 1) * c * max(v, 0.0)
            elif kind == "damper-curve":
                ratio = own["r_"] if v > 0 and "rebound" in extras else 1.0
                if "rounded-knee" in extras:
                    knee, width = own["v_k"], own["w_k"]
                    hinge = [0.5 * (u + np.hypot(u, width)) for u in (abs(v) - knee, -knee)]
                    curve = abs(v) - (1 - own["q_"]) * (hinge[0] - hinge[1])
                else:
                    number = 3 if "third-knee" in extras else 1
                    shift, bend = (own["b_k"], own["b_q"]) if v > 0 and "rebound-knee" in extras else (1.0, 1.0)
                    knots = np.array([0.0, *(shift * own[name] for name in ("v_k", "v_2", "v_3")[:number]), 10.0])
                    slopes = np.cumprod([1.0, *(own[name] for name in ("q_", "q_2", "q_3")[:number])])
                    slopes[1:] *= bend
                    curve = np.interp(abs(v), knots, np.concatenate([[0.0], np.cumsum(slopes * np.diff(knots))]))
                force[i] = ratio * c * (np.sign(v) * curve - v)
            elif kind == "air":
                height = 1 / own["e_"]
                force[i] = k * height / 1.3 * (1 - (1 + x / height) ** -1.3) - k * x
            elif kind == "bump-stop":
                force[i] = own["k_b"] * min(x + own["x_b"], 0.0)
            elif kind == "tyre-curve":  # its travel counts from where it first touches the ground
                force[i] = -0.5 * own["h_t"] * own["k_t"] * min(x + sag[i], 0.0) ** 2
            else:
                force[i] = -0.5 * own["p_"] * k * x**2
        A = inverse @ (-matrices.K @ X - matrices.C @ V - G.T @ force)
        return np.concatenate([V, A, grown])

    memories = 4 if "friction" in extras else 0
    step, steps = 0.0005, 300
    trajectory = stepper(extras, step).integrate(np.array([state, state]), np.zeros((2, memories)), steps)
    there = solve_ivp(
        slope, (0, step * steps), np.concatenate([state, np.zeros(memories)]), "DOP853", rtol=1e-9, atol=1e-10,
        t_eval=step * np.arange(0, steps + 1, 50), max_step=0.002,
    )  # fmt: skip
    scale = np.abs(trajectory.states[:, 0]).max(axis=0)
    assert np.all(np.abs(trajectory.states[::50, 0] - there.y[:14].T) < 3e-4 * scale)


def test_friction_grows_with_the_load() -> None:
    """What u adds under a load is a larger friction that builds up over the same travel F/s; nothing without a load."""
    extras = ("friction", "load-friction")
    names, values = values_of(extras)
    states, step, steps = some_states(2, 3), 0.002, 100
    trajectory = stepper(extras, step).integrate(states, np.zeros((2, 8)), steps)
    carried = BALLAST.mass_at_wheels(CAR.wheelbase)
    assert 2 * sum(carried.values()) == pytest.approx(150.0)
    larger = dict(zip(names, values.tolist(), strict=True))
    for axle, mass in carried.items():
        growth = 1 + larger[f"u_{axle}"] * 9.80665 * mass / larger[f"F_{axle}"]
        larger |= {
            f"F_{axle}": growth * larger[f"F_{axle}"],
            f"s_{axle}": growth * larger[f"s_{axle}"],
            f"u_{axle}": 0.0,
        }
    others = stepper(extras, step, np.array(list(larger.values()))).integrate(states, np.zeros((2, 8)), steps)
    np.testing.assert_allclose(trajectory.states[:, 1], others.states[:, 1], atol=1e-9)
    plain, none = values_of(("friction",))
    empty = stepper(("friction",), step, none).integrate(states, np.zeros((2, 4)), steps)
    assert plain == tuple(name for name in names if name[0] != "u")
    np.testing.assert_allclose(trajectory.states[:, 0], empty.states[:, 0], atol=1e-9)


@pytest.mark.parametrize("ground", [False, True])
def test_derivatives_are_those_of_the_steps_themselves(ground: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """But for what the surplus does to itself: c h/m of its own part, up to 0.08 of 0.1 with all laws on a wheel at 1 ms.

    Forces are solved for almost to rounding: differences of them would show what is left.
    """
    monkeypatch.setattr("sprung.vehicle.stepping._SOLVED", 1e-11)
    extras = tuple(extra for extra in EXTRAS if extra not in (*LINEAR_EXTRAS, "bump-stop"))
    names, values = values_of(extras)
    states, memories, step, steps = some_states(2, 1), np.full((2, 8), 0.3), 0.001, 90
    if ground:
        states[:, 3:7] = 0.03 + np.abs(states[:, 3:7])  # all wheels in the air, to come down one after the other
    before = stepper(extras, step, ground=ground)
    trajectory = before.integrate(states, memories, steps)
    outputs = 14 + before.forces.number
    every_output = np.eye(outputs)
    found = np.stack(
        [differentiate_motion(before, trajectory, drop, every_output, 1).transpose(2, 0, 1) for drop in range(2)],
        axis=1,
    )
    assert found.shape == (steps + 1, 2, outputs, len(names) + 22)
    if ground:
        matrices = linear_part()
        touching = matrices.deflection(matrices.M @ np.array([1.0, 0, 0, 1, 1, 1, 1]) * 9.80665)[3:7]
        assert np.any(trajectory.states[0, :, 3:7] > touching)
        assert not np.any(trajectory.states[-1, :, 3:7] > touching)

    def moved(unknown: int, by: float) -> Array:
        p = values.copy()
        p[unknown] += by
        there = stepper(extras, step, p, ground).integrate(states, memories, steps)
        return np.concatenate([there.states, there.forces], axis=2)

    def check(unknown: int, ends: Array, size: float) -> None:
        slope = (ends[0] - ends[1]) / (2 * size)
        scale = np.abs(slope).max(axis=(0, 1)) + 1e-9 * np.abs(slope).max()
        error = (found[..., unknown] - slope) / scale
        # Where a knot is passed just at a sample the surplus jumps a little, which a difference there shows enlarged.
        assert np.quantile(np.abs(error), 0.995) < 2e-3
        assert np.sqrt(np.mean(error**2)) < 5e-3

    # The rear axle has the laws of the front one; beside the ground, the other laws are those of the vehicle that stands on it.
    asked = [name for name in names if name[-1] != "r" and (not ground or name in WITH_GROUND)]
    for unknown, value in [(names.index(name), values[names.index(name)]) for name in asked]:
        size = 1e-6 * abs(value)
        check(unknown, np.array([moved(unknown, size), moved(unknown, -size)]), size)
    # Initial states and memories: all that are moved go side by side.
    start, size = np.hstack([states, memories]), 1e-6
    starts = (start + size * np.concatenate([np.eye(22), -np.eye(22)])[:, None]).reshape(88, 22)
    there = stepper(extras, step, ground=ground, pairs=44).integrate(starts[:, :14], starts[:, 14:], steps)
    ends = np.concatenate([there.states, there.forces], axis=2).reshape(steps + 1, 2, 22, 2, outputs)
    for place in range(22):
        check(len(names) + place, np.moveaxis(ends[:, :, place], 1, 0), size)


@pytest.mark.slow
@pytest.mark.parametrize("rounded", [False, True])
def test_knots_of_a_damper_curve_leave_the_steps_of_third_order(rounded: bool) -> None:
    """Half the step leaves an eighth of the error or less, though dampers pass a knot within a step.

    Forces that run straight over a step would leave a quarter: they miss (ωh)²/12 of the curved ones, 4e-4 at 1 ms and 11 Hz.
    The dampers lose up to 0.6 of 1500 N s/m at 0.3 m/s, 7 m/s² at a wheel of 40 kg; a tenth of that miss is allowed.
    """
    extras, state = ("rebound", "damper-curve", *(("rounded-knee",) if rounded else ())), some_states(2, 3)
    values, model = values_of(extras)[1], model_of(extras)
    rows = model.accelerations(values)[0]

    def accelerations(every: int) -> Array:
        step = 0.008 / every
        trajectory = stepper(extras, step).integrate(state, np.zeros((2, 0)), 100 * every)
        states, forces = trajectory.states[::every, 0], trajectory.forces[::every, 0]
        found: Array = (np.hstack([states, forces, np.ones((101, 1))]) @ rows.T)[:, [0, 3, 4, 5, 6]]
        return found

    exact = accelerations(128)
    errors = [float(np.sqrt(np.mean((accelerations(every) - exact) ** 2))) for every in (2, 8)]
    assert errors[0] / errors[1] > 8**2 / 2  # two halvings; where in a step a knot is passed is left to chance
    assert errors[1] < 0.1 * 4e-4 * 7


ALL_LAWS = tuple(extra for extra in EXTRAS if extra not in LINEAR_EXTRAS)


@pytest.mark.parametrize(
    "extras", [ALL_LAWS, ("air", "rebound", "damper-curve", "second-knee", "tyre-curve", "tyre-damping")]
)
def test_forces_memories_and_surplus_are_those_of_the_laws(extras: tuple[str, ...]) -> None:
    """What the compiled loop evaluates one by one: here arrays of the whole motions, wheels that land included."""
    names, values = values_of(extras)
    values = np.where([name.startswith("c_t") for name in names], 300.0, values)
    states, step = some_states(2, 1), 0.002
    states[:, 3:7] = 0.03 + np.abs(states[:, 3:7])
    before = stepper(extras, step, values, ground=True)
    motion = before.integrate(states, np.full((2, before.forces.memories), 0.3), 200)
    for drop in range(2):
        own = before.of_drop(drop)
        whole = np.hstack([motion.states[:, drop], motion.forces[:, drop], np.ones((201, 1))])
        inputs = whole @ own.inputs[0].T
        travel, rate = np.split(inputs, 2, axis=1)
        held = np.concatenate([motion.memories[:1, drop], motion.memories[:-1, drop]])
        found = own.forces_at.evaluate(ElementInput(travel, rate, np.diff(travel, axis=0, prepend=travel[:1]), held))
        largest = np.abs(found.force).max()
        assert np.ptp(motion.states[:, drop, 3]) > 0.03  # each wheel has been down
        np.testing.assert_allclose(motion.forces[:, drop], found.force, atol=1e-6 * largest)
        np.testing.assert_allclose(motion.memories[:, drop], found.memory, atol=1e-5)
        kinks = own.forces_at.kinks
        mean_rate = np.diff(travel, axis=0) / step
        curved = mean_rate - (rate[1:] + rate[:-1]) / 2
        by_rate, by_travel = (part[1:] + part[:-1] for part in (found.by_rate, found.by_travel))
        surplus = by_rate * curved - by_travel * np.diff(rate, axis=0) * step / 12
        surplus += kinks.surplus(inputs[:-1], inputs[1:])
        np.testing.assert_allclose(motion.surplus[1:, drop], surplus, atol=1e-5 * largest)
        assert not motion.surplus[0].any()


def test_a_motion_that_diverges_is_not_finite_from_there_on() -> None:
    names, values = values_of(("rebound",))
    values = np.where([name == "c_sf" for name in names], -1e3, values)
    trajectory = stepper(("rebound",), 0.01, values).integrate(some_states(2), np.zeros((2, 0)), 8000)
    assert np.isfinite(trajectory.states[:100]).all()
    assert all(np.isnan(part[-1]).all() for part in (trajectory.states, trajectory.forces, trajectory.surplus))


def test_systems_of_equations_are_solved_where_the_diagonal_is_zero() -> None:
    random = np.random.default_rng(0)
    matrix, right = (
        random.standard_normal((6, 6)).astype(np.float32),
        random.standard_normal((6, 16)).astype(np.float32),
    )
    matrix[0, 0] = matrix[1, 1] = 0.0
    expected = np.linalg.solve(matrix.astype(np.float64), right.astype(np.float64))
    solve(matrix, right)
    np.testing.assert_allclose(right, expected, atol=1e-4 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("law", "parameters"),
    [
        (FRICTION, (100.0, 2e5)), (FRICTION, (0.0, 2e5)), (REBOUND, (1.7, 1500.0)), (PROGRESSIVE, (3.0, 2e4)),
        (damper_curve(), (1500.0, 0.006, 0.4)),
        (damper_curve(CurveParts(has_ratio=True)), (1500.0, 1.7, 0.004, 0.5, 0.012, 0.2)),
        (damper_curve(CurveParts(is_rounded=True)), (1500.0, 0.002, 0.006, 0.4)),
        (damper_curve(CurveParts(has_ratio=True, is_rounded=True)), (1500.0, 1.7, 0.002, 0.004, 0.5, 0.012, 0.2)),
        (damper_curve(CurveParts(True, True, True)), (1500.0, 1.7, 0.8, 1.2, 0.002, 0.004, 0.5, 0.012, 0.2)),
        (damper_curve(CurveParts(has_rebound_knee=True)), (1500.0, 1.3, 0.7, 0.004, 0.5, 0.012, 0.2)),
        (AIR, (6.0, 2e4)), (AIR, (1e-6, 2e4)), (AIR, (0.0, 2e4)), (AIR, (60.0, 2e4)),
        (BUMP_STOP, (1e5, 0.004)), (GROUND, (2e4,)), (GROUND, (2e4, 30.0)),
    ],
)  # fmt: skip
def test_laws_tell_their_own_derivatives(law: ForceLaw, parameters: tuple[float, ...]) -> None:
    random = np.random.default_rng(2)
    travel, rate, increment = 0.01 * random.standard_normal((3, 3, 50))
    given = ElementInput(travel, rate, increment, law.has_memory * random.uniform(-0.9, 0.9, (3, 50)))
    p = np.array(parameters)[:, None] * np.ones(50)
    found = law.evaluate(p, given)
    e = 1e-9
    for field, total in (
        ("travel", found.by_travel), ("rate", found.by_rate),
        ("increment", found.by_memory * found.memory_by_travel), ("memory", found.by_memory * found.memory_by_memory),
    ):  # fmt: skip
        if field in ("increment", "memory") and not law.has_memory:
            continue
        up, down = (law.evaluate(p, given._replace(**{field: getattr(given, field) + side})).force for side in (e, -e))
        np.testing.assert_allclose(total, (up - down) / (2 * e), atol=1e-4 * np.abs(total).max() + 1e-6)
    of_force, of_memory = law.differentiate(p, given)
    for which in range(len(parameters)):
        if law is FRICTION and parameters[0] == 0:
            continue  # a corner: what F does to the way over which it builds up has no slope there
        step = np.zeros_like(p)
        step[which] = 1e-6 * max(parameters[which], 1e-3)
        more, less = (law.evaluate(p + side * step, given).force for side in (1, -1))
        width = 2 * step[which]
        total = of_force[which] + found.by_memory * of_memory[which]
        np.testing.assert_allclose(total, (more - less) / width, atol=1e-4 * np.abs(total).max() + 1e-9, rtol=1e-5)


def test_friction_slides_at_its_force_and_holds_at_its_stiffness() -> None:
    """Dahl: far along one way the force is F; over ways much shorter than F/s it is a spring of s."""
    p = np.array([[100.0], [2e5]])
    far = ElementInput(*(np.array([value]) for value in (0.1, 0.0, 0.1, -1.0)))
    assert FRICTION.evaluate(p, far).force[0] == pytest.approx(100.0)
    near = ElementInput(*(np.array([value]) for value in (1e-7, 0.0, 1e-7, 0.0)))
    assert FRICTION.evaluate(p, near).force[0] == pytest.approx(2e5 * 1e-7, rel=1e-3)
