"""The page of a campaign: its file as a form or as text, checked while somebody writes, saved unless it changed meanwhile."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Any
from urllib.parse import urlencode

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import JSONResponse, RedirectResponse, Response
from starlette.routing import Route

from sprung.app.campaign_pages import (
    UNREADABLE,
    conflict_page,
    difference_of,
    focus_after,
    form_page,
    group_sentence,
    sentence,
    state_sentence,
    text_page,
)
from sprung.app.forms import Form, read_form
from sprung.app.queries import queries_of
from sprung.app.rendering import wants_page
from sprung.app.text_difference import with_line_ends
from sprung.app.tool_pages import campaign_name, required
from sprung.app.workspace import NEW, ChangedError, Workspace
from sprung.errors import InputError, Problem


async def show(request: Request) -> Response:
    """Answer with the page of a campaign file, as its form or as text."""
    workspace: Workspace = request.app.state.workspace
    name = campaign_name(request)
    text, version = workspace.read_text(name)
    if version == NEW:
        raise HTTPException(404, f"There is no file {name}. Draft it from the recordings on the page of the folder.")
    if request.query_params.get("as") == "text":
        return await text_page(request, name, text, version, text)
    try:
        view = await _form_view(request, name, text)
    except InputError as error:  # no TOML: only its text can be shown
        return await text_page(request, name, text, version, text, error.problems)
    return await form_page(request, name, view, version, text, request.query_params.get("focus", ""))


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
        return await form_page(request, name, view, version, original, "", error.problems)
    meanwhile = "meanwhile" in form
    if action == "as text" and not view["unclear"]:
        return await text_page(request, name, view["text"], version, original, meanwhile=meanwhile)
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
    focus = focus_after(action, view)
    return await form_page(request, name, view, version, original, focus, problems, meanwhile=meanwhile)


async def _save(request: Request, name: str, text: str, version: str, **query: str) -> Response:
    """Save a text, unless the file has changed meanwhile, which has a page of its own; a script stays on its page."""
    try:
        version = request.app.state.workspace.write_text(name, text, version)
    except ChangedError:
        return await conflict_page(request, name, text) if wants_page(request) else JSONResponse({"saved": False})
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
            state = UNREADABLE
        state = state or state_sentence(len(found["problems"]), len(found["missing"]))
        return JSONResponse({**found, "state": state, "diff": await difference_of(request, original, text)})
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
            "diff": await difference_of(request, original, view["text"]),
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
        return await form_page(request, name, view, version, original, "", meanwhile=meanwhile)
    except InputError as error:
        if not wants_page(request):
            raise
        return await text_page(request, name, text, version, original, error.problems, meanwhile=meanwhile)


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


routes = (
    Route("/campaign", show),
    Route("/campaign", change, methods=["POST"]),
    Route("/campaign/live", live, methods=["POST"]),
    Route("/campaign/drop", drop, methods=["POST"]),
)
