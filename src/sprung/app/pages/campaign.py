"""The page of a campaign: its file as a form or as text, checked while somebody writes, saved unless it changed meanwhile."""

from __future__ import annotations

import json
import shlex
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any
from urllib.parse import urlencode

from markupsafe import Markup
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import JSONResponse, RedirectResponse, Response
from starlette.routing import Route

from sprung.app.commands import arguments, as_typed
from sprung.app.forms import Form, read_form
from sprung.app.queries import queries_of
from sprung.app.rendering import render, wants_page
from sprung.app.result_files import default_results
from sprung.app.text_difference import with_line_ends
from sprung.app.tool_pages import campaign_name, required
from sprung.app.workspace import NEW, ChangedError, OutsideError, Workspace, inside, parent_of
from sprung.errors import InputError, Problem


async def show(request: Request) -> Response:
    """Answer with the page of a campaign file, as its form or as text."""
    workspace: Workspace = request.app.state.workspace
    name = campaign_name(request)
    text, version = workspace.read_text(name)
    if version == NEW:
        raise HTTPException(404, f"There is no file {name}. Draft it from the recordings on the page of the folder.")
    if request.query_params.get("as") == "text":
        return await _text_page(request, name, text, version, text)
    try:
        view = await _form_view(request, name, text)
    except InputError as error:  # no TOML: only its text can be shown
        return await _text_page(request, name, text, version, text, error.problems)
    return await _form_page(request, name, view, version, text, request.query_params.get("focus", ""))


_SAVES = frozenset({"save", "save over"})
"""Buttons that save."""


async def change(request: Request) -> Response:
    """Save what was entered, or show the form again with what a button added or removed.

    A script, which does not ask for a page, learns only whether it was saved; if not, the browser asks again for the page that
    shows why.
    """
    name = campaign_name(request)
    form = await read_form(request)
    action, version, original = form.text("action", "save"), form.text("version"), _hidden_text(form, "original")
    if "text" in form:
        return await _change_text(request, name, form, action, version, original)
    if action == "add known":
        action += f" {form.text('quantity')}"
    if action not in _SAVES and not wants_page(request):
        return JSONResponse({"saved": False})
    return await _change_form(request, name, form, action, version, original)


async def _change_form(request: Request, name: str, form: Form, action: str, version: str, original: str) -> Response:
    save = action in _SAVES
    try:
        view = await _form_view(
            request, name, _hidden_text(form, "base"), form, "" if save or action == "as text" else action
        )
    except InputError as error:
        view = await _form_view(request, name, _hidden_text(form, "base"), form)
        return await _form_page(request, name, view, version, original, "", error.problems)
    meanwhile = "meanwhile" in form
    if action == "as text" and not view["unclear"]:
        return await _text_page(request, name, view["text"], version, original, meanwhile=meanwhile)
    problems: tuple[Problem, ...] = ()
    if save and not view["unclear"]:
        try:
            return await _save(request, name, view["text"], version)
        except InputError as error:
            if not wants_page(request):
                raise
            problems = error.problems
    elif save and not wants_page(request):
        return JSONResponse({"saved": False})
    focus = _focus(action, view)
    return await _form_page(request, name, view, version, original, focus, problems, meanwhile=meanwhile)


async def _save(request: Request, name: str, text: str, version: str, **query: str) -> Response:
    """Save a text, unless the file has changed meanwhile, which has a page of its own; a script stays on its page."""
    try:
        version = request.app.state.workspace.write_text(name, text, version)
    except ChangedError:
        return await _conflict(request, name, text) if wants_page(request) else JSONResponse({"saved": False})
    if wants_page(request):
        return RedirectResponse(f"/campaign?{urlencode({'campaign': name, **query, 'saved': 'yes'})}", 303)
    return JSONResponse({"saved": True, "version": version, "text": text})


async def live(request: Request) -> Response:
    """Answer with the problems, gaps and sketch of what was entered, without saving it."""
    name = campaign_name(request)
    form = await read_form(request)
    original = _hidden_text(form, "original")
    path = str(request.app.state.workspace.path(name))
    if "text" in form:
        state = ""
        text = _as_before(form.get("text", [""])[0], original)
        try:
            found = await queries_of(request).ask("form", "form_view:text_view", path=path, text=text)
        except InputError as error:
            found = {"problems": [asdict(problem) for problem in error.problems], "missing": []}
            state = _UNREADABLE
        state = state or state_sentence(len(found["problems"]), len(found["missing"]))
        return JSONResponse({**found, "state": state, "diff": await _difference(request, original, text)})
    view = await _form_view(request, name, _hidden_text(form, "base"), form)
    fields = {}
    groups = {}
    for group in view["form"]["groups"]:
        for part in (group, *group["items"]):
            groups[part["name"]] = {"problems": [*map(group_sentence, part["problems"])], "gaps": part["gaps"]}
            for each in part["fields"]:
                if each["problems"] or each["missing"]:
                    fields[each["name"]] = {
                        "problems": [*map(sentence, each["problems"])],
                        "missing": each["missing"],
                    }
    return JSONResponse(
        {
            "fields": fields,
            "groups": groups,
            "where": view["form"]["where"],
            "general": [*map(sentence, view["form"]["problems"]), *view["refused"]],
            "state": state_sentence(view["form"]["faulty"], view["form"]["missing"]),
            "sketch": view["sketch"],
            "diff": await _difference(request, original, view["text"]),
        }
    )


