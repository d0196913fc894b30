"""From named vectors, matrices, texts and numbers to one table, for every format with such content."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sprung.errors import InputError, Problem
from sprung.formats.interpolation import MIN_RATE
from sprung.formats.metadata import MetadataScope, split_list
from sprung.formats.nested import Numbers, flatten_nested
from sprung.formats.resampling import ResampledChannel, resample
from sprung.formats.sample_store import join_samples
from sprung.formats.stated_rates import TIME_UNITS
from sprung.formats.table import SampleTable
from sprung.formats.vector_clock import Vector, VectorClock, find_vector_clock, time_name_unit
from sprung.units import split_unit

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path as File

    from sprung.formats.nested import Content, Node, NumberBlock, Path, Text
    from sprung.formats.sample_store import Samples


def table_from_nested(node: Node, file: File, do: str) -> SampleTable:
    """Return the recording in the content of a file as a table.

    It is made of the vectors of one length: of those with a time, or with a rate in the file, the ones that hold most
    samples together. Matrices count as so many vectors along their longer side, or along the time.

    Parameters
    ----------
    node
        What the file holds.
    file
        The file.
    do
        The remedy where it holds no vectors.

    Returns
    -------
    SampleTable
        Its notes state what was assumed, and what was left out.

    Raises
    ------
    InputError
        If there are no vectors of one length, or no clock among them.
    """
    content = flatten_nested(node)
    scope = MetadataScope(content)
    notes: list[str] = []
    every = _vectors(content, scope, notes)
    if not every:
        other = f" but {'; '.join(content.foreign[:5])}" if content.foreign else ""
        expected = "a time and at least one channel, as vectors of one length"
        raise InputError([Problem(file.name, f"no vectors of numbers{other}", expected, do)])
    vectors = _with_units(_recording(every), scope, notes)
    clock = find_vector_clock(vectors, content, scope, file.name)
    channels = [vector for vector in vectors if vector not in clock.taken]
    if not channels:
        found = f"only the time, {clock.taken[0].name}"
        raise InputError([Problem(file.name, found, "at least one channel of the same length", "Export it again.")])
    strays = [vector for vector in every if len(vector) != len(channels[0])]
    others = _on_other_clocks(strays, clock, len(channels[0]), content, scope, file.name)
    if others:
        read_too = ", ".join(vector.name for vector in others)
        notes.append(f"on another clock, interpolated to the times of the others: {read_too}")
    timed = {len(vector) for vector in others}
    left_out = [
        *(
            f"{vector.name} ({len(vector)} samples)"
            for vector in strays
            if vector.path not in {other.path for other in others} and not (len(vector) in timed and vector.is_time())
        ),
        *content.foreign,
    ]
    if left_out:
        more = f" and {len(left_out) - 8} more" if len(left_out) > 8 else ""
        notes.append(f"left out: {', '.join(left_out[:8])}{more}")
    return SampleTable(
        channels=_shortest([vector.called for vector in (*channels, *others)]),
        units=tuple(vector.unit for vector in (*channels, *others)),
        store=join_samples([*(vector.samples for vector in channels), *(samples for samples, _ in others.values())]),
        clock=clock.time,
        notes=(*clock.notes, *notes),
        resampled={number: how for number, (_, how) in enumerate(others.values(), len(channels))},
    )


def _on_other_clocks(
    strays: Sequence[Vector], clock: VectorClock, length: int, content: Content, scope: MetadataScope, file: str
) -> dict[Vector, tuple[Samples, ResampledChannel]]:
    """Read vectors of other lengths at the times of the recording, where they have a time of their own over the same span."""
    found: dict[Vector, tuple[Samples, ResampledChannel]] = {}
    times = clock.time if isinstance(clock.time, np.ndarray) else np.arange(length) / clock.time
    for other in sorted({len(vector) for vector in strays}):
        vectors = [vector for vector in strays if len(vector) == other]
        if not any(vector.is_time() for vector in vectors):
            continue
        vectors = _with_units(vectors, scope, [])
        try:
            own = find_vector_clock(vectors, content, scope, file)
        except InputError:  # whoever needs these will miss them
            continue
        if not isinstance(own.time, np.ndarray) or other - 1 < MIN_RATE * (own.time[-1] - own.time[0]):
            continue
        for vector in vectors:
            if vector not in own.taken and (
                read := resample(vector.samples, own.time, length, lambda a, b: times[a:b])
            ):
                found[vector] = read
    return found


def _vectors(content: Content, scope: MetadataScope, notes: list[str]) -> list[Vector]:
    """Return the vectors of all blocks with their names."""
    lengths = {shape[0] for block in content.blocks if len(shape := _shape(block)) == 1}
    called = Counter(scope.named_path(block.path) for block in content.blocks)
    vectors: list[Vector] = []
    for block in content.blocks:
        path = scope.named_path(block.path)
        path = path if called[path] == 1 else block.path
        columns = _columns(block, lengths, notes)
        if len(columns) == 1:
            paths: Sequence[Path] = [path]
        elif names := scope.column_names(block.path, len(columns)):
            paths = [(*path[:-1], name) for name in names]
        else:
            paths = [(*path[:-1], f"{''.join(path[-1:])}_{index}") for index in range(1, len(columns) + 1)]
        moments = isinstance(block.numbers, Numbers) and block.numbers.moments
        for full, samples in zip(paths, columns, strict=True):
            unit = time_name_unit(full[-1])
            name, unit = split_unit(full[-1]) if unit is None else (full[-1], unit)
            vectors.append(Vector(block.path, (*full[:-1], name), samples, unit or None, moments))
    return vectors


def _shape(block: NumberBlock) -> tuple[int, ...]:
    """Return the shape of a block; that of vectors of one length has two sides."""
    if isinstance(block.numbers, Numbers):
        return block.numbers.shape
    return (*block.numbers[0].shape, len(block.numbers))


def _columns(block: NumberBlock, lengths: set[int], notes: list[str]) -> Sequence[Samples]:
    """Return the vectors in a block: along the side of a matrix as long as another vector, otherwise along its longer one."""
    if not isinstance(block.numbers, Numbers):
        return [vector.along(0)[0] for vector in block.numbers]
    if len(block.numbers.shape) == 1:
        return block.numbers.along(0)
    down, across = block.numbers.shape
    if (down in lengths) == (across in lengths):
        if down == across:
            notes.append(f"{'.'.join(block.path)} is as wide as long; its columns are used as channels")
        upright = down >= across
    else:
        upright = down in lengths
    return block.numbers.along(0 if upright else 1)


def _recording(every: Sequence[Vector]) -> list[Vector]:
    """Return the vectors that have the length of the recording."""
    counts = Counter(len(vector) for vector in every)
    timed = {len(vector) for vector in every if vector.is_time()}
    timed = {length for length in timed if counts[length] > 1} or set(counts)
    length = max(timed, key=lambda length: (length * counts[length], length))
    return [vector for vector in every if len(vector) == length]


def _with_units(vectors: Sequence[Vector], scope: MetadataScope, notes: list[str]) -> list[Vector]:
    """Add the units that the file states beside the vectors, not in their names."""
    lists = scope.unit_lists()
    units: list[str | None] = []
    members: dict[Text, list[int]] = {}
    for index, vector in enumerate(vectors):
        units.append(vector.unit or ("s" if vector.moments else scope.unit_of(vector.path, vector.called[-1])))
        text = None if units[index] else scope.nearest(lists, vector.path)
        if text is not None:
            members.setdefault(text, []).append(index)
    for text, indices in members.items():
        words = split_list(text)
        times = [index for index in indices if vectors[index].is_time()]
        others = [index for index in indices if index not in times]
        if len(words) == 2 and words[0].lower() in TIME_UNITS and times:
            said = dict.fromkeys(times, words[0]) | dict.fromkeys(others, words[1])
        elif len(words) == len(indices):
            in_order = [*times, *others] if words[0].lower() in TIME_UNITS else indices
            said = dict(zip(in_order, words, strict=True))
        elif len(words) == len(others):
            said = dict(zip(others, words, strict=True))
        elif len(words) == 1:
            said = dict.fromkeys(times if times and words[0].lower() in TIME_UNITS else others, words[0])
        else:
            said = {}
            notes.append(f"{'.'.join(text.path)} names {len(words)} units for {len(indices)} vectors: left out")
        for index, unit in said.items():
            units[index] = unit.strip("[]() ") or None
    return [replace(vector, unit=unit) for vector, unit in zip(vectors, units, strict=True)]


def _shortest(paths: Sequence[Path]) -> tuple[str, ...]:
    """Return a unique name for each path, of as few of its last parts as possible."""
    counts = Counter(path[-depth:] for path in paths for depth in range(1, len(path) + 1))
    depths = (next((d for d in range(1, len(p)) if counts[p[-d:]] == 1), len(p)) for p in paths)
    return tuple(".".join(path[-depth:]) for path, depth in zip(paths, depths, strict=True))
