"""Heat maps over the plan: the radius that holds 95 % of positions at the best and at the worst heading."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose
from app.geometry.target_map import TargetMap
from app.planning.coverage import Coverage
from app.planning.plan_walls import Wall
from app.planning.suggestions import Suggestion
from app.services.coverage_report.classes import INKS, NOT_LOCATED, class_of, names_of, round_edges_m
from app.services.reporting.drawing import Drawing, Ellipse, Ink, Label, Path, Pen, Shape, rectangle
from app.services.reporting.figures.axes import Axes, digits_of_step, nice_step
from app.services.reporting.figures.key import key, key_height
from app.services.reporting.figures.labels import legible
from app.services.reporting.figures.scale_bar import scale_bar
from app.services.reporting.numbers import fixed, nice_below

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class HeatMapOptions:
    """How the maps are drawn, points.

    Attributes
    ----------
    width : float
        Of the sheet.
    tallest : float
        Of one map; a long narrow site is drawn smaller.
    target : float
        Length of the stroke of a target, and of the one that shows its front.
    """

    width: float = 520.0
    tallest: float = 420.0
    target: float = 5.0


@dataclass(frozen=True)
class PlanMaterial:
    """What a heat map shows: predicted accuracy, and what hangs and stands there.

    Attributes
    ----------
    title, subtitle : str
    coverage : Coverage
    target_map : TargetMap
    walls : tuple of Wall
    least_targets : int
        In view, below which a camera is not located.
    suggestions : tuple of Suggestion
    """

    title: str
    subtitle: str
    coverage: Coverage
    target_map: TargetMap
    walls: tuple[Wall, ...] = ()
    least_targets: int = 2
    suggestions: tuple[Suggestion, ...] = ()


LEFT, RIGHT, TOP = 46.0, 14.0, 56.0
TITLE_SIZE, HEAD_SIZE, NOTE_SIZE = 11.0, 9.0, 7.0
TITLE_DOWN, SUBTITLE_DOWN = 18.0, 31.0
HEAD_ABOVE, BETWEEN, TITLE_LEFT = 6.0, 62.0, 32.0
FOOT_BELOW, KEY_BELOW, MARGIN_BELOW = 40.0, 22.0, 8.0
GRID_COUNT = 5
BAR_SHARE = 0.2  # of the map's width
FRAME, WALL = Pen("muted", 0.5), Pen("ink", 1.6)
BLANK = Pen("band", 0.0, filled=True)
UPRIGHT = 0.1  # greatest vertical part of an upright wall's normal: floors are not drawn
ROOM_SHARE = 0.05  # around what is drawn, of its larger side: numbers of suggestions stand behind their walls
SUGGESTED = 6.0  # radius of a suggestion's circle


def draw_heat_map(material: PlanMaterial, options: HeatMapOptions = HeatMapOptions()) -> Drawing:
    """The best and the worst heading of each position, one below the other, with one key."""
    sheet = _Sheet(material, options)
    shapes: list[Shape] = [
        Label(np.array([LEFT, TITLE_DOWN]), material.title, "ink", TITLE_SIZE),
        Label(np.array([LEFT, SUBTITLE_DOWN]), material.subtitle, "muted", NOTE_SIZE),
    ]
    top = TOP
    for head, radii_m in sheet.maps():
        axes = sheet.axes(top)
        shapes += sheet.map(axes, head, radii_m)
        top += axes.size[1] + BETWEEN
    foot = top - BETWEEN + FOOT_BELOW
    shapes += sheet.bar(np.array([LEFT, foot]))
    entries = sheet.entries()
    width = options.width - LEFT - RIGHT
    shapes += key(np.array([LEFT, foot + KEY_BELOW]), width, entries)
    height = foot + KEY_BELOW + key_height(width, entries) + MARGIN_BELOW
    return Drawing(options.width, float(height), tuple(shapes))


def describe(material: PlanMaterial) -> str:
    """The maps for those who do not see them."""
    best, worst = material.coverage.best_m, material.coverage.worst_m
    told = []
    for name, radii_m in (("best", best), ("worst", worst)):
        finite = radii_m[np.isfinite(radii_m)]
        middle = f"{1000.0 * float(np.median(finite)):.1f} mm in the median" if len(finite) else "nowhere located"
        told.append(f"at the {name} heading {middle}, {len(finite)} of {len(radii_m)} positions located")
    return f"{material.title}: radius that holds 95 % of positions; {'; '.join(told)}."


class _Sheet:
    """What the maps have in common: extent, scale, classes."""

    def __init__(self, material: PlanMaterial, options: HeatMapOptions) -> None:
        self.material, self.options = material, options
        coverage = material.coverage
        self.edges_m = round_edges_m(np.concatenate([coverage.best_m, coverage.worst_m]))
        places_m = self._extent_m()
        self.low, self.high = places_m.min(axis=0), places_m.max(axis=0)
        room_m = ROOM_SHARE * float((self.high - self.low).max())
        self.low, self.high = self.low - room_m, self.high + room_m
        free = np.array([options.width - LEFT - RIGHT, options.tallest])
        self.per_m = float((free / (self.high - self.low)).min())

    def maps(self) -> list[tuple[str, Array]]:
        """Heads of the maps and what they show."""
        coverage = self.material.coverage
        count = len(coverage.headings_rad)
        if count == 1:
            return [("At the one heading", coverage.best_m)]
        return [
            (f"At the best of {count} headings", coverage.best_m),
            (f"At the worst of {count} headings", coverage.worst_m),
        ]

    def axes(self, top: float) -> Axes:
        """A frame below a height."""
        return Axes(self.low, self.high, np.array([LEFT, top]), self.per_m * (self.high - self.low))

    def map(self, axes: Axes, head: str, radii_m: Array) -> list[Shape]:
        """One heat map, what matters most on top."""
        finite = radii_m[np.isfinite(radii_m)]
        told = f"{100.0 * len(finite) / len(radii_m):.0f} % of {len(radii_m)} positions are located"
        if len(finite):
            told += f"; median {fixed(1000.0 * float(np.median(finite)), 1)} mm"
        corner = axes.corner
        step = nice_step(0.0, float((self.high - self.low).max()), GRID_COUNT)
        digits = digits_of_step(step)
        return [
            Label(corner - np.array([0.0, HEAD_ABOVE]), f"{head}: {told}", "ink", HEAD_SIZE),
            *self._cells(axes, radii_m),
            *axes.grid(0, step, digits),
            *axes.grid(1, step, digits),
            rectangle(corner, corner + axes.size, FRAME),
            *axes.titles("X, m", "Y, m", TITLE_LEFT),
            *self._walls(axes),
            *(
                shape
                for target in self.material.target_map.targets
                for shape in self._target(axes, target.site_from_target)
            ),
            *self._suggested(axes),
        ]

    def bar(self, at: Array) -> list[Shape]:
        """A length of the plan."""
        length_m = nice_below(BAR_SHARE * float(self.high[0] - self.low[0]))
        return scale_bar(at, length_m * self.per_m, f"{length_m:g} m", "ink")

    def entries(self) -> list[tuple[Pen, str]]:
        """The key: classes with their unit, and what else is drawn."""
        classes = [(Pen(ink, 0.0, filled=True), name) for ink, name in zip(INKS, names_of(self.edges_m), strict=True)]
        few = f"fewer than {self.material.least_targets} targets in view"
        drawn = [(BLANK, few), (Pen("target", 2.0), "target")]
        drawn += [(WALL, "wall")] if self.material.walls else []
        drawn += [(Pen("control", 1.2), "suggested, in order")] if self.material.suggestions else []
        return [*classes, *drawn]

    def _extent_m(self) -> Array:
        """All that is drawn, shape (N, 2)."""
        grid = self.material.coverage.grid
        cells_m = np.array([[grid.columns_m[0], grid.rows_m[0]], [grid.columns_m[-1], grid.rows_m[-1]]])
        half_m = _step_m(grid.columns_m, grid.rows_m) / 2.0
        walls = [wall.corners_m()[:, :2] for wall in self.material.walls]
        targets = [target.dots_m[:, :2] for target in self.material.target_map.targets]
        return np.concatenate([cells_m - half_m, cells_m + half_m, *walls, *targets])

    def _cells(self, axes: Axes, radii_m: Array) -> list[Shape]:
        """Cells of one class that lie side by side as one rectangle."""
        grid = self.material.coverage.grid
        classes = grid.spread(class_of(radii_m, self.edges_m).astype(np.float64))
        half_m = _step_m(grid.columns_m, grid.rows_m) / 2.0
        shapes: list[Shape] = []
        for row_m, row in zip(grid.rows_m, classes, strict=True):
            for first, last, of in _runs(row):
                low = np.array([grid.columns_m[first] - half_m, row_m - half_m])
                high = np.array([grid.columns_m[last] + half_m, row_m + half_m])
                pen = BLANK if of == NOT_LOCATED else Pen(INKS[of], 0.0, filled=True)
                shapes.append(rectangle(axes.place(low), axes.place(high), pen))
        return shapes

    def _walls(self, axes: Axes) -> list[Shape]:
        upright = [wall for wall in self.material.walls if abs(wall.site_from_wall.rotation[2, 2]) < UPRIGHT]
        return [Path(axes.place(wall.corners_m()[:2, :2]), WALL) for wall in upright]

    def _target(self, axes: Axes, pose: Pose, ink: Ink = "target") -> list[Shape]:
        """A stroke along the plate, and a short one out of its front."""
        place = axes.place(pose.position_m[:2])
        along, out = (np.array([part[0], -part[1]]) for part in (pose.rotation[:, 0], pose.rotation[:, 2]))
        half = self.options.target / 2.0 * along
        return [
            Path(np.array([place - half, place + half]), Pen(ink, 2.0)),
            Path(np.array([place, place + self.options.target * out]), Pen(ink, 0.8)),
        ]

    def _suggested(self, axes: Axes) -> list[Shape]:
        shapes: list[Shape] = []
        labels = []
        for number, suggestion in enumerate(self.material.suggestions, start=1):
            pose = suggestion.place.posted.site_from_target
            place = axes.place(pose.position_m[:2])
            shapes += [
                *self._target(axes, pose, "control"),
                Ellipse(place, np.full(2, SUGGESTED), 0.0, Pen("control", 1.2)),
            ]
            inwards = np.array([pose.rotation[0, 2], -pose.rotation[1, 2]])
            at = place - 2.0 * SUGGESTED * inwards + np.array([0.0, 0.35 * HEAD_SIZE])
            labels.append(Label(at, str(number), "control", HEAD_SIZE, "middle"))
        return [*shapes, *legible(labels)]


def _runs(row: Array) -> list[tuple[int, int, int]]:
    """First and last column, and class, of neighbours of one class; NaN is none."""
    borders = np.flatnonzero(np.r_[True, row[1:] != row[:-1], True])
    runs = zip(borders[:-1].tolist(), borders[1:].tolist(), strict=True)
    return [(first, after - 1, int(row[first])) for first, after in runs if np.isfinite(row[first])]


def _step_m(columns_m: Array, rows_m: Array) -> float:
    """Of the grid; a metre for a single position."""
    longer = columns_m if len(columns_m) > 1 else rows_m
    return float(longer[1] - longer[0]) if len(longer) > 1 else 1.0
