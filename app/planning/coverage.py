"""Coverage: how well cameras will be located over a grid of positions, at their best and at their worst heading."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.errors import InvalidInput
from app.geometry.pose import Pose
from app.geometry.target_map import TargetMap
from app.photogrammetry.resection_equations import CameraPrior
from app.planning.plan_view import ViewWish
from app.planning.plan_walls import Wall
from app.planning.predicted_accuracy import datum_covariances, information_of, position_covariances, radius95
from app.planning.predicted_views import MapArrays, Seeing, predict_views
from app.planning.sight_lines import find_sight_lines, lie_open
from app.planning.survey_plan import look_at

Array = npt.NDArray[np.float64]
Counts = npt.NDArray[np.intp]
Progress = Callable[[str, int, int], None]

MOST_VIEWS = 400_000  # positions times headings: some minutes of work
REPORTED_EVERY = 20  # positions


@dataclass(frozen=True)
class Grid:
    """Positions at equal steps, row by row from the south-west.

    Attributes
    ----------
    columns_m, rows_m : ndarray of shape (X,), (Y,)
        Coordinates along x and y.
    positions_m : ndarray of shape (P, 3)
        Those that lie before walls.
    cells : ndarray of shape (P,)
        Which cell of the grid, ``row * X + column``, each position is.
    """

    columns_m: Array
    rows_m: Array
    positions_m: Array
    cells: Counts

    def spread(self, values: Array) -> Array:
        """Values (P, ...) as a picture (Y, X, ...), NaN where there is no position."""
        picture = np.full((len(self.rows_m) * len(self.columns_m), *values.shape[1:]), np.nan)
        picture[self.cells] = values
        return picture.reshape(len(self.rows_m), len(self.columns_m), *values.shape[1:])


@dataclass(frozen=True)
class Coverage:
    """Predicted accuracy of P positions in H directions.

    Attributes
    ----------
    grid : Grid
    headings_rad : ndarray of shape (H,)
        From the site's X, anticlockwise seen from above.
    radii95_m : ndarray of shape (P, H)
        Radius that holds 95 % of positions, in 3-D; infinite where a camera would not be located.
    sigmas_m : ndarray of shape (P, H, 3)
        Standard deviation along x, y, z; infinite likewise.
    targets : ndarray of shape (P, H), int
        In view.
    """

    grid: Grid
    headings_rad: Array
    radii95_m: Array
    sigmas_m: Array
    targets: Counts

    @property
    def best_m(self) -> Array:
        """Radius at each position's best heading, shape (P,)."""
        return np.asarray(self.radii95_m.min(axis=1))

    @property
    def worst_m(self) -> Array:
        """Radius at each position's worst heading, shape (P,)."""
        return np.asarray(self.radii95_m.max(axis=1))

    @property
    def middle_m(self) -> Array:
        """Radius that half of the headings reach, shape (P,)."""
        ordered = np.sort(self.radii95_m, axis=1)
        return np.asarray(ordered[:, (ordered.shape[1] - 1) // 2])

    @property
    def located_share(self) -> Array:
        """Share of headings with a position, shape (P,)."""
        return np.asarray(np.isfinite(self.radii95_m).mean(axis=1))


def predict_coverage(
    target_map: TargetMap,
    walls: Sequence[Wall],
    seeing: Seeing,
    wish: ViewWish,
    progress: Progress | None = None,
) -> Coverage:
    """Predicted accuracy over a grid.

    Parameters
    ----------
    target_map : TargetMap
        Of a survey, or ``planned_map``.
    walls : sequence of Wall
        What hides; none: only the targets' fronts and sizes decide.
    seeing : Seeing
        Its limits are the wish's.
    wish : ViewWish
    progress : callable, optional
        Told a stage, positions done and positions in all.

    Raises
    ------
    InvalidInput
        When the grid has no position, or too many.
    """
    grid = make_grid(target_map, walls, wish)
    arrays, prior = MapArrays.of(target_map.targets), CameraPrior.of(seeing.camera)
    focal_px = seeing.camera.camera.fx_px
    lines = find_sight_lines(grid.positions_m, target_map.targets, walls, (focal_px, seeing.limits))
    datum = datum_covariances(target_map.datum, grid.positions_m)
    headings_rad = headings_of(wish)
    shape = len(grid.positions_m), len(headings_rad)
    radii_m, sigmas_m = np.full(shape, np.inf), np.full((*shape, 3), np.inf)
    targets = np.zeros(shape, dtype=np.intp)
    for index, position_m in enumerate(grid.positions_m):
        views = predict_views(arrays, lines.of(index), poses_at(position_m, headings_rad, wish), seeing)
        known = information_of(views, prior)
        targets[index] = known.targets
        enough = known.targets >= seeing.limits.min_targets
        covariances = position_covariances(known.matrices[enough], datum[index])
        radii_m[index, enough] = radius95(covariances)
        sigmas_m[index, enough] = np.sqrt(np.diagonal(covariances, axis1=1, axis2=2))
        if progress is not None and (index + 1) % REPORTED_EVERY == 0:
            progress("predict", index + 1, shape[0])
    return Coverage(grid, headings_rad, radii_m, sigmas_m, targets)


def make_grid(target_map: TargetMap, walls: Sequence[Wall], wish: ViewWish) -> Grid:
    """The positions of a wish: at whole steps from the middle of its area, before walls.

    Raises
    ------
    InvalidInput
        When there is none, or too many.
    """
    west, south, east, north = wish.area_m or _enclosed(target_map, walls)
    columns_m, rows_m = _steps(west, east, wish.step_m), _steps(south, north, wish.step_m)
    if len(columns_m) * len(rows_m) * wish.headings > MOST_VIEWS:
        raise InvalidInput(
            f"{len(columns_m)} x {len(rows_m)} positions in {wish.headings} directions are more than {MOST_VIEWS} "
            "views; take a larger step, fewer headings or a smaller area",
            field="step_m",
        )
    x_m, y_m = (part.ravel() for part in np.meshgrid(columns_m, rows_m))
    everywhere_m = np.column_stack([x_m, y_m, np.full(len(x_m), wish.height_m)])
    cells = np.flatnonzero(lie_open(everywhere_m, walls, wish.clearance_m))
    if not len(cells):
        raise InvalidInput(
            "no position of the grid lies before the walls; check the area, the height, the clearance and which way "
            "the walls face",
            field="area",
        )
    return Grid(columns_m, rows_m, everywhere_m[cells], cells)


def headings_of(wish: ViewWish) -> Array:
    """Directions from the site's X, anticlockwise, shape (H,)."""
    return np.arange(wish.headings) * 2.0 * np.pi / wish.headings


def poses_at(position_m: Array, headings_rad: Array, wish: ViewWish) -> tuple[Pose, ...]:
    """``site_from_cam`` at a position in each direction."""
    rise, roll_rad = np.tan(np.radians(wish.pitch_deg)), np.pi / 2 if wish.upright else 0.0
    return tuple(
        look_at(position_m, position_m + np.array([np.cos(heading), np.sin(heading), rise]), roll_rad)
        for heading in headings_rad
    )


def _enclosed(target_map: TargetMap, walls: Sequence[Wall]) -> tuple[float, float, float, float]:
    """The rectangle around walls, or around targets where there are none."""
    if walls:
        corners_m = np.concatenate([wall.corners_m() for wall in walls])
        (west, south), (east, north) = corners_m[:, :2].min(axis=0), corners_m[:, :2].max(axis=0)
    else:
        least_m, greatest_m = target_map.bounds_m()
        (west, south), (east, north) = least_m[:2], greatest_m[:2]
    return float(west), float(south), float(east), float(north)


def _steps(least_m: float, greatest_m: float, step_m: float) -> Array:
    """Coordinates at equal steps, as far from both ends, a position in the middle of each cell."""
    count = max(int(np.floor((greatest_m - least_m) / step_m + 1e-9)), 1)
    if count > MOST_VIEWS:
        raise InvalidInput(f"a step of {step_m:g} m makes {count} columns; take a larger one", field="step_m")
    from_middle = np.arange(count, dtype=np.float64) - (count - 1) / 2
    return np.asarray((least_m + greatest_m) / 2 + from_middle * step_m, dtype=np.float64)
