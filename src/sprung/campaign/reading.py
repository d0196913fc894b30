"""Reading a campaign, or a vehicle file: every fault of all its files at once."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sprung.progress import Progress, silent

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    from sprung.campaign.campaign import Campaign
    from sprung.campaign.vehicle_file import VehicleFile
    from sprung.formats import Signals

# The formats and the models of the files are imported where a file is read: whoever has a campaign needs none of them.

CAMPAIGN_FILE = "campaign.toml"
"""The campaign file's name, where only its folder is given."""


def read(
    path: str | os.PathLike[str],
    *,
    signals: Signals | None = None,
    complete: bool = True,
    progress: Progress = silent,
) -> Campaign:
    """Read a campaign and its recordings.

    Parameters
    ----------
    path
        The campaign file, or the folder that holds it as ``campaign.toml``.
    signals
        Recordings in memory, by the names under which the campaign file has them: those files are not opened. Each is a list
        of dictionaries as SEP005 of the SDyPy project proposes them, one per signal, with ``name``, ``data`` of shape
        (time,), ``unit_str``, and ``fs`` in Hz or ``time`` in s. Unit and direction of a sensor in the campaign file hold for
        them as for a file.
    complete
        Whether the file must say everything that an identification needs. Otherwise what it does not say is in
        `Campaign.missing`, recordings that cannot be read are left out and named in its faults, and `sprung.check` can judge
        the others.
    progress
        Called with each recording that is begun.

    Returns
    -------
    Campaign
        In SI, positive up. Spoilt channels and drops are NaN, and named in the faults of their recordings.

    Raises
    ------
    InputError
        If something is wrong with the campaign file, or with a recording so that it cannot be used; every problem of
        all the files at once.

    Examples
    --------
    >>> import sprung
    >>> campaign = sprung.read("campaign.toml", signals={"empty_bounce": signals})          # doctest: +SKIP
    """
    from sprung.campaign.toml_document import read_toml  # noqa: PLC0415 (see above)

    path = Path(path) / CAMPAIGN_FILE if Path(path).is_dir() else Path(path)
    return read_document(read_toml(path), path, signals=signals, complete=complete, progress=progress)


def read_document(
    document: Mapping[str, Any],
    path: Path,
    *,
    signals: Signals | None = None,
    complete: bool = True,
    progress: Progress = silent,
) -> Campaign:
    """Read the recordings of a campaign file that has been read already, or is not written yet.

    Parameters
    ----------
    document
        What the campaign file holds, as TOML gives it.
    path
        Of the campaign file; the recordings are beside it.
    signals, complete, progress
        As for `read`.

    Returns
    -------
    Campaign

    Raises
    ------
    InputError
        As `read` does.
    """
    from sprung.campaign.file_reading import read_campaign  # noqa: PLC0415 (see above)

    return read_campaign(document, path, signals or {}, complete, progress)


def is_vehicle_file(path: str | os.PathLike[str]) -> bool:
    """Return whether a path is a vehicle file, with the section ``[parameters]``; a misspelt name counts too.

    Parameters
    ----------
    path
        Of a file or a folder.

    Returns
    -------
    bool
        False of a file that cannot be read, which is reported where it is read.
    """
    from sprung.campaign.file_kind import find_parameters_section  # noqa: PLC0415 (see above)

    try:
        document = tomllib.loads(Path(path).read_bytes().decode("utf-8-sig"))
    except (OSError, ValueError, RecursionError):
        return False
    return find_parameters_section(document) is not None


def read_vehicle(path: str | os.PathLike[str]) -> VehicleFile:
    """Read a vehicle file: a vehicle's parameters, and the sensors, loads and drops to simulate.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    VehicleFile

    Raises
    ------
    InputError
        If something is wrong with it; every problem at once.
    """
    from sprung.campaign.vehicle_file import read_vehicle_file  # noqa: PLC0415 (see above)

    return read_vehicle_file(Path(path))
