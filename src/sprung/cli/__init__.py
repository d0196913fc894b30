"""The command line: parse, call, print, exit code; nothing is computed here."""

from __future__ import annotations

import sys

from sprung.cli.commands import app
from sprung.errors import SprungError

BAD_INPUT = 2
DEFECT = 1


def main() -> None:
    """Run the command line; exit status 0, 1, 2 or 3 as the contract has it."""
    try:
        app()
    except SprungError as error:
        sys.stderr.write(f"{_headline(error)}\n{error}\n")
        raise SystemExit(BAD_INPUT) from None


def _headline(error: SprungError) -> str:
    problems = getattr(error, "problems", ())
    return (
        "sprung cannot use this input:"
        if len(problems) < 2
        else f"sprung cannot use this input, {len(problems)} faults:"
    )
