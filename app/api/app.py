"""The application: routes with their size limits, the error table, the services of its lifetime."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from typing import Any

from fastapi import FastAPI
from fastapi.middleware.cors import CORSMiddleware
from fastapi.openapi.utils import get_openapi

from app.api.access_document import describe_access
from app.api.admission import AdmittedOnly
from app.api.dependencies import Services
from app.api.faults import FaultsAsProblems
from app.api.http_metrics import HttpMetrics
from app.api.metrics_page import MetricsPage
from app.api.observed import Observed
from app.api.origins import TrustedPagesOnly, cors_rules, trusted_pages
from app.api.problems import Problem, add_handlers, describe_slow_bodies
from app.api.request_id import RequestIds
from app.api.routes import (
    alerts,
    audit,
    cameras,
    coverage,
    docs,
    evaluations,
    jobs,
    keys,
    live_evaluations,
    locate,
    maps,
    operations,
    pages,
    print_batches,
    session,
    sites,
    snapshots,
    storage,
    survey_photos,
    surveys,
    targets,
    trajectories,
    trajectory_import,
    transfer,
)
from app.api.routes.pages import add_assets
from app.api.security_headers import SecurityHeaders
from app.api.slow_bodies import Patience, SlowBodies
from app.api.streams import StreamsEndWithServer
from app.api.too_large import TooLargeAsProblem
from app.services.draining import Draining
from app.settings import Settings

OpenServices = Callable[[], AbstractAsyncContextManager[Services]]

FORM_OVERHEAD_BYTES = 2**16  # of a snapshot's form around its image

DESCRIPTION = "Survey a room with printed targets, then locate photographs in it to millimetres."


def build_api(settings: Settings, open_services: OpenServices) -> FastAPI:
    """The HTTP interface over services that live as long as it does.

    Parameters
    ----------
    settings : Settings
        For the limits of request bodies.
    open_services : callable
        Gives a context that starts the services and ends them.
    """

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[dict[str, Any]]:
        async with open_services() as services:
            app.state.metrics_page.registry.register(services.metrics)
            _build_routes(app)
            yield {"services": services}
            app.state.metrics_page.registry.unregister(services.metrics)

    app = FastAPI(
        title="Scattermark",
        description=DESCRIPTION,
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        lifespan=lifespan,
    )
    add_handlers(app)
    app.state.draining = Draining()  # whoever runs the server says when it leaves
    app.state.metrics_page = MetricsPage()
    # From the inside to the outside.
    app.add_middleware(SlowBodies, patience=Patience(settings.upload_grace_s, most_slow=settings.max_slow_uploads))
    app.add_middleware(TooLargeAsProblem)
    app.add_middleware(AdmittedOnly)
    app.add_middleware(TrustedPagesOnly, trusted=trusted_pages(settings))
    app.add_middleware(FaultsAsProblems)
    app.add_middleware(StreamsEndWithServer, draining=app.state.draining)
    app.add_middleware(Observed, metrics=HttpMetrics(app.state.metrics_page.registry))
    app.add_middleware(RequestIds)
    if settings.page_origins:
        app.add_middleware(CORSMiddleware, **cors_rules(settings.page_origins))
    app.add_middleware(SecurityHeaders)
    snapshot_bytes = settings.max_photo_bytes + FORM_OVERHEAD_BYTES
    # First, as it is called most: each router before it is asked whether the call is its own.
    app.include_router(locate.router, max_body_size=snapshot_bytes)
    app.include_router(transfer.import_router, max_body_size=settings.max_import_bytes)
    app.include_router(trajectory_import.router, max_body_size=settings.max_trajectory_bytes)
    texts = (
        sites,
        print_batches,
        transfer,
        surveys,
        survey_photos,
        jobs,
        maps,
        coverage,
        alerts,
        cameras,
        targets,
        trajectories,
        live_evaluations,
        evaluations,
        snapshots,
        operations,
        storage,
        keys,
        session,
        audit,
    )
    for routes in texts:
        app.include_router(routes.router, max_body_size=settings.max_text_bytes)
    app.include_router(surveys.photo_router, max_body_size=snapshot_bytes)
    app.include_router(docs.router)
    app.include_router(pages.router)
    add_assets(app)
    app.include_router(surveys.upload_router, max_body_size=settings.max_upload_bytes)
    app.include_router(cameras.upload_router, max_body_size=settings.max_upload_bytes)
    _describe_problems(app)
    return app


def _build_routes(app: FastAPI) -> None:
    """Have the framework build all routes now: the first request would wait for it, for a tenth of a second."""
    nowhere = {"type": "http", "method": "GET", "path": "/", "root_path": "", "headers": [], "query_string": b""}
    for route in app.routes:
        route.matches(dict(nowhere))


def _describe_problems(app: FastAPI) -> None:
    """Put the problem's schema, which the error table refers to by name, into the OpenAPI document."""

    def openapi() -> dict[str, Any]:
        if app.openapi_schema is None:
            document = get_openapi(title=app.title, version=app.version, description=app.description, routes=app.routes)
            document["components"]["schemas"]["Problem"] = Problem.model_json_schema()
            describe_access(document)
            describe_slow_bodies(document)
            app.openapi_schema = document
        return app.openapi_schema

    app.openapi = openapi  # type: ignore[method-assign]
