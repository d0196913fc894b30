"""What was entered in the form of a campaign, as changes of the file: numbers with a decimal comma or a decimal point."""

from __future__ import annotations

import datetime as dt
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from sprung.app.campaign_form import CampaignForm, Field, Group
from sprung.app.campaign_text import Change, quoted
from sprung.app.decimals import number_literal
from sprung.app.toml_spans import Place
from sprung.errors import Problem

_DATE = re.compile(r"(\d{4})-(\d{1,2})-(\d{1,2})|(\d{1,2})\.\s*(\d{1,2})\.\s*(\d{4})", re.ASCII)


@dataclass(frozen=True)
class Entered:
    """What was entered, understood.

    Attributes
    ----------
    changes
        Of the file.
    problems
        Of what could not be understood, by the name of the input; the file keeps what it says there.
    """

    changes: tuple[Change, ...]
    problems: Mapping[str, Problem] = field(default_factory=dict)


class _NotUnderstoodError(Exception):
    """An input that cannot be understood."""

    def __init__(self, name: str, found: str, expected: str, do: str) -> None:
        super().__init__(name)
        self.problem = Problem(name, found, expected, do)


def understand(form: CampaignForm, entered: Mapping[str, Sequence[str]]) -> Entered:
    """Return the changes that turn the file into what was entered.

    Parameters
    ----------
    form
        The form as it was shown.
    entered
        Values by the names of the inputs. An input that is not among them is unchanged; of several words those that are
        chosen, and an empty text that shows that the field was there.
    """
    changes: list[Change] = []
    problems: dict[str, Problem] = {}
    for each in form.fields():
        given = [_last(entered, part.name) for part in each.parts]
        if any(value is None for value in given):
            continue
        try:
            if each.kind == "several":
                changes += _several(each, entered[each.parts[0].name])
            else:
                changes += _changes(each, [value.strip() for value in given if value is not None])
        except _NotUnderstoodError as error:
            problems[str(error)] = error.problem
    changes += _renamed(form, changes)
    return Entered(tuple(_without_placeholders(changes, form.placeholders)), problems)


def _renamed(form: CampaignForm, changes: Sequence[Change]) -> Iterator[Change]:
    """Yield the changes by which drops keep a load that has a new name, unless another load was chosen for them."""
    changed = {change.place: change.value for change in changes}
    names = {each.place: each.parts[0].value for each in form.fields() if each.place[::2] == ("load", "name")}
    new = {
        old: changed[place] for place, old in names.items() if changed.get(place) and [*names.values()].count(old) == 1
    }
    for each in form.fields():
        if each.place[::2] == ("drop", "load") and each.place not in changed and each.parts[0].value in new:
            yield Change(each.place, new[each.parts[0].value])


def _without_placeholders(changes: Sequence[Change], placeholders: Collection[Place]) -> Iterator[Change]:
    """Yield changes, and before the first one within a text that stands for what is missing the removal of that text."""
    removed: set[Place] = set()
    for change in changes:
        around = (change.place[:depth] for depth in range(1, len(change.place)))
        for place in around:
            if place in placeholders and place not in removed:
                removed.add(place)
                yield Change(place, None)
        yield change


def _last(entered: Mapping[str, Sequence[str]], name: str) -> str | None:
    values = entered.get(name)
    return values[-1] if values else None


def _several(each: Field, words: Sequence[str]) -> Iterator[Change]:
    """Yield the change of a field of several words, in the order in which they are offered."""
    chosen = tuple(word for word in each.choices if word in words)
    if set(chosen) != set(each.chosen):
        none = not chosen and each.spec.key != "wheels"
        yield Change(each.place, None if none else f"[{', '.join(map(quoted, chosen))}]")


