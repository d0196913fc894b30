"""What long work tells of itself: one step after the other, in words and in numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sized
from typing import TypeVar


class Step(str):
    """One step of long work: a sentence, so that ``print`` is enough to show it, with its number where steps are counted.

    Attributes
    ----------
    stage
        What is being done, such as ``reading the recordings``; the same for all its steps.
    step, of
        Number of the step that begins, from 1, and of all steps of the stage; None where nobody knows how many there will be.
    done
        Part of the stage that is done, 0 to 1, from which the rest can be estimated; None where nobody knows.

    Examples
    --------
    >>> step = Step("fitting from a start", 2, 3)
    >>> print(step)
    fitting from a start, 2 of 3
    >>> step.step, step.of
    (2, 3)
    >>> step.done
    0.3333333333333333
    """

    __slots__ = ("done", "of", "stage", "step")
    stage: str
    step: int | None
    of: int | None
    done: float | None

    def __new__(
        cls,
        stage: str,
        step: int | None = None,
        of: int | None = None,
        detail: str = "",
        done: float | None = None,
    ) -> Step:
        """Make a step; ``detail`` is what it works on, such as a file."""
        if done is None and step is not None and of:
            done = (step - 1) / of
        text = stage if step is None or of is None else f"{stage}, {step} of {of}"
        made = super().__new__(cls, f"{text}: {detail}" if detail else text)
        for name, value in (("stage", stage), ("step", step), ("of", of), ("done", done)):
            object.__setattr__(made, name, value)
        return made

    def __setattr__(self, name: str, _: object) -> None:
        raise AttributeError(f"a step is what it is: {name} cannot be set")

    def __reduce__(self) -> tuple[object, ...]:
        detail = str(self).removeprefix(str(Step(self.stage, self.step, self.of))).removeprefix(": ")
        return Step, (self.stage, self.step, self.of, detail, self.done)


Progress = Callable[[Step], None]
"""What a long function calls with each step that begins."""


def silent(step: Step) -> None:
    """Show nothing."""


_Item = TypeVar("_Item")


def counted(progress: Progress, stage: str, items: Iterable[_Item], of: int | None = None) -> Iterator[_Item]:
    """Yield items one after the other, and tell that each begins.

    Parameters
    ----------
    progress
        Called with a `Step` before each item.
    stage
        What is being done with them.
    items
        With a length, unless `of` is given. Those that are text, or that have a name, are named.
    of
        How many there are.
    """
    if of is None:
        of = len(items) if isinstance(items, Sized) else None
    for number, item in enumerate(items, start=1):
        detail = item if isinstance(item, str) else getattr(item, "name", "")
        progress(Step(stage, number, of, detail if isinstance(detail, str) else ""))
        yield item
