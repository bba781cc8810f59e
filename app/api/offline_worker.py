"""The service worker's text: which files the pages are made of, and a version that changes when one of them does."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

WORKER = "offline_worker.js"
DOCUMENTS = {"/": "index.html", "/manifest.webmanifest": "manifest.webmanifest"}
FOLDERS = ("assets", "vendor")
KINDS = (".js", ".css", ".svg", ".png")
BUILD_INPUT = "-entry.js"  # what a vendored library is made from
VERSION_DIGITS = 16


def worker_text(web: Path) -> str:
    """The worker with the files that it keeps.

    Parameters
    ----------
    web : Path
        Folder of the pages.
    """
    files = _files(web)
    digest = hashlib.sha256()
    for address, path in files.items():
        digest.update(f"{address}\n".encode())
        digest.update(path.read_bytes())
    worker = (web / WORKER).read_text(encoding="utf-8")
    digest.update(worker.encode())
    version = digest.hexdigest()[:VERSION_DIGITS]
    return f"const VERSION = {json.dumps(version)};\nconst FILES = {json.dumps(list(files))};\n{worker}"


def _files(web: Path) -> dict[str, Path]:
    """The pages' files by their addresses."""
    found = {address: web / name for address, name in DOCUMENTS.items()}
    for folder in FOLDERS:
        for path in sorted((web / folder).rglob("*")):
            if path.suffix in KINDS and not path.name.endswith(BUILD_INPUT):
                found[f"/{path.relative_to(web).as_posix()}"] = path
    return found
