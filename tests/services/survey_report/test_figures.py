"""Drawings mean what they show: ellipses are the covariances', arrows the residuals', bars the counts'."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from app.geometry.target_map import MappedTarget
from app.photogrammetry.image_residuals import ImageResiduals
from app.services.reporting.document import Figure
from app.services.reporting.drawing import Ellipse, Label, Path, Shape
from app.services.survey_report.figures.photo_residuals import photo_residuals
from app.services.survey_report.figures.plan_view import PlanOptions, plan_view
from app.services.survey_report.figures.residual_field import FieldOptions, residual_field
from app.services.survey_report.figures.residual_histogram import residual_histogram
from app.services.survey_report.material import ReportMaterial

Array = npt.NDArray[np.float64]

CHI2_95_2D = 5.991  # 95 % of a chi-squared distribution of two degrees of freedom


def ellipses(figure: Figure, ink: str) -> list[Ellipse]:
    return [shape for shape in figure.drawing.shapes if isinstance(shape, Ellipse) and shape.pen.ink == ink]


def paths(shapes: tuple[Shape, ...], ink: str) -> list[Path]:
    return [shape for shape in shapes if isinstance(shape, Path) and shape.pen.ink == ink]


def enlargement(figure: Figure) -> float:
    (told,) = re.findall(r"enlarged ([\d,]+) times", figure.caption)
    return float(told.replace(",", ""))


def points_per_m(figure: Figure, targets: tuple[MappedTarget, ...]) -> float:
    """The plan's scale, from where two targets stand on the sheet."""
    on_sheet = [ellipse.centre for ellipse in ellipses(figure, "target")[:: len(targets) - 1]]
    in_site_m = [targets[index].site_from_target.position_m[:2] for index in (0, -1)]
    return float(np.linalg.norm(on_sheet[1] - on_sheet[0]) / np.linalg.norm(in_site_m[1] - in_site_m[0]))


def stretched(material: ReportMaterial) -> ReportMaterial:
    """With one target that is known badly along a direction of its own."""
    first, *others = material.target_map.targets
    along = np.array([3.0, 1.0, 0.0])
    covariance = first.covariance + np.pad(1e-5 * np.outer(along, along), ((0, 3), (0, 3)))
    targets = (replace(first, covariance=covariance), *others)
    return replace(material, target_map=replace(material.target_map, targets=targets))


def test_ellipses_of_the_plan_are_those_of_the_covariances(good: ReportMaterial) -> None:
    material = stretched(good)
    targets, datum = material.target_map.targets, material.target_map.datum
    figure = plan_view(material)
    scale = points_per_m(figure, targets) * enlargement(figure)
    for ellipse, target in zip(ellipses(figure, "target"), targets, strict=True):
        whole = (target.covariance + datum.pose_covariance(target.site_from_target.position_m))[:2, :2]
        turn = np.radians(-ellipse.turn_deg)  # the sheet's y points down
        axes = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        drawn = axes @ np.diag((ellipse.semi_axes / scale) ** 2) @ axes.T
        np.testing.assert_allclose(drawn, CHI2_95_2D * whole, rtol=1e-3, atol=1e-3 * np.trace(whole))


def test_the_plan_keeps_the_sites_shape(good: ReportMaterial) -> None:
    figure = plan_view(good)
    targets = good.target_map.targets
    scale = points_per_m(figure, targets)
    on_sheet = np.array([ellipse.centre for ellipse in ellipses(figure, "target")])
    in_site_m = np.array([target.site_from_target.position_m[:2] for target in targets])
    np.testing.assert_allclose(np.ptp(on_sheet, axis=0), scale * np.ptp(in_site_m, axis=0), rtol=1e-6)
    highest = in_site_m[:, 1].argmax()
    assert on_sheet[highest, 1] == on_sheet[:, 1].min()  # Y is up
    assert (on_sheet >= 0).all()
    assert (on_sheet <= [figure.drawing.width, figure.drawing.height]).all()


def test_residuals_of_points_point_where_they_point(good: ReportMaterial) -> None:
    figure = plan_view(good)
    scale = points_per_m(figure, good.target_map.targets) * enlargement(figure)
    heads = [path for path in paths(figure.drawing.shapes, "error") if path.closed]
    for point, head in zip(good.report.control, heads, strict=False):  # the last head is the key's
        assert point.residual_m is not None
        step = scale * point.residual_m[:2] * [1.0, -1.0]
        place = symbol_of(figure, head.points[0] - step)
        np.testing.assert_allclose(head.points[0] - step, place, atol=1e-6)


