"""A database for every test that asks for one: the test then runs once on each kind. And how property tests run."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterator

import pytest
from hypothesis import settings

from app.cli.compile_ import compile_first
from app.storage.database import Database
from tests.databases import Databases, PostgresDatabases, SqliteDatabases, postgres_server
from tests.object_stores import S3Server, s3_server

# No example has a time limit: a loaded machine is no fault of the code. In CI the examples are the same at each run, so
# that a red run means a change; at a desk they differ, and find more.
settings.register_profile("scattermark", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("scattermark")

# Files of few tests that wait for processes, or compute, longer than any other: begun last, one would keep the suite
# waiting while the other core has nothing to do.
LONG = (
    "tests/faults/test_kill_builds.py",
    "tests/containers/test_image.py",
    "tests/test_docs.py",
    "tests/cli/test_demo.py",
    "tests/benchmarks/test_service_memory.py",
    "tests/contract/test_contract.py",
    "tests/cli/test_graceful_server.py",
    "tests/cli/test_serve.py",
    "tests/faults/test_processes.py",
    "tests/faults/test_clock.py",
    "tests/api/test_on_postgres.py",
    "tests/web/test_survey.py",
)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The longest files first; the others as they come."""
    items.sort(key=lambda item: not item.nodeid.startswith(LONG))


def pytest_sessionstart() -> None:
    """Compile once: the services that tests start would each do it, and at the same time."""
    compile_first()


@pytest.fixture(autouse=True)
def logs_as_before() -> Iterator[None]:
    """Commands set up how their process logs, onto a stream that is gone after their test."""
    root = logging.getLogger()
    before = root.handlers[:], root.level
    yield
    root.handlers[:] = before[0]
    root.setLevel(before[1])
    logging.captureWarnings(False)


@pytest.fixture(scope="session")
def sqlite(tmp_path_factory: pytest.TempPathFactory) -> SqliteDatabases:
    return SqliteDatabases(tmp_path_factory.mktemp("sqlite"))


@pytest.fixture(scope="session")
def postgresql() -> Iterator[PostgresDatabases]:
    with postgres_server() as url:
        databases = PostgresDatabases(url)
        yield databases
        databases.close()


@pytest.fixture(params=["sqlite", "postgresql"])
def databases(request: pytest.FixtureRequest) -> Databases:
    """The kind of database of this run."""
    kind: Databases = request.getfixturevalue(request.param)
    return kind


@pytest.fixture
def database_url(databases: Databases) -> Iterator[str]:
    """A database with the newest tables."""
    url = databases.migrated()
    yield url
    databases.take_back(url)


@pytest.fixture
def database(database_url: str) -> Iterator[Database]:
    opened = Database(database_url)
    yield opened
    opened.close()


@pytest.fixture
def empty_database(databases: Databases) -> Iterator[Database]:
    """Without tables."""
    url = databases.empty()
    opened = Database(url)
    yield opened
    opened.close()
    databases.take_back(url)


@pytest.fixture(scope="session")
def s3() -> Iterator[S3Server]:
    with s3_server() as server:
        yield server
