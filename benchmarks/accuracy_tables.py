"""How the accuracy benchmark is printed."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from benchmarks.coverage_score import CoverageScore
from benchmarks.map_score import DATUM_DOF, TARGET_DOF, MapScore
from benchmarks.output import mm, print_table
from benchmarks.pose_score import POSE_DOF, PoseScore

BYTES_PER_GB = 1e9


def print_accuracy(record: dict[str, Any]) -> None:
    """All tables of one room."""
    for part in ("survey", "locate"):
        _print_recall(record["room"], part, record[f"detection_{part}"])
    rows = [*_detection_rows(record), *_survey_rows(record["survey"]), *_map_rows(record["map"])]
    rows += [row for part in ("survey_poses", "locate") for row in _pose_rows(part, record[part])]
    rows.append(["snapshots refused", ", ".join(f"{name}: {why}" for name, why in record["refused"]) or "none"])
    if "natural" in record:
        natural = record["natural"]
        rows.append(["false targets", f"{natural['false_targets']} in {natural['photographs']} photographs"])
    print_table(f"{record['room']}, {record['detector']} detector", ["what", "value"], rows)


def _print_recall(room: str, part: str, score: dict[str, Any]) -> None:
    sizes = [*score["px_per_u_edges"], None]
    angles = score["incidence_edges_deg"]
    headings = ["px per u", *(f"{least:g}-{below:g} deg" for least, below in pairwise(angles)), "dot RMSE px"]
    rows = []
    for row, (least, below) in enumerate(pairwise(sizes)):
        cells = [f"{found} / {total}" for found, total in zip(score["found"][row], score["total"][row], strict=True)]
        rmse_px = score["dot_rmse_px_by_size"][row]
        label = f"over {least:g}" if below is None else f"{least:g}-{below:g}"
        if any(score["total"][row]):
            rows.append([label, *cells, "-" if rmse_px is None else f"{rmse_px:.3f}"])
    print_table(f"{room}/{part}: plates wholly in view, read rightly / all", headings, rows)


def _detection_rows(record: dict[str, Any]) -> list[list[str]]:
    rows = []
    for part in ("survey", "locate"):
        score = record[f"detection_{part}"]
        recall = f"{100.0 * score['recall']:.2f} % ({score['recall_found']} of {score['recall_total']})"
        rows.append([f"{part}: recall at >= 2.2 px per u, <= 60 deg", recall])
        rows.append([f"{part}: wrong codes", str(score["wrong_codes"])])
        rows.append(
            [f"{part}: plates of wrong structure read", f"{score['wrong_plates_read']} of {score['wrong_plates']}"]
        )
        if score["dots"]:
            rows.append([f"{part}: dot centres, RMSE per coordinate", f"{score['dot_rmse_px']:.3f} px"])
            rows.append([f"{part}: dot centres, NEES (2 expected)", f"{score['dot_nees_mean']:.2f}"])
    return rows


def _survey_rows(survey: dict[str, Any]) -> list[list[str]]:
    coverage: CoverageScore = survey["coverage"]
    camera = survey["cameras"][0]
    return [
        ["photographs oriented", f"{survey['oriented']} of {survey['photographs']}"],
        ["targets published of those carried", f"{coverage.carried - len(coverage.missing)} of {coverage.carried}"],
        ["wrong codes published", str(len(coverage.wrong_codes))],
        ["build time, memory", f"{survey['build_s']:.1f} s, {survey['peak_bytes'] / BYTES_PER_GB:.2f} GB"],
        ["focal length, error +- sigma", f"{camera['fx_error_px']:.3f} +- {camera['fx_sigma_px']:.3f} px"],
    ]


def _map_rows(score: MapScore) -> list[list[str]]:
    ratio = "-" if score.floor_rmse_m is None else f"{score.absolute_rmse_m / score.floor_rmse_m:.2f}"
    return [
        ["map RMSE in shape", f"{mm(score.shape_rmse_m)} mm"],
        ["map RMSE absolute", f"{mm(score.absolute_rmse_m)} mm"],
        ["floor: a perfect map on the same control points", f"{mm(score.floor_rmse_m)} mm"],
        ["absolute over floor", ratio],
        ["check points RMSE", f"{mm(score.check_rmse_m)} mm"],
        [f"targets, NEES ({TARGET_DOF} expected)", f"{score.target_nees:.2f}"],
        [f"datum, NEES ({DATUM_DOF} expected)", f"{score.datum_nees:.2f}"],
    ]


def _pose_rows(part: str, score: PoseScore | None) -> list[list[str]]:
    if score is None:
        return [[f"{part}: located", "none"]]
    rmse = score.rmse
    return [
        [f"{part}: poses", str(score.count)],
        [f"{part}: RMSE X, Y, Z", f"{mm(rmse.x_m)}, {mm(rmse.y_m)}, {mm(rmse.z_m)} mm"],
        [f"{part}: RMSE 2-D (X, Y), 3-D", f"{mm(rmse.xy_m)}, {mm(rmse.xyz_m)} mm"],
        [f"{part}: worst, claimed sigma", f"{mm(score.worst_m)}, {mm(score.sigma_rms_m)} mm"],
        [f"{part}: angle RMSE", f"{score.angle_rmse_deg:.4f} deg"],
        [f"{part}: NEES ({POSE_DOF} expected)", f"{score.nees_mean:.2f}"],
    ]