def symbol_of(figure: Figure, near: Array) -> Array:
    """Where the nearest point's symbol stands."""
    circles = [ellipse.centre for ellipse in ellipses(figure, "check")]
    triangles = [path.points.mean(axis=0) for path in paths(figure.drawing.shapes, "control") if path.closed]
    places = np.array([*circles, *triangles])
    return np.asarray(places[np.hypot(*(places - near).T).argmin()])


def test_labels_are_left_out_where_they_would_hide_each_other(good: ReportMaterial) -> None:
    def labels(options: PlanOptions) -> set[str]:
        return {shape.text for shape in plan_view(good, options).drawing.shapes if isinstance(shape, Label)}

    code = str(good.target_map.targets[0].code)
    assert code in labels(PlanOptions())
    assert code not in labels(PlanOptions(most_labels=3))


def test_photographs_are_numbered_as_in_their_table(good: ReportMaterial) -> None:
    figure = plan_view(replace(good, photos=good.photos[::-1]))  # the database orders them its own way
    labels = {
        shape.text: shape.at for shape in figure.drawing.shapes if isinstance(shape, Label) and shape.ink == "photo"
    }
    places = np.array([ellipse.centre for ellipse in ellipses(figure, "photo")])[::-1]
    for number, place in enumerate(places, start=1):
        assert np.hypot(*(labels[str(number)] - place)) < 12.0  # it stands beside its photograph


def field(mean_px: Array, counts: int = 100) -> ImageResiduals:
    rows, columns = mean_px.shape[:2]
    full = np.full((rows, columns), counts)
    return ImageResiduals(120.0, full, mean_px, 0.07, 0.0175, np.array([0, 2, 30, 28, 3, 1]))


def radial(rows: int = 9, columns: int = 16) -> Array:
    y, x = np.mgrid[:rows, :columns]
    return 0.001 * np.stack([x - (columns - 1) / 2, y - (rows - 1) / 2], axis=-1)


def test_the_fields_arrows_are_the_mean_residuals(good: ReportMaterial) -> None:
    (camera,) = good.report.cameras
    mean_px = radial()
    figure = residual_field(camera, field(mean_px))
    lines = [path.points for path in paths(figure.drawing.shapes, "error") if not path.closed and len(path.points) == 2]
    heads = [path.points[0] for path in paths(figure.drawing.shapes, "error") if path.closed]
    drawn = np.array([tip - points[0] for tip, points in zip(heads, lines, strict=False)])
    scale = enlargement(figure) * (figure.drawing.width - 2.0) / camera.width_px
    np.testing.assert_allclose(drawn, scale * mean_px.reshape(-1, 2), atol=1e-9)
    starts = np.array([points[0] for points in lines[: len(drawn)]])
    assert (np.diff(starts.reshape(9, 16, 2)[:, 0, 1]) > 0).all()  # rows go down, as in the image


def test_cells_of_few_dots_show_no_arrow(good: ReportMaterial) -> None:
    (camera,) = good.report.cameras
    few = FieldOptions().fewest_dots - 1
    figure = residual_field(camera, field(radial(), few))
    assert paths(figure.drawing.shapes, "error") == []
    assert len(ellipses(figure, "grid")) == 9 * 16


def test_bars_of_the_histogram_are_its_counts() -> None:
    found = field(radial())
    figure = residual_histogram(found)
    heights = np.array([np.ptp(path.points[:, 1]) for path in paths(figure.drawing.shapes, "target")])
    np.testing.assert_allclose(heights / heights.max(), found.histogram / found.histogram.max(), atol=1e-9)


def test_bars_of_photographs_are_their_residuals(good: ReportMaterial) -> None:
    figure = photo_residuals(good.report.photos)
    heights = np.array([np.ptp(path.points[:, 1]) for path in paths(figure.drawing.shapes, "photo")])
    rms_px = np.array([photo.rms_px for photo in good.report.photos])
    np.testing.assert_allclose(heights / heights.max(), rms_px / rms_px.max(), atol=1e-9)
