"""Errors and faults, each with its remedy.

A `Problem` makes an input unusable; all problems of an input are raised as one `InputError`. A `Fault` concerns a recording or
the campaign, of which the rest can be used, and is reported with the result.
"""

from __future__ import annotations

import difflib
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from sprung.display import enumerated, shown

_CANDIDATES = 10
"""Number of names with most common letters that are compared with a mistyped one letter by letter."""

_MOST_ALIKE = 4
"""Words that are suggested together at the most: those of the four wheels."""


class SprungError(Exception):
    """Base class of the errors that sprung raises."""


@shown
@dataclass(frozen=True, slots=True)
class Problem:
    """One reason why an input cannot be used.

    Attributes
    ----------
    where
        File and place in it: ``campaign.toml: sensor[2].position``.
    found
        Content at that place.
    expected
        Content that is expected there.
    do
        Remedy.
    """

    where: str
    found: str
    expected: str
    do: str

    def __str__(self) -> str:
        text = f"{self.where}: found {self.found}; expected {self.expected}. {self.do}"
        # Control characters of a damaged file must not reach the terminal, and unusual spaces must be visible.
        return text if text.isprintable() else "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


class InputError(SprungError, ValueError):
    """Input that cannot be used, with all its problems.

    Attributes
    ----------
    problems : tuple of Problem
    """

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))


class UnknownNameError(SprungError, KeyError):
    """Unknown name; the message states the nearest known one.

    Attributes
    ----------
    name : str
    """

    def __init__(self, name: str, allowed: Iterable[str]) -> None:
        self.name = name
        super().__init__(name)
        self._text = f"nothing is named '{name}'. {did_you_mean(name, allowed)}"

    def __str__(self) -> str:
        return self._text


class RejectedResultError(InputError):
    """Result that is rejected, where its estimates are needed."""


class ResultFileError(InputError):
    """Saved result that cannot be read: newer schema, truncated or edited."""


@shown
@dataclass(frozen=True, slots=True)
class Fault:
    """Fault of a recording or of the campaign, of which the rest can be used.

    Attributes
    ----------
    code
        One of the contract's fault codes, such as ``missing`` or ``no-release``.
    where
        Recording and channel, such as ``empty_bounce.csv: wheel_fl``.
    what
        What was found, and how it was treated.
    do
        Remedy.
    """

    code: str
    where: str
    what: str
    do: str

    def as_problem(self, expected: str) -> Problem:
        """Return the problem of an input of which the fault leaves nothing to use.

        Parameters
        ----------
        expected
            What is needed.

        Returns
        -------
        Problem
        """
        return Problem(self.where, f"the fault {self.code} ({self.what})", expected, self.do)


def merge_faults(faults: Iterable[Fault]) -> list[Fault]:
    """Return faults with those that differ only by their place merged into one.

    Parameters
    ----------
    faults
        In any order.

    Returns
    -------
    list of Fault
        In the order of the first of each; its place names all recordings, each with its channels.

    Examples
    --------
    >>> gap = "1 of 900 samples is missing"
    >>> merge_faults([Fault("missing", f"a.csv: {channel}", gap, "See the logger.") for channel in ("x", "y")])[0].where
    'a.csv: x, y'
    """
    places: defaultdict[tuple[str, str, str], list[str]] = defaultdict(list)
    for fault in faults:
        places[fault.code, fault.what, fault.do].append(fault.where)
    return [Fault(code, _join_places(where), what, do) for (code, what, do), where in places.items()]


def _join_places(places: Iterable[str]) -> str:
    channels: defaultdict[str, list[str]] = defaultdict(list)
    for place in dict.fromkeys(places):
        recording, _, channel = place.partition(": ")
        channels[recording] += [channel] if channel else []
    texts = [f"{recording}: {', '.join(own)}" if own else recording for recording, own in channels.items()]
    return ("; " if any(channels.values()) else ", ").join(texts)


class Problems:
    """Collection of the problems of an input, which are then reported together.

    Examples
    --------
    >>> problems = Problems()
    >>> problems.add("a.csv", "an empty file", "samples", "Record again.")
    >>> bool(problems)
    True
    """

    def __init__(self) -> None:
        self._problems: list[Problem] = []

    def __bool__(self) -> bool:
        return bool(self._problems)

    def __iter__(self) -> Iterator[Problem]:
        return iter(self._problems)

    def add(self, where: str, found: str, expected: str, do: str) -> None:
        """Add a problem: where it is, what was found, what is expected, and what to do."""
        self._problems.append(Problem(where, found, expected, do))

    @contextmanager
    def collect(self) -> Iterator[None]:
        """Add the problems of an `InputError` raised inside the block, and continue after it."""
        try:
            yield
        except InputError as error:
            self._problems.extend(error.problems)

    def raise_if_any(self) -> None:
        """Raise one `InputError` with all problems.

        Raises
        ------
        InputError
            If there is any problem.
        """
        if self._problems:
            raise InputError(self._problems)


