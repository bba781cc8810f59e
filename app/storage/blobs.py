"""Arrays as bytes and back: little-endian float64, the shape known from what is stored."""

from __future__ import annotations

import io
import json
from dataclasses import astuple
from typing import Any

import numpy as np
import numpy.typing as npt

from app.geometry.observations import Detection, Rejected, TargetObservation
from app.geometry.plate_sigmas import INDEPENDENT_DOTS, PlateSigmas

Array = npt.NDArray[np.float64]
STORED = np.dtype("<f8")


def blob_of_array(array: Array) -> bytes:
    """Bytes of an array, row-major."""
    return np.ascontiguousarray(array, dtype=STORED).tobytes()


def array_of_blob(blob: bytes, *shape: int) -> Array:
    """The array of ``blob_of_array``.

    Raises
    ------
    ValueError
        When the bytes do not fill the shape.
    """
    return np.frombuffer(blob, dtype=STORED).reshape(shape).astype(np.float64)


def blob_of_detection(detection: Detection) -> bytes:
    """A detection as one compressed npz: the targets stacked, the rejects as JSON."""
    targets = detection.targets
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        size_px=np.array([detection.width_px, detection.height_px]),
        counts=np.array([[target.code, target.corrected, target.erased] for target in targets]).reshape(-1, 3),
        centres_px=np.array([target.centres_px for target in targets]).reshape(-1, 16, 2),
        covariances_px2=np.array([target.covariances_px2 for target in targets]).reshape(-1, 16, 2, 2),
        measured=np.array([target.measured for target in targets], dtype=np.bool_).reshape(-1, 16),
        rms_px=np.array([target.rms_px for target in targets]),
        plate_sigmas=np.array([astuple(target.plate_sigmas) for target in targets]).reshape(-1, 3),
        rejected=np.frombuffer(json.dumps([json_of_reject(item) for item in detection.rejected]).encode(), np.uint8),
    )
    return buffer.getvalue()


def detection_of_blob(blob: bytes) -> Detection:
    """The detection of ``blob_of_detection``, equal to the last bit."""
    with np.load(io.BytesIO(blob), allow_pickle=False) as stored:
        arrays = {name: stored[name] for name in stored.files}
    # Archives of earlier releases say nothing of shared errors.
    sigmas = arrays.get("plate_sigmas", np.tile(astuple(INDEPENDENT_DOTS), (len(arrays["counts"]), 1)))
    targets = tuple(
        TargetObservation(
            code=int(counts[0]),
            centres_px=arrays["centres_px"][row],
            covariances_px2=arrays["covariances_px2"][row],
            measured=arrays["measured"][row],
            corrected=int(counts[1]),
            erased=int(counts[2]),
            rms_px=float(arrays["rms_px"][row]),
            plate_sigmas=PlateSigmas(*sigmas[row].tolist()),
        )
        for row, counts in enumerate(arrays["counts"])
    )
    width_px, height_px = (int(side) for side in arrays["size_px"])
    rejected = tuple(reject_of_json(item) for item in json.loads(arrays["rejected"].tobytes()))
    return Detection(width_px, height_px, targets, rejected)


def json_of_reject(rejected: Rejected) -> dict[str, Any]:
    """A JSON-ready record of something refused."""
    corners_px = None if rejected.corners_px is None else rejected.corners_px.tolist()
    return {
        "reason": rejected.reason,
        "centre_px": rejected.centre_px.tolist(),
        "detail": rejected.detail,
        "code": rejected.code,
        "corners_px": corners_px,
    }


def reject_of_json(record: dict[str, Any]) -> Rejected:
    """What ``json_of_reject`` wrote."""
    corners_px = record["corners_px"]
    return Rejected(
        reason=record["reason"],
        centre_px=np.array(record["centre_px"], dtype=np.float64),
        detail=record["detail"],
        code=record["code"],
        corners_px=None if corners_px is None else np.array(corners_px, dtype=np.float64),
    )
