"""The content of formats with nested names, structs in structs or groups in groups, in one flat form."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from sprung.formats.sample_store import Samples, store_in_memory

if TYPE_CHECKING:
    from numpy.typing import NDArray

DEEPEST = 32
"""Deepest nesting that is read."""

Node: TypeAlias = "Mapping[str, Node] | Sequence[Node] | NDArray[Any] | Numbers | Foreign | str"
"""Something that stands in a file: more names, a list, numbers that were read or are still unread, or text. Values of a
thing that also has attributes stand beside them under the empty name."""

Path: TypeAlias = tuple[str, ...]
"""The names that lead to something, outermost first."""


@dataclass(frozen=True, eq=False)
class Numbers:
    """Real numbers that are not yet read.

    Attributes
    ----------
    shape
        Without the sides of length 1: one side, or two of a matrix.
    along
        Gives the vectors that lie along a side, the first or the second.
    moments
        Whether the file declares them to be times, which are then in s.
    """

    shape: tuple[int, ...]
    along: Callable[[int], Sequence[Samples]]
    moments: bool = False


@dataclass(frozen=True)
class Foreign:
    """Something that cannot be numbers of a recording.

    Attributes
    ----------
    what
        In words, ``an object of class timetable``.
    """

    what: str


@dataclass(frozen=True, eq=False)
class NumberBlock:
    """Numbers.

    Attributes
    ----------
    path
        The names that lead to them.
    numbers
        A vector, a matrix of which one side is time, or vectors of one length.
    """

    path: Path
    numbers: Numbers | tuple[Numbers, ...]


@dataclass(frozen=True)
class Text:
    """Words: one, or a list of them."""

    path: Path
    words: tuple[str, ...]


@dataclass(frozen=True)
class Number:
    """A single number."""

    path: Path
    value: float


@dataclass(frozen=True, eq=False)
class Content:
    """Everything in a file, in its order, without the nesting.

    Attributes
    ----------
    blocks, texts, numbers
        By kind.
    foreign
        What else is there, in words.
    """

    blocks: tuple[NumberBlock, ...]
    texts: tuple[Text, ...]
    numbers: tuple[Number, ...]
    foreign: tuple[str, ...]


def flatten_nested(node: Node) -> Content:
    """Return everything beneath a node, without the nesting.

    Parameters
    ----------
    node
        The outermost one, as a format's library gives it.

    Returns
    -------
    Content
    """
    collected = _Collector([], [], [], [])
    waiting: list[tuple[Path, Node]] = [((), node)]
    while waiting:
        path, here = waiting.pop()
        if len(path) > DEEPEST:
            collected.foreign.append(f"{'.'.join(path[:3])}...: nested too deeply")
        else:
            waiting.extend(reversed(collected.take(path, here)))
    blocks, texts, numbers, foreign = collected
    return Content(tuple(blocks), tuple(texts), tuple(numbers), tuple(foreign))


class _Collector(NamedTuple):
    """What was collected so far."""

    blocks: list[NumberBlock]
    texts: list[Text]
    numbers: list[Number]
    foreign: list[str]

    def take(self, path: Path, node: Node) -> list[tuple[Path, Node]]:
        """Add what a node is, and return the nodes in it."""
        match node:
            case str():
                self.texts.append(Text(path, (node,)))
            case Numbers():
                self._numbers(path, node)
            case Foreign():
                self.foreign.append(f"{'.'.join(path)}: {node.what}")
            case np.ndarray():
                self._array(path, node)
            case Mapping():
                return [((*path, name), child) for name, child in node.items()]
            case Sequence():
                return self._list(path, node)
        return []

    def _list(self, path: Path, nodes: Sequence[Node]) -> list[tuple[Path, Node]]:
        words = tuple(node for node in nodes if isinstance(node, str))
        vectors = tuple(vector for node in nodes if (vector := _vector(node)) is not None)
        if words and len(words) == len(nodes):
            self.texts.append(Text(path, words))
        elif len(vectors) == len(nodes) > 1 and len({vector.shape for vector in vectors}) == 1:
            self.blocks.append(NumberBlock(path, vectors))
        elif len(nodes) == 1:
            return [(path, nodes[0])]
        else:
            return [((*path[:-1], f"{path[-1]}({index})"), node) for index, node in enumerate(nodes, 1)]
        return []

    def _array(self, path: Path, array: NDArray[Any]) -> None:
        if (other := non_numeric_kind(array.dtype)) is not None:
            self.foreign.append(f"{'.'.join(path)}: {other}")
        elif array.size == 1:
            self.numbers.append(Number(path, float(array.item())))
        else:
            self._numbers(path, wrap_array(array))

    def _numbers(self, path: Path, numbers: Numbers) -> None:
        if len(numbers.shape) > 2:
            self.foreign.append(f"{'.'.join(path)}: an array of {len(numbers.shape)} dimensions")
        elif all(numbers.shape):
            self.blocks.append(NumberBlock(path, numbers))


def non_numeric_kind(dtype: np.dtype[Any]) -> str | None:
    """Return what values are that are not real numbers; None for real numbers."""
    if dtype.kind in "fiub":
        return None
    return "complex numbers" if dtype.kind == "c" else f"values of type {dtype}"


def wrap_array(array: NDArray[Any]) -> Numbers:
    """Return numbers in memory as `Numbers`.

    Parameters
    ----------
    array
        Of real numbers, any shape.
    """
    flat = array.reshape([side for side in array.shape if side != 1] or [1])

    def along(side: int) -> list[Samples]:
        store = store_in_memory(np.atleast_2d(flat if side == flat.ndim - 1 else flat.T))
        return [Samples(store, column) for column in range(store.width)]

    return Numbers(flat.shape, along)


def _vector(node: Node) -> Numbers | None:
    if isinstance(node, Numbers):
        return node if len(node.shape) == 1 else None
    if (
        isinstance(node, np.ndarray)
        and non_numeric_kind(node.dtype) is None
        and node.size == max(node.shape, default=0) > 1
    ):
        return wrap_array(node)
    return None
