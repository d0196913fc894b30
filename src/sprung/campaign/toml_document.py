"""The text of a TOML file, and where it is none."""

from __future__ import annotations

import re
import shlex
import tomllib
from typing import TYPE_CHECKING, Any

from sprung.errors import InputError, Problem, did_you_mean

if TYPE_CHECKING:
    from pathlib import Path


def read_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file.

    Raises
    ------
    InputError
        If it is missing, unreadable or not TOML; the message names line and column.
    """
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except FileNotFoundError:
        beside = [other.name for other in path.parent.glob("*.toml")]
        do = did_you_mean(path.name, beside, heading="There are")
        if not beside and any(other.is_dir() or other.is_file() for other in path.parent.glob("[!.]*")):
            do = f"Draft it from the recordings: `sprung new {shlex.quote(str(path.parent))}`."
        elif not beside:
            do = "Correct the path, or write that file: `sprung demo` writes an example to copy."
        raise InputError([Problem(str(path), "no such file", "a campaign file or vehicle file", do)]) from None
    except IsADirectoryError:
        do = "Name the file in it." if path.suffix != ".toml" else "Rename the folder, and put the file in its place."
        raise InputError([Problem(str(path), "a folder", "a campaign file or vehicle file", do)]) from None
    except OSError as error:
        found = f"a file that cannot be read ({error.strerror})"
        raise InputError([Problem(str(path), found, "a readable file", "Check its permissions.")]) from error
    except UnicodeDecodeError as error:
        line = path.read_bytes()[: error.start].count(b"\n") + 1
        found = "a character that is not UTF-8"
        do = "Save the file as UTF-8 in your editor."
        raise InputError([Problem(f"{path.name}: line {line}", found, "text in UTF-8, as TOML needs it", do)]) from None
    return parse_toml(text, path)


def parse_toml(text: str, path: Path) -> dict[str, Any]:
    """Return the content of a TOML file from its text.

    Parameters
    ----------
    text
        Of the file.
    path
        Of the file, for messages.

    Raises
    ------
    InputError
        If it is not TOML; the message names line and column.
    """
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError([_syntax_problem(path, text, str(error))]) from None
    except RecursionError:
        found, do = "lists or tables in each other, thousands deep", "Write the file as `sprung demo` does."
        raise InputError([Problem(path.name, found, "a campaign file or vehicle file", do)]) from None


_REPEATED = {
    "Cannot overwrite a value": ("a key that its section has already", "Delete one of the two."),
    "Duplicate inline table key": ("a key that its table has already", "Delete one of the two."),
    "Cannot declare": (
        "a section that the file has already",
        "Put the keys of the two into one; a section that may be repeated, such as [[drop]], stands in double brackets.",
    ),
}
"""What was found, and what to do, where something occurs twice: by the beginning of the message of `tomllib`."""


def _syntax_problem(path: Path, text: str, message: str) -> Problem:
    match = re.fullmatch(r"(?P<what>.*) \(at (?:line (?P<line>\d+), column (?P<column>\d+)|end of document)\)", message)
    what = match["what"] if match else message
    lines = text.splitlines() or [""]
    line = int(match["line"]) if match and match["line"] else len(lines)
    written = lines[min(line, len(lines)) - 1].strip()
    column = int(match["column"]) if match and match["column"] else len(lines[-1]) + 1
    where, found = f"{path.name}: line {line}, column {column}", f"`{written[:60]}`"
    for beginning, (repeated, remedy) in _REPEATED.items():
        if what.startswith(beginning):
            return Problem(where, f"{found}, {repeated}", "each key and section once", remedy)
    do = "Correct this line: text stands in double quotes, lists in [ ], and numbers have a decimal point."
    if path.suffix.lower() != ".toml":
        do = "Give the campaign file, which ends in .toml and names the recordings."
    return Problem(where, found, f"TOML ({what})", do)
