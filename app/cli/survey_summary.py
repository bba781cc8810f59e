"""An adjustment report in a few lines, for people."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

MM_PER_M = 1000.0
LEFT_OUT_SHOWN = 10  # all of them stand in the report


def summary_lines(report: dict[str, Any]) -> Iterator[str]:
    """What a surveyor looks at first, of a report as JSON."""
    photos, unoriented = report["photos"], report["unoriented"]
    total = len(photos) + len(unoriented)
    targets = len(report["targets"])
    yield f"{len(photos)} of {total} photographs oriented, {targets} targets mapped, sigma0 {report['sigma0']:.2f}"
    for camera in report["cameras"]:
        values = dict(zip(camera["names"], zip(camera["intrinsics"], camera["sigmas"], strict=True), strict=True))
        focal_px, sigma_px = values["fx"]
        yield f"camera {camera['key']}: fx {focal_px:.2f} +- {sigma_px:.2f} px"
    for role, figure in (("control", "root mean square residual"), ("check", "RMSE")):
        rmse_m = report[f"{role}_rmse_m"]
        if rmse_m is not None:
            yield f"{role} points: {figure} {MM_PER_M * rmse_m:.1f} mm"
    for photo in unoriented:
        yield f"not oriented: {photo['name']}: {photo['reason']}"
    left_out = report["left_out"]
    for target in left_out[:LEFT_OUT_SHOWN]:
        yield f"left out: target {target['code']}: {target['detail']}"
    if len(left_out) > LEFT_OUT_SHOWN:
        yield f"left out: {len(left_out) - LEFT_OUT_SHOWN} more targets, see the report"
    yield from report["warnings"]
