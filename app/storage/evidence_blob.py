"""What a snapshot tells of its map as bytes and back: movements in seven digits, some 120 bytes a target."""

from __future__ import annotations

import numpy as np

from app.geometry.camera import INTRINSIC_COUNT, Camera
from app.geometry.pose import Pose
from app.photogrammetry.evidence import Movements, SnapshotEvidence

ROWS, COLUMNS = np.triu_indices(6)  # the upper triangle of a 6 x 6
HEAD = np.dtype(
    [
        ("rotation", "<f8", (3, 3)),
        ("position_m", "<f8", 3),
        ("intrinsics", "<f8", INTRINSIC_COUNT),
        ("sigma0", "<f8"),
        ("size_px", "<i4", 2),
        ("counts", "<i4", 3),  # movements, unknown codes, codes that were seen beside
    ]
)
MOVEMENT = np.dtype([("code", "<i4"), ("used", "?"), ("values", "<f4", 6), ("information", "<f4", len(ROWS))])
CODE = np.dtype("<i4")


def blob_of_evidence(evidence: SnapshotEvidence) -> bytes:
    """The bytes of what a snapshot tells."""
    movements, camera = evidence.movements, evidence.camera
    told = np.empty(len(movements), MOVEMENT)
    told["code"], told["used"], told["values"] = movements.codes, movements.used, movements.values
    told["information"] = movements.information[:, ROWS, COLUMNS]
    beside = sorted(evidence.seen_codes - set(movements.codes.tolist()) - set(evidence.unknown_codes))
    head = np.zeros((), HEAD)
    head["rotation"], head["position_m"] = evidence.site_from_cam.rotation, evidence.site_from_cam.position_m
    head["intrinsics"], head["sigma0"] = camera.intrinsics, evidence.sigma0
    head["size_px"] = camera.width_px, camera.height_px
    head["counts"] = len(movements), len(evidence.unknown_codes), len(beside)
    return head.tobytes() + told.tobytes() + np.array([*evidence.unknown_codes, *beside], CODE).tobytes()


def evidence_of_blob(blob: bytes) -> SnapshotEvidence:
    """What ``blob_of_evidence`` wrote.

    Raises
    ------
    ValueError
        When the bytes are none of it.
    """
    head = np.frombuffer(blob, HEAD, count=1)[0]
    count, unknown, beside = head["counts"].tolist()
    told = np.frombuffer(blob, MOVEMENT, count=count, offset=HEAD.itemsize)
    codes = np.frombuffer(blob, CODE, count=unknown + beside, offset=HEAD.itemsize + told.nbytes).tolist()
    information = np.empty((count, 6, 6))
    information[:, ROWS, COLUMNS] = information[:, COLUMNS, ROWS] = told["information"]
    movements = Movements(
        told["code"].astype(np.int64), told["used"].astype(np.bool_), told["values"].astype(np.float64), information
    )
    width_px, height_px = head["size_px"].tolist()
    return SnapshotEvidence(
        site_from_cam=Pose(head["rotation"].copy(), head["position_m"].copy()),
        camera=Camera(width_px, height_px, head["intrinsics"].copy()),
        sigma0=float(head["sigma0"]),
        movements=movements,
        unknown_codes=tuple(codes[:unknown]),
        seen_codes=frozenset([*codes, *told["code"].tolist()]),
    )
