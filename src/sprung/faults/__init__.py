"""When the records make no sense as they are: what, being otherwise, makes sense of them, and what is done about it.

Everything that may be wrong is a hypothesis, and all of them compete on the same samples in one currency, the likelihood of
all records. A channel or a drop is left out and the rest is fitted; what was left out is then held against the vehicle that
explains the rest, which says what it is. Nothing is named on suspicion: a hypothesis has to explain the records, beyond
chance, and no other one may do so about as well.
"""

from sprung.faults.bench import Bench, without_looking_at_wheels
from sprung.faults.common.search import examine
from sprung.faults.common.statements import wrong_statement
from sprung.faults.competition import diagnose
from sprung.faults.hypotheses import Hypothesis
from sprung.faults.slowly import walking_slowly
from sprung.faults.suspicion import Suspicion, scores, suspicious

__all__ = [
    "Bench",
    "Hypothesis",
    "Suspicion",
    "diagnose",
    "examine",
    "scores",
    "suspicious",
    "walking_slowly",
    "without_looking_at_wheels",
    "wrong_statement",
]
