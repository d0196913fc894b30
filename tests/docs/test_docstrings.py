"""The docstring of every public name states units, array shapes, returned values and errors."""

from __future__ import annotations

import inspect

import numpy as np
import pytest
from numpy.typing import NDArray

from docstrings import complaints, public
from sprung.errors import InputError

NAMES = dict(public())


@pytest.mark.parametrize("name", NAMES)
def test_the_docstring_is_complete(name: str) -> None:
    assert complaints(name, NAMES[name]) == []


def test_every_room_is_included() -> None:
    rooms = {name.split(".")[1] for name in NAMES if name.count(".") == 2}
    assert rooms >= {"analysis", "campaign", "estimation", "modal", "preprocess", "report", "study", "vehicle"}
    assert {
        "sprung.identify",
        "sprung.compare",
        "sprung.errors.InputError",
        "sprung.vehicle.PARAMETERS",
    } <= NAMES.keys()


def told(values: NDArray[np.float64], rate: float, names: list[str]) -> NDArray[np.float64]:  # noqa: ARG001 (told of)
    """Tell nothing.

    Parameters
    ----------
    values
        m/s², shape (channel, time).
    rate
        Samples per second.
    names
        Of the channels.

    Returns
    -------
    ndarray
        The same.

    Raises
    ------
    InputError
        Always.
    """
    raise InputError([])


@pytest.mark.parametrize(
    ("there", "instead", "said"),
    [
        ("m/s², shape (channel, time).", "shape (channel, time).", "(values): no unit"),
        ("m/s², shape (channel, time).", "m/s².", "(values): no shape"),
        ("Samples per second.", "How fast.", "(rate): no unit"),
        ("    names\n        Of the channels.\n", "", ": no word of names"),
        ("    rate\n", "    pace\n", ": pace are no parameters"),
        ("    Returns\n    -------\n    ndarray\n        The same.\n", "", ": no Returns"),
        ("    InputError\n        Always.\n", "    OSError\n        Never.\n", ": no Raises of InputError"),
        ("Tell nothing.", "Tell nothing, eq. (99).", ": eq. 99 is none of the paper's"),
    ],
)
def test_a_missing_part_is_reported(monkeypatch: pytest.MonkeyPatch, there: str, instead: str, said: str) -> None:
    assert complaints("told", told) == []
    text = inspect.getsource(told).split('"""')[1]
    assert there in text
    monkeypatch.setattr(told, "__doc__", text.replace(there, instead))
    assert f"told{said}" in complaints("told", told)
