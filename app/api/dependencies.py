"""What endpoints are given: the running services, a session that commits before the answer leaves, checked ids."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Path, Query, Request
from pydantic import AfterValidator

from app.errors import NotFound
from app.services.alerts import MapWatch
from app.services.calibration_request import CalibrationDesk
from app.services.coverage import Planner
from app.services.evaluations import Evaluator
from app.services.gatekeeper import Gatekeeper
from app.services.locate import Locator
from app.services.metrics import ServiceMetrics
from app.services.photo_viewer import PhotoViewer
from app.services.readiness import Readiness
from app.services.report import ReportWriter
from app.services.sessions import BrowserSessions
from app.services.sheets.printer import SheetPrinter
from app.services.site_transfer import SiteTransfers
from app.services.smoothing import Smoother
from app.services.snapshot_keeper import SnapshotKeeper
from app.services.snapshot_removal import SnapshotEraser
from app.services.storage_budget import StorageBudget
from app.services.survey_guide import SurveyGuide
from app.services.surveys import PhotoIntake
from app.services.trajectory_bell import TrajectoryBell
from app.services.trajectory_import import TrajectoryImporter
from app.storage.database import Database, Session
from app.storage.paging import PageRequest

GREATEST_INTEGER = 2**31 - 1  # of a database column
GREATEST_PAGE = 1000
CURSOR = "^[A-Za-z0-9_-]+={0,2}$"  # base64 for URLs


@dataclass(frozen=True)
class Services:
    """All that runs behind the interface."""

    database: Database
    intake: PhotoIntake
    calibrations: CalibrationDesk
    budget: StorageBudget
    keeper: SnapshotKeeper
    eraser: SnapshotEraser
    transfers: SiteTransfers
    locator: Locator
    reports: ReportWriter
    map_watch: MapWatch
    guide: SurveyGuide
    viewer: PhotoViewer
    printer: SheetPrinter
    planner: Planner
    bell: TrajectoryBell
    importer: TrajectoryImporter
    evaluator: Evaluator
    smoother: Smoother
    readiness: Readiness
    gatekeeper: Gatekeeper
    sessions: BrowserSessions
    metrics: ServiceMetrics


async def services_of(request: Request) -> Services:
    """The services that the lifespan started; a coroutine, as the framework sends any other through a thread."""
    services = request.state.services
    assert isinstance(services, Services)
    return services


Running = Annotated[Services, Depends(services_of)]


def reading(services: Running) -> Iterator[Session]:
    """A session that cannot write."""
    with services.database.reading() as session:
        yield session


def writing(services: Running) -> Iterator[Session]:
    """A session that is committed when the endpoint returns, before its answer leaves."""
    with services.database.writing() as session:
        yield session


ReadSession = Annotated[Session, Depends(reading, scope="function")]
WriteSession = Annotated[Session, Depends(writing, scope="function")]


def _plausible_id(text: str) -> str:
    """An id that a database can be asked for; any other names nothing."""
    if not text.isprintable() or len(text) > 100:
        raise NotFound(f"there is nothing with the id {text[:100]!r}; ids are what the answers to POST name")
    return text


Id = Annotated[str, AfterValidator(_plausible_id)]
PathId = Annotated[str, Path(), AfterValidator(_plausible_id)]
Version = Annotated[int, Query(ge=1, le=GREATEST_INTEGER, description="A version of the map; the active one if none.")]
PathVersion = Annotated[int, Path(ge=1, le=GREATEST_INTEGER)]


def page_request(
    limit: Annotated[int, Query(ge=1, le=GREATEST_PAGE)] = 100,
    cursor: Annotated[
        str | None, Query(max_length=1000, pattern=CURSOR, description="What the page before named next_cursor.")
    ] = None,
) -> PageRequest:
    """Which page of a list is wanted."""
    return PageRequest(limit, cursor)


Paging = Annotated[PageRequest, Depends(page_request)]
