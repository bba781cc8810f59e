"""What the report says is what the adjustment found, and nothing that went wrong is left unsaid."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.geometry.pose import Pose
from app.photogrammetry.survey import SurveyResult
from app.services.reporting.document import Document, Facts, Findings, KeyFigures, Signatures
from app.services.survey_report.compose import compose
from app.services.survey_report.material import ReportMaterial
from tests.services.reporting.names import HOSTILE
from tests.services.reporting.texts import cells, section_of, table_of, texts_of
from tests.services.survey_report.scene import ROOM, STATIONS


def number(text: str) -> float:
    return float(text.replace("−", "-").replace(",", ""))  # noqa: RUF001 - the report writes a real minus


def titles_of_findings(document: Document) -> list[str]:
    blocks = section_of(document, "Warnings").blocks
    return [finding.title for block in blocks if isinstance(block, Findings) for finding in block.findings]


def facts(document: Document, section: str) -> dict[str, str]:
    return {
        name: text
        for block in section_of(document, section).blocks
        if isinstance(block, Facts)
        for name, text in block.lines
    }


def test_the_sections_come_in_the_order_of_reading(document: Document) -> None:
    assert [section.title for section in document.sections] == [
        "Summary",
        "Warnings",
        "Control and check points",
        "Plan view",
        "Adjustment",
        "Camera",
        "Photographs",
        "Targets",
        "Conventions",
        "Signatures",
    ]


def test_the_first_page_says_how_good_the_survey_is(document: Document, good: ReportMaterial) -> None:
    (figures,) = (block for block in section_of(document, "Summary").blocks if isinstance(block, KeyFigures))
    shown = {figure.label: figure.value for figure in figures.figures}
    assert shown["photographs oriented"] == f"{len(STATIONS)} of {len(STATIONS)}"
    assert shown["targets in the map"] == str(len(good.target_map.targets))
    assert good.report.check_rmse_m is not None
    assert number(shown["RMSE of check points"].removesuffix(" mm")) == pytest.approx(
        1e3 * good.report.check_rmse_m, abs=0.005
    )
    known = facts(document, "Summary")
    assert known["Site"] == "Hall 3"
    assert known["Software"] == "Scattermark 0"
    assert known["Map version"] == "7"
    assert known["Map built"] == "2026-05-01 09:30 UTC"
    assert known["Datum"].startswith("control points control102")


def test_each_photograph_is_told_with_its_pose(document: Document, survey: SurveyResult) -> None:
    table = table_of(document, "Poses of the photographs")
    assert len(table.rows) == len(survey.photos)
    for index, photo in enumerate(survey.photos):
        row = cells(table, index)
        pose = photo.site_from_cam
        assert row["", "Photograph"] == photo.name
        told_m = [number(row["Projection centre, m", axis]) for axis in "XYZ"]
        np.testing.assert_allclose(told_m, pose.position_m, atol=0.51e-4)
        told_xyzw = np.array([number(row["Orientation", part]) for part in "xyzw"])
        assert np.abs(Pose.from_quaternion(told_xyzw, pose.position_m).rotation - pose.rotation).max() < 1e-5
        sigmas_mm = [number(row["Sigma, mm", axis]) for axis in "XYZ"]
        np.testing.assert_allclose(sigmas_mm, 1e3 * np.sqrt(np.diag(photo.covariance)[:3]), atol=0.0051)
        turns_mdeg = [number(row["Sigma of rotation, mdeg", axis]) for axis in "XYZ"]
        np.testing.assert_allclose(turns_mdeg, 1e3 * np.degrees(np.sqrt(np.diag(photo.covariance)[3:])), atol=0.051)
        assert row["", "Targets"] == str(photo.target_count)


def test_each_target_is_told_with_both_parts_of_its_sigma(document: Document, survey: SurveyResult) -> None:
    table = table_of(document, "Poses of the targets")
    datum = survey.target_map.datum
    for index, target in enumerate(survey.target_map.targets):
        row = cells(table, index)
        position_m = target.site_from_target.position_m
        whole = target.covariance + datum.pose_covariance(position_m)
        assert (row["", "Code"], row["", "Rays"]) == (str(target.code), str(target.rays))
        np.testing.assert_allclose([number(row["Centre, m", axis]) for axis in "XYZ"], position_m, atol=0.51e-4)
        for group, covariance in (("Sigma, mm", whole), ("Own sigma, mm", target.covariance)):
            sigmas_mm = [number(row[group, axis]) for axis in "XYZ"]
            np.testing.assert_allclose(sigmas_mm, 1e3 * np.sqrt(np.diag(covariance)[:3]), atol=0.0051)


def test_angles_are_left_out_where_they_are_not_defined(good: ReportMaterial) -> None:
    along_y = Pose(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]), np.zeros(3))
    first, *others = good.report.photos
    photos = (replace(first, orientation_xyzw=along_y.orientation_xyzw), *others)
    document = compose(replace(good, report=replace(good.report, photos=photos)))
    row = cells(table_of(document, "Poses of the photographs"), 0)
    assert {row["Angles, degrees", angle] for angle in ("phi", "omega", "kappa")} == {"–"}  # noqa: RUF001
    assert number(row["Orientation", "w"]) == pytest.approx(np.sqrt(0.5), abs=1e-6)


def test_residuals_of_points_are_told_and_the_doubtful_one_is_marked(faulty_document: Document) -> None:
    table = table_of(faulty_document, "Listed coordinates and residuals")
    (doubtful,) = table.marked
    assert cells(table, doubtful)["", "Name"] == "check112"
    assert number(cells(table, doubtful)["Residual, mm", "3-D"]) > 50.0
    assert cells(table, len(table.rows) - 1)["", "Largest, sigmas"] == "not in the map"


def test_listed_coordinates_are_those_of_the_list(document: Document) -> None:
    row = cells(table_of(document, "Listed coordinates and residuals"), 0)
    listed_m = [number(row["Listed, m", axis]) for axis in "XYZ"]
    assert np.abs(listed_m - ROOM.dots_m(102)[0]).max() < 0.005  # five sigmas of the list


def test_a_good_survey_has_no_warning(document: Document) -> None:
    assert titles_of_findings(document) == []


def test_all_that_went_wrong_is_said_and_the_grave_comes_first(faulty_document: Document) -> None:
    (block,) = section_of(faulty_document, "Warnings").blocks
    assert isinstance(block, Findings)
    grave = [finding.grave for finding in block.findings]
    assert grave == sorted(grave, reverse=True)
    assert titles_of_findings(faulty_document) == [
        "Adjustment",
        "Doubtful control or check points",
        "Moved targets (1)",
        "Bent or wrongly printed targets (1)",
        "Weak targets: too few rays (1)",
        "Weak targets: rays too nearly parallel (1)",
        "Misread targets (1)",
        "Photographs without a pose (1)",
        "Targets in a new place",
        "Left out on request",
        "Extended map",
    ]
    assert "NOT converged" in facts(faulty_document, "Adjustment")["Steps"]
    assert [row[0] for row in table_of(faulty_document, "Targets left out of the map").rows] == [
        "106",
        "123",
        "700",
        "701",
    ]
    assert table_of(faulty_document, "Photographs without a pose").rows == ((HOSTILE[1], HOSTILE[5]),)


def test_a_map_that_nothing_checks_and_nothing_fixes_says_so(good: ReportMaterial) -> None:
    assumed = replace(good.target_map, datum=replace(good.target_map.datum, assumed_scale=True))
    bare = replace(good, report=replace(good.report, control=(), check_rmse_m=None), target_map=assumed)
    document = compose(bare)
    assert "No check points" in titles_of_findings(document)
    assert facts(document, "Summary")["Datum"].startswith("assumed")
    assert "No points were given." in set(texts_of(document))


def test_the_camera_is_told_with_sigmas_and_correlations(document: Document, good: ReportMaterial) -> None:
    (camera,) = good.report.cameras
    table = table_of(document, "Intrinsics with standard deviations and correlations")
    for index, name in enumerate(camera.names):
        row = cells(table, index)
        assert row["", ""].startswith(name)
        assert number(row["", "Value"]) == pytest.approx(camera.intrinsics[index], abs=0.00051)
        assert number(row["", "Sigma"]) == pytest.approx(camera.sigmas[index], abs=0.00051)
        for other in range(index):
            told = number(row["Correlation", camera.names[other]])
            assert told == pytest.approx(camera.correlations[index, other], abs=0.0051)


def test_several_cameras_are_told_apart(faulty_document: Document) -> None:
    assert {"Camera 1", "Camera 2"} <= {section.title for section in faulty_document.sections}
    table = table_of(faulty_document, "Poses of the photographs")
    assert [cells(table, index)["", "Camera"] for index in range(4)] == ["1", "2", "1", "2"]


def test_what_is_signed_names_map_and_digest(document: Document) -> None:
    (block,) = section_of(document, "Signatures").blocks
    assert isinstance(block, Signatures)
    assert all(part in block.statement for part in ("version 7", "Hall 3", "0123456789abcdef"))
    assert block.roles == ("Surveyed by", "Checked by")
