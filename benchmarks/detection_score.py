"""Detections against the truth: what was found, what was misread, how well dots are placed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from app.cli.room import TrueShot, TrueShots
from app.geometry.observations import Detection, TargetObservation
from app.photogrammetry.survey import SurveyPhoto
from app.targets.layout import BASE_CELLS, PLATE_SIDE_U, dot_centres_u

Array = npt.NDArray[np.float64]

# What the figure of merit counts (the published claim's own terms): large enough and not too oblique.
COUNTED_PX_PER_U = 2.2
COUNTED_INCIDENCE_DEG = 60.0
PX_PER_U_EDGES = (0.0, 1.0, 1.5, 2.2, 3.0, 4.5, 7.0, 12.0, np.inf)
INCIDENCE_EDGES_DEG = (0.0, 30.0, 45.0, 60.0, 75.0, 90.0)
CORNERS = list(BASE_CELLS[:4])  # A, B, C, D
SAME_PLACE_U = 1.5  # half a pitch: a target whose middle is farther from where its code hangs was misread
CONFIDENCE_DOF = 2  # coordinates of a dot


@dataclass(frozen=True)
class DetectionScore:
    """Counts over a set of photographs.

    Attributes
    ----------
    found, total : ndarray of shape (P, Q), int
        Plates wholly in view that were read rightly, and all of them, by px per u and by incidence.
    counted_found, counted_total : int
        The same within the bounds of the figure of merit.
    wrong_codes : int
        Accepted targets that do not hang where they were seen.
    wrong_plates_read, wrong_plates : int
        Sightings of plates of wrong structure that were read as targets, and all of them.
    errors_px, sizes_px_per_u, nees : ndarray of shape (N, 2), (N,), (N,)
        Of measured dots of plates wholly in view: measured - true centre, size of their plate, normalised error
        squared.
    """

    found: npt.NDArray[np.int64]
    total: npt.NDArray[np.int64]
    counted_found: int
    counted_total: int
    wrong_codes: int
    wrong_plates_read: int
    wrong_plates: int
    errors_px: Array
    sizes_px_per_u: Array
    nees: Array


def score_detections(photos: Sequence[SurveyPhoto], truth: TrueShots, dots_m: dict[int, Array]) -> DetectionScore:
    """Score photographs whose truth is known."""
    found, sizes, incidences, wrong_codes, wrong_read, wrong_plates = [], [], [], 0, 0, 0
    dots: list[tuple[Array, float, Array]] = []
    for photo in photos:
        shot = truth.shots[photo.name]
        by_code = {target.code: target for target in photo.detection.targets}
        places_px = _places_px(truth, shot, dots_m)
        right = {code for code, target in by_code.items() if _in_place(target, places_px)}
        wrong_codes += len(by_code) - len(right)
        for plate in shot.plates:
            if plate.code is None:
                wrong_plates += 1
                wrong_read += _is_read(plate.dots_px, plate.px_per_u, photo.detection)
                continue
            found.append(plate.code in right)
            sizes.append(plate.px_per_u)
            incidences.append(plate.incidence_deg)
            if plate.code in right:
                dots.append(_dot_errors(by_code[plate.code], plate.dots_px, plate.px_per_u))
    return _score(np.array(found), np.array(sizes), np.array(incidences), dots, (wrong_codes, wrong_read, wrong_plates))


def dot_rmse_px(score: DetectionScore, least: float = 0.0, below: float = np.inf) -> float | None:
    """Root mean square of the dots' errors per coordinate, of plates of a size in px per u; None without any."""
    chosen = score.errors_px[(score.sizes_px_per_u >= least) & (score.sizes_px_per_u < below)]
    return float(np.sqrt(np.square(chosen).mean())) if len(chosen) else None


