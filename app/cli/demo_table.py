"""What the demo shows: the survey in a few lines, the accuracy table."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table

from app.cli.demo_story import Surveyed
from app.cli.score import Located, SnapshotScore, rmse_of_scores, score_to_json
from app.cli.survey_summary import summary_lines

MM_PER_M = 1000.0
TABLE_WIDTH = 110  # where the output is no terminal and tells no width


def print_survey(surveyed: Surveyed) -> None:
    """What was built."""
    print(f"\nTarget map built in {surveyed.build_s:.1f} s")
    for line in summary_lines(surveyed.report):
        print(f"  {line}")
    print()


def print_scores(located: list[Located], scores: list[SnapshotScore] | None) -> None:
    """The accuracy table, or the poses alone where no truth is known."""
    console = Console()
    if not console.is_terminal:
        console = Console(width=TABLE_WIDTH, highlight=False)
    if scores is None:
        console.print("Snapshots (no truth is known of this room)")
        console.print(_pose_table(located))
        return
    console.print("Snapshots against the truth: estimate - truth, and the claimed 3-D sigma")
    console.print(_score_table(scores))
    rmse = rmse_of_scores(scores)
    if rmse is None:
        console.print("no snapshot was located")
        return
    count = sum(score.error_m is not None for score in scores)
    console.print(
        f"RMSE of {count} located of {len(scores)} snapshots: X {_mm(rmse.x_m)}, Y {_mm(rmse.y_m)}, "
        f"2-D (X, Y) {_mm(rmse.xy_m)}, 3-D {_mm(rmse.xyz_m)} mm"
    )


def results_to_json(surveyed: Surveyed, located: list[Located], scores: list[SnapshotScore] | None) -> dict[str, Any]:
    """All results for machines."""
    rmse = None if scores is None else rmse_of_scores(scores)
    return {
        "targets": surveyed.targets,
        "build_s": surveyed.build_s,
        "report": surveyed.report,
        "snapshots": [_located_to_json(one) for one in located],
        "scores": None if scores is None else [score_to_json(score) for score in scores],
        "rmse": None if rmse is None else asdict(rmse),
    }


def _located_to_json(located: Located) -> dict[str, Any]:
    pose = located.site_from_cam
    return {
        "name": located.name,
        "position_m": None if pose is None else pose.position_m.tolist(),
        "orientation_xyzw": None if pose is None else pose.orientation_xyzw.tolist(),
        "sigma_m": None if located.sigma_m is None else located.sigma_m.tolist(),
        "reason": located.reason,
    }


def _score_table(scores: list[SnapshotScore]) -> Table:
    table = _table(["dx mm", "dy mm", "dz mm", "distance mm", "angle deg", "sigma mm"])
    for score in scores:
        if score.error_m is None or score.sigma_m is None or score.angle_deg is None:
            table.add_row(score.name, *["-"] * 6, f"refused: {score.reason}")
            continue
        dx_m, dy_m, dz_m = score.error_m
        numbers = [dx_m, dy_m, dz_m, float(np.linalg.norm(score.error_m))]
        sigma_m = float(np.linalg.norm(score.sigma_m))
        table.add_row(score.name, *map(_mm, numbers), f"{score.angle_deg:.3f}", _mm(sigma_m))
    return table


def _pose_table(located: list[Located]) -> Table:
    table = _table(["x m", "y m", "z m", "sigma mm"])
    for one in located:
        if one.site_from_cam is None or one.sigma_m is None:
            table.add_row(one.name, *["-"] * 4, f"refused: {one.reason}")
            continue
        position = [f"{coordinate_m:.4f}" for coordinate_m in one.site_from_cam.position_m]
        table.add_row(one.name, *position, _mm(float(np.linalg.norm(one.sigma_m))))
    return table


def _table(headings: list[str]) -> Table:
    """A table in Markdown, so that it can be quoted as it is."""
    table = Table(box=box.MARKDOWN)
    table.add_column("snapshot")
    for heading in headings:
        table.add_column(heading, justify="right")
    table.add_column("")
    return table


def _mm(length_m: float) -> str:
    return f"{MM_PER_M * length_m:z.1f}"  # z: no minus before a zero
