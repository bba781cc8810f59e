"""A site whose snapshots are synthesised without pixels: a map that errs as it says, targets that move.

What a snapshot errs by: each plate's image is shifted as a whole and each dot by itself, the focal length breathes,
some codes are misread as those of other targets, and some pictures are bad as a whole.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.errors import NotLocated
from app.geometry.camera import CalibratedCamera, Camera
from app.geometry.observations import TargetObservation
from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.geometry.target_map import Datum, MappedTarget, TargetMap
from app.photogrammetry.evidence import gather_evidence
from app.photogrammetry.map_watch import WatchedSnapshot
from app.photogrammetry.resection import resect
from app.planning.posting import RoomOptions
from app.planning.room import build_room
from app.planning.scene import PostedTarget
from app.planning.survey_plan import look_at, phone_camera
from app.targets.family import family_by_name
from app.targets.layout import DOT_COUNT

Array = npt.NDArray[np.float64]

FAMILY = "golay"


@dataclass(frozen=True)
class SiteOptions:
    """What the site is like.

    Attributes
    ----------
    room : RoomOptions
    own_sigmas : tuple of float
        Of a mapped target: each coordinate, m; each rotation, rad.
    shift_px, dot_px : float
        Standard deviations of a plate's image as a whole and of a dot by itself; the covariances tell the latter only.
    focal_share : float
        By which the focal length breathes from snapshot to snapshot.
    misread_share, bad_share : float
        Of sightings that carry another target's code, of pictures with errors ten times as great.
    least_px_per_u, greatest_incidence_deg : float
        Plates that are read.
    """

    room: RoomOptions = RoomOptions(size_m=(8.0, 6.0, 2.8), targets=60, furniture=False)
    own_sigmas: tuple[float, float] = (2.5e-4, 8e-4)
    shift_px: float = 0.05
    dot_px: float = 0.07
    focal_share: float = 5e-4
    misread_share: float = 0.005
    bad_share: float = 0.02
    least_px_per_u: float = 2.2
    greatest_incidence_deg: float = 60.0


class WatchedSite:
    """A site and its snapshots, each a second after the last.

    Parameters
    ----------
    options : SiteOptions
    seed : int
    """

    def __init__(self, options: SiteOptions, seed: int) -> None:
        self._options = options
        self._rng = np.random.default_rng(seed)
        self._targets = build_room(options.room, family_by_name(FAMILY), seed).targets
        self._camera = phone_camera(1920, 1080)
        self.target_map = self._surveyed()
        self._time_s = 0.0

    @property
    def codes(self) -> tuple[int, ...]:
        """Of all targets."""
        return tuple(target.code for target in self._targets)

    def move(self, code: int, along_wall_m: float) -> Array:
        """Move a target along its wall into a random direction; by how much, site axes, shape (3,)."""
        (target,) = (target for target in self._targets if target.code == code)
        angle_rad = self._rng.uniform(0.0, 2.0 * np.pi)
        pose = target.site_from_target
        shift_m = pose.rotation @ (along_wall_m * np.array([np.cos(angle_rad), np.sin(angle_rad), 0.0]))
        moved = replace(target, site_from_target=Pose(pose.rotation, pose.position_m + shift_m))
        self._set(code, (moved,))
        return np.asarray(shift_m)

    def take_down(self, code: int) -> None:
        """Remove a target."""
        self._set(code, ())

    def snapshots(self) -> Iterator[WatchedSnapshot]:
        """One after the other, for ever; a picture that is refused for any reason but contradiction tells nothing."""
        while True:
            self._time_s += 1.0
            observations = self.observe()
            try:
                resection = resect(observations, self.target_map, self.calibrated)
            except NotLocated as refusal:
                if refusal.fields["reason"] == "inconsistent":
                    yield WatchedSnapshot(self._time_s, None, None)
                continue
            yield WatchedSnapshot(self._time_s, None, gather_evidence(observations, self.target_map, resection))

    def _set(self, code: int, instead: tuple[PostedTarget, ...]) -> None:
        self._targets = (*(target for target in self._targets if target.code != code), *instead)

    def _surveyed(self) -> TargetMap:
        """The map: every target errs as its covariance says."""
        sigmas = np.repeat(self._options.own_sigmas, 3)
        targets = []
        for target in self._targets:
            error = self._rng.normal(0.0, sigmas)
            pose = target.site_from_target
            site_from_target = Pose(exp_rotation(error[3:]) @ pose.rotation, pose.position_m + error[:3])
            in_target_m = pose.inverse().apply(target.dots_m())
            targets.append(
                MappedTarget(
                    target.code, site_from_target, site_from_target.apply(in_target_m), np.diag(sigmas**2), 9, 0.1
                )
            )
        return TargetMap(tuple(targets), Datum(np.zeros(3), np.zeros((7, 7))), FAMILY, self._options.room.u_m)

    @property
    def calibrated(self) -> CalibratedCamera:
        """What is believed of the camera: the truth's mean, with the scatter between photographs."""
        sigmas = np.array(
            [self._options.focal_share * self._camera.fx_px] * 2 + [0.5, 0.5, 1e-3, 3e-3, 5e-5, 5e-5, 3e-3]
        )
        return CalibratedCamera(self._camera, np.diag(sigmas**2), "survey")

    def observe(self) -> list[TargetObservation]:
        """What a phone somewhere in the room reads."""
        options, rng = self._options, self._rng
        x_m, y_m, _ = options.room.size_m
        position_m = rng.uniform([1.0, 1.0, 1.2], [x_m - 1.0, y_m - 1.0, 1.8])
        heading_rad, up_rad = rng.uniform(0.0, 2.0 * np.pi), rng.normal(0.0, 0.1)
        ahead_m = np.array([np.cos(heading_rad), np.sin(heading_rad), np.tan(up_rad)])
        site_from_cam = look_at(position_m, position_m + ahead_m)
        breath = np.array([1.0 + rng.normal(0.0, options.focal_share)] * 2 + [1.0] * 7)
        camera = self._camera.with_intrinsics(self._camera.intrinsics * breath)
        worse = 10.0 if rng.random() < options.bad_share else 1.0
        read: dict[int, TargetObservation] = {}
        for target in self._targets:
            dots_px = self._image_of(target, camera, site_from_cam)
            code = int(rng.choice(self.codes)) if rng.random() < options.misread_share else target.code
            if dots_px is not None and code not in read:
                read[code] = self._measured(code, dots_px, worse)
        return list(read.values())

    def _image_of(self, target: PostedTarget, camera: Camera, site_from_cam: Pose) -> Array | None:
        """Where the dots are seen, shape (16, 2); None when the plate is not wholly in view or cannot be read."""
        options = self._options
        cam_m = site_from_cam.inverse().apply(target.dots_m())
        towards_m = site_from_cam.position_m - target.site_from_target.position_m
        cosine = target.site_from_target.rotation[:, 2] @ towards_m / np.linalg.norm(towards_m)
        size_px = camera.fx_px * target.u_m / cam_m[:, 2].mean()
        readable = size_px >= options.least_px_per_u and cosine >= np.cos(np.radians(options.greatest_incidence_deg))
        straight_px = cam_m[:, :2] / cam_m[:, 2:] * camera.fx_px
        corner_px = np.array([camera.width_px - 1, camera.height_px - 1])
        if not readable or cam_m[:, 2].min() <= 0 or (np.abs(straight_px) > corner_px).any():
            return None
        dots_px = camera.project(cam_m)
        return dots_px if ((dots_px > 0) & (dots_px < corner_px)).all() else None

    def _measured(self, code: int, dots_px: Array, worse: float) -> TargetObservation:
        options, rng = self._options, self._rng
        shift_px = rng.normal(0.0, worse * options.shift_px, 2)
        centres_px = dots_px + shift_px + rng.normal(0.0, worse * options.dot_px, (DOT_COUNT, 2))
        covariances_px2 = np.tile(options.dot_px**2 * np.eye(2), (DOT_COUNT, 1, 1))
        return TargetObservation(code, centres_px, covariances_px2, np.ones(DOT_COUNT, dtype=np.bool_))
