from __future__ import annotations

import pytest

from app.services.evaluation_report.compose import compose
from app.services.evaluation_report.material import ReportMaterial
from app.services.reporting.document import Document
from tests.services.evaluation_report.scene import several


@pytest.fixture(scope="session")
def material() -> ReportMaterial:
    return several()


@pytest.fixture(scope="session")
def report(material: ReportMaterial) -> Document:
    return compose(material)


@pytest.fixture(scope="session")
def single(material: ReportMaterial) -> ReportMaterial:
    """One of the systems by itself."""
    return ReportMaterial("Hall 3", "trajectory 17", {"UWB": material.evaluations["UWB"]}, (), material.zones)
