"""Changes of a campaign file: only what is changed is written, and the file means afterwards what was asked for."""

from __future__ import annotations

import difflib
import tomllib
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sprung.app.campaign_text import Change, apply_changes, quoted
from sprung.app.text_difference import difference as line_difference
from sprung.app.text_difference import with_line_ends
from sprung.app.toml_spans import Place, entries_by_place, scan
from sprung.errors import InputError

FILE = '''#:schema ./campaign.schema.json
schema = 1

# what was measured
[vehicle]   # by tape
name      = "Van \\u00b7 [7]"   # not a header: [[sensor]]
wheelbase = "TODO: m, front axle to rear axle, by tape"  # to come
motion_ratio = { spring_front = 0.70, damper_front = { value = 0.68, std = 0.010 } }
# cg_height = 0.9      # optional

[known]
total_mass = { value = 1194, std = 2 }  # on the scales

# One for each channel
[[sensor]]
# noise 0.05
channel = "body_fl"
on = "body"
position = [0.10,  0.580, # left
   0.50]   # above ground

[[sensor]]
channel = 'wheel "fl"'
on = "fl"

# Loads
[[load]]
name = """
sand # "no comment"
bags"""
items = [
  { mass = 235, position = [-1.2, 0.4, 1.1] },  # first
  { mass = 6.5, on = "fl" },
]

[[drop]]
file = "a.csv"

[[sensor]]
channel = "late"
on = "rr"
[[drop]]
file = "b.csv"
wheels = ["fl", "fr"]
'''


def changed(text: str, *changes: tuple[Place, str | None]) -> str:
    return apply_changes(text, [Change(place, value) for place, value in changes])


def difference(old: str, new: str) -> list[str]:
    lines = difflib.unified_diff(old.splitlines(), new.splitlines(), n=0, lineterm="")
    return [line for line in lines if not line.startswith(("---", "+++", "@@"))]


@pytest.mark.parametrize(
    ("place", "value", "expected"),
    [
        (
            ("vehicle", "wheelbase"),
            "{ value = 2.55, std = 0.005 }",
            [
                '-wheelbase = "TODO: m, front axle to rear axle, by tape"  # to come',
                "+wheelbase = { value = 2.55, std = 0.005 }  # to come",
            ],
        ),
        (
            ("sensor", 0, "position", 1),
            "0.60",
            ["-position = [0.10,  0.580, # left", "+position = [0.10,  0.60, # left"],
        ),
        (("sensor", 2, "on"), '"fr"', ['-on = "rr"', '+on = "fr"']),
        (("sensor", 1, "unit"), '"g"', ['+unit = "g"']),
        (("vehicle", "cg_height"), "0.9", ["+cg_height    = 0.9"]),
        (("sensor", 0, "on"), None, ['-on = "body"']),
        (
            ("load", 0, "items", 1),
            None,
            [
                "-  { mass = 235, position = [-1.2, 0.4, 1.1] },  # first",
                '-  { mass = 6.5, on = "fl" },',
                "+  { mass = 235, position = [-1.2, 0.4, 1.1] },",
            ],
        ),
        (
            ("load", 0, "items", 2),
            '{ mass = 3, on = "fr" }',
            ['-  { mass = 6.5, on = "fl" },', '+  { mass = 6.5, on = "fl" }, { mass = 3, on = "fr" },'],
        ),
        (
            ("known", "total_mass", "std"),
            None,
            [
                "-total_mass = { value = 1194, std = 2 }  # on the scales",
                "+total_mass = { value = 1194 }  # on the scales",
            ],
        ),
        (("drop", 1, "start"), "1.5", ["+start  = 1.5"]),
        (("drop", 2), 'file = "c.csv"', ["+", "+[[drop]]", '+file = "c.csv"']),
        (("test", "date"), "2026-11-22", ["+", "+[test]", "+date = 2026-11-22"]),
    ],
    ids=lambda value: ".".join(map(str, value)) if isinstance(value, tuple) else "",
)
def test_a_change_is_all_that_is_written(place: Place, value: str | None, expected: list[str]) -> None:
    assert difference(FILE, changed(FILE, (place, value))) == expected


