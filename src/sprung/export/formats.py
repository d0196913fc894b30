"""Every format by its name: what `sprung export` writes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields

from sprung.errors import InputError, Problem, RejectedResultError, did_you_mean
from sprung.export.commonroad_parameters import commonroad
from sprung.export.file import ExportedFile
from sprung.export.functional_mockup import fmu
from sprung.export.linear_system import state_space
from sprung.export.markup import latex, markdown
from sprung.export.modelica_text import modelica
from sprung.export.mujoco_model import mjcf
from sprung.export.parameter_draws import USUAL_NUMBER, draws
from sprung.results import Result
from sprung.vehicle import EMPTY, Load, Sensor


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportOptions:
    """Options of an export; each belongs to some formats, None where it is left open.

    Attributes
    ----------
    load
        Name of the load on the vehicle.
    amplitude, frequency
        Motion for which a state space is linearised, m and Hz.
    approximate
        Whether what a format cannot hold is approximated.
    number, seed
        Number of draws, and the seed of their random numbers.
    table
        Whether draws are written as ``csv`` or ``parquet``.
    """

    load: str | None = None
    amplitude: float | None = None
    frequency: float | None = None
    approximate: bool | None = None
    number: int | None = None
    seed: int | None = None
    table: str | None = None


@dataclass(frozen=True, slots=True)
class _Format:
    """A format: its options, and what writes it."""

    options: frozenset[str]
    write: Callable[[Result, ExportOptions], ExportedFile]


def _state_space(result: Result, options: ExportOptions) -> ExportedFile:
    return state_space(
        result.vehicle,
        _load(result, options),
        sensors=_sensors(result),
        amplitude=options.amplitude,
        frequency=options.frequency,
    ).mat()


def _draws(result: Result, options: ExportOptions) -> ExportedFile:
    drawn = draws(result, USUAL_NUMBER if options.number is None else options.number, seed=options.seed)
    return drawn.parquet() if options.table == "parquet" else drawn.csv()


_FORMATS: Mapping[str, _Format] = {
    "state-space": _Format(frozenset({"load", "amplitude", "frequency"}), _state_space),
    "commonroad": _Format(
        frozenset({"load", "approximate"}),
        lambda result, options: commonroad(
            result.vehicle, _load(result, options), approximate=bool(options.approximate)
        ),
    ),
    "modelica": _Format(
        frozenset({"load"}),
        lambda result, options: modelica(result.vehicle, _load(result, options), sensors=_moving_sensors(result)),
    ),
    "mjcf": _Format(
        frozenset({"load", "approximate"}),
        lambda result, options: mjcf(
            result.vehicle,
            _load(result, options),
            sensors=[sensor for sensor in _moving_sensors(result) if sensor.quantity == "acceleration"],
            approximate=bool(options.approximate),
        ),
    ),
    "fmu": _Format(
        frozenset({"load"}),
        lambda result, options: fmu(result.vehicle, _load(result, options), sensors=_moving_sensors(result)),
    ),
    "draws": _Format(frozenset({"number", "seed", "table"}), _draws),
    "markdown": _Format(frozenset(), lambda result, _: markdown(result)),
    "latex": _Format(frozenset(), lambda result, _: latex(result)),
}

FORMATS: tuple[str, ...] = tuple(_FORMATS)
"""Names of the formats."""

_NEED_NO_VEHICLE = frozenset({"markdown", "latex"})


def export(result: Result, to: str, options: ExportOptions = ExportOptions()) -> ExportedFile:
    """Return a result in a format of another program.

    Parameters
    ----------
    result
        Of an identification.
    to
        One of `FORMATS`.
    options
        Of the format.

    Returns
    -------
    ExportedFile
        Its notes state what a doubtful or rejected verdict means for its reader.

    Raises
    ------
    RejectedResultError
        If the result is rejected and the format needs a vehicle.
    InputError
        If there is no such format, an option does not belong to it, or the vehicle cannot be put into it; with all reasons.
    """
    where = f"export of {result.name}"
    if to not in _FORMATS:
        raise InputError([Problem(where, f"the format '{to}'", "the name of a format", did_you_mean(to, FORMATS))])
    given = [one.name for one in fields(options) if getattr(options, one.name) is not None]
    problems = [
        Problem(where, f"the option {name}", f"options of {to}", f"It belongs to {_formats_with(name)}; leave it out.")
        for name in given
        if name not in _FORMATS[to].options
    ]
    if options.load is not None and options.load not in (names := [EMPTY.name, *_loads(result)]):
        problems.append(Problem(where, f"the load '{options.load}'", "a load", did_you_mean(options.load, names)))
    file: ExportedFile | None = None
    try:
        if to not in _NEED_NO_VEHICLE:
            result.vehicle  # noqa: B018 (raises what prevents every export)
        if not problems:
            file = _FORMATS[to].write(result, options)
    except RejectedResultError as error:
        if not problems:
            raise
        problems += error.problems
    except InputError as error:
        problems += error.problems
    if file is None:
        raise InputError(problems)
    state, reasons = result.verdict.state, "; ".join(result.verdict.reasons)
    warnings = {
        "doubtful": f"The result is doubtful: {reasons}",
        "reject": "The result is rejected: it has no estimates, and the file has none.",
    }
    return file.with_notes(warnings[state]) if state in warnings else file


def _formats_with(option: str) -> str:
    return ", ".join(name for name, one in _FORMATS.items() if option in one.options)


def _loads(result: Result) -> dict[str, Load]:
    return {load.name: load for load in result.setup.loads}


def _load(result: Result, options: ExportOptions) -> Load | None:
    return None if options.load in (None, EMPTY.name) else _loads(result)[str(options.load)]


def _sensors(result: Result) -> list[Sensor]:
    """Return the sensors of the test that measure something of the vehicle or the forces on it."""
    return [sensor for sensor in result.setup.sensors if sensor.pad is None or sensor.quantity == "force"]


def _moving_sensors(result: Result) -> list[Sensor]:
    return [sensor for sensor in _sensors(result) if sensor.pad is None]
