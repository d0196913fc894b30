"""What a template is given."""

from __future__ import annotations

from typing import Any, TypeAlias

Context: TypeAlias = dict[str, Any]
"""By the names that the template uses."""
