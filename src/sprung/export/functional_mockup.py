"""FMU: the equations of motion as tables in C, behind the co-simulation interface of FMI 3.0."""

from __future__ import annotations

import io
import os
import platform
import shlex
import shutil
import subprocess
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from hashlib import sha256
from importlib.resources import files
from pathlib import Path

from sprung.errors import InputError
from sprung.export.equations import Equations
from sprung.export.file import ExportedFile
from sprung.export.fmu_description import build_description, model_description
from sprung.export.fmu_tables import model_tables
from sprung.export.outputs import identifier, outputs_of, sensor_problems
from sprung.export.requests import resolve_load
from sprung.vehicle import Load, Sensor, Vehicle

_SOURCES = ("fmu.c", "vehicle.c")
"""Files of C in this room; the first one includes the others."""

_BUILD_TIME = 120.0
"""s after which a compiler is stopped."""

_FILE_TIME = (1980, 1, 1, 0, 0, 0)
"""Time of the files in the archive: equal vehicles give equal files."""


def fmu(
    vehicle: Vehicle, load: Load | None = None, *, sensors: Sequence[Sensor] = (), build: bool = True
) -> ExportedFile:
    """Return a vehicle as an FMU for co-simulation (FMI 3.0), with its source in C.

    All linear and nonlinear elements are in it, and tyres lift off. Inputs are the height of the road under each wheel, in m,
    and its rate, in m/s, with which the height goes on from the beginning of a communication step. The vehicle begins at rest
    on the road as it is then. Parameters are those of the vehicle.

    Parameters
    ----------
    vehicle
        The vehicle, such as `Result.vehicle`.
    load
        What is on it; nothing unless given.
    sensors
        Sensors on body and wheels that become outputs too, SI, positive up.
    build
        Whether to build the library for this system, if it has a compiler; the source alone is a complete FMU that the
        importing program has to build.

    Returns
    -------
    ExportedFile
        The archive; its notes say for which system a library is in it.

    Raises
    ------
    InputError
        If a sensor is on a pad, or two outputs have one name.
    """
    equations = Equations.of(vehicle, resolve_load(load))
    outputs = outputs_of(vehicle, sensors)
    if problems := sensor_problems(sensors, outputs, f"FMU of {vehicle.name}"):
        raise InputError(problems)
    name = identifier(vehicle.name)
    sources = {one: (files("sprung.export") / "c" / one).read_text(encoding="utf-8") for one in _SOURCES}
    tables = "\n".join(model_tables(equations, outputs)) + "\n"
    token = sha256("".join((*sources.values(), tables, name)).encode()).hexdigest()
    sources["model.h"] = tables + f'#define INSTANTIATION_TOKEN "{token}"\n'
    content: dict[str, bytes] = {
        "modelDescription.xml": model_description(equations, outputs, name, token).encode(),
        "sources/buildDescription.xml": build_description(name, _SOURCES[0]).encode(),
        **{f"sources/{one}": text.encode() for one, text in sources.items()},
    }
    note = "The FMU contains its source in C only: the importing program has to build it."
    if build and (library := _built(sources)) is not None:
        folder, suffix = _system()
        content[f"binaries/{folder}/{name}{suffix}"] = library
        note = f"The FMU contains its source in C and a library for {folder}."
    return ExportedFile(f"{name}.fmu", _zipped(content), (note,))


def _zipped(content: Mapping[str, bytes]) -> bytes:
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as opened:
        for name, data in content.items():
            opened.writestr(zipfile.ZipInfo(name, _FILE_TIME), data, zipfile.ZIP_DEFLATED)
    return archive.getvalue()


def _system() -> tuple[str, str]:
    """Return the folder of libraries for this system, and the suffix of their names."""
    machine = {"amd64": "x86_64", "arm64": "aarch64", "i386": "x86", "i686": "x86"}.get(
        platform.machine().lower(), platform.machine().lower()
    )
    system, suffix = {"Darwin": ("darwin", ".dylib"), "Windows": ("windows", ".dll")}.get(
        platform.system(), ("linux", ".so")
    )
    return f"{machine}-{system}", suffix


def _built(sources: Mapping[str, str]) -> bytes | None:
    """Return the library built from sources by name; None without a compiler that can."""
    named = shlex.split(os.environ.get("CC", ""))
    compiler = named or [found for found in map(shutil.which, ("cc", "gcc", "clang")) if found][:1]
    if not compiler:
        return None
    with tempfile.TemporaryDirectory(prefix="sprung-fmu-") as folder:
        for name, text in sources.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        library = Path(folder) / "library"
        options = ["-std=c99", "-O2", "-shared", "-fPIC", "-fvisibility=hidden", "-o", str(library), _SOURCES[0], "-lm"]
        try:
            subprocess.run([*compiler, *options], cwd=folder, check=True, capture_output=True, timeout=_BUILD_TIME)  # noqa: S603 (no shell)
        except (OSError, subprocess.SubprocessError):
            return None
        return library.read_bytes()
