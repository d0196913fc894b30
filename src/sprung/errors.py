"""What can go wrong, in words that tell what to do.

Two nouns: a `Problem` makes an input unusable and is raised, together with all others found, as one `InputError`;
a `Fault` is something wrong with one recording that the rest of the campaign survives, and is reported with the result.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from sprung.display import shown

_CANDIDATES = 10
"""How many of the names that share most letters with a mistyped one are compared with it letter by letter."""


class SprungError(Exception):
    """Base of every error that sprung raises on purpose."""


@shown
@dataclass(frozen=True, slots=True)
class Problem:
    """One reason why an input cannot be used.

    Attributes
    ----------
    where
        File, and place in it: ``campaign.toml: sensor[2].position``.
    found
        What stands there.
    expected
        What should stand there.
    do
        The one thing to do about it.
    """

    where: str
    found: str
    expected: str
    do: str

    def __str__(self) -> str:
        said = f"{self.where}: found {self.found}; expected {self.expected}. {self.do}"
        # What stands in a damaged file must not steer the terminal, and a space of another kind is to be seen.
        return said if said.isprintable() else "".join(c if c.isprintable() else repr(c)[1:-1] for c in said)


class InputError(SprungError, ValueError):
    """Bad input; carries every problem found, not only the first.

    Attributes
    ----------
    problems : tuple of Problem
    """

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))


class UnknownNameError(SprungError, KeyError):
    """Nothing has this name; says which one was probably meant.

    Attributes
    ----------
    name : str
    """

    def __init__(self, name: str, allowed: Iterable[str]) -> None:
        self.name = name
        super().__init__(name)
        self._said = f"nothing is named '{name}'. {did_you_mean(name, allowed)}"

    def __str__(self) -> str:
        return self._said


class ResultFileError(InputError):
    """A saved result cannot be read back: newer schema, truncated or edited."""


@shown
@dataclass(frozen=True, slots=True)
class Fault:
    """Something wrong with a recording or the campaign which the rest of the campaign survives.

    Attributes
    ----------
    code
        One of the contract's fault codes, such as ``missing`` or ``no-release``.
    where
        Recording and channel, such as ``empty_bounce.csv: wheel_fl``.
    what
        What was found, and what was done about it.
    do
        What the user can do.
    """

    code: str
    where: str
    what: str
    do: str


class Problems:
    """Collects problems while an input is read, so that the user sees all of them at once.

    Examples
    --------
    >>> problems = Problems()
    >>> problems.add("a.csv", "an empty file", "samples", "Record again.")
    >>> bool(problems)
    True
    """

    def __init__(self) -> None:
        self._found: list[Problem] = []

    def __bool__(self) -> bool:
        return bool(self._found)

    def __iter__(self) -> Iterator[Problem]:
        return iter(self._found)

    def add(self, where: str, found: str, expected: str, do: str) -> None:
        """Note one more problem: where it is, what was found there, what is expected, and what to do about it."""
        self._found.append(Problem(where, found, expected, do))

    @contextmanager
    def collecting(self) -> Iterator[None]:
        """Take up the problems of an `InputError` raised inside the block, and go on after it."""
        try:
            yield
        except InputError as error:
            self._found.extend(error.problems)

    def raise_if_any(self) -> None:
        """Raise one `InputError` with everything collected so far.

        Raises
        ------
        InputError
            If anything was collected.
        """
        if self._found:
            raise InputError(self._found)


class Omissions:
    """Collects what only decorates a result and could not be made; the result is worth as much without it.

    Examples
    --------
    >>> omissions = Omissions()
    >>> with omissions.noting("The stabilisation diagram"):
    ...     raise ValueError("no poles")
    >>> omissions.sentences
    ('The stabilisation diagram could not be drawn: no poles (ValueError).',)
    """

    def __init__(self, sentences: Iterable[str] = ()) -> None:
        self._found = dict.fromkeys(sentences)

    @property
    def sentences(self) -> tuple[str, ...]:
        """One for each thing that is missing, with the reason."""
        return tuple(self._found)

    def add(self, sentences: Iterable[str]) -> None:
        """Take up what is missing elsewhere too, each sentence once."""
        self._found |= dict.fromkeys(sentences)

    @contextmanager
    def noting(self, what: str, done: str = "drawn", unless: tuple[type[Exception], ...] = ()) -> Iterator[None]:
        """Note that something could not be drawn, where the block fails, and go on after it.

        Parameters
        ----------
        what
            The beginning of the sentence: what is missing.
        done
            What could not be done with it, as a participle.
        unless
            Errors that pass.
        """
        try:
            yield
        except unless:
            raise
        except InputError as error:
            reasons = "; ".join(f"{one.found}. {one.do}" for one in error.problems)
            self._found[f"{what} could not be {done}: {reasons}"] = None
        except Exception as error:  # noqa: BLE001 (whatever it is, it must not cost the result)
            reason = " ".join(str(error).split())
            kind = type(error).__name__
            self._found[f"{what} could not be {done}: {f'{reason} ({kind})' if reason else kind}."] = None


def did_you_mean(word: str, allowed: Iterable[str]) -> str:
    """Say which allowed word was probably meant.

    Parameters
    ----------
    word
        What was written.
    allowed
        What may be written.

    Returns
    -------
    str
        ``Did you mean 'wheels'?`` if one is close, otherwise the allowed words.
    """
    allowed = sorted(allowed)
    close = difflib.get_close_matches(word.lower(), [name.lower() for name in allowed], n=_CANDIDATES, cutoff=0.6)
    if close:
        # They come by their common letters, the most first, which does not tell exchanged letters from wrong ones.
        nearest = min(close, key=lambda name: _typing_errors(word.lower(), name))
        meant = next(name for name in allowed if name.lower() == nearest)
        return f"Did you mean '{meant}'?"
    return f"Allowed: {', '.join(allowed)}." if allowed else "Nothing is allowed here."


def _typing_errors(written: str, meant: str) -> int:
    """Count the letters left out, added, mistaken or exchanged with a neighbour (optimal string alignment distance)."""
    before: list[int] = []
    last = list(range(len(meant) + 1))
    for i, letter in enumerate(written):
        row = [i + 1]
        for j, other in enumerate(meant):
            errors = min(last[j + 1] + 1, row[j] + 1, last[j] + (letter != other))
            if i and j and letter == meant[j - 1] and other == written[i - 1]:
                errors = min(errors, before[j - 1] + 1)
            row.append(errors)
        before, last = last, row
    return last[-1]