async def drop(request: Request) -> Response:
    """Answer with the picture of one drop's recording."""
    name = campaign_name(request)
    workspace: Workspace = request.app.state.workspace
    form = await read_form(request)
    index = required(request, "drop")
    found = await queries_of(request).ask(
        "recording",
        "drops_view:drop_view",
        path=str(workspace.path(name)),
        root=str(workspace.folder),
        text=_hidden_text(form, "base"),
        entered=_inputs(form),
        index=int(index) if index.isdecimal() and len(index) < 6 else -1,
    )
    return JSONResponse(found)


async def _change_text(request: Request, name: str, form: Form, action: str, version: str, original: str) -> Response:
    text = _as_before(form.get("text", [""])[0], original)
    meanwhile = "meanwhile" in form
    if action not in _SAVES and not wants_page(request):
        return JSONResponse({"saved": False})
    try:
        if action in _SAVES:
            return await _save(request, name, text, version, **{"as": "text"})
        view = await _form_view(request, name, text)
        return await _form_page(request, name, view, version, original, "", meanwhile=meanwhile)
    except InputError as error:
        if not wants_page(request):
            raise
        return await _text_page(request, name, text, version, original, error.problems, meanwhile=meanwhile)


async def _form_view(
    request: Request, name: str, text: str, form: Form | None = None, action: str = ""
) -> dict[str, Any]:
    path = str(request.app.state.workspace.path(name))
    entered = None if form is None else _inputs(form)
    view: dict[str, Any] = await queries_of(request).ask(
        "form", "form_view:form_view", path=path, text=text, entered=entered, action=action
    )
    return view


def _inputs(form: Form) -> dict[str, list[str]]:
    """Return the inputs of a form that are places in the file, which have a dot."""
    return {key: values for key, values in form.items() if "." in key}


async def _form_page(
    request: Request,
    name: str,
    view: Mapping[str, Any],
    version: str,
    original: str,
    focus: str,
    problems: tuple[Problem, ...] = (),
    meanwhile: bool = False,
) -> Response:
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


async def _text_page(
    request: Request,
    name: str,
    text: str,
    version: str,
    original: str,
    problems: tuple[Problem, ...] = (),
    meanwhile: bool = False,
) -> Response:
    """Answer with the text of the file; with reasons for which what was asked for is not possible, if there are some."""
    try:
        path = str(request.app.state.workspace.path(name))
        view = await queries_of(request).ask("form", "form_view:text_view", path=path, text=text)
        found, missing = view["problems"], view["missing"]
        state = state_sentence(len(found), len(missing))
    except InputError as error:
        found, missing, state = [asdict(problem) for problem in error.problems], [], _UNREADABLE
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
        diff=await _difference(request, original, text),
        lines=commands,
        outside=outside,
        saved="saved" in request.query_params,
        **context,
    )


async def _conflict(request: Request, name: str, text: str) -> Response:
    """Show both: the file as it is now, and what was to be saved."""
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
        diff=await _difference(request, now, text),
    )


def _focus(action: str, view: Mapping[str, Any]) -> str:
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


_UNREADABLE = "The file cannot be read. What is missing in it is known once this is corrected."


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


def _hidden_text(form: Form, name: str) -> str:
    """Return the text in a hidden field, which holds it as JSON."""
    try:
        text = json.loads(form.text(name) or '""')
    except ValueError as error:
        raise HTTPException(400, "The form is incomplete. Load the page again.") from error
    if not isinstance(text, str):
        raise HTTPException(400, "The form is incomplete. Load the page again.")
    return text


def _as_before(text: str, original: str) -> str:
    """Return a text from a text field with the line ends of the file and its byte order mark."""
    mark = "\ufeff" if original.startswith("\ufeff") else ""
    return mark + with_line_ends(text.removeprefix("\ufeff"), original.removeprefix(mark))


async def _difference(request: Request, old: str, new: str) -> list[str]:
    """Return the lines of a file that are changed; the server answers others while two long texts are compared."""
    if old == new:
        return []
    lines: list[str] = await queries_of(request).ask("form", "text_difference:difference", old=old, new=new)
    return lines


routes = (
    Route("/campaign", show),
    Route("/campaign", change, methods=["POST"]),
    Route("/campaign/live", live, methods=["POST"]),
    Route("/campaign/drop", drop, methods=["POST"]),
)
