"""Common causes: one mistake in the campaign file that explains what would otherwise be many single faults.

Each hypothesis is one file: how it changes the campaign, and what it is called. All of them are judged by the same cheap
evidence first, the first motion of the body and the wheels after the release, and by one fit each only where several remain.
"""

from sprung.faults.common.search import Examined, examine, with_common_cause_corrected
from sprung.faults.common.statements import wrong_statement

__all__ = ["Examined", "examine", "with_common_cause_corrected", "wrong_statement"]
