"""Files are written whole or not at all, and only over files that sprung wrote itself."""

from sprung.files.atomic_write import atomic_write
from sprung.files.ownership import overwriting_problems

__all__ = [
    "atomic_write",
    "overwriting_problems",
]
