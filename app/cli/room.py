"""A room on disk: photographs, control points, and, where it is known, the truth to score against.

The truth is for scoring alone; of the files that hold it only the printed size of the plates is read before.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from app.cli.arguments import photo_files
from app.errors import InvalidInput
from app.geometry.camera import Camera
from app.geometry.pose import Pose
from app.targets.layout import DEFAULT_U_M, DOT_COUNT

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Room:
    """What a survey of a room consists of.

    Attributes
    ----------
    folder : Path
    survey, snapshots : tuple of Path
        Photographs to build the map from, and photographs to locate.
    control_points : Path
        CSV with the columns ``name,code,dot,x_m,y_m,z_m,sigma_m,role``.
    plate_u_m : float
        Printed module of the plates.
    """

    folder: Path
    survey: tuple[Path, ...]
    snapshots: tuple[Path, ...]
    control_points: Path
    plate_u_m: float


@dataclass(frozen=True)
class PlateInView:
    """A plate that stands wholly in a photograph's view.

    Attributes
    ----------
    code : int or None
        None for a plate of wrong structure, which must be refused.
    px_per_u : float
        Size: fx u / mean depth, not foreshortened.
    incidence_deg : float
        Angle between the view and the plate's normal.
    dots_px : ndarray of shape (16, 2)
        True dot centres, row-major cells.
    """

    code: int | None
    px_per_u: float
    incidence_deg: float
    dots_px: Array


@dataclass(frozen=True)
class TrueShot:
    """What is true of one photograph."""

    name: str
    site_from_cam: Pose
    plates: tuple[PlateInView, ...]


@dataclass(frozen=True)
class TrueShots:
    """What is true of a folder of photographs, by file name."""

    camera: Camera
    shots: dict[str, TrueShot]


def open_room(folder: Path, plate_u_m: float | None = None) -> Room:
    """Look at a room's folder.

    Raises
    ------
    InvalidInput
        When something that a survey needs is missing.
    """
    for part in ("survey", "locate", "control_points.csv"):
        if not (folder / part).exists():
            raise InvalidInput(
                f"{folder} is no room: {part} is missing; a room holds survey/, locate/ and control_points.csv"
            )
    return Room(
        folder,
        tuple(photo_files([folder / "survey"])),
        tuple(photo_files([folder / "locate"])),
        folder / "control_points.csv",
        plate_u_m or _printed_u_m(folder),
    )


def has_truth(room: Room) -> bool:
    """Whether snapshots of the room can be scored."""
    return (room.folder / "locate" / "truth.json").exists()


def true_shots(folder: Path) -> TrueShots:
    """The truth of ``survey`` or ``locate``.

    Raises
    ------
    InvalidInput
        When the file is missing or of another form.
    """
    record = _read_json(folder / "truth.json")
    try:
        camera, shots = _camera(record["camera"]), [_shot(shot) for shot in record["shots"]]
    except (KeyError, TypeError, ValueError) as error:
        raise InvalidInput(f"{folder / 'truth.json'} is not the truth of photographs: {error!r}") from error
    return TrueShots(camera, {shot.name: shot for shot in shots})


def true_dots_m(room: Room) -> dict[int, Array]:
    """Dot centres in the site frame, shape (16, 3), by code.

    Raises
    ------
    InvalidInput
        When the file is missing or of another form.
    """
    path = room.folder / "targets_truth.json"
    try:
        return {
            int(target["code"]): np.array(target["dots_m"], dtype=np.float64).reshape(DOT_COUNT, 3)
            for target in _read_json(path)["targets"]
        }
    except (KeyError, TypeError, ValueError) as error:
        raise InvalidInput(f"{path} is not the truth of targets: {error!r}") from error


def _printed_u_m(folder: Path) -> float:
    path = folder / "targets_truth.json"
    return float(_read_json(path)["u_m"]) if path.exists() else DEFAULT_U_M


def _read_json(path: Path) -> Any:
    try:
        return json.loads(path.read_text())
    except OSError as error:
        raise InvalidInput(f"cannot read {path}: {error.strerror}") from error
    except ValueError as error:
        raise InvalidInput(f"{path} is no JSON: {error}") from error


def _camera(record: dict[str, Any]) -> Camera:
    intrinsics = [record["fx"], record["fy"], record["cx"], record["cy"], *record["dist"]]
    return Camera(int(record["w"]), int(record["h"]), np.array(intrinsics, dtype=np.float64))


def _shot(record: dict[str, Any]) -> TrueShot:
    # The file rounds rotations to nine digits: the nearest proper one is meant.
    u, _, vt = np.linalg.svd(np.array(record["world_from_cam"], dtype=np.float64))
    site_from_cam = Pose(u @ vt, np.array(record["position_m"], dtype=np.float64))
    plates = tuple(
        PlateInView(
            None if plate["wrong"] else int(plate["code"]),
            float(plate["px_per_u"]),
            float(plate["incidence_deg"]),
            np.array(plate["dots_px"], dtype=np.float64),
        )
        for plate in record["visible"]
    )
    return TrueShot(str(record["file"]), site_from_cam, plates)
