"""From where to photograph a target next, so that its rays meet at a wide angle."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

UP = np.array([0.0, 0.0, 1.0])  # of the site frame


@dataclass(frozen=True)
class Viewed:
    """A target that stands, and the photographs that stand and see it.

    Attributes
    ----------
    rotation : ndarray of shape (3, 3)
        ``frame_from_target``: x to the right of whoever faces the plate, y up the plate, z towards the viewer.
    position_m : ndarray of shape (3,)
    eyes_m : ndarray of shape (N, 3)
        Where the photographs were taken.
    names : tuple of str
        Of these photographs.
    """

    rotation: Array
    position_m: Array
    eyes_m: Array
    names: tuple[str, ...]

    @property
    def normal(self) -> Array:
        """Towards the viewer, shape (3,)."""
        return self.rotation[:, 2]

    @cached_property
    def rays(self) -> Array:
        """Directions from the target to the photographs, shape (N, 3)."""
        away_m = self.eyes_m - self.position_m
        return np.asarray(away_m / np.linalg.norm(away_m, axis=-1, keepdims=True))

    @property
    def angle_rad(self) -> float:
        """Greatest angle between two rays; zero with fewer than two."""
        if len(self.rays) == 0:
            return 0.0
        return float(np.arccos(np.clip((self.rays @ self.rays.T).min(), -1.0, 1.0)))

    def angle_to(self, direction: Array) -> float:
        """Least angle between a direction and the rays, rad."""
        return float(np.arccos(np.clip((self.rays @ direction).max(), -1.0, 1.0)))


@dataclass(frozen=True)
class ViewpointOptions:
    """Which viewpoints are proposed.

    Attributes
    ----------
    turns_rad : tuple of float
        Directions that are tried, to either side of the plate's normal: up to 50 degrees plates are measured well.
    nearer : tuple of float
        Distances that are tried, as shares of the median distance that the target was photographed from.
    half_view_rad : float
        What of a phone's picture is surely in view about its middle.
    greatest_incidence_rad : float
        Plates are read up to here without fail.
    reach : float
        Targets are helped that are no farther than so many times the one that is aimed at.
    new_rad : float
        A ray this far from all others is a new one: three times the angle that a target needs.
    """

    turns_rad: tuple[float, ...] = tuple(np.radians(np.arange(-50.0, 51.0, 10.0)).tolist())
    nearer: tuple[float, ...] = (1.0, 0.8, 0.6)
    half_view_rad: float = float(np.radians(25.0))
    greatest_incidence_rad: float = float(np.radians(60.0))
    reach: float = 1.5
    new_rad: float = float(np.radians(15.0))


@dataclass(frozen=True)
class Shot:
    """Where to stand and what to look at.

    Attributes
    ----------
    eye_m, aim_m : ndarray of shape (3,)
    beside : str
        The photograph that was taken nearest to there.
    right_m, back_m, up_m : float
        How far from where it was taken, for whoever faces the target: to the right, away from it, upwards.
    options : ViewpointOptions
    """

    eye_m: Array
    aim_m: Array
    beside: str
    right_m: float
    back_m: float
    up_m: float
    options: ViewpointOptions

    def helps(self, viewed: Viewed) -> bool:
        """Whether a photograph from here shows a target and adds a ray that none of its rays comes near to."""
        to_eye_m = self.eye_m - viewed.position_m
        distance_m = float(np.linalg.norm(to_eye_m))
        ahead = (self.aim_m - self.eye_m) / np.linalg.norm(self.aim_m - self.eye_m)
        in_view = -to_eye_m @ ahead >= distance_m * np.cos(self.options.half_view_rad)
        faced = to_eye_m @ viewed.normal >= distance_m * np.cos(self.options.greatest_incidence_rad)
        near = distance_m <= self.options.reach * float(np.linalg.norm(self.aim_m - self.eye_m))
        return bool(in_view and faced and near and viewed.angle_to(to_eye_m / distance_m) >= self.options.new_rad)


@dataclass(frozen=True)
class Viewpoints:
    """Proposes viewpoints.

    Attributes
    ----------
    upright : bool
        Whether z is up: then the camera stays as high as it was. Else the plates' own uprights are believed.
    stations_m : ndarray of shape (P, 3)
        Where photographs were taken, of whatever: there one can stand.
    names : tuple of str
        Of these photographs.
    options : ViewpointOptions
    """

    upright: bool
    stations_m: Array
    names: tuple[str, ...]
    options: ViewpointOptions = ViewpointOptions()

    def shot(self, viewed: Viewed) -> Shot:
        """Of the viewpoints that give a new ray the one nearest to where somebody stood; else the newest ray."""
        axes = self._axes(viewed)
        tried_m = self._tried(viewed, axes)
        angles_rad = np.array([viewed.angle_to(_unit(at_m - viewed.position_m)) for at_m in tried_m])
        away_m = np.linalg.norm(tried_m[:, None] - self.stations_m, axis=2)
        new = angles_rad >= min(self.options.new_rad, float(angles_rad.max()))
        best = int(np.where(new, away_m.min(axis=1), np.inf).argmin())
        nearest = int(away_m[best].argmin())
        right_m, back_m, up_m = (float(axis @ (tried_m[best] - self.stations_m[nearest])) for axis in axes)
        return Shot(tried_m[best], viewed.position_m, self.names[nearest], right_m, back_m, up_m, self.options)

    def _tried(self, viewed: Viewed, axes: tuple[Array, Array, Array]) -> Array:
        """Viewpoints about as far from the target, and as high, as those that it was photographed from, (N, 3)."""
        right, out, up = axes
        heights_m = (viewed.eyes_m - viewed.position_m) @ up
        away_m = float(np.median(np.linalg.norm(viewed.eyes_m - viewed.position_m - np.outer(heights_m, up), axis=1)))
        level_m = viewed.position_m + float(np.median(heights_m)) * up
        return np.array(
            [
                level_m + share * away_m * (np.cos(turn_rad) * out + np.sin(turn_rad) * right)
                for share in self.options.nearer
                for turn_rad in self.options.turns_rad
            ]
        )

    def _axes(self, viewed: Viewed) -> tuple[Array, Array, Array]:
        """To the right of whoever faces the plate, away from it, upwards; of a plate on the floor, the plate's own."""
        if self.upright:
            level = np.array([viewed.normal[0], viewed.normal[1], 0.0])
            if np.linalg.norm(level) > np.sin(self.options.half_view_rad):
                out = _unit(level)
                return np.cross(UP, out), out, UP
        return viewed.rotation[:, 0], viewed.rotation[:, 2], viewed.rotation[:, 1]


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))
