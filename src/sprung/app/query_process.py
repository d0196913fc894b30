"""A process that answers short questions: forms, sketches and pictures of recordings, one JSON document in each line.

``python -P -m sprung.app.query_process`` reads ``{"question": "module:function", "arguments": {...}}`` from standard input and
writes ``{"answer": ...}``, ``{"problems": [...]}`` or ``{"defect": ...}``. It ends when its standard input does, which is when
the server ends, also where it was killed.
"""

from __future__ import annotations

import importlib
import json
import os
import queue
import sys
import threading
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from sprung.app.job_process import SHARE, limit_memory, machine_memory
from sprung.errors import InputError


def main() -> None:
    """Answer questions until there are no more."""
    limit_memory(machine_memory() // SHARE)
    with os.fdopen(os.dup(1), "w", encoding="utf-8") as answers:
        os.dup2(2, 1)  # nothing that a library prints may be taken for an answer
        questions: queue.SimpleQueue[str] = queue.SimpleQueue()
        threading.Thread(target=_read, args=(questions,), daemon=True).start()
        while True:
            # ASCII: no text of a file may end the line.
            answers.write(json.dumps(answer(json.loads(questions.get()))) + "\n")
            answers.flush()


def answer(request: Mapping[str, Any]) -> dict[str, Any]:
    """Return the answer to one question.

    Parameters
    ----------
    request
        ``question``, a function of this room as ``module:function``, and its ``arguments``.
    """
    module, _, function = request["question"].partition(":")
    try:
        found = getattr(importlib.import_module(f"sprung.app.{module}"), function)(**request["arguments"])
    except InputError as error:
        return {"problems": [asdict(problem) for problem in error.problems]}
    except Exception as error:  # noqa: BLE001 (the next question must be answered)
        return {"defect": f"{type(error).__name__}: {error}"}
    return {"answer": found}


def _read(questions: queue.SimpleQueue[str]) -> None:
    """Pass on every line of standard input; end the process, whatever it computes, at its end."""
    for line in sys.stdin:
        questions.put(line)
    os._exit(0)


if __name__ == "__main__":
    main()
