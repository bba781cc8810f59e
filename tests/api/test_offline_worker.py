"""The service worker keeps every file of the pages, and changes when one of them does."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

from app.api.offline_worker import worker_text
from app.api.routes.pages import WEB
from tests.api.serving import Served


def kept_files(text: str) -> list[str]:
    found = re.search(r"^const FILES = (\[.*\]);$", text, re.MULTILINE)
    assert found is not None
    files: list[str] = json.loads(found[1])
    return files


def version(text: str) -> str:
    return text.splitlines()[0]


def test_all_that_a_page_imports_is_kept(served: Served) -> None:
    answer = served.client.get("/sw.js")
    assert answer.headers["content-type"].startswith("text/javascript")
    assert answer.headers["service-worker-allowed"] == "/"
    assert answer.headers["cache-control"] == "no-cache"
    assert "default-src 'none'" in answer.headers["content-security-policy"]
    files = kept_files(answer.text)
    for path in (WEB / "assets").rglob("*.*"):
        assert f"/assets/{path.relative_to(WEB / 'assets').as_posix()}" in files
    assert {"/", "/manifest.webmanifest", "/vendor/preact.min.js"} <= set(files)
    for address in files:
        assert served.client.get(address).status_code == 200, address
    assert not any(address.startswith(("/sites", "/locate", "/session")) for address in files)


def test_the_version_tells_what_the_files_hold(tmp_path: Path) -> None:
    shutil.copytree(WEB, tmp_path / "web")
    first = worker_text(tmp_path / "web")
    assert worker_text(tmp_path / "web") == first
    (tmp_path / "web" / "assets" / "main.js").write_text("// another\n")
    second = worker_text(tmp_path / "web")
    assert version(second) != version(first)
    (tmp_path / "web" / "assets" / "new.js").write_text("// new\n")
    assert "/assets/new.js" in kept_files(worker_text(tmp_path / "web"))
    assert version(worker_text(tmp_path / "web")) != version(second)
