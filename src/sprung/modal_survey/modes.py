"""Modes from free decays, without a vehicle model: of each load of a campaign, of recordings alone, or of arrays."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Campaign, CampaignSource, resolve_campaign
from sprung.dataframes import require_pandas
from sprung.display import shown
from sprung.errors import Problems
from sprung.modal import DEFAULT_METHOD
from sprung.modal_survey.load_modes import LoadModes
from sprung.modal_survey.modal_analysis import modal_analysis
from sprung.modal_survey.recordings import RECORDINGS, is_recordings, modes_of_arrays, modes_of_recordings
from sprung.preprocess import FreeDecay, prepare
from sprung.progress import Progress, silent
from sprung.uncertainty import NamedValues

if TYPE_CHECKING:
    import pandas as pd

Real = NDArray[np.float64]

_SEVERAL = 3
"""Dimensions of an array of several decays."""


@shown
class ModesByLoad(NamedValues[LoadModes]):
    """The modes of every load, by its name."""

    def to_dataframe(self) -> pd.DataFrame:
        """Return frequencies (Hz) and damping ratios (1) with their uncertainties as a table, a row for each load and mode."""
        require_pandas()
        import pandas as pd  # noqa: PLC0415 (optional, and nothing else here needs it)

        columns = ("frequency", "frequency_std", "damped_frequency", "damping_ratio", "damping_ratio_std", "status")
        rows = [
            (load, mode.name, *(getattr(mode, column) for column in columns))
            for load, modes_of_load in self.items()
            for mode in modes_of_load
        ]
        return pd.DataFrame(rows, columns=["load", "mode", *columns]).set_index(["load", "mode"])

    def _repr_html_(self) -> str:
        """Return the tables for a notebook."""
        return "".join(modes.table(load).html() for load, modes in self.items())


def modes(
    source: CampaignSource | Real | Sequence[Real],
    method: str = DEFAULT_METHOD,
    order: int | None = None,
    *,
    rate: float | None = None,
    channels: Sequence[str] | None = None,
    start: float | None = None,
    amplitude: bool = False,
    diagram: bool = False,
    progress: Progress = silent,
) -> ModesByLoad:
    """Identify modes from free decays; no vehicle model is needed.

    Parameters
    ----------
    source
        A campaign, or the path of its file or folder: the modes of every load. Or a recording in any format sprung reads, or a
        folder of nothing but recordings: the modes common to them. Or an array of shape (channel, time), or several, in any
        unit: one free decay each.
    method
        One of `sprung.modal.METHODS`; ``ml``, the default, fits poles and shapes to all drops of a load by maximum likelihood,
        with uncertainties.
    order
        Number of poles; chosen by the method unless given.
    rate
        Of arrays: samples per second.
    channels
        Of arrays: names of the channels.
    start
        Of recordings and arrays: start of the free decay, s; unless given, a recording's largest reading, and an array's first
        sample.
    amplitude
        Whether to identify frequency and damping of each mode against amplitude.
    diagram
        Whether to compute a stabilisation diagram too.
    progress
        Called with each step that begins.

    Returns
    -------
    ModesByLoad
        A dict by load, lowest frequency first; of recordings and arrays by the one key ``recordings``, their modes numbered and
        in the unit of the channels. The modes of a campaign are named by their shapes at the sensors: one of
        `sprung.vibration.MODE_NAMES`, or ``unnamed``.

    Raises
    ------
    InputError
        If the source cannot be read, there is no such method or no drop can be used.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(400) / 200
    >>> decay = np.exp(-0.5 * t) * np.array([np.cos(12 * t), 2 * np.cos(12 * t)])
    >>> noise = 1e-3 * np.random.default_rng(1).standard_normal(decay.shape)
    >>> [round(mode.damped_frequency, 2) for mode in modes(decay + noise, rate=200, order=2)["recordings"]]
    [1.91]
    """
    if isinstance(source, np.ndarray) or (isinstance(source, Sequence) and not isinstance(source, str)):
        arrays = [source] if isinstance(source, np.ndarray) and source.ndim < _SEVERAL else list(source)
        in_memory = modes_of_arrays(
            arrays, rate, method, order, channels=channels, start=start, amplitude=amplitude, diagram=diagram
        )
        return ModesByLoad({RECORDINGS: in_memory})
    _check_not_given("arrays", rate=rate, channels=channels)
    if not isinstance(source, Campaign) and is_recordings(source):
        recorded = modes_of_recordings(
            source, method, order, start=start, amplitude=amplitude, diagram=diagram, progress=progress
        )
        return ModesByLoad({RECORDINGS: recorded})
    _check_not_given("arrays and recordings", start=start)
    campaign = resolve_campaign(source, progress)
    decays = [decay for decay in prepare(campaign, progress).decays if not decay.pads]
    if not decays:
        problems = Problems()
        expected, do = "at least one, not on pads", "Run `sprung check` on the campaign."
        problems.add(campaign.name, "no drop that can be used", expected, do)
        problems.raise_if_any()
    by_load = ModesByLoad()
    for load in campaign.loads:
        of_load = [decay for decay in decays if decay.load == load.name]
        if of_load:
            by_load[load.name] = _modes_of(of_load, campaign, method, order, amplitude, diagram, progress)
    return by_load


def _check_not_given(sources: str, **given: object) -> None:
    """Raise an error for arguments that only some sources need."""
    problems = Problems()
    for name, value in given.items():
        if value is not None:
            problems.add(f"modes: {name}", repr(value), f"nothing: it is for {sources}", f"Leave {name} out.")
    problems.raise_if_any()


def _modes_of(
    decays: list[FreeDecay],
    campaign: Campaign,
    method: str,
    order: int | None,
    amplitude: bool,
    diagram: bool,
    progress: Progress,
) -> LoadModes:
    # One matrix holds records of one rate, and channels that all drops have.
    rate = Counter(decay.rate for decay in decays).most_common(1)[0][0]
    chosen = [decay for decay in decays if decay.rate == rate]
    usable = np.logical_and.reduce([decay.usable for decay in chosen])
    records = [decay.values[usable] - _offset(decay)[usable, None] for decay in chosen]
    sensors = [sensor for sensor, used in zip(campaign.sensors, usable, strict=True) if used]
    a = campaign.known.get("a")
    return modal_analysis(
        records,
        rate,
        method,
        order,
        tuple(sensor.channel for sensor in sensors),
        tuple(decay.name for decay in chosen),
        sensors=sensors,
        a=a.value if a is not None else None,
        amplitude=amplitude,
        diagram=diagram,
        load=decays[0].load,
        progress=progress,
    )


def _offset(decay: FreeDecay) -> Real:
    """Return the offset of each channel: its reading at rest, or its mean where there was none; shape (channel,)."""
    return np.where(np.isnan(decay.rest.level), decay.values.mean(axis=1), decay.rest.level)
