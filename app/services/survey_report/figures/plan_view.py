"""The plan: the site from above with targets, photographs, points and their error ellipses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose
from app.geometry.target_map import MappedTarget
from app.photogrammetry.report import ControlRecord
from app.services.reporting.document import Figure
from app.services.reporting.drawing import Drawing, Ellipse, Ink, Label, Path, Pen, Shape, arrow, rectangle
from app.services.reporting.figures.axes import digits_of_step, nice_step, plan_axes
from app.services.reporting.figures.labels import legible
from app.services.reporting.figures.scale_bar import scale_bar
from app.services.reporting.numbers import MM_PER_M, count, fixed, nice_below
from app.services.survey_report.figures.plan_key import SYMBOL, WEDGE, legend, symbol
from app.services.survey_report.material import ReportMaterial
from app.storage.records import PhotoResult
from app.targets.layout import PLATE_SIDE_U

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class PlanOptions:
    """How the plan is drawn.

    Attributes
    ----------
    width, height : float
        Of the sheet at most, points: what an A4 page holds beside its margins and the caption.
    confidence : float
        Probability that an ellipse holds the true place.
    ellipse : float
        Semi-axis of a typical ellipse, points: large enough to see its shape.
    most_labels : int
        Targets, and photographs, beyond which they are not labelled: most labels would cover each other.
    """

    width: float = 500.0
    height: float = 560.0
    confidence: float = 0.95
    ellipse: float = 9.0
    most_labels: int = 60

    @property
    def ellipse_sigmas(self) -> float:
        """Semi-axes in standard deviations: the radius that a 2-D normal distribution keeps within."""
        return float(np.sqrt(-2.0 * np.log(1.0 - self.confidence)))


MARGIN = np.array([34.0, 12.0])  # left of the frame for numbers, above it
FOOT = 62.0  # below the frame: numbers, scale bars, legend
FRAME = Pen("muted", 0.6)
LABEL_SIZE = 6.0
GRID_COUNT = 5
LONGEST_NAME = 24
NAMED_LEFT_FROM = 0.75  # share of the frame's width beyond which names stand to the left
BAR_POINTS = 90.0
BARS_BELOW, LEGEND_BELOW = 26.0, 56.0


def plan_view(material: ReportMaterial, options: PlanOptions = PlanOptions()) -> Figure:
    """Targets, photographs and points of a survey from above."""
    plan = _Plan(material, options)
    drawing = Drawing(options.width, float(plan.axes.corner[1] + plan.axes.size[1]) + FOOT, tuple(plan.shapes()))
    percent = f"{100.0 * options.confidence:.0f} %"
    caption = (
        f"Plan view, X to the right and Y up, in metres. Error ellipses of position at {percent} "
        f"({options.ellipse_sigmas:.2f} standard deviations, the datum's part included) and residuals of points, both "
        f"enlarged {count(round(plan.enlargement))} times; plates true to scale."
    )
    return Figure(drawing, caption, plan.description())


class _Plan:
    """What the plan's parts have in common: axes, enlargement, and what is drawn."""

    def __init__(self, material: ReportMaterial, options: PlanOptions) -> None:
        self.material = material
        self.options = options
        self.photos = [photo for photo in material.photos if photo.site_from_cam is not None]
        free = np.array([options.width - MARGIN[0] - MARGIN[1], options.height - MARGIN[1] - FOOT])
        self.axes = plan_axes(self._extent_m(), MARGIN, free)
        typical_m = options.ellipse_sigmas * self._typical_sigma_m()
        self.enlargement = nice_below(options.ellipse / (typical_m * self.axes.points_per_unit[0]))

    def shapes(self) -> list[Shape]:
        """All of the plan, what matters most on top."""
        return [
            *self._grid(),
            *(shape for target in self.material.target_map.targets for shape in self._target(target)),
            *(shape for photo in self.photos for shape in self._photo(photo)),
            *(shape for point in self.material.report.control for shape in self._point(point)),
            *legible([*self._names(), *self._photo_numbers(), *self._codes()]),
            *self._scale_bars(),
            *legend(self.axes.corner + np.array([0.0, self.axes.size[1] + LEGEND_BELOW])),
        ]

    def description(self) -> str:
        """The plan for those who do not see it."""
        low, high = self.axes.low, self.axes.high
        return (
            f"Plan of {len(self.material.target_map.targets)} targets, {len(self.photos)} photographs and "
            f"{len(self.material.report.control)} control and check points between X {fixed(low[0], 1)} and "
            f"{fixed(high[0], 1)} m and Y {fixed(low[1], 1)} and {fixed(high[1], 1)} m."
        )

    def _extent_m(self) -> Array:
        """All places, shape (N, 2)."""
        targets = [target.dots_m[:, :2] for target in self.material.target_map.targets]
        poses = [photo.site_from_cam for photo in self.photos]
        photos = [pose.position_m[None, :2] for pose in poses if pose is not None]
        return np.concatenate([*targets, *photos, *(point.position_m[None, :2] for point in self._seen())])

    def _seen(self) -> list[ControlRecord]:
        return [point for point in self.material.report.control if point.residual_m is not None]

    def _typical_sigma_m(self) -> float:
        """Greater semi-axis of a typical target's ellipse, in standard deviations."""
        covariances = np.array([self._covariance(target) for target in self.material.target_map.targets])
        return float(np.sqrt(np.median(np.linalg.eigvalsh(covariances)[:, -1])))

    def _covariance(self, target: MappedTarget) -> Array:
        shared = self.material.target_map.datum.pose_covariance(target.site_from_target.position_m)
        return (target.covariance + shared)[:2, :2]

    def _grid(self) -> list[Shape]:
        low, high = self.axes.low, self.axes.high
        step = nice_step(0.0, float((high - low).max()), GRID_COUNT)
        digits = digits_of_step(step)
        frame = rectangle(self.axes.corner, self.axes.corner + self.axes.size, FRAME)
        return [*self.axes.grid(0, step, digits), *self.axes.grid(1, step, digits), frame]

    def _target(self, target: MappedTarget) -> list[Shape]:
        half_m = PLATE_SIDE_U * self.material.target_map.u_m / 2.0
        corners_m = half_m * np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
        pose = target.site_from_target
        outline = Path(self.axes.place(pose.apply(corners_m)[:, :2]), Pen("target", 1.4), closed=True)
        return [self._ellipse(pose.position_m, self._covariance(target), "target"), outline]

    def _photo(self, photo: PhotoResult) -> list[Shape]:
        if photo.site_from_cam is None or photo.covariance is None:
            return []
        place_m, view = photo.site_from_cam.position_m, photo.site_from_cam.rotation[:, 2]
        along = np.array([view[0], -view[1]])  # on the sheet y points down
        turn = np.array([along, [-along[1], along[0]]])
        wedge = Path(self.axes.place(place_m[:2]) + WEDGE @ turn, Pen("photo", 0.7), closed=True)
        return [self._ellipse(place_m, photo.covariance[:2, :2], "photo"), wedge]

    def _names(self) -> list[Label]:
        return [self._name(point) for point in self._seen()]

    def _photo_numbers(self) -> list[Label]:
        """As in the table of the photographs."""
        poses = {photo.name: photo.site_from_cam for photo in self.photos}
        if len(poses) > self.options.most_labels:
            return []
        numbered = [(poses[photo.name], number) for number, photo in enumerate(self.material.report.photos, start=1)]
        return [self._behind(pose, str(number), "photo") for pose, number in numbered if pose is not None]

    def _codes(self) -> list[Label]:
        targets = self.material.target_map.targets
        if len(targets) > self.options.most_labels:
            return []
        return [self._behind(target.site_from_target, str(target.code), "target") for target in targets]

    def _behind(self, pose: Pose, text: str, ink: Ink) -> Label:
        """A label behind what looks along its z."""
        backwards = -pose.rotation[:, 2]
        length = float(np.hypot(*backwards[:2]))
        step = np.array([backwards[0], -backwards[1]]) / max(length, 1.0) * LABEL_SIZE
        anchor = self.axes.place(pose.position_m[:2]) + 1.4 * step + np.array([0.0, 0.35 * LABEL_SIZE])
        side = step[0] / LABEL_SIZE
        return Label(anchor, text, ink, LABEL_SIZE, "start" if side > 0.5 else "end" if side < -0.5 else "middle")

    def _point(self, point: ControlRecord) -> list[Shape]:
        if point.residual_m is None:
            return []
        ink = _ink(point)
        place = self.axes.place(point.position_m[:2])
        residual = self.enlargement * point.residual_m[:2] * self.axes.points_per_unit * np.array([1.0, -1.0])
        return [*symbol(place, ink), *arrow(place, residual, Pen("error", 0.9))]

    def _name(self, point: ControlRecord) -> Label:
        """Beside a point, on the side that has room."""
        ink, place = _ink(point), self.axes.place(point.position_m[:2])
        text = point.name if len(point.name) <= LONGEST_NAME else f"{point.name[: LONGEST_NAME - 1]}…"
        left = place[0] > self.axes.corner[0] + NAMED_LEFT_FROM * self.axes.size[0]
        beside = np.array([-SYMBOL - 1.5 if left else SYMBOL + 1.5, -SYMBOL])
        return Label(place + beside, text, ink, LABEL_SIZE + 0.5, "end" if left else "start")

    def _ellipse(self, place_m: Array, covariance_m2: Array, ink: Ink) -> Ellipse:
        values, axes = np.linalg.eigh(covariance_m2)
        reach_m = self.options.ellipse_sigmas * np.sqrt(np.maximum(values[::-1], 0.0)) * self.enlargement
        turn_deg = -float(np.degrees(np.arctan2(axes[1, 1], axes[0, 1])))
        return Ellipse(self.axes.place(place_m[:2]), reach_m * self.axes.points_per_unit[0], turn_deg, Pen(ink, 0.3))

    def _scale_bars(self) -> list[Shape]:
        """Lengths of the plan, and of ellipses and residuals."""
        per_m = float(self.axes.points_per_unit[0])
        plan_m, error_m = nice_below(BAR_POINTS / per_m), nice_below(BAR_POINTS / per_m / self.enlargement)
        at = self.axes.corner + np.array([0.0, self.axes.size[1] + BARS_BELOW])
        error_mm = MM_PER_M * error_m
        errors = f"{error_mm:g} mm in ellipses and residuals"
        second = at + np.array([0.0, 16.0])
        return [
            *scale_bar(at, plan_m * per_m, f"{plan_m:g} m in the plan", "ink"),
            *scale_bar(second, error_m * self.enlargement * per_m, errors, "error"),
        ]


def _ink(point: ControlRecord) -> Ink:
    return "control" if point.role == "control" else "check"