@contextmanager
def record_failure(
    omissions: list[str], what: str, done: str = "drawn", unless: tuple[type[Exception], ...] = ()
) -> Iterator[None]:
    """Add a sentence, once, if an optional part of a report, such as a figure, raises an error; and continue after it.

    Parameters
    ----------
    omissions
        A sentence for each part that could not be made, to which it is added.
    what
        The part, as the subject of the sentence.
    done
        What could not be done, as a participle.
    unless
        Errors that are raised.

    Yields
    ------
    None
        The block that makes the part runs here.

    Examples
    --------
    >>> omissions = []
    >>> with record_failure(omissions, "The stabilisation diagram"):
    ...     raise ValueError("no poles")
    >>> omissions
    ['The stabilisation diagram could not be drawn: no poles (ValueError).']
    """
    try:
        yield
        return
    except unless:
        raise
    except InputError as error:
        reasons = "; ".join(f"{problem.found}. {problem.do}" for problem in error.problems)
        sentence = f"{what} could not be {done}: {reasons}"
    except Exception as error:  # noqa: BLE001 (no error of an optional part may prevent the result)
        reason = " ".join(str(error).split())
        kind = type(error).__name__
        sentence = f"{what} could not be {done}: {f'{reason} ({kind})' if reason else kind}."
    if sentence not in omissions:
        omissions.append(sentence)


def did_you_mean(word: str, allowed: Iterable[str], *, listed: bool = False, heading: str = "Allowed") -> str:
    """Return a sentence with the allowed word that was probably meant.

    Parameters
    ----------
    word
        The word.
    allowed
        The allowed words.
    listed
        Whether the message lists them already, as what is expected.
    heading
        What stands before the list of the allowed words.

    Returns
    -------
    str
        ``Did you mean 'wheels'?`` if some are `closest_words`; otherwise the allowed words, unless they are listed already.
    """
    allowed = sorted(set(allowed))
    if meant := [f"'{name}'" for name in closest_words(word, allowed)]:
        return f"Did you mean {enumerated(meant, 'or')}?"
    if not allowed:
        return "Nothing is allowed here."
    return "Write one of these." if listed else f"{heading}: {', '.join(allowed)}."


def closest_words(word: str, allowed: Iterable[str]) -> list[str]:
    """Return the allowed words that were probably meant.

    Parameters
    ----------
    word
        The word.
    allowed
        The allowed words.

    Returns
    -------
    list of str
        The one of which the word's initials are, as of "rear right" those are rr; or the one with the fewest typing errors,
        all of them if two are equally close; none if none is close.

    Examples
    --------
    >>> closest_words("wheel", ["wheels", "height"])
    ['wheels']
    """
    allowed = sorted(set(allowed))
    initials = "".join(part[0] for part in re.split(r"[\W_]+", word.lower()) if part)
    if initials in allowed and len(initials) > 1:
        return [initials]
    close = difflib.get_close_matches(word.lower(), [name.lower() for name in allowed], n=_CANDIDATES, cutoff=0.6)
    # Their order is by common letters, which does not distinguish exchanged letters from wrong ones.
    errors = {name: _typing_errors(word.lower(), name) for name in close}
    nearest = [name for name in errors if errors[name] == min(errors.values())]
    nearest = nearest[: 1 if len(nearest) > _MOST_ALIKE else None]  # of many that are as close none is meant more
    return [name for name in allowed if name.lower() in nearest]


def _typing_errors(written: str, meant: str) -> int:
    """Return the optimal string alignment distance: letters left out, added, replaced or exchanged with a neighbour."""
    previous: list[int] = []
    last = list(range(len(meant) + 1))
    for i, letter in enumerate(written):
        row = [i + 1]
        for j, expected in enumerate(meant):
            errors = min(last[j + 1] + 1, row[j] + 1, last[j] + (letter != expected))
            if i and j and letter == meant[j - 1] and expected == written[i - 1]:
                errors = min(errors, previous[j - 1] + 1)
            row.append(errors)
        previous, last = last, row
    return last[-1]
