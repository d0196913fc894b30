"""The pages of a campaign file: its form, its text, and both versions where it was changed meanwhile."""

from __future__ import annotations

import json
import shlex
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from markupsafe import Markup
from starlette.requests import Request
from starlette.responses import Response

from sprung.app.commands import arguments, as_typed
from sprung.app.queries import queries_of
from sprung.app.rendering import render
from sprung.app.result_files import default_results
from sprung.app.workspace import OutsideError, inside, parent_of
from sprung.errors import InputError, Problem


async def form_page(
    request: Request,
    name: str,
    view: Mapping[str, Any],
    version: str,
    original: str,
    focus: str,
    problems: tuple[Problem, ...] = (),
    meanwhile: bool = False,
) -> Response:
    """Return the page of a campaign file as a form.

    Parameters
    ----------
    request, name
        The request, and the name of the file.
    view
        As `sprung.app.form_view.form_view` returns it.
    version, original
        Version of the file that was read, and its text.
    focus
        Id of the input that has the focus; empty for none.
    problems
        Why what was asked for is not possible.
    meanwhile
        Whether saving replaces a version that was changed by others.
    """
    drawings = [{**each, "svg": Markup(each["svg"])} for each in view["sketch"]["drawings"]]  # noqa: S704 (escaped there)
    groups = view["form"]["groups"]
    return await _page(
        request,
        "campaign.html",
        name,
        version,
        original,
        view["text"],
        status=400 if view["unclear"] or problems else 200,
        form=view["form"],
        sections={
            kind: [group for group in groups if group["section"] == kind]
            for kind in ("vehicle", "known", "sensor", "load", "drop", "model", "test")
        },
        unclear=view["unclear"],
        refused=view["refused"],
        sketch={**view["sketch"], "drawings": drawings},
        sentence=sentence,
        group_sentence=group_sentence,
        state=state_sentence(view["form"]["faulty"], view["form"]["missing"]),
        focus=focus,
        problems=problems,
        meanwhile=meanwhile,
    )


async def text_page(
    request: Request,
    name: str,
    text: str,
    version: str,
    original: str,
    problems: tuple[Problem, ...] = (),
    meanwhile: bool = False,
) -> Response:
    """Return the page of a campaign file as text; the parameters are those of `form_page`."""
    try:
        path = str(request.app.state.workspace.path(name))
        view = await queries_of(request).ask("form", "form_view:text_view", path=path, text=text)
        found, missing = view["problems"], view["missing"]
        state = state_sentence(len(found), len(missing))
    except InputError as error:
        found, missing, state = [asdict(problem) for problem in error.problems], [], UNREADABLE
        problems = tuple(problem for problem in problems if problem not in error.problems)
    return await _page(
        request,
        "campaign_text.html",
        name,
        version,
        original,
        text,
        status=400 if problems else 200,
        refusals=problems,
        problems=found,
        gaps=missing,
        state=state,
        meanwhile=meanwhile,
    )


async def _page(
    request: Request,
    template: str,
    name: str,
    version: str,
    original: str,
    text: str,
    status: int = 200,
    **context: Any,
) -> Response:
    workspace = request.app.state.workspace
    commands, outside = [f"$EDITOR {shlex.quote(name)}"], ""
    try:
        output = default_results(workspace, name)
        own = None if output == inside(parent_of(name), "results") else output
        outputs = {"check": None, "identify": own, "plan": None}
        commands += [as_typed(arguments(workspace, command, name, output=o)) for command, o in outputs.items()]
    except OutsideError as error:  # it can be mended here, but not be run
        outside = str(error)
    return render(
        request,
        template,
        status,
        campaign=name,
        version=version,
        base=json.dumps(text),  # line ends of a form are changed by browsers, those in JSON are not
        original=json.dumps(original),
        text=text,
        diff=await difference_of(request, original, text),
        lines=commands,
        outside=outside,
        saved="saved" in request.query_params,
        **context,
    )


async def conflict_page(request: Request, name: str, text: str) -> Response:
    """Return the page of both versions: the file as it is now, and what was to be saved."""
    now, version = request.app.state.workspace.read_text(name)
    return render(
        request,
        "conflict.html",
        409,
        campaign=name,
        version=version,
        original=json.dumps(now),
        text=text,
        now=now,
        diff=await difference_of(request, now, text),
    )


def focus_after(action: str, view: Mapping[str, Any]) -> str:
    """Return the input that is to have the focus after a button was pressed."""
    verb, _, what = action.partition(" ")
    kind, _, rest = what.partition(" ")
    groups = [group["name"] for group in view["form"]["groups"]]
    if verb == "add" and kind in {"sensor", "load", "drop"}:
        name = max((g for g in groups if g.startswith(f"{kind}.")), key=lambda g: int(g.split(".")[1]), default="")
        return f"{name}.{'channel' if kind == 'sensor' else 'name' if kind == 'load' else 'file'}"
    if verb == "add" and kind == "known":
        return f"known.{rest}.value"
    if verb == "add" and kind == "item":
        group = next((group for group in view["form"]["groups"] if group["name"] == rest), None)
        return f"{group['items'][-1]['name']}.mass.value" if group and group["items"] else ""
    if verb != "remove":
        return ""
    left = [each for group in view["form"]["groups"] for each in group["fields"] if each["name"] == what]
    if left:  # a field that is empty now
        return str(left[0]["parts"][0]["name"])
    load, item, _ = what.partition(".items.")
    return f"add-item-{load}" if item else f"add-{what.split('.')[0]}"


def sentence(problem: Mapping[str, str]) -> str:
    """Return a problem beside its field as a sentence."""
    return f"Found {problem['found']}; expected {problem['expected']}. {problem['do']}"


def group_sentence(problem: Mapping[str, str]) -> str:
    """Return a problem of several fields together as a sentence: what they say is seen, not found as a table of the file."""
    return problem["do"] if problem["found"].startswith("{") else sentence(problem)


UNREADABLE = "The file cannot be read. What is missing in it is known once this is corrected."
"""How complete a campaign is that is no TOML."""


def state_sentence(problems: int, gaps: int) -> str:
    """Return how complete a campaign is.

    Examples
    --------
    >>> state_sentence(1, 7), state_sentence(0, 0)
    ('1 problem; 7 places to be filled in.', 'No problems; nothing is missing.')
    """
    wrong = f"{problems} problem{'s' if problems > 1 else ''}" if problems else "No problems"
    missing = f"{gaps} place{'s' if gaps > 1 else ''} to be filled in" if gaps else "nothing is missing"
    return f"{wrong}; {missing}."


async def difference_of(request: Request, old: str, new: str) -> list[str]:
    """Return the lines of a file that are changed; the server answers others while two long texts are compared."""
    if old == new:
        return []
    lines: list[str] = await queries_of(request).ask("form", "text_difference:difference", old=old, new=new)
    return lines
