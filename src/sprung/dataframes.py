"""pandas is optional: only `to_dataframe` needs it."""

from __future__ import annotations

from importlib.util import find_spec


def require_pandas() -> None:
    """Check that pandas can be imported.

    Raises
    ------
    ImportError
        If it is not installed; the message says how to install it.
    """
    if find_spec("pandas") is None:
        raise ImportError('to_dataframe needs pandas, which is missing: pip install "sprung[pandas]"')
