"""The first stage: from recordings to decays, after the campaign's statements are compared with what is recorded."""

from __future__ import annotations

from dataclasses import replace

from sprung.analysis.analysis import Analysis
from sprung.analysis.on_pads import require_linear_terms
from sprung.errors import InputError, Problem
from sprung.faults import examine
from sprung.preprocess import Prepared, exclude_drops, prepare
from sprung.progress import Progress, Step


def preprocess(run: Analysis, progress: Progress) -> Analysis:
    """Find the decays, correct statements that the first motion contradicts, and leave drops out."""
    if run.preparations == 0:
        progress(Step("comparing the drops with the campaign file"))
        campaign, prepared, undeclared = examine(run.campaign, progress)
        is_corrected = campaign is not run.campaign
        run = replace(
            run,
            campaign=campaign,
            preprocessed=campaign,
            excluded=undeclared,
            suspected=tuple(dict.fromkeys(undeclared.values())),
            preparation=prepared,
            preparations=1 + is_corrected,
        )
        if is_corrected:
            run = run.noted("preprocess", f"corrected {campaign.faults[-1].where}", campaign.faults[-1].what)
    elif run.preparation is None:
        run = replace(run, preparation=prepare(run.campaign, progress), preparations=run.preparations + 1)
    prepared = exclude_drops(run.campaign, run.prepared, run.excluded)
    _require_decays(run, prepared)
    require_linear_terms(replace(run, preparation=prepared))
    what = f"{len(prepared.decays)} of {len(run.campaign.drops)} drops can be used"
    reasons = "; ".join(f"{where}: {fault.what}" for where, fault in run.excluded.items())
    return replace(run, preparation=prepared).noted("preprocess", what, reasons)


def _require_decays(run: Analysis, prepared: Prepared) -> None:
    if prepared.decays:
        return
    where = "campaign" if run.campaign.path is None else run.campaign.path.name
    none = Problem(where, "no drop that can be used", "at least one", "Read the reasons below and record again.")
    reasons = (fault.as_problem("a usable decay") for _, faults in prepared.left_out for fault in faults)
    raise InputError([none, *reasons])