def _changes(each: Field, given: list[str]) -> Iterator[Change]:
    shown = [part.value.strip() for part in each.parts]
    if given == shown:
        return
    if not any(given):
        if each.stated and any(shown):
            yield Change(each.place, '""' if each.spec.required and each.kind == "text" else None)
        return
    match each.kind:
        case "measured":
            yield from _measured(each, given, shown)
        case "vector":
            yield from _vector(each, given, shown)
        case "number":
            yield Change(each.place, _number(each, 0, given[0]))
        case "date":
            yield Change(each.place, _date(each, given[0]))
        case "lines":
            lines = [quoted(line.strip()) for line in given[0].splitlines() if line.strip()]
            yield Change(each.place, f"[{', '.join(lines)}]")
        case _:
            is_flag = each.choices == ("true", "false")
            yield Change(each.place, given[0] if is_flag else quoted(given[0]))


def _measured(each: Field, given: list[str], shown: list[str]) -> Iterator[Change]:
    """Yield the changes of a value and its standard uncertainty: a number alone, or { value, std }."""
    value, std = given
    if not value:
        raise _NotUnderstoodError(
            each.parts[0].name,
            "a standard uncertainty without a value",
            "the value too",
            "Enter the value, or clear both.",
        )
    number = _number(each, 0, value)
    if not std and not shown[1]:
        yield Change((*each.place, "value") if each.is_table else each.place, number)
        return
    if not shown[1]:
        yield Change(each.place, f"{{ value = {number}, std = {_number(each, 1, std)} }}")
        return
    if value != shown[0]:
        yield Change((*each.place, "value"), number)
    if std != shown[1]:
        yield Change((*each.place, "std"), _number(each, 1, std) if std else None)


def _vector(each: Field, given: list[str], shown: list[str]) -> Iterator[Change]:
    numbers = [_number(each, index, text) if text else "" for index, text in enumerate(given)]
    if not all(numbers):
        index = numbers.index("")
        names = ", ".join(part.label for part in each.parts)
        raise _NotUnderstoodError(
            each.parts[index].name,
            f"no {each.parts[index].label}",
            f"{names}, all of them",
            "Enter the missing number.",
        )
    if all(shown):
        for index, (text, before) in enumerate(zip(given, shown, strict=True)):
            if text != before:
                yield Change((*each.place, index), numbers[index])
    else:
        yield Change(each.place, f"[{', '.join(numbers)}]")


def _number(each: Field, index: int, text: str) -> str:
    literal = number_literal(text)
    if literal is None:
        do = "Write it without thousands separators." if "," in text and "." in text else "Write digits only."
        raise _NotUnderstoodError(each.parts[index].name, f"'{text}'", "a number such as 2.55 or 2,55", do)
    return literal


def _date(each: Field, text: str) -> str:
    found = _DATE.fullmatch(text)
    try:
        if found is None:
            raise ValueError(text)
        year, month, day = (found[1], found[2], found[3]) if found[1] else (found[6], found[5], found[4])
        return dt.date(int(year), int(month), int(day)).isoformat()
    except ValueError:
        expected = "a day such as 2026-11-22 or 22.11.2026"
        raise _NotUnderstoodError(each.parts[0].name, f"'{text}'", expected, "Correct it.") from None


def with_problems(
    form: CampaignForm, entered: Mapping[str, Sequence[str]], problems: Mapping[str, Problem]
) -> CampaignForm:
    """Return a form that shows what could not be understood as it was entered, with the reasons.

    Parameters
    ----------
    form
        With all that was understood.
    entered
        Values by the names of the inputs.
    problems
        By the name of the input.
    """
    if not problems:
        return form

    def field_with(each: Field) -> Field:
        own = [problems[part.name] for part in each.parts if part.name in problems]
        if not own:
            return each
        parts = tuple(
            replace(part, value=_last(entered, part.name) or "") if part.name in entered else part
            for part in each.parts
        )
        return replace(each, parts=parts, problems=(*own, *each.problems))

    def group_with(group: Group) -> Group:
        return replace(group, fields=tuple(map(field_with, group.fields)), items=tuple(map(group_with, group.items)))

    return replace(form, groups=tuple(map(group_with, form.groups)), faulty=form.faulty + len(problems))
