"""Progress of long computations, step by step."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sized
from typing import TypeVar


class Step(str):
    """A step of a long computation: a text that can be printed, with its number where steps are counted.

    Attributes
    ----------
    stage
        Name of the stage, such as ``reading the recordings``; the same for all its steps.
    step, of
        Number of the step that begins, from 1, and number of steps of the stage; None where it is not known.
    done
        Part of the stage that is done, 0 to 1; None where it is not known.

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
        """Return a step; ``detail`` is its object, such as a file."""
        if done is None and step is not None and of:
            done = (step - 1) / of
        text = stage if step is None or of is None else f"{stage}, {step} of {of}"
        step_text = super().__new__(cls, f"{text}: {detail}" if detail else text)
        for name, value in (("stage", stage), ("step", step), ("of", of), ("done", done)):
            object.__setattr__(step_text, name, value)
        return step_text

    def __setattr__(self, name: str, _: object) -> None:
        raise AttributeError(f"{name} of a step cannot be set")

    def __reduce__(self) -> tuple[object, ...]:
        detail = str(self).removeprefix(str(Step(self.stage, self.step, self.of))).removeprefix(": ")
        return Step, (self.stage, self.step, self.of, detail, self.done)


Progress = Callable[[Step], None]
"""Function that is called with each step that begins."""


def silent(step: Step) -> None:
    """Ignore a step."""


_Item = TypeVar("_Item")


def counted(progress: Progress, stage: str, items: Iterable[_Item], of: int | None = None) -> Iterator[_Item]:
    """Yield items, and report the beginning of each.

    Parameters
    ----------
    progress
        Called with a `Step` before each item.
    stage
        Name of the stage.
    items
        With a length, unless `of` is given. An item that is text, or has a name, is named in the step.
    of
        Number of items.
    """
    if of is None:
        of = len(items) if isinstance(items, Sized) else None
    for number, item in enumerate(items, start=1):
        detail = item if isinstance(item, str) else getattr(item, "name", "")
        progress(Step(stage, number, of, detail if isinstance(detail, str) else ""))
        yield item
