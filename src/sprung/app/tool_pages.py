"""What the pages of commands share: a form starts a job, and the same page shows what the job found."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any
from urllib.parse import urlencode

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from sprung.app.commands import as_typed, start
from sprung.app.decimals import number_literal
from sprung.app.jobs import Job
from sprung.app.rendering import render
from sprung.errors import InputError, Problem, Problems


def show_tool(request: Request, template: str, *, problems: Iterable[Problem] = (), **context: Any) -> Response:
    """Answer with the page of a command: its form, and the job that its address names.

    Parameters
    ----------
    request
        The request; ``?job=ID`` names a job.
    template
        Of the page.
    problems
        Of the form, which was not sent on.
    **context
        Variables of the template.
    """
    job = job_of(request)
    found = tuple(problems)
    common = {
        "job": job,
        "query": request.query_params,
        "problems": found,
        "typed": [] if job is None else [as_typed(job.arguments)],
        "again": f"{request.url.path}?{request.url.query}",
    }
    return render(request, template, 400 if found else 200, **common, **context)


def start_tool(
    request: Request, arguments: Sequence[str], title: str, query: Mapping[str, str | Sequence[str]]
) -> Response:
    """Start a command, and answer with a redirection to its page, whose address then names the job.

    Parameters
    ----------
    request
        The request, whose path is that of the page.
    arguments
        Of the command.
    title
        What it does, for people.
    query
        What the page is about, and the fields of the form, so that the page shows them again.
    """
    state = request.app.state
    job = start(state.jobs, state.workspace, arguments, title)
    return RedirectResponse(f"{request.url.path}?{urlencode({**query, 'job': job.id}, doseq=True)}", 303)


def job_of(request: Request) -> Job | None:
    """Return the job that an address names; None if it names none, or one that is forgotten."""
    try:
        job: Job = request.app.state.jobs.get(request.query_params["job"])
    except KeyError:
        return None
    return job


def document_of(job: Job | None) -> Any:
    """Return what a job printed as JSON; None while it has not ended, or if it failed."""
    if job is None or job.state != "done":
        return None
    try:
        return json.loads(job.output)
    except ValueError:
        return None


def required(request: Request, name: str) -> str:
    """Return a parameter of the address.

    Raises
    ------
    HTTPException
        400 if it is missing.
    """
    if name not in request.query_params:
        raise HTTPException(400, f"The address names no {name}. Open it from the page of the folder.")
    return request.query_params[name]


def required_campaign(request: Request) -> str:
    """Return the campaign file that an address names; it exists.

    Raises
    ------
    HTTPException
        400 if none is named, or one that is none; 404 if it does not exist.
    """
    name = campaign_name(request)
    if not request.app.state.workspace.path(name).is_file():
        raise HTTPException(404, f"There is no file {name}. Draft it from the recordings on the page of the folder.")
    return name


def campaign_name(request: Request) -> str:
    """Return the name of the campaign file in an address; no recording can be opened, or overwritten, as one.

    Raises
    ------
    HTTPException
        400 if it is missing, or not that of a campaign file.
    """
    name = required(request, "campaign")
    if not name:
        raise HTTPException(400, "The address names no campaign. Open it from the page of the folder.")
    if not name.endswith(".toml"):
        raise HTTPException(400, f"{name} is no campaign file, whose name ends in .toml.")
    return name


def read_number(text: str, where: str, low: float, high: float, what: str) -> float | None:
    """Return the number in a field; its decimals may follow a point or a comma.

    Parameters
    ----------
    text
        As it was typed; blank for none.
    where
        Label of the field.
    low, high
        Limits, in the unit of the field.
    what
        What is expected, with the unit, such as ``a speed from 1 to 400 km/h``.

    Raises
    ------
    InputError
        If it is no number, or beyond the limits.

    Examples
    --------
    >>> read_number("72,5", "Speed", 1, 400, "a speed from 1 to 400 km/h")
    72.5
    """
    return _checked_number(text.strip(), where, low, high, what, "Write one number, such as 1.5 or 1,5.")


def _checked_number(text: str, where: str, low: float, high: float, what: str, do: str) -> float | None:
    if not text:
        return None
    literal = number_literal(text)
    number = float("nan" if literal is None else literal)
    if not low <= number <= high:
        raise InputError([Problem(where, f"'{text}'", what, do)])
    return number


def read_numbers(text: str, where: str, low: float, high: float, what: str) -> tuple[float, ...]:
    """Return the numbers in a field, separated by blanks or semicolons.

    Raises
    ------
    InputError
        As for `read_number`, with every reason.

    Examples
    --------
    >>> read_numbers("50 72,5", "Speeds", 1, 400, "speeds from 1 to 400 km/h")
    (50.0, 72.5)
    """
    problems, found = Problems(), []
    for part in text.replace(";", " ").split():
        with problems.collect():
            number = _checked_number(
                part, where, low, high, what, "Write numbers with blanks between them, such as 50 72,5."
            )
            if number is not None:
                found.append(number)
    if problems:
        raise InputError(problems)
    return tuple(found)