def test_nothing_changed_is_the_same_file() -> None:
    assert apply_changes(FILE, []) == FILE


def test_every_value_can_be_replaced_and_removed() -> None:
    for place, value in entries_by_place(scan(FILE)).items():
        assert FILE[value.start : value.end].strip() == FILE[value.start : value.end]
        replaced = changed(FILE, (place, '"other"'))
        assert _at(tomllib.loads(replaced), place) == "other"
        assert len(difference(FILE, replaced)) <= 2 + FILE.count("\n", value.start, value.end)
        removed = tomllib.loads(changed(FILE, (place, None)))
        assert removed != tomllib.loads(FILE)


def test_every_section_can_be_removed_with_the_comments_of_others_kept() -> None:
    for kind, count in (("sensor", 3), ("load", 1), ("drop", 2)):
        for index in range(count):
            new = changed(FILE, ((kind, index), None))
            assert len(tomllib.loads(new).get(kind, [])) == count - 1
            for comment in ("# One for each channel", "# Loads", "# by tape", "# cg_height"):
                assert comment in new


def test_a_load_stands_before_the_drops_and_a_sensor_before_the_loads() -> None:
    text = changed(
        '[vehicle]\nname = "a"\n\n# drops\n[[drop]]\nfile = "a.csv"\n',
        (("load", 0), 'name = "b"\nadded = { mass = 3 }'),
    )
    assert (
        text
        == '[vehicle]\nname = "a"\n\n[[load]]\nname = "b"\nadded = { mass = 3 }\n\n# drops\n[[drop]]\nfile = "a.csv"\n'
    )
    text = changed(text, (("sensor", 0), 'channel = "c"\non = "fl"'))
    assert text.index("[[sensor]]") < text.index("[[load]]") < text.index("# drops")


def test_an_empty_file_takes_everything() -> None:
    text = changed("", (("vehicle", "name"), '"a"'), (("known", "total_mass"), "5"), (("drop", 0), 'file = "x.csv"'))
    assert tomllib.loads(text) == {"vehicle": {"name": "a"}, "known": {"total_mass": 5}, "drop": [{"file": "x.csv"}]}


def test_windows_line_ends_and_a_byte_order_mark_remain() -> None:
    text = "\ufeff" + FILE.replace('"""\nsand # "no comment"\nbags"""', '"x"').replace("\n", "\r\n")
    new = changed(text, (("sensor", 1, "unit"), '"g"'))
    assert new.startswith("\ufeff#:schema")
    assert new.count("\n") == new.count("\r\n") == text.count("\r\n") + 1


def test_sub_sections_and_dotted_keys() -> None:
    text = 'vehicle.name = "a"\n[[load]]\nname = "b"\n[[load.items]]\nmass = 3\non = "fl"\n'
    text += '[load.extra]\nx.y = 1 # c\n[[load]]\nname = "c"\n'
    new = changed(
        text,
        (("load", 0, "items", 0, "mass"), "4"),
        (("load", 0, "extra", "x", "y"), "2"),
        (("vehicle", "name"), '"d"'),
    )
    assert difference(text, new) == [
        '-vehicle.name = "a"',
        '+vehicle.name = "d"',
        "-mass = 3",
        "+mass = 4",
        "-x.y = 1 # c",
        "+x.y = 2 # c",
    ]
    assert tomllib.loads(changed(text, (("load", 0), None))) == {"vehicle": {"name": "a"}, "load": [{"name": "c"}]}


def test_what_cannot_be_changed_is_refused_and_not_spoilt() -> None:
    with pytest.raises(InputError, match=r"sensor\[9\].unit: found no such entry"):
        changed(FILE, (("sensor", 8, "unit"), '"g"'))
    with pytest.raises(InputError, match="TOML"):
        changed(FILE, (("vehicle", "name"), "1\n[known]"))
    split = "[[load]]\nname = 'b'\n[[load.items]]\nmass = 3\n"
    with pytest.raises(InputError, match="Change it in the text"):
        changed(split, (("load", 0, "items", 1), "{ mass = 4 }"))


