"""Databases that cannot be brought up to date are named in one line."""

from __future__ import annotations

import sqlite3
from pathlib import Path

import pytest

from app.cli import main


def test_an_empty_folder_gets_a_database_and_keeps_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for _ in range(2):
        assert main(["migrate", "--data-dir", str(tmp_path / "data")]) == 0
    assert capsys.readouterr().out.splitlines() == ["the database is up to date"] * 2
    assert list((tmp_path / "data").glob("*.db"))


def test_a_file_that_is_no_database(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "scattermark.db").write_text("this is no database, and long enough to be taken for one")
    assert main(["migrate", "--data-dir", str(tmp_path)]) == 1
    assert "file is not a database" in one_line(capsys)


def test_a_database_of_another_version(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["migrate", "--data-dir", str(tmp_path)]) == 0
    with sqlite3.connect(tmp_path / "scattermark.db") as database:
        database.execute("UPDATE alembic_version SET version_num = 'from-the-future'")
    database.close()
    capsys.readouterr()
    assert main(["migrate", "--data-dir", str(tmp_path)]) == 1
    assert "another version" in one_line(capsys)


def test_a_url_that_is_none(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCATTERMARK_DATABASE_URL", "nonsense")
    assert main(["migrate"]) == 1
    assert "SCATTERMARK_DATABASE_URL='nonsense'" in one_line(capsys)


def one_line(capsys: pytest.CaptureFixture[str]) -> str:
    (line,) = capsys.readouterr().err.splitlines()
    return line
