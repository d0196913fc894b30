"""Figures: axes in, axes out, and in them what the result holds."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.axes import Axes

import sprung
from sprung import plot
from sprung.assessment import Verdict
from sprung.campaign import Campaign
from sprung.errors import InputError
from sprung.estimation import ForceCurve
from sprung.results import Result
from sprung.vehicle import TABLE_1_CAR

mpl.use("Agg")


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    drops = [{"wheels": wheels, "load": "empty"} for wheels in (["fl", "fr", "rl", "rr"], ["rl", "rr"], ["fl", "rl"])]
    known = {"total_mass": TABLE_1_CAR.total_mass}
    return sprung.simulate(TABLE_1_CAR, drops=drops, noise=0.02, seed=1, known=known)


@pytest.fixture(scope="module")
def result(campaign: Campaign) -> Result:
    return sprung.identify(campaign, amplitude=True)


@pytest.fixture(autouse=True)
def closed() -> Iterator[None]:
    yield
    plt.close("all")


def lines(axes: Axes, points: int) -> list[np.ndarray[tuple[int, ...], np.dtype[np.float64]]]:
    return [
        np.asarray(line.get_ydata(), dtype=float) for line in axes.lines if len(np.asarray(line.get_ydata())) == points
    ]


def test_fit_shows_the_body_and_what_is_left(result: Result) -> None:
    axes = plot.fit(result, "empty_roll_left")
    series = result.series["empty_roll_left"]
    assert [one.get_ylabel() for one in axes[::2]] == ["vertical, m/s²", "pitch, rad/s²", "roll, rad/s²"]
    assert series.body_measured is not None
    assert series.body_simulated is not None
    for i, (above, below) in enumerate(zip(axes[::2], axes[1::2], strict=True)):
        measured, simulated = lines(above, len(series.time))
        np.testing.assert_array_equal(measured, series.body_measured[i].astype(float))
        np.testing.assert_array_equal(simulated, series.body_simulated[i].astype(float))
        [left] = lines(below, len(series.time))
        np.testing.assert_array_equal(left, measured - simulated)
    assert axes[-1].get_xlabel() == "time on the recording's clock, s"


def test_fit_of_channels_draws_into_the_axes_it_is_given(result: Result) -> None:
    _, given = plt.subplots(4)
    found = plot.fit(result, "empty_bounce", ["wheel_fl", "body_rr"], axes=given)
    assert all(one is other for one, other in zip(found, given, strict=True))
    series = result.series["empty_bounce"]
    measured, fitted = lines(found[2], len(series.time))
    np.testing.assert_array_equal(measured, series.measured[series.channels.index("body_rr")])
    np.testing.assert_array_equal(fitted, series.fitted[series.channels.index("body_rr")])


def test_recordings_of_a_result_and_of_a_check(campaign: Campaign, result: Result) -> None:
    for of in (result, sprung.check(campaign)):
        axes = plot.recording(of, "empty_bounce")
        assert [one.get_ylabel() for one in axes] == list(campaign.recordings[0].channels)
        [drawn] = lines(axes[-1], campaign.recordings[0].values.shape[1])
        np.testing.assert_allclose(drawn, campaign.recordings[0].values[-1], rtol=1e-6)
    near = plot.recording(result, "empty_bounce", near=True)
    drop = result.drops[0]
    assert near[0].get_xlim()[0] < (drop.release or 0) < (drop.landing or 0) < near[0].get_xlim()[1] < (drop.end or 0)


def test_spectra_have_their_peaks_at_the_modes(result: Result) -> None:
    _, wheels = plot.spectra(result)
    curve = max(wheels.lines, key=lambda line: len(np.asarray(line.get_ydata())))
    peak = float(np.asarray(curve.get_xdata(), dtype=float)[np.argmax(np.asarray(curve.get_ydata(), dtype=float))])
    # The wheels of the Table 1 car hop between 10.77 and 11.29 Hz, design.md; damped by a quarter, they peak a little lower.
    assert 9.5 < peak < 11.5


def test_labels_of_lines_leave_the_panels_their_height(result: Result) -> None:
    """Stacked above the panel, none over another one or beyond the figure."""
    body, wheels = plot.spectra(result)
    figure = body.get_figure(root=True)
    assert figure is not None
    figure.draw_without_rendering()
    labels = [text.get_window_extent() for text in body.texts if text.get_text() and "sensors" not in text.get_text()]
    assert (
        len(labels)
        == len({float(np.asarray(line.get_xdata())[0]) for line in body.lines if line.get_linestyle() == "--"}) - 3
    )
    for i, one in enumerate(labels):
        assert figure.bbox.x0 <= one.x0 < one.x1 <= figure.bbox.x1
        assert body.bbox.y1 <= one.y0 < one.y1 <= figure.bbox.y1
        assert not any(one.overlaps(other) for other in labels[:i])
    assert body.bbox.height + wheels.bbox.height > 0.6 * figure.bbox.height


def test_stabilisation_of_modes_of_a_load_of_a_diagram_and_of_a_result(campaign: Campaign, result: Result) -> None:
    modes = sprung.modes(campaign, diagram=True)
    diagram = modes["empty"].diagram
    assert diagram is not None
    wanted = sorted(abs(one.pole) / (2 * np.pi) for one in diagram.chosen if one.pole.imag > 0)
    for of in (modes, modes["empty"], diagram):
        axes = plot.stabilisation(of)
        stays = sorted(float(np.asarray(line.get_xdata())[0]) for line in axes.lines if line.get_linestyle() == "--")
        assert stays == pytest.approx(wanted)
    # Level and start differ a little between the two: what stays does not.
    assert len([line for line in plot.stabilisation(result).lines if line.get_linestyle() == "--"]) >= 3
    with pytest.raises(InputError, match="diagram=True"):
        plot.stabilisation(sprung.modes(campaign))


def test_a_mode_is_a_moved_car(result: Result) -> None:
    still, moved = plot.mode(result, "body bounce", phase=np.pi / 2), plot.mode(result, "body bounce")
    assert f"{result.modes['empty'][0].frequency:.4g} Hz" in moved.get_title()

    def highest(axes: Axes) -> float:
        return min(float(np.asarray(line.get_ydata()).min()) for line in axes.lines if line.get_linestyle() == "-")

    assert highest(moved) < highest(still) - 10  # upwards on the picture is less


def test_parameters_and_correlation(result: Result) -> None:
    axes = plot.parameters(result)
    estimated = [name for name, one in result.parameters.items() if one.status == "estimated"]
    assert [text.get_text() for text in axes.get_yticklabels()] == estimated
    own = plt.subplots()[1]
    assert plot.correlation(result, axes=own) is own
    np.testing.assert_array_equal(np.asarray(own.images[0].get_array()), result.correlation.matrix)
    assert own.get_title(loc="left") == "Correlation of the estimated parameters"


def test_amplitude(result: Result) -> None:
    frequency, damping = plot.amplitude(result, "body pitch")
    assert (frequency.get_ylabel(), damping.get_ylabel()) == ("frequency, Hz", "damping ratio, %")
    assert frequency.get_xlim()[0] > frequency.get_xlim()[1]  # it dies to the right
    with pytest.raises(InputError, match="amplitude=True"):
        plot.amplitude(replace(result, amplitude=()))
    quarter = {name: one for name, one in result.parameters.items() if name == "m_s"} | {
        "m_u": result.parameters["m_uf"]
    }
    with pytest.raises(InputError, match="which a part of a vehicle does not have together"):
        plot.amplitude(replace(result, parameters=quarter, amplitude=()))
    with pytest.raises(InputError, match="Did you mean 'body bounce'"):
        plot.amplitude(result, "body bounse")


def test_curves_of_dampers_as_from_a_dynamometer_and_of_springs_in_compression(result: Result) -> None:
    x, force = np.array([-1.0, 0.0, 1.0]), np.array([-1000.0, 0.0, 3000.0])
    front = ForceCurve(x=x, force=force, std=np.abs(force) / 10, x_unit="m/s", force_unit="N", reached=(-0.8, 0.5))
    rear = replace(front, force=2 * force)
    spring = replace(front, x=0.05 * x, x_unit="m", reached=(-0.04, 0.02))
    curved = replace(result, curves={"damper_front": front, "damper_rear": rear, "spring_front": spring})
    axes = plot.curve(curved)
    assert axes.get_xlabel() == "velocity (rebound positive), m/s"
    solid = [line for line in axes.lines if line.get_linestyle() == "-" and line.get_label() in ("front", "rear")]
    for line, factor in zip(solid, (1, 2), strict=True):
        velocity, drawn = (np.asarray(data, dtype=float) for data in line.get_data())
        assert (velocity.min(), velocity.max()) == (-0.8, 0.5)
        np.testing.assert_allclose(drawn, factor * np.interp(velocity, x, force))
    bands = [np.asarray(band.get_paths()[0].vertices) for band in axes.collections if band.get_paths()]
    # 95 % of 10 % of -800 N, beside the curve at the end of the range.
    assert bands[0][:, 1].min() == pytest.approx(-800 - 1.96 * 80, rel=1e-4)
    (compressed,) = [line for line in plot.curve(curved, "spring").lines if line.get_label() == "front"]
    travel, load = (np.asarray(data, dtype=float) for data in compressed.get_data())
    assert (travel.min(), travel.max()) == pytest.approx((-20, 40))
    assert load[travel.argmax()] == pytest.approx(800)
    with pytest.raises(InputError, match="Did you mean 'spring'"):
        plot.curve(curved, "sprung")
    with pytest.raises(InputError, match="no force curves"):
        plot.curve(result)


def test_what_is_not_there_is_named(result: Result) -> None:
    with pytest.raises(InputError, match="Did you mean 'empty_bounce'"):
        plot.fit(result, "empty_bonce")
    with pytest.raises(InputError, match="6 axes, one for each panel"):
        plot.fit(result, "empty_bounce", axes=[plt.subplots()[1]])
    with pytest.raises(InputError, match="at least one channel"):
        plot.fit(result, "empty_bounce", [])
    for phase in (np.nan, np.inf):
        with pytest.raises(InputError, match="a finite angle in rad"):
            plot.mode(result, "body bounce", phase=phase)
    rejected = replace(result, verdict=Verdict("reject", ()))
    with pytest.raises(InputError, match="rejected"):
        plot.mode(rejected, "body bounce")


@pytest.mark.parametrize(
    ("done", "said"),
    [
        ("import sprung, sprung.report; print('matplotlib' in sys.modules)", "False"),
        ("import sprung; sprung.plot.fit; print('matplotlib' in sys.modules)", "True"),
        (
            "sys.modules['matplotlib'] = None\nimport sprung\ntry:\n    sprung.plot\nexcept ImportError as e:\n    print(e)",
            'sprung.plot needs matplotlib, which is not installed: pip install "sprung[plot]"',
        ),
    ],
)
@pytest.mark.slow
def test_matplotlib_is_loaded_only_by_who_draws_with_it(done: str, said: str) -> None:
    run = subprocess.run([sys.executable, "-c", f"import sys\n{done}"], capture_output=True, text=True, check=True)  # noqa: S603
    assert run.stdout.strip() == said
