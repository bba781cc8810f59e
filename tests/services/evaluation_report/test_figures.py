"""Figures mean what they show: curves are the quantiles', arrows the errors', boxes the quartiles'."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from app.services.evaluation_report.figures.boxes import boxes
from app.services.evaluation_report.figures.components import components
from app.services.evaluation_report.figures.cumulative import cumulative_rotation, cumulative_spatial
from app.services.evaluation_report.figures.histogram import histogram
from app.services.evaluation_report.figures.over_time import BETWEEN, SIZE, over_time
from app.services.evaluation_report.figures.plan_view import class_limits_m, plan_view
from app.services.evaluation_report.look import pens
from app.services.evaluation_report.material import ReportMaterial
from app.services.reporting.document import Figure
from app.services.reporting.drawing import Ellipse, Label, Path
from app.trajectories.evaluation import Evaluation, EvaluationOptions, evaluate
from app.trajectories.metrics.bootstrap import BootstrapOptions
from app.trajectories.trajectory import Trajectory
from tests.services.evaluation_report.scene import evaluated, system
from tests.trajectories.walks import START_S, noisy, walk_at

Array = NDArray[np.float64]
SMALLEST = 0.02  # points: what a comparison on the sheet forgives


def paths(figure: Figure, ink: str) -> list[Path]:
    return [shape for shape in figure.drawing.shapes if isinstance(shape, Path) and shape.pen.ink == ink]


def ellipses(figure: Figure, ink: str) -> list[Ellipse]:
    return [shape for shape in figure.drawing.shapes if isinstance(shape, Ellipse) and shape.pen.ink == ink]


def labels(figure: Figure) -> dict[str, Array]:
    return {shape.text: shape.at for shape in figure.drawing.shapes if isinstance(shape, Label)}


def points_per_unit(figure: Figure, axis: int) -> float:
    """The scale along an axis, from two of its numbers, which stand in order along it."""
    numbers = [
        (float(shape.text.replace("−", "-")), float(shape.at[axis]))  # noqa: RUF001 - a real minus
        for shape in figure.drawing.shapes
        if isinstance(shape, Label) and shape.anchor == ("end" if axis else "middle") and shape.ink == "muted"
        if re.fullmatch(r"−?[\d.]+", shape.text)  # noqa: RUF001
    ]
    (first, start), *_, (last, end) = numbers
    return (end - start) / (last - first)


@pytest.fixture(scope="module")
def uwb(material: ReportMaterial) -> Evaluation:
    return material.evaluations["UWB"]


@pytest.fixture(scope="module")
def long() -> Evaluation:
    """More pairs than any figure draws."""
    reference = walk_at(START_S + np.arange(60_000) * 0.02)
    said = noisy(reference, 0.1)
    said.positions_m[30_001] += [3.0, 0.0, 0.0]
    estimate = Trajectory(said.times_s, said.positions_m)
    return evaluate(reference, estimate, EvaluationOptions(bootstrap=BootstrapOptions(resamples=4)))


def test_the_curves_circles_stand_at_the_quantiles_of_the_table(uwb: Evaluation) -> None:
    figure = cumulative_spatial({"UWB": uwb})
    scale, spatial = points_per_unit(figure, 0), uwb.accuracy.spatial
    zero = labels(figure)["0.00"][0]
    circles = [circle.centre[0] - zero for circle in ellipses(figure, "series1")]
    np.testing.assert_allclose(
        circles, scale * np.array([spatial.median, spatial.quantile_75, spatial.quantile_95]), atol=SMALLEST
    )


def test_the_curve_is_the_distribution(uwb: Evaluation) -> None:
    figure = cumulative_spatial({"UWB": uwb})
    curve = max((path.points for path in paths(figure, "series1")), key=len)
    zero = labels(figure)["0.00"][0]
    sizes_m = np.sort(uwb.errors.spatial_m)
    np.testing.assert_allclose(curve[1:-2, 0] - zero, points_per_unit(figure, 0) * sizes_m, atol=SMALLEST)
    assert (np.diff(curve, axis=0) * [1.0, -1.0] >= -1e-9).all()  # never falls; the sheet's y points down


def test_orientations_have_a_curve_and_a_panel_where_they_are_told(material: ReportMaterial, uwb: Evaluation) -> None:
    figure = cumulative_rotation(material.evaluations)
    assert figure is not None
    assert "Wi-Fi" not in labels(figure) and "rotation error, degrees" in labels(figure)
    turned = material.evaluations["turned"].accuracy.rotation
    assert turned is not None
    circles = [circle.centre[0] for circle in ellipses(figure, "series4")]
    levels_deg = np.degrees([turned.median, turned.quantile_75, turned.quantile_95])
    zero = labels(figure)["0.00"][0]
    np.testing.assert_allclose(circles, zero + points_per_unit(figure, 0) * levels_deg, atol=SMALLEST)
    assert "angle of rotation" in over_time(uwb, "series1").caption
    without = material.evaluations["Wi-Fi"]
    assert "rotation" not in over_time(without, "series2").caption
    assert cumulative_rotation({"Wi-Fi": without}) is None


def test_systems_differ_in_colour_and_in_dashes() -> None:
    strokes = list(pens([f"system {index}" for index in range(36)]).values())
    assert len({(pen.ink, pen.dash) for pen in strokes}) == 36
    assert all(len({pen.dash for pen in strokes[start : start + 6]}) == 6 for start in (0, 6, 30))


def test_arrows_of_the_plan_are_the_errors(uwb: Evaluation) -> None:
    figure = plan_view(uwb, ())
    (told,) = re.findall(r"enlarged ([\d,]+) times", figure.caption)
    scale = points_per_unit(figure, 0) * float(told)
    coloured = [
        shape for shape in figure.drawing.shapes if isinstance(shape, Path) and shape.pen.ink.startswith("size")
    ]
    drawn = [head.points[0] - line.points[0] for line, head in pairwise(coloured) if head.closed]
    smallest_first = np.argsort(uwb.errors.horizontal_m)
    np.testing.assert_allclose(drawn, scale * uwb.errors.vectors_m[smallest_first, :2] * [1.0, -1.0], atol=SMALLEST)


def test_classes_hold_the_sizes_that_the_key_says(uwb: Evaluation) -> None:
    limits_m = class_limits_m(uwb.errors.horizontal_m)
    figure = plan_view(uwb, ())
    counts = [sum(path.closed for path in paths(figure, f"size{rank}")) for rank in range(1, 6)]
    expected = np.bincount(np.searchsorted(limits_m, uwb.errors.horizontal_m), minlength=5)
    assert counts == expected.tolist()
    assert f"up to {limits_m[0]:g} m" in labels(figure) and f"above {limits_m[-1]:g} m" in labels(figure)
    np.testing.assert_allclose(np.diff(limits_m), limits_m[0])


def test_errors_that_leave_the_plan_end_at_its_frame(material: ReportMaterial) -> None:
    figure = plan_view(material.evaluations["ARKit"], material.zones)
    assert "3 of them end at the frame" in figure.caption
    frame = next(path.points for path in paths(figure, "muted") if path.closed and not path.pen.dash)
    ends = np.concatenate([path.points for path in paths(figure, "size5")])
    inside = ends[ends[:, 1] <= frame[:, 1].max() + 1e-6]
    assert (inside >= frame.min(axis=0) - 1e-6).all() and (inside <= frame.max(axis=0) + 1e-6).all()


def test_zones_are_outlined_and_named(uwb: Evaluation, material: ReportMaterial) -> None:
    figure = plan_view(uwb, material.zones)
    outlines = [path for path in paths(figure, "muted") if path.pen.dash]
    assert [len(path.points) for path in outlines] == [4, 4]
    assert {"atrium", "corridor"} <= set(labels(figure))


def test_boxes_stand_at_the_quartiles(uwb: Evaluation, single: ReportMaterial) -> None:
    figure = boxes(single)
    box = next(
        path.points
        for path in paths(figure, "series1")
        if path.closed and len(path.points) == 4 and not path.pen.filled
    )
    zero, scale = labels(figure)["0.00"][0], points_per_unit(figure, 0)
    quartiles_m = np.quantile(uwb.errors.spatial_m, [0.25, 0.75])
    np.testing.assert_allclose([box[:, 0].min(), box[:, 0].max()], zero + scale * quartiles_m, atol=SMALLEST)
    counts = [len(uwb.pairs), *(uwb.zones[zone].spatial.count for zone in ("atrium", "corridor", "elsewhere"))]
    names = ["UWB", "atrium · UWB", "corridor · UWB", "elsewhere · UWB"]
    assert {f"{name} ({count})" for name, count in zip(names, counts, strict=True)} <= set(labels(figure))


def test_an_error_beyond_the_axis_is_counted_once(material: ReportMaterial) -> None:
    figure = boxes(material)
    greatest_m = material.evaluations["ARKit"].accuracy.spatial.greatest
    assert f" 3 of the errors in space lie beyond the axis, the greatest at {greatest_m:.4f} m." in figure.caption


def test_bars_of_the_histogram_hold_all_pairs(uwb: Evaluation) -> None:
    figure = histogram(uwb, "series1")
    heights = np.array([np.ptp(path.points[:, 1]) for path in paths(figure, "series1")])
    assert heights.sum() / -points_per_unit(figure, 1) == pytest.approx(len(uwb.errors), abs=1e-6)
    assert f"SE95 {uwb.accuracy.spatial.quantile_95:.4f} m" in labels(figure)


def test_the_ellipse_of_the_components_is_that_of_the_covariance(uwb: Evaluation) -> None:
    figure = components(uwb, "series1")
    outline = next(path.points for path in paths(figure, "ink") if len(path.points) > 100)
    drawn = np.ptp(outline, axis=0) / 2.0 / points_per_unit(figure, 1)
    # The extent of an ellipse along an axis is the root of the covariance's diagonal, times chi of 95 %.
    sigmas_m = np.sqrt(np.diag(uwb.accuracy.covariance_m2)[:2])
    np.testing.assert_allclose(np.abs(drawn), np.sqrt(5.991) * sigmas_m, rtol=1e-3)
    assert len(ellipses(figure, "series1")) == 2 * len(uwb.errors)


def test_the_references_uncertainty_lies_behind_the_errors(uwb: Evaluation) -> None:
    figure = over_time(uwb, "series1")
    across, up, turned = paths(figure, "band")
    scales = [-points_per_unit(labels_of_panel(figure, panel), 1) for panel in (0, 1)]
    assert np.ptp(across.points[:, 1]) / scales[0] == pytest.approx(np.sqrt(5.991) * 0.02, rel=1e-3)
    assert np.ptp(up.points[:, 1]) / scales[1] == pytest.approx(2 * 1.96 * 0.03, rel=1e-3)
    assert np.ptp(turned.points[:, 1]) > 0.0


def labels_of_panel(figure: Figure, panel: int) -> Figure:
    """The labels of one of its panels alone."""
    kept = tuple(
        shape
        for shape in figure.drawing.shapes
        if not isinstance(shape, Label) or int(shape.at[1] // (SIZE[1] + BETWEEN)) == panel
    )
    return replace(figure, drawing=replace(figure.drawing, shapes=kept))


def test_a_silence_breaks_the_line(material: ReportMaterial) -> None:
    runs = [path for path in paths(over_time(material.evaluations["Wi-Fi"], "series2"), "series2") if not path.closed]
    assert len(runs) == 4  # two runs in each panel


def test_gross_errors_are_pointed_to_and_counted(material: ReportMaterial) -> None:
    figure = over_time(material.evaluations["ARKit"], "series3")
    triangles = [path for path in paths(figure, "series3") if path.closed]
    assert len(triangles) == 6
    greatest_m = material.evaluations["ARKit"].accuracy.horizontal.greatest
    assert f"3 of the errors in the plan lie beyond the axis, the greatest at {greatest_m:.4f} m" in figure.caption


def test_long_series_are_thinned_and_keep_their_extremes(long: Evaluation) -> None:
    time, plan, cloud = over_time(long, "series1"), plan_view(long, ()), components(long, "series1")
    assert all(len(figure.drawing.shapes) < 20_000 for figure in (time, plan, cloud))
    drawn = sum(len(path.points) for path in paths(time, "series1") if not path.closed) // 2
    assert f"Of 60,000 pairs {drawn:,} are drawn" in time.caption
    assert "Of 60,000 errors 699 are drawn" in plan.caption or "Of 60,000 errors 700 are drawn" in plan.caption
    assert f"the greatest at {long.accuracy.horizontal.greatest:.4f} m" in time.caption
    assert [path for path in paths(time, "series1") if path.closed]


def test_errors_of_a_single_moment_can_be_drawn() -> None:
    one = evaluated(system(0.1, 1).take(np.array([7])))
    for figure in (
        plan_view(one, ()),
        over_time(one, "series1"),
        components(one, "series1"),
        histogram(one, "series1"),
    ):
        assert figure.drawing.shapes
    assert cumulative_spatial({"one": one}).drawing.shapes
