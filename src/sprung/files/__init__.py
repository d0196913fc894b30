"""Files are written whole or not at all, and only over files that sprung wrote itself."""

from sprung.files.atomic_write import atomic_write
from sprung.files.kinds import NO_RECORDINGS
from sprung.files.ownership import overwriting_problems
from sprung.files.recovery import new_token, recover, temporary_path

__all__ = [
    "NO_RECORDINGS",
    "atomic_write",
    "new_token",
    "overwriting_problems",
    "recover",
    "temporary_path",
]
