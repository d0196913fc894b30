"""The registry of file formats: exactly one of them must claim a file."""

from __future__ import annotations

from functools import cache
from importlib import metadata
from importlib.metadata import EntryPoint
from typing import TYPE_CHECKING, Protocol

from sprung.errors import InputError, Problem, did_you_mean

if TYPE_CHECKING:
    from collections.abc import Collection
    from pathlib import Path

    from sprung.formats.table import SampleTable

GROUP = "sprung.formats"
HEAD = 8192

# Searching the installed packages takes as long as reading a file, of which a campaign has many.
entry_points = cache(metadata.entry_points)

# Other packages add theirs by an entry point of this group.
_OWN = tuple(
    EntryPoint(name, f"sprung.formats.{name}:{format_}", GROUP)
    for name, format_ in (
        ("csv", "CsvFormat"),
        ("excel", "ExcelFormat"),
        ("hdf5", "Hdf5Format"),
        ("iso_mme", "IsoMmeFormat"),
        ("lvm", "LvmFormat"),
        ("mat", "MatFormat"),
        ("mdf", "MdfFormat"),
        ("parquet", "ParquetFormat"),
        ("rpc", "RpcFormat"),
        ("tdms", "TdmsFormat"),
        ("uff", "UffFormat"),
        ("wav", "WavFormat"),
    )
)


class Format(Protocol):
    """One file format.

    A package adds one by an entry point in the group ``sprung.formats`` that leads to a class like this one. Heavy
    libraries belong inside `read`: every format is loaded to be asked, only the one that is met may cost time.
    """

    def claims(self, path: Path, head: bytes) -> bool:
        """Return whether a file is of this format.

        Parameters
        ----------
        path
            The file.
        head
            Its first 8192 bytes.
        """
        ...

    def read(self, path: Path) -> SampleTable:
        """Read a file.

        Parameters
        ----------
        path
            The file.

        Returns
        -------
        SampleTable

        Raises
        ------
        InputError
            If it cannot be read; every problem at once.
        """
        ...


def formats() -> dict[str, Format]:
    """Return every installed format by its name, sprung's own first."""
    found = {entry.name: entry for entry in (*_OWN, *entry_points(group=GROUP))}
    return {name: entry.load()() for name, entry in found.items()}


def read_table(path: Path, others: Collection[str] = ()) -> SampleTable:
    """Read a file in whatever known format it is.

    Parameters
    ----------
    path
        The file.
    others
        Names of files beside it that are used elsewhere: they are not suggested where the file is missing.

    Returns
    -------
    SampleTable

    Raises
    ------
    InputError
        If it is missing or unreadable, if no format or more than one claims it, or if its content is faulty.
    """
    head = _head(path, others)
    known = formats()
    claiming = [name for name, format_ in known.items() if format_.claims(path, head)]
    match claiming:
        case [only]:
            return known[only].read(path)
        case [] if not head:
            found, do = "an empty file", "Export the recording again."
        case []:
            found, do = "a file of no known format", "Export the recording in one of these formats."
        case _:
            found = f"a file that {len(claiming)} formats claim: {', '.join(claiming)}"
            do = "Export it in another format, or uninstall the package that claims too much."
    raise InputError([Problem(path.name, found, f"exactly one of the known formats: {', '.join(known)}", do)])


def _head(path: Path, others: Collection[str]) -> bytes:
    """Return the first bytes of a file.

    Raises
    ------
    InputError
        If it is missing or cannot be opened.
    """
    try:
        with path.open("rb") as file:
            return file.read(HEAD)
    except FileNotFoundError:
        beside = [other.name for other in path.parent.glob("*") if other.suffix != ".toml" and other.is_file()]
        beside = [name for name in beside if name not in others]
        do = "Put the recordings there, or correct the path."
        if beside:
            do = did_you_mean(path.name, beside, heading="There are")
        problem = Problem(path.name, f"no such file in {path.parent}", "a recording", do)
    except IsADirectoryError:
        problem = Problem(path.name, "a folder", "a recording", "Name the file in it.")
    except OSError as error:
        reason = f"a file that cannot be read ({error.strerror})"
        problem = Problem(path.name, reason, "a recording", "Check its permissions.")
    except UnicodeEncodeError as error:
        found = "a name with characters that file names cannot have with the present settings of the system"
        expected = f"a name in the encoding of file names, {error.encoding}"
        do = "Set the environment variable PYTHONUTF8=1 or a locale with UTF-8, or rename the file."
        problem = Problem(path.name, found, expected, do)
    except ValueError as error:
        problem = Problem(
            path.name, f"a name that no file can have ({error})", "the name of a recording", "Correct it."
        )
    raise InputError([problem])
