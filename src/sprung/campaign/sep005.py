"""Recordings as SEP005 signals, which other Python tools take."""

from __future__ import annotations

from sprung.campaign.recording import Recording


def to_sep005(recording: Recording) -> list[dict[str, object]]:
    """Return a recording as signals.

    Parameters
    ----------
    recording
        Its channels that are left out are left out here too.

    Returns
    -------
    list of dict
        One per channel: ``name``, ``data`` in m/s², positive up, shape (time,), ``unit_str``, ``quantity``, and ``fs``
        in Hz if the clock starts at 0, otherwise ``time`` in s, shape (time,).
    """
    clock: dict[str, object] = {"fs": recording.rate} if recording.start == 0 else {"time": recording.time}
    return [
        {"name": name, "data": values.copy(), "unit_str": "m/s^2", "quantity": "acceleration", **clock}
        for name, values, usable in zip(recording.channels, recording.values, recording.usable, strict=True)
        if usable
    ]
