"""``scattermark keys`` on the database, and what the service makes of it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from app.cli import keys, main
from app.services.keys import digest_of
from app.services.principal import SCOPES
from app.settings import Settings
from app.storage.audit import AuditRepository
from app.storage.database import Database
from app.storage.keys import KeyRepository
from app.storage.paging import PageRequest


def run(capsys: pytest.CaptureFixture[str], folder: Path, *arguments: str) -> Any:
    """What a command prints for machines."""
    assert main(["keys", *arguments, "--json", "--data-dir", str(folder)]) == 0
    return json.loads(capsys.readouterr().out)


def refusal(capsys: pytest.CaptureFixture[str], folder: Path, *arguments: str) -> str:
    assert main(["keys", *arguments, "--data-dir", str(folder)]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    return line


def test_a_key_is_made_listed_shown_and_revoked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    made = run(capsys, tmp_path, "create", "hall phones", "--scope", "locate", "--rate", "5", "--burst", "9")
    secret = made.pop("secret")
    assert (made["name"], made["scopes"], made["rate_per_s"], made["burst"]) == ("hall phones", ["locate"], 5.0, 9)
    assert run(capsys, tmp_path, "list") == {"keys": [made]}
    assert run(capsys, tmp_path, "show", made["key_id"]) == made
    assert run(capsys, tmp_path, "revoke", made["key_id"])["revoked_at"] is not None
    database = Database(Settings(data_dir=tmp_path).sqlalchemy_url)
    with database.reading() as session:
        key = KeyRepository(session).find(digest_of(secret))
        assert key is not None and key.revoked_s is not None
        actions = [(entry.action, entry.actor.name) for entry in AuditRepository(session).page(PageRequest()).items]
    assert actions == [("keys revoke", "command line"), ("keys create", "command line")]
    database.close()


def test_people_read_the_secret_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["keys", "create", "ops", "--scope", "admin", "--days", "1.5", "--data-dir", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    (secret,) = [line.split()[1] for line in printed.splitlines() if line.startswith("secret")]
    assert secret.startswith("smk_")
    assert "nobody can look it up again" in printed
    assert main(["keys", "list", "--data-dir", str(tmp_path)]) == 0
    listed = capsys.readouterr().out
    assert "ops" in listed and "valid" in listed
    assert secret not in listed


def test_no_keys_are_said_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["keys", "list", "--data-dir", str(tmp_path)]) == 0
    assert "keys create" in capsys.readouterr().out


def test_bad_input_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    create = ("create", "x", "--scope", "locate")
    assert "there is no site nowhere" in refusal(capsys, tmp_path, *create, "--site", "nowhere")
    assert "name is 1 to 200" in refusal(capsys, tmp_path, "create", " ", "--scope", "locate")
    assert "there is no key nothing" in refusal(capsys, tmp_path, "revoke", "nothing")
    with pytest.raises(SystemExit):
        main(["keys", "create", "x", "--scope", "fly"])


def test_the_scopes_are_the_service_s() -> None:
    assert keys.SCOPES == SCOPES
