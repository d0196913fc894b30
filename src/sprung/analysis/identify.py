"""From a campaign to a result."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from sprung.analysis.amplitude import amplitudes_of
from sprung.analysis.analysis import Analysis, AnalysisOptions
from sprung.analysis.options import model_options
from sprung.analysis.profiles import check_asked
from sprung.analysis.stages import analyse
from sprung.analysis.starting import start_values
from sprung.assessment import ModeAmplitude, body_motions
from sprung.campaign import CampaignSource, resolve_campaign
from sprung.errors import record_failure
from sprung.progress import Progress, silent
from sprung.results import Result
from sprung.vehicle import Tracks, Vehicle


def identify(
    campaign: CampaignSource,
    *,
    tracks: Tracks | None = None,
    extras: str | Sequence[str] | None = None,
    fall: bool | None = None,
    start: Result | Vehicle | Mapping[str, float] | None = None,
    profile: str | Sequence[str] = (),
    amplitude: bool = False,
    progress: Progress = silent,
) -> Result:
    """Identify every parameter of a vehicle from its drop tests.

    Parameters
    ----------
    campaign
        From `sprung.read` or `sprung.simulate`; or the path of a campaign file or of its folder.
    tracks
        ``shared``: one half-distance per axle; ``separate``: springs and dampers apart. Overrides the campaign.
    extras
        Exactly these extras beyond the paper's model, such as ``anti-roll``; one may be given alone. Overrides the campaign.
    fall
        Whether drops are used from their release on, and not only from when the last tyre is down. It halves the uncertainties
        and takes a few times as long; left open, it is done where a parameter is uncertain by more than 2 %. Overrides the
        campaign.
    start
        A vehicle near the one that is sought: an earlier result, a vehicle, or values by name, SI. It competes with usual
        vehicles for where the search begins, which helps where the vehicle is unlike them all; the likeliest one found wins.
    profile
        Parameters whose 95 % interval is to follow from the whole profile of the likelihood, not from its curvature at the
        maximum: for those that are weakly determined, whose interval is not symmetric. Also derived quantities
        (``total_mass``, ``front_axle_mass``, ``rear_axle_mass``, ``wheelbase``), or ``all`` for every parameter.
    amplitude
        Whether to follow the body's modes through the decays, for frequency and damping against amplitude. Where that
        fails, the result says so under ``omissions``.
    progress
        Called with each step that begins, a `sprung.progress.Step`: a sentence, with its number where steps are counted.

    Returns
    -------
    Result

    Raises
    ------
    InputError
        If the campaign cannot be read, tracks or an extra are unknown, no drop can be used, what is known contradicts the model
        that is wanted, or a profile is wanted of something that the model does not have.

    Examples
    --------
    >>> import sprung
    >>> car = sprung.Vehicle(m_s=1380, I_yy=2440, I_xx=380, m_uf=40.5, m_ur=45.4, k_sf=17000, k_sr=22000, k_tf=192000,
    ...                      k_tr=192000, c_sf=1500, c_sr=1500, a=1.25, b=1.51, t_f=0.74, t_r=0.74)
    >>> campaign = sprung.simulate(car, noise=0.02, seed=1, known={"total_mass": car.total_mass})
    >>> result = sprung.identify(campaign)
    >>> result.verdict.state, abs(result.parameters["k_sf"].value / 17000 - 1) < 0.01
    ('accept', True)
    """
    run = identify_campaign(
        campaign, tracks=tracks, extras=extras, fall=fall, start=start, profile=profile, progress=progress
    )
    return with_amplitudes(run, progress) if amplitude else result_of(run)


def identify_campaign(
    campaign: CampaignSource,
    *,
    tracks: Tracks | None = None,
    extras: str | Sequence[str] | None = None,
    fall: bool | None = None,
    start: Result | Vehicle | Mapping[str, float] | None = None,
    profile: str | Sequence[str] = (),
    progress: Progress = silent,
) -> Analysis:
    """Analyse a campaign, without anything that only decorates the result, so that it can be saved first.

    Parameters
    ----------
    campaign, tracks, extras, fall, start, profile, progress
        As for `identify`.

    Returns
    -------
    Analysis

    Raises
    ------
    InputError
        As `identify` does.
    """
    tracks, terms = model_options(tracks, extras)
    begin = start_values(start)
    campaign = resolve_campaign(campaign, progress)
    asked = check_asked(profile, campaign, tracks, terms)
    texts: dict[str, object] = {"tracks": tracks, "extras": terms, "fall": fall, "profile": asked}
    if begin:
        texts["start"] = [f"{name} = {value:g}" for name, value in begin.items()]
    return analyse(campaign, AnalysisOptions(tracks, terms, fall, begin, tuple(asked), texts), progress)


def result_of(run: Analysis) -> Result:
    """Return the result of an analysis that is complete.

    Parameters
    ----------
    run
        From `identify_campaign` or `analyse`.

    Returns
    -------
    Result
    """
    if run.result is None:
        raise RuntimeError("the last stage of an analysis makes its result")
    return run.result


def with_amplitudes(run: Analysis, progress: Progress = silent) -> Result:
    """Return the result with the amplitude curves of the body's modes, or with the reason why there are none.

    Parameters
    ----------
    run
        From `identify_campaign`.
    progress
        As for `identify`.

    Returns
    -------
    Result
    """
    result = result_of(run)
    if result.verdict.state == "reject":
        return result  # a model that does not describe the recordings has no modes to follow
    omissions = list(result.omissions)
    amplitudes: tuple[ModeAmplitude, ...] = ()
    with record_failure(omissions, "The amplitude curves"):
        motions = body_motions(run.fit, run.decays, run.fit.fitted, run.campaign.sensors)
        amplitudes = amplitudes_of(run, motions, progress)
    return replace(result, amplitude=amplitudes, omissions=tuple(omissions))
