"""A target map as a JSON file: what ``GET /sites/{site_id}/targets`` answers, and all that an honest pose needs.

Beside the published fields it holds each target's covariance, the datum and the survey's cameras.
"""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from app.errors import InvalidInput
from app.geometry.camera import CalibratedCamera, Camera, CameraIdentity, CameraSource
from app.geometry.pose import Pose
from app.geometry.readout import Readout
from app.geometry.target_map import Datum, MappedTarget, TargetMap

FORMAT = "scattermark-map-1"


@dataclass(frozen=True)
class MapCamera:
    """A calibrated camera and how its photographs are recognised."""

    identity: CameraIdentity
    calibrated: CalibratedCamera


@dataclass(frozen=True)
class MapFile:
    """What one file holds: a target map and the cameras of its survey."""

    target_map: TargetMap
    cameras: tuple[MapCamera, ...] = ()


def write_map(path: Path, content: MapFile) -> None:
    """Write a map file whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile("w", dir=path.parent, prefix=f".{path.name}.", delete=False) as file:
        partial = Path(file.name)
        try:
            json.dump(map_to_json(content), file)
            file.flush()
            os.fsync(file.fileno())
        except BaseException:
            partial.unlink()
            raise
    partial.replace(path)


def read_map(path: Path) -> MapFile:
    """Read a map file.

    Raises
    ------
    InvalidInput
        When it is missing, no JSON, or no target map.
    """
    try:
        record = json.loads(path.read_text())
    except OSError as error:
        raise InvalidInput(f"cannot read the map {path}: {error.strerror}") from error
    except ValueError as error:
        raise InvalidInput(
            f"{path} is no JSON ({error}); give the file that `scattermark build --out` wrote"
        ) from error
    try:
        return map_from_json(record)
    except (KeyError, TypeError, ValueError) as error:
        raise InvalidInput(f"{path} is no target map: {error!r}; write it again with `scattermark build`") from error


def map_to_json(content: MapFile) -> dict[str, Any]:
    """A JSON-ready record; ``map_from_json`` reads it back exactly."""
    target_map = content.target_map
    datum = target_map.datum
    return {
        "format": FORMAT,
        "code_family": target_map.code_family,
        "plate_u_m": target_map.u_m,
        "targets": [target_to_json(target, datum) for target in target_map.targets],
        "datum": {
            "origin_m": datum.origin_m.tolist(),
            "covariance": datum.covariance.tolist(),
            "assumed_scale": datum.assumed_scale,
            "assumed_orientation": datum.assumed_orientation,
        },
        "cameras": [_camera_to_json(camera) for camera in content.cameras],
    }


def map_from_json(record: Mapping[str, Any]) -> MapFile:
    """The content of a record; ``KeyError``, ``TypeError`` or ``ValueError`` when it is another thing."""
    if record["format"] != FORMAT:
        raise ValueError(f"its format is {record['format']!r}, not {FORMAT!r}")
    datum = Datum(
        origin_m=np.array(record["datum"]["origin_m"], dtype=np.float64),
        covariance=np.array(record["datum"]["covariance"], dtype=np.float64),
        assumed_scale=bool(record["datum"]["assumed_scale"]),
        assumed_orientation=bool(record["datum"]["assumed_orientation"]),
    )
    targets = tuple(_target_from_json(target) for target in record["targets"])
    target_map = TargetMap(targets, datum, str(record["code_family"]), float(record["plate_u_m"]))
    return MapFile(target_map, tuple(_camera_from_json(camera) for camera in record["cameras"]))


def target_to_json(target: MappedTarget, datum: Datum) -> dict[str, Any]:
    """One target; ``sigma_m`` holds both parts of its uncertainty, ``covariance`` its own part."""
    pose = target.site_from_target
    position_variance_m2 = np.diag(target.covariance + datum.pose_covariance(pose.position_m))[:3]
    return {
        "code": target.code,
        "position_m": pose.position_m.tolist(),
        "orientation_xyzw": pose.orientation_xyzw.tolist(),
        "dots_m": target.dots_m.tolist(),
        "sigma_m": np.sqrt(position_variance_m2).tolist(),
        "rays": target.rays,
        "rms_px": target.rms_px,
        "covariance": target.covariance.tolist(),
    }


def _target_from_json(record: Mapping[str, Any]) -> MappedTarget:
    return MappedTarget(
        code=int(record["code"]),
        site_from_target=Pose.from_quaternion(
            np.array(record["orientation_xyzw"], dtype=np.float64), np.array(record["position_m"], dtype=np.float64)
        ),
        dots_m=np.array(record["dots_m"], dtype=np.float64),
        covariance=np.array(record["covariance"], dtype=np.float64),
        rays=int(record["rays"]),
        rms_px=float(record["rms_px"]),
    )


def _camera_to_json(known: MapCamera) -> dict[str, Any]:
    return {
        "identity": asdict(known.identity),
        "intrinsics": known.calibrated.camera.intrinsics.tolist(),
        "covariance": known.calibrated.covariance.tolist(),
        "source": known.calibrated.source,
        "readout_s": None if known.calibrated.readout is None else known.calibrated.readout.duration_s,
    }


def _camera_from_json(record: Mapping[str, Any]) -> MapCamera:
    identity = CameraIdentity(**record["identity"])
    intrinsics = np.array(record["intrinsics"], dtype=np.float64)
    camera = Camera(identity.width_px, identity.height_px, intrinsics)
    covariance = np.array(record["covariance"], dtype=np.float64)
    readout_s = record.get("readout_s")  # maps that were written before it was asked for have none
    readout = None if readout_s is None else Readout(float(readout_s))
    return MapCamera(identity, CalibratedCamera(camera, covariance, cast(CameraSource, record["source"]), readout))