KEYS = st.sampled_from(["a", "b-c", "ä ö", 'q"', "x.y", "]"])
SCALARS = st.one_of(
    st.integers(-5, 5).map(str),
    st.sampled_from(
        ["1.50", "true", "2026-11-22", "1979-05-27 07:32:00", "'lit # [x]'", '"""a\n"" b"""', "'''c\n'''", "inf"]
    ),
    st.text("ab\"\\#[]{}=,' \t", max_size=6).map(quoted),
)
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.one_of(
        st.lists(inner, max_size=3).map(lambda parts: "[" + ", # c\n".join(parts) + "]"),
        st.dictionaries(KEYS, inner.filter(lambda part: "\n" not in part), max_size=3).map(
            lambda parts: "{ " + ", ".join(f"{quoted(key)} = {value}" for key, value in parts.items()) + " }"
        ),
    ),
    max_leaves=5,
)
SECTIONS = st.lists(
    st.tuples(st.sampled_from(["vehicle", "known", "sensor", "drop"]), st.dictionaries(KEYS, VALUES, max_size=3)),
    max_size=5,
)


@given(SECTIONS, st.data())
def test_any_value_of_any_document(parts: list[tuple[str, dict[str, str]]], data: Any) -> None:
    lines: list[str] = []
    for number, (name, entries) in enumerate(parts):
        once = name in {"vehicle", "known"}
        if once and any(name == other for other, _ in parts[:number]):
            continue
        lines += [f"# about {number}", f"[{name}]  # h" if once else f"[[ {name} ]]", ""]
        lines += [f"  {quoted(key)}\t= {value}  # v" for key, value in entries.items()]
    text = "\n".join(lines)
    values = entries_by_place(scan(text))
    assert sorted(map(str, values)) == sorted(map(str, _places(tomllib.loads(text))))
    if values:
        place = data.draw(st.sampled_from(sorted(values, key=str)))
        new = changed(text, (place, data.draw(VALUES.filter(lambda value: "\n" not in value))))
        assert new.count("# about") == text.count("# about")
        changed(text, (place, None))


def _places(node: Any, place: Place = ()) -> list[Place]:
    """All places of values, without sections and their entries in double brackets."""
    items = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    found = [inner for key, value in items for inner in _places(value, (*place, key))]
    is_section = len(place) < 2 or (len(place) == 2 and isinstance(place[1], int))
    return found if is_section else [place, *found]


def _at(node: Any, place: Place) -> Any:
    for part in place:
        node = node[part]
    return node


def test_a_long_file_is_compared_quickly() -> None:
    """Where every line is the same, a whole comparison takes a time that grows with the third power of their number."""
    import time  # noqa: PLC0415

    file = "# about nothing\n" * 31_000  # the largest that is read
    began = time.process_time()
    assert line_difference(file, f"{file}end = 1\n") == ["@@ -31000,1 +31000,2 @@", " # about nothing", "+end = 1"]
    both = line_difference(f"a = 1\n{file}b = 1\n", f"a = 2\n{file}b = 2\n")
    assert both[1:3] == ["-a = 1", "-# about nothing"]
    assert len(both) < 1100
    assert time.process_time() - began < 1.0


LINES = st.lists(st.sampled_from(["", "a", "b", "c"]), max_size=8)


@given(LINES, LINES, st.lists(st.booleans(), min_size=8, max_size=8))
def test_every_line_that_stays_keeps_its_end(old: list[str], new: list[str], ends: list[bool]) -> None:
    file = "".join(f"{line}\r\n" if end else f"{line}\n" for line, end in zip(old, ends, strict=False))
    text = "".join(f"{line}\n" for line in new)
    found = with_line_ends(text, file)
    assert found.replace("\r\n", "\n") == text
    assert with_line_ends(file.replace("\r\n", "\n"), file) == file
    added = with_line_ends(f"{file}new\n".replace("\r\n", "\n"), file)
    assert added.startswith(file)
    shown = line_difference(file, found)
    assert shown == line_difference(file.replace("\r\n", "\n"), text)
    context = [line[1:] for line in shown if line[0] in " +"]
    assert all(line in new for line in context)
