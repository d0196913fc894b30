"""What formats of nested names hold, structs in structs or groups in groups, brought into one plain form."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

DEEPEST = 32
"""How many names may lie within each other; recordings need a handful."""

Node: TypeAlias = "Mapping[str, Node] | Sequence[Node] | NDArray[Any] | Moments | Foreign | str"
"""Something that stands in a file: more names, a list, numbers, times, or text. Values of a thing that also has
attributes stand beside them under the empty name."""

Path: TypeAlias = tuple[str, ...]
"""The names that lead to something, outermost first."""


@dataclass(frozen=True, eq=False)
class Moments:
    """Numbers that the file itself declares to be times.

    Attributes
    ----------
    seconds
        Shape (time,), s.
    """

    seconds: NDArray[np.float64]


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
class Block:
    """Numbers.

    Attributes
    ----------
    path
        The names that lead to them.
    values
        A vector, a matrix of which one side is time, or vectors of one length.
    moments
        Whether the file declares them to be times.
    """

    path: Path
    values: NDArray[Any] | tuple[NDArray[Any], ...]
    moments: bool = False


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

    blocks: tuple[Block, ...]
    texts: tuple[Text, ...]
    numbers: tuple[Number, ...]
    foreign: tuple[str, ...]


def content_of(node: Node) -> Content:
    """Gather what lies beneath a node.

    Parameters
    ----------
    node
        The outermost one, as a format's library gives it.

    Returns
    -------
    Content
    """
    gathered = _Gathered([], [], [], [])
    waiting: list[tuple[Path, Node]] = [((), node)]
    while waiting:
        path, here = waiting.pop()
        if len(path) > DEEPEST:
            gathered.foreign.append(f"{'.'.join(path[:3])}...: nested too deeply")
        else:
            waiting.extend(reversed(gathered.take(path, here)))
    blocks, texts, numbers, foreign = gathered
    return Content(tuple(blocks), tuple(texts), tuple(numbers), tuple(foreign))


class _Gathered(NamedTuple):
    """What was met so far."""

    blocks: list[Block]
    texts: list[Text]
    numbers: list[Number]
    foreign: list[str]

    def take(self, path: Path, node: Node) -> list[tuple[Path, Node]]:
        """Take up what a node is, and give what lies in it."""
        match node:
            case str():
                self.texts.append(Text(path, (node,)))
            case Moments():
                self.blocks.append(Block(path, node.seconds, moments=True))
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
        vectors = tuple(node.ravel() for node in nodes if isinstance(node, np.ndarray) and _is_vector(node))
        if words and len(words) == len(nodes):
            self.texts.append(Text(path, words))
        elif len(vectors) == len(nodes) > 1 and len({len(vector) for vector in vectors}) == 1:
            self.blocks.append(Block(path, vectors))
        elif len(nodes) == 1:
            return [(path, nodes[0])]
        else:
            return [((*path[:-1], f"{path[-1]}({index})"), node) for index, node in enumerate(nodes, 1)]
        return []

    def _array(self, path: Path, array: NDArray[Any]) -> None:
        flat = array.reshape([side for side in array.shape if side != 1] or [1])
        if array.dtype.kind not in "fiub":
            kind = "complex numbers" if array.dtype.kind == "c" else f"values of type {array.dtype}"
            self.foreign.append(f"{'.'.join(path)}: {kind}")
        elif flat.size == 1:
            self.numbers.append(Number(path, float(flat.item())))
        elif flat.ndim > 2:
            self.foreign.append(f"{'.'.join(path)}: an array of {flat.ndim} dimensions")
        elif flat.size:
            self.blocks.append(Block(path, flat))


def _is_vector(array: NDArray[Any]) -> bool:
    return array.dtype.kind in "fiub" and array.size == max(array.shape, default=0) > 1
