"""One synthetic survey, adjusted once, and the reports of it."""

from __future__ import annotations

import pytest

from app.photogrammetry.survey import SurveyResult
from app.services.reporting.document import Document
from app.services.survey_report.compose import compose
from app.services.survey_report.material import ReportMaterial
from tests.services.survey_report.scene import faulty_material, good_survey, material_of


@pytest.fixture(scope="session")
def survey() -> SurveyResult:
    return good_survey()


@pytest.fixture(scope="session")
def good(survey: SurveyResult) -> ReportMaterial:
    return material_of(survey)


@pytest.fixture(scope="session")
def faulty(survey: SurveyResult) -> ReportMaterial:
    return faulty_material(survey)


@pytest.fixture(scope="session")
def document(good: ReportMaterial) -> Document:
    return compose(good)


@pytest.fixture(scope="session")
def faulty_document(faulty: ReportMaterial) -> Document:
    return compose(faulty)
