"""What a form of the page sends."""

from __future__ import annotations

from urllib.parse import parse_qsl

from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import Request

_MOST_FIELDS = 5000
"""Most fields of a form."""


class Form(dict[str, list[str]]):
    """The values of each field, in the order in which they were sent."""

    def text(self, name: str, default: str = "") -> str:
        """Return the first value of a field, without spaces around it."""
        return self.get(name, [default])[0].strip()


async def read_form(request: Request) -> Form:
    """Return the fields of a form (``application/x-www-form-urlencoded``).

    Raises
    ------
    HTTPException
        400 if it is none.
    """
    body = await request.body()
    try:
        return await run_in_threadpool(_form, body)  # others are answered while a large one is decoded
    except ValueError as error:
        raise HTTPException(400, "The fields of the form cannot be read.") from error


def _form(body: bytes) -> Form:
    form = Form()
    pairs = parse_qsl(body.decode("utf-8"), keep_blank_values=True, errors="strict", max_num_fields=_MOST_FIELDS)
    for name, value in pairs:
        form.setdefault(name, []).append(value.replace("\r\n", "\n"))
    return form
