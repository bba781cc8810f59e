"""A service to be ill-treated, and the ledger that it is held against."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing

import pytest

from app.settings import Settings
from tests.api.serving import Served, serve
from tests.faults.ledger import Ledger


@pytest.fixture(scope="package")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    settings = Settings(data_dir=tmp_path_factory.mktemp("faults") / "data", locate_workers=1, build_workers=1)
    with serve(settings, worker=False) as running:
        yield running


@pytest.fixture(scope="package")
def shared_ledger(served: Served) -> Iterator[Ledger]:
    with closing(Ledger(served)) as kept:
        yield kept


@pytest.fixture(scope="module")
def ledger(shared_ledger: Ledger) -> Iterator[Ledger]:
    """After the tests of a file nothing may be lost; each of them says itself what it leaves."""
    yield shared_ledger
    shared_ledger.check()
