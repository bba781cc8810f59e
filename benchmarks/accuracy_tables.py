"""How the accuracy benchmark is printed: the detectors side by side."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from benchmarks.coverage_score import CoverageScore
from benchmarks.map_score import DATUM_DOF, TARGET_DOF, MapScore
from benchmarks.output import mm, print_table
from benchmarks.pose_score import POSE_DOF, PoseScore
from benchmarks.side_by_side import Figure, print_side_by_side

BYTES_PER_GB = 1e9
PERCENT = 100.0


def print_accuracy(record: dict[str, Any]) -> None:
    """All tables of one room."""
    for part in ("survey", "locate"):
        scores = {name: figures[f"detection_{part}"] for name, figures in record["detectors"].items()}
        _print_recall(f"{record['room']}/{part}", scores)
    columns = {name: _figures(figures) for name, figures in record["detectors"].items()}
    print_side_by_side(f"{record['room']}, by detector", columns)


def _print_recall(what: str, scores: Mapping[str, dict[str, Any]]) -> None:
    first = next(iter(scores.values()))
    sizes = [*first["px_per_u_edges"], None]
    angles = [f"{least:g}-{below:g} deg" for least, below in pairwise(first["incidence_edges_deg"])]
    rows = []
    for row, (least, below) in enumerate(pairwise(sizes)):
        if any(first["total"][row]):
            label = f"over {least:g}" if below is None else f"{least:g}-{below:g}"
            counts = zip(*(score["found"][row] for score in scores.values()), first["total"][row], strict=True)
            cells = [f"{', '.join(map(str, found))} / {total}" for *found, total in counts]
            rmses_px = [score["dot_rmse_px_by_size"][row] for score in scores.values()]
            rows.append([label, *cells, ", ".join(_px(rmse_px) for rmse_px in rmses_px)])
    title = f"{what}: plates wholly in view, read rightly by {', by '.join(scores)} / all"
    print_table(title, ["px per u", *angles, "dot RMSE px"], rows)


def _figures(record: dict[str, Any]) -> list[Figure]:
    figures = [*_detection_figures(record), _shared_dots(record)]
    if "no_map" in record:
        figures.append(Figure("photographs oriented", "no map: " + record["no_map"]))
    else:
        figures += [*_survey_figures(record["survey"]), *_map_figures(record["map"])]
        figures += [row for part in ("survey_poses", "locate") for row in _pose_figures(part, record[part])]
        refused = ", ".join(f"{name}: {why}" for name, why in record["refused"])
        figures.append(Figure("snapshots refused", refused or "none"))
    if "natural" in record:
        natural = record["natural"]
        text = f"{natural['false_targets']} in {natural['photographs']} photographs"
        figures.append(Figure("false targets", text, natural["false_targets"], "less"))
    return figures


def _detection_figures(record: dict[str, Any]) -> list[Figure]:
    figures = []
    for part in ("survey", "locate"):
        score = record[f"detection_{part}"]
        recall = f"{PERCENT * score['recall']:.2f} % ({score['recall_found']} of {score['recall_total']})"
        wrong = f"{score['wrong_plates_read']} of {score['wrong_plates']}"
        figures += [
            Figure(f"{part}: recall at >= 2.2 px per u, <= 60 deg", recall, score["recall"], "more"),
            Figure(f"{part}: wrong codes", str(score["wrong_codes"]), score["wrong_codes"], "less"),
            Figure(f"{part}: plates of wrong structure read", wrong, score["wrong_plates_read"], "less"),
        ]
        if score["dots"]:
            # Not compared: each detector's dots are others, those of small plates among them or not.
            rmse = f"{score['dot_rmse_px']:.3f} px ({score['dots']} dots)"
            figures.append(Figure(f"{part}: dot centres, RMSE per coordinate", rmse))
            figures.append(Figure(f"{part}: dot centres, NEES (2 expected)", f"{score['dot_nees_mean']:.2f}"))
    return figures


def _shared_dots(record: dict[str, Any]) -> Figure:
    rmse_px = record["shared_base_dot_rmse_px"]
    text = f"{_px(rmse_px)} px ({record['shared_base_dots']} dots)"
    return Figure("survey: dot centres, RMSE on base dots that all measured", text, rmse_px, "less")


def _survey_figures(survey: dict[str, Any]) -> list[Figure]:
    coverage: CoverageScore = survey["coverage"]
    camera = survey["cameras"][0]
    published = coverage.carried - len(coverage.missing)
    return [
        Figure("photographs oriented", f"{survey['oriented']} of {survey['photographs']}", survey["oriented"], "more"),
        Figure("targets published of those carried", f"{published} of {coverage.carried}", published, "more"),
        Figure("wrong codes published", str(len(coverage.wrong_codes)), len(coverage.wrong_codes), "less"),
        Figure("build time", f"{survey['build_s']:.1f} s", survey["build_s"], "less"),
        # Not compared: one process adjusts for all detectors, and its greatest memory only grows.
        Figure("build memory", f"{survey['peak_bytes'] / BYTES_PER_GB:.2f} GB"),
        Figure("focal length, error +- sigma", f"{camera['fx_error_px']:.3f} +- {camera['fx_sigma_px']:.3f} px"),
    ]


def _map_figures(score: MapScore) -> list[Figure]:
    ratio = None if score.floor_rmse_m is None else score.absolute_rmse_m / score.floor_rmse_m
    floor = "floor: a perfect map on the same control points"
    return [
        Figure("map RMSE in shape", f"{mm(score.shape_rmse_m)} mm", score.shape_rmse_m, "less"),
        Figure("map RMSE absolute", f"{mm(score.absolute_rmse_m)} mm", score.absolute_rmse_m, "less"),
        Figure(floor, f"{mm(score.floor_rmse_m)} mm"),
        Figure("absolute over floor", "-" if ratio is None else f"{ratio:.2f}", ratio, "less"),
        Figure("check points RMSE", f"{mm(score.check_rmse_m)} mm", score.check_rmse_m, "less"),
        Figure(f"targets, NEES ({TARGET_DOF} expected)", f"{score.target_nees:.2f}"),
        Figure(f"datum, NEES ({DATUM_DOF} expected)", f"{score.datum_nees:.2f}"),
    ]


def _pose_figures(part: str, score: PoseScore | None) -> list[Figure]:
    if score is None:
        return [Figure(f"{part}: poses", "0", 0.0, "more")]
    rmse = score.rmse
    return [
        Figure(f"{part}: poses", str(score.count), score.count, "more"),
        Figure(f"{part}: RMSE X, Y, Z", f"{mm(rmse.x_m)}, {mm(rmse.y_m)}, {mm(rmse.z_m)} mm"),
        Figure(f"{part}: RMSE 2-D (X, Y)", f"{mm(rmse.xy_m)} mm", rmse.xy_m, "less"),
        Figure(f"{part}: RMSE 3-D", f"{mm(rmse.xyz_m)} mm", rmse.xyz_m, "less"),
        Figure(f"{part}: worst", f"{mm(score.worst_m)} mm", score.worst_m, "less"),
        Figure(f"{part}: claimed sigma", f"{mm(score.sigma_rms_m)} mm"),
        Figure(f"{part}: angle RMSE", f"{score.angle_rmse_deg:.4f} deg", score.angle_rmse_deg, "less"),
        Figure(f"{part}: NEES ({POSE_DOF} expected)", f"{score.nees_mean:.2f}"),
    ]


def _px(length_px: float | None) -> str:
    return "-" if length_px is None else f"{length_px:.3f}"