def score_to_json(score: DetectionScore) -> dict[str, Any]:
    """A JSON-ready record."""
    edges = list(pairwise(PX_PER_U_EDGES))
    return {
        "px_per_u_edges": [edge for edge in PX_PER_U_EDGES if np.isfinite(edge)],
        "incidence_edges_deg": list(INCIDENCE_EDGES_DEG),
        "found": score.found.tolist(),
        "total": score.total.tolist(),
        "recall": score.counted_found / max(score.counted_total, 1),
        "recall_found": score.counted_found,
        "recall_total": score.counted_total,
        "wrong_codes": score.wrong_codes,
        "wrong_plates_read": score.wrong_plates_read,
        "wrong_plates": score.wrong_plates,
        "dots": len(score.errors_px),
        "dot_rmse_px": dot_rmse_px(score),
        "dot_median_error_px": float(np.median(np.linalg.norm(score.errors_px, axis=1))) if len(score.nees) else None,
        "dot_rmse_px_by_size": [dot_rmse_px(score, *edge) for edge in edges],
        "dot_nees_mean": float(score.nees.mean()) if len(score.nees) else None,
        "dot_nees_expected": CONFIDENCE_DOF,
    }


def _places_px(truth: TrueShots, shot: TrueShot, dots_m: dict[int, Array]) -> dict[int, Array]:
    """Where the middle of each target in front of the camera is, by code; targets partly in view count too."""
    codes = list(dots_m)
    middles_m = np.array([dots_m[code].mean(axis=0) for code in codes])
    in_camera_m = shot.site_from_cam.inverse().apply(middles_m)
    front = in_camera_m[:, 2] > 0.0
    middles_px = truth.camera.project(in_camera_m[front])
    return dict(zip((code for code, seen in zip(codes, front, strict=True) if seen), middles_px, strict=True))


def _in_place(target: TargetObservation, places_px: dict[int, Array]) -> bool:
    """Whether a target was seen where it hangs."""
    place_px = places_px.get(target.code)
    if place_px is None:
        return False
    corners_px, corners_u = target.centres_px[CORNERS], dot_centres_u()[CORNERS]
    diagonals_px = np.linalg.norm(corners_px[:2] - corners_px[2:], axis=1)
    u_px = diagonals_px.max() / np.linalg.norm(corners_u[0] - corners_u[2])
    return bool(np.linalg.norm(target.centre_px - place_px) < SAME_PLACE_U * u_px)


def _is_read(dots_px: Array, px_per_u: float, detection: Detection) -> bool:
    """Whether something was accepted at a plate of wrong structure."""
    middle_px = dots_px.mean(axis=0)
    reach_px = PLATE_SIDE_U / 2.0 * px_per_u
    return any(np.linalg.norm(target.centre_px - middle_px) < reach_px for target in detection.targets)


def _dot_errors(target: TargetObservation, dots_px: Array, px_per_u: float) -> tuple[Array, float, Array]:
    errors_px = (target.centres_px - dots_px)[target.measured]
    weights = np.linalg.inv(target.covariances_px2[target.measured])
    return errors_px, px_per_u, np.einsum("ni,nij,nj->n", errors_px, weights, errors_px)


def _score(
    found: npt.NDArray[np.bool_],
    sizes: Array,
    incidences: Array,
    dots: Sequence[tuple[Array, float, Array]],
    wrong: tuple[int, int, int],
) -> DetectionScore:
    counted = (sizes >= COUNTED_PX_PER_U) & (incidences <= COUNTED_INCIDENCE_DEG)
    edges = [np.array(PX_PER_U_EDGES), np.array(INCIDENCE_EDGES_DEG)]
    return DetectionScore(
        found=np.histogram2d(sizes[found], incidences[found], edges)[0].astype(np.int64),
        total=np.histogram2d(sizes, incidences, edges)[0].astype(np.int64),
        counted_found=int((found & counted).sum()),
        counted_total=int(counted.sum()),
        wrong_codes=wrong[0],
        wrong_plates_read=wrong[1],
        wrong_plates=wrong[2],
        errors_px=_stacked((errors for errors, _, _ in dots), (0, 2)),
        sizes_px_per_u=_stacked((np.full(len(errors), size) for errors, size, _ in dots), (0,)),
        nees=_stacked((nees for _, _, nees in dots), (0,)),
    )


def _stacked(parts: Iterable[Array], empty_shape: tuple[int, ...]) -> Array:
    return np.concatenate([np.zeros(empty_shape), *parts])
