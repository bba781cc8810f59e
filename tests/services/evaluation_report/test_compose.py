"""What the report says is what the evaluations found: every number is read back from its cell."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from app.services.evaluation_report.compose import compose
from app.services.evaluation_report.material import ReportMaterial
from app.services.reporting.document import Document, Findings, KeyFigures
from app.trajectories.evaluation import Evaluation
from tests.services.evaluation_report.scene import evaluated, system
from tests.services.reporting.texts import cells, section_of, table_of, texts_of

HALF_DIGIT = 0.51e-4  # metres are told to four digits

Told = tuple[str, Callable[[Evaluation], float]]
ACCURACY: tuple[Told, ...] = (
    ("CE50, m", lambda e: e.accuracy.horizontal.median),
    ("CE95, m", lambda e: e.accuracy.horizontal.quantile_95),
    ("VE50, m", lambda e: e.accuracy.vertical.median),
    ("VE95, m", lambda e: e.accuracy.vertical.quantile_95),
    ("SE50, m", lambda e: e.accuracy.spatial.median),
    ("SE95, m", lambda e: e.accuracy.spatial.quantile_95),
    ("Mean in the plan, m", lambda e: e.accuracy.horizontal.mean),
    ("Mean in height, m", lambda e: e.accuracy.vertical.mean),
    ("Mean in space, m", lambda e: e.accuracy.spatial.mean),
    ("RMS in the plan, m", lambda e: e.accuracy.horizontal.rms),
    ("RMS in height, m", lambda e: e.accuracy.vertical.rms),
    ("RMS in space, m", lambda e: e.accuracy.spatial.rms),
    ("Standard deviation in space, m", lambda e: e.accuracy.spatial.std),
    ("Least in space, m", lambda e: e.accuracy.spatial.least),
    ("Greatest in space, m", lambda e: e.accuracy.spatial.greatest),
    ("Bias X, m", lambda e: e.accuracy.bias_m[0]),
    ("Bias Y, m", lambda e: e.accuracy.bias_m[1]),
    ("Bias Z, m", lambda e: e.accuracy.bias_m[2]),
    ("RMS X, m", lambda e: e.accuracy.rms_m[0]),
    ("RMS Z, m", lambda e: e.accuracy.rms_m[2]),
    ("Covariance XY, m²", lambda e: e.accuracy.covariance_m2[0, 1]),
    ("Covariance ZZ, m²", lambda e: e.accuracy.covariance_m2[2, 2]),
)
EVAAL: tuple[Told, ...] = (
    ("Third quartile (score), m", lambda e: e.evaal.quantile_75),
    ("Mean, m", lambda e: e.evaal.mean),
    ("Median, m", lambda e: e.evaal.median),
    ("95 % quantile, m", lambda e: e.evaal.quantile_95),
)
ALIGNMENT: tuple[Told, ...] = (
    ("Clock offset, s", lambda e: e.time_offset.offset_s),
    ("Scale", lambda e: e.alignment.site_from_estimate.scale),
    ("Pairs that fixed it", lambda e: e.alignment.pairs_used),
    ("Translation X, m", lambda e: e.alignment.site_from_estimate.translation_m[0]),
    ("Translation Z, m", lambda e: e.alignment.site_from_estimate.translation_m[2]),
)
AVAILABILITY: tuple[Told, ...] = (
    ("Pairs", lambda e: len(e.pairs)),
    ("Poses of the system", lambda e: e.pairs.estimate_count),
    ("Reference covered, %", lambda e: round(100 * e.availability.covered_share, 1)),
    ("Longest silence, s", lambda e: e.availability.longest_silence_s),
)


def number(text: str) -> float:
    return float(text.replace("−", "-").replace(",", ""))  # noqa: RUF001 - the report writes a real minus


def numbers(text: str) -> list[float]:
    """Value, low and high of a cell that tells an interval."""
    return [number(part) for part in text.replace("(", "").replace(")", "").replace(" to ", " ").split()]


@pytest.mark.parametrize(
    ("title", "told"),
    [
        ("Accuracy in the terms of ISO/IEC 18305", ACCURACY),
        ("EvAAL", EVAAL),
        ("Clock and alignment", ALIGNMENT),
        ("Availability", AVAILABILITY),
    ],
)
def test_each_number_is_the_evaluations(
    report: Document, material: ReportMaterial, title: str, told: tuple[Told, ...]
) -> None:
    table = table_of(report, title)
    labels = [row[0] for row in table.rows]
    for label, value in told:
        row = cells(table, labels.index(label))
        for name, evaluation in material.evaluations.items():
            assert number(row["", name]) == pytest.approx(float(value(evaluation)), abs=HALF_DIGIT), (label, name)


def test_intervals_are_told_with_their_ends(report: Document, material: ReportMaterial) -> None:
    table = table_of(report, "Confidence intervals")
    for row, (name, evaluation) in enumerate(material.evaluations.items()):
        intervals, told_of = evaluation.intervals, cells(table, row)
        assert told_of["", "System"] == name
        for title, interval in (("Mean", intervals.mean), ("RMS", intervals.rms), ("SE95", intervals.quantile_95)):
            told = numbers(told_of["Errors in space (interval), m", title])
            assert told == pytest.approx([interval.value, interval.low, interval.high], abs=HALF_DIGIT)


def test_orientations_are_told_where_there_are_any(report: Document, material: ReportMaterial) -> None:
    table = table_of(report, "Accuracy in the terms of ISO/IEC 18305")
    row = cells(table, [row[0] for row in table.rows].index("RMS rotation, degrees"))
    rotation = material.evaluations["turned"].accuracy.rotation
    assert rotation is not None
    assert number(row["", "turned"]) == pytest.approx(np.degrees(rotation.rms), abs=0.51e-3)
    assert row["", "Wi-Fi"] == "–"  # noqa: RUF001 - an en dash


def test_pose_errors_are_told_system_by_system(report: Document, material: ReportMaterial) -> None:
    table = table_of(report, "Absolute and relative pose errors")
    told = {(row[0], row[1]): cells(table, index) for index, row in enumerate(table.rows)}
    assert len(told) == 4 * 3 + 1  # motions need orientations, which one of the four does not tell
    found = material.evaluations["UWB"].pose_errors
    for error, parts in (("APE", found.absolute), ("RPE per metre", found.relative["metres"])):
        row = told["UWB", error]
        assert number(row["", "Count"]) == parts["trans"].count
        assert number(row["Position, m", "RMSE"]) == pytest.approx(parts["trans"].rms, abs=HALF_DIGIT)
        assert number(row["Position, m", "Greatest"]) == pytest.approx(parts["trans"].greatest, abs=HALF_DIGIT)
        assert number(row["Orientation, degrees", "Median"]) == pytest.approx(parts["rot_deg"].median, abs=0.51e-3)
        assert number(row["Full pose", "RMSE"]) == pytest.approx(parts["full"].rms, abs=HALF_DIGIT)
    assert told["Wi-Fi", "APE"]["Orientation, degrees", "RMSE"] == "–"  # noqa: RUF001 - an en dash
    assert ("Wi-Fi", "RPE per second") not in told


def test_the_rotation_of_the_alignment_is_told(report: Document, material: ReportMaterial) -> None:
    table = table_of(report, "Clock and alignment")
    labels = [row[0] for row in table.rows]
    x, y, z, w = (number(cells(table, labels.index(f"Rotation q{part}"))["", "turned"]) for part in "xyzw")
    rotation = material.evaluations["turned"].alignment.site_from_estimate.rotation
    told = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w)], [2 * (x * y + z * w), 1 - 2 * (x * x + z * z)]]
    np.testing.assert_allclose(told, rotation[:2, :2], atol=4e-6)
    assert cells(table, labels.index("Alignment"))["", "turned"] == "posyaw"
    assert cells(table, labels.index("Its sigma, s"))["", "turned"] == "given"


def test_zones_are_told_system_by_system(report: Document, material: ReportMaterial) -> None:
    table = table_of(report, "Accuracy by zone")
    told = {(row[0], row[1]): cells(table, index) for index, row in enumerate(table.rows)}
    expected = {(zone, name) for name, found in material.evaluations.items() for zone in found.zones}
    assert set(told) == expected
    for (zone, name), row in told.items():
        accuracy = material.evaluations[name].zones[zone]
        assert number(row["", "Pairs"]) == accuracy.spatial.count
        assert number(row["In the plan, m", "CE95"]) == pytest.approx(accuracy.horizontal.quantile_95, abs=HALF_DIGIT)
        assert number(row["In height, m", "VE50"]) == pytest.approx(accuracy.vertical.median, abs=HALF_DIGIT)
        assert number(row["In space, m", "RMS"]) == pytest.approx(accuracy.spatial.rms, abs=HALF_DIGIT)


def test_paired_differences_are_told_with_who_is_better(report: Document, material: ReportMaterial) -> None:
    table = table_of(report, "Paired differences")
    for row, difference in zip(table.rows, material.differences, strict=True):
        assert row[:2] == (difference.first, difference.second)
        assert difference.mean_m is not None
        interval = difference.mean_m
        assert numbers(row[3]) == pytest.approx([interval.value, interval.low, interval.high], abs=HALF_DIGIT)
        assert row[4] == (difference.better or "neither beyond doubt")


def test_verdicts_are_told_and_the_grave_come_first(material: ReportMaterial) -> None:
    exact = evaluated(system(0.001, 9))
    assert exact.verdict is not None and not exact.verdict.distinguishable
    document = compose(replace(material, evaluations={**material.evaluations, "too good": exact}))
    (block,) = (block for block in section_of(document, "Summary").blocks if isinstance(block, Findings))
    first, *others = block.findings
    assert first.title == "too good" and first.grave and "cannot be told" in first.text
    assert [finding.grave for finding in others] == [False] * len(material.evaluations)
    verdict = material.evaluations["UWB"].verdict
    assert verdict is not None and verdict.sentence[1:] in next(f.text for f in others if f.title == "UWB")


def test_a_reference_without_covariances_is_said_once(material: ReportMaterial) -> None:
    silent = {name: replace(found, verdict=None) for name, found in material.evaluations.items()}
    document = compose(replace(material, evaluations=silent))
    (block,) = (block for block in section_of(document, "Summary").blocks if isinstance(block, Findings))
    assert [finding.title for finding in block.findings] == ["No verdict on UWB, Wi-Fi, ARKit, turned"]


def test_one_system_is_told_by_key_figures_and_compared_with_nobody(single: ReportMaterial) -> None:
    document = compose(single)
    (figures,) = (block for block in section_of(document, "Summary").blocks if isinstance(block, KeyFigures))
    shown = [figure.value for figure in figures.figures]
    spatial = single.evaluations["UWB"].accuracy.spatial
    assert shown[:3] == [f"{value:.4f} m" for value in (spatial.median, spatial.quantile_95, spatial.rms)]
    assert "Comparison" not in {section.title for section in document.sections}


def test_sections_come_in_the_order_of_reading(report: Document, material: ReportMaterial) -> None:
    assert [section.title for section in report.sections] == [
        "Summary",
        "Comparison",
        "Accuracy",
        "Pose errors",
        "Zones",
        "Distribution of the errors",
        *material.evaluations,
        "Availability and alignment",
        "Conventions",
    ]
    assert "trajectory 17" in set(texts_of(report))


def test_material_without_systems_or_outlines_is_refused(material: ReportMaterial) -> None:
    with pytest.raises(ValueError, match="one evaluation"):
        replace(material, evaluations={})
    with pytest.raises(ValueError, match="outlines"):
        replace(material, zones=())
