"""The table of model terms: what a vehicle may have beside the paper's linear seven degrees of freedom.

A new term is one row of `LINEAR_TERMS` or `NONLINEAR_TERMS`, its law and parameters in `sprung.vehicle`, and one test. Sizes
are ratios to what the term acts beside; usual sizes and their spread are those of road vehicles (Dixon, The Shock Absorber
Handbook, 2007; Gillespie, Fundamentals of Vehicle Dynamics, 1992; Reimpell, The Automotive Chassis, 2001), rounded. A size is
negligible where leaving the term out moves no other parameter by more than about one percent
(tests/selection/test_practical_effect.py).
"""

from __future__ import annotations

from collections.abc import Mapping

from sprung.selection.linear_terms import LINEAR_TERMS
from sprung.selection.model_term import ModelTerm
from sprung.selection.nonlinear_terms import NONLINEAR_TERMS

TERMS: Mapping[str, ModelTerm] = {term.name: term for term in (*LINEAR_TERMS, *NONLINEAR_TERMS)}
"""Every term by its name, in the order in which they are listed."""
