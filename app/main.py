"""The service put together: settings -> database, photographs, worker pool -> the HTTP interface."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import ExitStack, asynccontextmanager
from functools import partial

from fastapi import FastAPI

from app.api.app import build_api
from app.api.dependencies import Services
from app.jobs.fork_server import start_fork_server
from app.jobs.pool import WorkerPool
from app.services.access_upkeep import AccessUpkeep
from app.services.alerts import MapWatch
from app.services.calibration_request import CalibrationDesk
from app.services.coverage import Planner
from app.services.evaluations import Evaluator
from app.services.gatekeeper import AccessRules, Gatekeeper
from app.services.keys import ensure_bootstrap_key
from app.services.locate import Afterwards, LocateLimits, Locator
from app.services.metrics import ServiceMetrics
from app.services.metrics_of_pools import ConnectionMetrics, PoolMetrics
from app.services.metrics_of_stored import StoredMetrics
from app.services.photo_viewer import PhotoViewer, ViewLimits
from app.services.rates import Rate
from app.services.readiness import Dependencies, Readiness
from app.services.report import ReportWriter
from app.services.sessions import BrowserSessions
from app.services.sheets.printer import SheetPrinter
from app.services.site_transfer import SiteTransfers, TransferLimits
from app.services.site_transfer_import import UNPACKED, ImportLimits
from app.services.smoothing import Smoother
from app.services.snapshot_keeper import SnapshotKeeper
from app.services.snapshot_removal import SnapshotEraser
from app.services.storage_budget import StorageBudget, StorageLimits
from app.services.survey_guide import GuideLimits, SurveyGuide
from app.services.surveys import PhotoIntake
from app.services.trajectory_bell import TrajectoryBell
from app.services.trajectory_import import TrajectoryImporter
from app.services.workers import start_locating
from app.settings import Settings, settings_from_environment
from app.storage.database import Database
from app.storage.migrate import check_tables, upgrade
from app.storage.photo_store import PhotoStore, open_photo_store
from app.storage.workers import WorkerRepository
from app.vision.photo import PhotoLimits

LAST_WORK_S = 1.0  # the server has ended: whoever asked for what is still under way has left
HOUR_S = 3600.0
DAY_S = 24 * HOUR_S


def create_app(settings: Settings | None = None) -> FastAPI:
    """The application for one server process; settings come from the environment when none are given."""
    settings = settings or settings_from_environment()
    return build_api(settings, partial(run_services, settings))


@asynccontextmanager
async def run_services(settings: Settings) -> AsyncIterator[Services]:
    """Start all that runs behind the interface, and end it in order."""
    database, photos = await asyncio.to_thread(_open_storage, settings)
    limits = PhotoLimits(settings.max_photo_bytes, settings.max_photo_pixels)
    bench = (settings.sqlalchemy_url, settings.photographs_location)
    locating = WorkerPool(settings.locate_workers, settings.queue_depth, start_locating, bench)
    budget = StorageBudget(database, photos, StorageLimits(settings.quota_bytes, settings.min_free_bytes))
    bell = TrajectoryBell()
    metrics = _metrics(database, photos, {"locate": locating})
    keeper = SnapshotKeeper(database, photos, budget)
    guide_limits = GuideLimits(limits, settings.detect_timeout_s, settings.evaluate_timeout_s)
    guide = SurveyGuide(database, locating, guide_limits)
    intake = PhotoIntake(database, photos, limits, budget, guide.notice)
    locate_limits = LocateLimits(limits, settings.locate_timeout_s)
    locator = Locator(database, locating, locate_limits, Afterwards(bell, keeper), metrics)
    gatekeeper = Gatekeeper(database, access_rules(settings))
    upkeep = AccessUpkeep(database, gatekeeper.ring, settings.audit_days * DAY_S)
    try:
        start_fork_server(start_locating.__module__)
        await asyncio.to_thread(locating.start)
        async with upkeep.running(), locator.running(), guide.running():
            yield Services(
                database=database,
                intake=intake,
                calibrations=CalibrationDesk(database, intake),
                budget=budget,
                keeper=keeper,
                eraser=SnapshotEraser(database, photos),
                transfers=SiteTransfers(database, photos, budget, transfer_limits(settings)),
                locator=locator,
                bell=bell,
                evaluator=Evaluator(locating, settings.evaluate_timeout_s),
                smoother=Smoother(database, locating, settings.evaluate_timeout_s),
                importer=TrajectoryImporter(locating, settings.evaluate_timeout_s, settings.data_dir),
                reports=ReportWriter(locating, settings.report_timeout_s),
                printer=SheetPrinter(locating, settings.report_timeout_s),
                planner=Planner(locating, settings.report_timeout_s),
                guide=guide,
                viewer=PhotoViewer(database, photos, locating, view_limits(settings)),
                map_watch=MapWatch(database, locating, settings.evaluate_timeout_s),
                readiness=Readiness(
                    Dependencies(database, photos, locating, settings.min_free_bytes, partial(_live_workers, database))
                ),
                metrics=metrics,
                gatekeeper=gatekeeper,
                sessions=BrowserSessions(database, gatekeeper.ring, settings.session_hours * HOUR_S),
            )
    finally:
        await asyncio.to_thread(locating.close, LAST_WORK_S)
        database.close()


def view_limits(settings: Settings) -> ViewLimits:
    """What photographs that somebody looks at may take."""
    photo = PhotoLimits(settings.max_photo_bytes, settings.max_photo_pixels)
    return ViewLimits(photo, settings.locate_timeout_s, settings.detect_timeout_s)


def transfer_limits(settings: Settings) -> TransferLimits:
    """What sites that come and go may take."""
    photo = PhotoLimits(settings.max_photo_bytes, settings.max_photo_pixels)
    return TransferLimits(ImportLimits(photo, settings.data_dir, settings.max_import_bytes * UNPACKED))


def _metrics(database: Database, photos: PhotoStore, pools: dict[str, WorkerPool]) -> ServiceMetrics:
    metrics = ServiceMetrics()
    for collector in (PoolMetrics(pools), ConnectionMetrics(database), StoredMetrics(database, photos)):
        metrics.include(collector)
    return metrics


def access_rules(settings: Settings) -> AccessRules:
    """How an installation with these settings is guarded."""
    return AccessRules(
        keys_required=settings.require_keys,
        trusts_network=settings.insecure,
        key_rate=Rate(settings.key_rate_per_s, settings.key_burst),
        address_rate=None
        if settings.address_rate_per_s == 0
        else Rate(settings.address_rate_per_s, settings.address_rate_per_s),
    )


def _live_workers(database: Database) -> int:
    """Worker processes that stand ready for builds, on whatever machine."""
    with database.reading() as session:
        return len(WorkerRepository(session).live_workers())


def _open_storage(settings: Settings) -> tuple[Database, PhotoStore]:
    """Database and photographs; the embedded database is brought to the present tables, any other must have them."""
    settings.data_dir.mkdir(parents=True, exist_ok=True)
    photos = open_photo_store(settings.photographs_location)
    photos.sweep()
    database = Database(settings.sqlalchemy_url)
    with ExitStack() as if_it_fails:
        if_it_fails.callback(database.close)
        if settings.embedded:
            upgrade(database)
        check_tables(database)
        if settings.bootstrap_key:
            ensure_bootstrap_key(database, settings.bootstrap_key)
        if_it_fails.pop_all()
    return database, photos
