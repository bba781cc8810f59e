"""What the engines of both databases promise alike."""

from __future__ import annotations

import pytest
from sqlalchemy import text

from app.storage.engines import Access, engine_for

ON_DISK = {"sqlite": ("PRAGMA synchronous", 2), "postgresql": ("SHOW synchronous_commit", "on")}
SOON_ON_DISK = {"sqlite": 1, "postgresql": "local"}
LOCK_WAIT = {"sqlite": ("PRAGMA busy_timeout", 10_000), "postgresql": ("SHOW lock_timeout", "10s")}


@pytest.mark.parametrize("access", Access)
def test_only_pose_rows_wait_for_less_than_all(database_url: str, access: Access) -> None:
    engine = engine_for(database_url, access)
    question, on_disk = ON_DISK[engine.dialect.name]
    expected = SOON_ON_DISK[engine.dialect.name] if access is Access.RECORD else on_disk
    with engine.connect() as connection:
        assert connection.execute(text(question)).scalar() == expected
    engine.dispose()


@pytest.mark.parametrize("access", Access)
def test_no_lock_is_waited_for_without_end(database_url: str, access: Access) -> None:
    engine = engine_for(database_url, access)
    question, wait = LOCK_WAIT[engine.dialect.name]
    with engine.connect() as connection:
        assert connection.execute(text(question)).scalar() == wait
    engine.dispose()


def test_what_a_url_says_stands_before_the_default() -> None:
    engine = engine_for("postgresql://somebody@nowhere/db?connect_timeout=3", Access.WRITE)
    assert engine.url.query["connect_timeout"] == "3"
    assert engine.dialect.driver == "psycopg"
