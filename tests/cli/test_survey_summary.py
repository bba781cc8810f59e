"""The lines that a surveyor sees first."""

from __future__ import annotations

from typing import Any

from app.cli.survey_summary import LEFT_OUT_SHOWN, summary_lines


def a_report(**changes: Any) -> dict[str, Any]:
    report = {
        "photos": [{}] * 14,
        "unoriented": [{"name": "b.jpg", "reason": "no targets"}],
        "targets": [{}] * 38,
        "sigma0": 0.936,
        "cameras": [{"key": "phone", "names": ["fx", "fy"], "intrinsics": [921.5, 921.6], "sigmas": [0.17, 0.2]}],
        "control_rmse_m": 0.00093,
        "check_rmse_m": 0.002,
        "left_out": [{"code": 389, "detail": "photograph it again"}],
        "warnings": ["Three control points cannot tell which of them is wrong."],
    }
    return {**report, **changes}


def test_all_that_matters_is_said() -> None:
    assert list(summary_lines(a_report())) == [
        "14 of 15 photographs oriented, 38 targets mapped, sigma0 0.94",
        "camera phone: fx 921.50 +- 0.17 px",
        "control points: root mean square residual 0.9 mm",
        "check points: RMSE 2.0 mm",
        "not oriented: b.jpg: no targets",
        "left out: target 389: photograph it again",
        "Three control points cannot tell which of them is wrong.",
    ]


def test_a_free_map_has_no_figures_of_points() -> None:
    lines = list(summary_lines(a_report(control_rmse_m=None, check_rmse_m=None)))
    assert not [line for line in lines if "points:" in line]


def test_a_long_list_is_cut() -> None:
    left_out = [{"code": code, "detail": "seen once"} for code in range(LEFT_OUT_SHOWN + 3)]
    lines = list(summary_lines(a_report(left_out=left_out, warnings=[])))
    assert lines[-1] == "left out: 3 more targets, see the report"
    assert sum("seen once" in line for line in lines) == LEFT_OUT_SHOWN
