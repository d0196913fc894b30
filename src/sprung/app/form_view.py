"""The page of a campaign as data: its text, the form of it, and the sketch; answered by a query process."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any

from sprung.app.campaign_form import CampaignForm, Field, Group, campaign_form
from sprung.app.campaign_text import Change, apply_changes
from sprung.app.form_actions import apply_action
from sprung.app.form_changes import understand, with_problems
from sprung.app.form_fields import Spec
from sprung.app.load_description import superseded
from sprung.campaign import Campaign, parse_toml
from sprung.errors import InputError, record_failure
from sprung.report import sketch_svg, vehicle_sketch


def ready() -> bool:
    """Return True, once this module with all that it needs has been loaded."""
    return True


def form_view(
    path: str, text: str, entered: Mapping[str, Sequence[str]] | None = None, action: str = ""
) -> dict[str, Any]:
    """Return a campaign file with what was entered in its form.

    Parameters
    ----------
    path
        Of the file; absolute.
    text
        Of the file as the form was made from it.
    entered
        Values by the names of the inputs; None where nothing was entered.
    action
        Button of the form that adds or removes something; empty for none.

    Returns
    -------
    dict
        ``text`` with the changes; ``form``, its groups and fields; ``unclear``, the number of inputs that were not understood;
        ``sketch``, two drawings, their legend and what is unknown.

    Raises
    ------
    InputError
        If the text is no TOML, or the action is not possible.
    """
    place = Path(path)
    parse_toml(text.removeprefix("\ufeff"), place)
    unclear = {}
    refused: list[str] = []
    if entered is not None:
        understood = understand(campaign_form(text, place)[0], entered)
        unclear = dict(understood.problems)
        text, refused = _with(text, understood.changes)
        needless = tuple(superseded(parse_toml(text.removeprefix("\ufeff"), place), understood.changes))
        text, refused_too = _with(text, needless)
        refused += refused_too
    if action and not unclear:
        text = apply_action(text, action)
    form, checked = campaign_form(text, place)
    if entered is not None:
        form = with_problems(form, entered, unclear)
    return {
        "text": text,
        "form": _document(form),
        "unclear": len(unclear) + len(refused),
        "refused": refused,
        "sketch": sketch(checked.campaign),
    }


def _with(text: str, changes: Iterable[Change]) -> tuple[str, list[str]]:
    """Return a text with those changes that can be made, and why the others cannot."""
    refused: list[str] = []
    for change in changes:
        try:
            text = apply_changes(text, [change])
        except InputError as error:  # an entry that is written in a way that only its author can change
            refused += [str(problem) for problem in error.problems]
    return text, refused


def text_view(path: str, text: str) -> dict[str, Any]:
    """Return the problems and gaps of a campaign file that is edited as text.

    Parameters
    ----------
    path
        Of the file; absolute.
    text
        As it was entered.

    Raises
    ------
    InputError
        If it is no TOML.
    """
    parse_toml(text.removeprefix("\ufeff"), Path(path))
    form, checked = campaign_form(text, Path(path))
    problems = list(form.problems)
    for group in form.groups:
        for part in (group, *group.items):
            problems += [*part.problems, *(problem for each in part.fields for problem in each.problems)]
    missing = [asdict(entry.problem) for entry in checked.missing]
    return {"problems": [asdict(problem) for problem in problems], "missing": missing}


def sketch(campaign: Campaign | None) -> dict[str, Any]:
    """Return the sketch of a campaign as SVG elements.

    Parameters
    ----------
    campaign
        Without drops; None where nothing can be drawn.
    """
    found: dict[str, Any] = {"drawings": [], "key": "", "unknown": []}
    if campaign is not None:
        omissions: list[str] = []
        with record_failure(omissions, "The sketch"):
            drawn = vehicle_sketch(campaign)
            found = {
                "drawings": [{"title": each.title, "svg": sketch_svg(each, movable=True)} for each in drawn.drawings],
                "key": drawn.key,
                "unknown": list(drawn.unknown),
            }
        found["unknown"] += omissions
    return found


def _document(form: CampaignForm) -> dict[str, Any]:
    """Return a form as data for the template and the script of its page."""
    return {
        "groups": [_group_document(group) for group in form.groups],
        "problems": [asdict(problem) for problem in form.problems],
        "missing": form.missing,
        "faulty": form.faulty,
        "addable": form.addable,
        "where": list(_where(form)),
    }


def _where(form: CampaignForm) -> Iterator[dict[str, str]]:
    """Yield every place with a problem or a gap: the id of an element of the page, and its name."""
    for group in form.groups:
        for part in (group, *group.items):
            title = group.title if part is group else f"{group.title}, {part.title}"
            if part.problems or part.gaps:
                yield {"id": f"problem-{part.name}", "text": title}
            for each in part.fields:
                if each.problems or each.missing:
                    yield {"id": _first_input(each), "text": f"{title}, {each.spec.label}"}


def _first_input(each: Field) -> str:
    return next((part.name for part in each.parts), each.name)


def _group_document(group: Group) -> dict[str, Any]:
    return {
        "name": group.name,
        "section": group.section,
        "title": group.title,
        "fields": [_field_document(each) for each in group.fields],
        "items": [_group_document(item) for item in group.items],
        "problems": [asdict(problem) for problem in group.problems],
        "gaps": group.gaps,
    }


def _field_document(each: Field) -> dict[str, Any]:
    return {
        "name": each.name,
        "spec": _spec_document(each.spec),
        "parts": [{"name": part.name, "label": part.label, "value": part.value} for part in each.parts],
        "choices": each.choices,
        "chosen": each.chosen,
        "missing": each.missing,
        "may_be_left_out": each.may_be_left_out,
        "problems": [asdict(problem) for problem in each.problems],
        "stated": each.stated,
        "folded": each.is_folded,
    }


@cache
def _spec_document(spec: Spec) -> dict[str, Any]:
    return asdict(spec)  # the same for hundreds of fields
