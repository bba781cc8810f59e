"""A snapshot to a pose with the cameras of a map file: photo -> detect -> look up -> resect."""

from __future__ import annotations

from app.geometry.camera import CalibratedCamera
from app.geometry.map_file import MapFile
from app.geometry.observations import Detection
from app.services.best_pose import BestPose, resect_best
from app.services.choose_camera import KnownCameras, choose_cameras
from app.storage.records import StoredCamera
from app.targets.family import family_by_name
from app.vision.detector import detect
from app.vision.photo import Photo


def known_cameras(content: MapFile, named: CalibratedCamera | None = None) -> KnownCameras:
    """The survey's cameras, and the one that the user describes, which comes first."""
    stored = tuple(
        StoredCamera(camera.identity.key, camera.identity, camera.calibrated, None, None, None, 0.0)
        for camera in content.cameras
    )
    return KnownCameras(named=named, stored=stored)


def detect_in_map(photo: Photo, content: MapFile) -> Detection:
    """What is seen of a site whose codes are known."""
    target_map = content.target_map
    family = family_by_name(target_map.code_family)
    return detect(photo.bgr, family, known_codes=frozenset(target_map.by_code))


def resect_in_map(photo: Photo, detection: Detection, content: MapFile, known: KnownCameras) -> BestPose:
    """Pose and camera of a snapshot.

    Raises
    ------
    NotLocated
    """
    return resect_best(detection, content.target_map, choose_cameras(photo.header, known))
