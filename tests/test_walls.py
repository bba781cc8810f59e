"""The walls of the architecture: who may import whom, read from the source, lazy and typing-only imports included."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

import app

APP_DIR = Path(app.__file__).parent

# The way the data takes: a folder or file of app/ may import what stands before it.
ORDER = (
    "errors",
    "compiled",  # a decorator of the library's innermost loops; knows nothing of them
    "settings",
    "logs",  # services and jobs bind their ids, whoever starts a process sets it up
    "targets",
    "geometry",
    "vision",
    "photogrammetry",
    "trajectories",
    "planning",
    "storage",
    "services",
    "jobs",
    "api",
    "web",
    "main",
    "cli",
)
LIBRARY = ("targets", "geometry", "vision", "photogrammetry", "trajectories", "planning")
HTTP = ("fastapi", "starlette", "uvicorn", "httpx", "http", "multipart")
SQL = ("sqlalchemy", "alembic", "sqlite3", "psycopg")


@dataclass(frozen=True)
class Wall:
    """Folders of app/ and the modules that they never import."""

    name: str
    folders: tuple[str, ...]
    forbidden: tuple[str, ...]


@dataclass(frozen=True)
class Import:
    """One imported module and where it stands."""

    folder: str
    module: str
    place: str


WALLS = (
    Wall("the library runs in a notebook", LIBRARY, (*HTTP, *SQL, "pydantic", "app.settings", "app.logs")),
    Wall("vision meets its neighbours in geometry", ("vision",), ("app.photogrammetry", "app.trajectories")),
    Wall("photogrammetry meets its neighbours in geometry", ("photogrammetry",), ("app.vision", "app.trajectories")),
    Wall("trajectories meet their neighbours in geometry", ("trajectories",), ("app.vision", "app.photogrammetry")),
    Wall("storage knows no vision, services or api", ("storage",), ("app.vision", "app.services", "app.api", *HTTP)),
    Wall("services know no HTTP", ("services",), (*HTTP, "app.api")),
    Wall("api holds no SQL and no pixels", ("api",), (*SQL, "cv2")),
    Wall("api and jobs meet through services", ("api",), ("app.jobs",)),
    Wall("jobs know no HTTP", ("jobs",), (*HTTP, "app.api")),
)


def imports_of(app_dir: Path) -> Iterator[Import]:
    """Each import statement below a folder laid out as app/."""
    for path in sorted(app_dir.rglob("*.py")):
        parts = ("app", *path.relative_to(app_dir).with_suffix("").parts)
        package = parts[:-1]
        for node in ast.walk(ast.parse(path.read_text())):
            for module in modules_of(node, package):
                yield Import(parts[1], module, f"{'/'.join(parts)}.py:{getattr(node, 'lineno', 0)}")


def modules_of(node: ast.AST, package: tuple[str, ...]) -> list[str]:
    """Absolute names that one statement imports; ``from app import x`` counts as ``app.x``."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    if isinstance(node, ast.ImportFrom):
        base = (*package[: len(package) - node.level + 1], node.module) if node.level else (node.module,)
        prefix = ".".join(part for part in base if part)
        return [f"{prefix}.{alias.name}" for alias in node.names]
    return []


def within(module: str, prefix: str) -> bool:
    return module == prefix or module.startswith(f"{prefix}.")


def breaches(found: Import) -> Iterator[str]:
    """The walls that one import breaks, in words."""
    for wall in WALLS:
        if found.folder in wall.folders and any(within(found.module, prefix) for prefix in wall.forbidden):
            yield f"{found.place} imports {found.module}: {wall.name}"
    imported = found.module.split(".")
    if imported[0] == "app" and len(imported) > 1 and found.folder != "__init__":
        if imported[1] not in ORDER:
            yield f"{found.place} imports {found.module}, which has no place in the order"
        elif ORDER.index(imported[1]) > ORDER.index(found.folder):
            yield f"{found.place} imports {found.module}: data flows one way"


def test_no_wall_is_broken() -> None:
    assert [breach for found in imports_of(APP_DIR) for breach in breaches(found)] == []


def test_everything_in_app_has_its_place() -> None:
    names = {path.stem for path in APP_DIR.iterdir() if path.suffix == ".py" or any(path.glob("*.py"))}
    assert names - {"__init__"} <= set(ORDER)


# A file of app/, what it says, and the wall that it breaks.
BREACHES = (
    ("vision/a.py", "import fastapi", "notebook"),
    ("geometry/a.py", "from pydantic import BaseModel", "notebook"),
    ("planning/a.py", "from app import settings", "notebook"),
    ("vision/a.py", "from app.logs import log_context", "notebook"),
    ("vision/a.py", "from app.photogrammetry.resection import resect", "vision meets"),
    ("photogrammetry/a.py", "from ..vision import detector", "photogrammetry meets"),
    ("trajectories/a.py", "import app.vision.photo", "trajectories meet"),
    ("storage/a.py", "def later():\n    from app.vision import photo", "storage knows"),
    ("services/a.py", "from starlette.requests import Request", "services know"),
    ("api/a.py", "from sqlalchemy import select", "no SQL"),
    ("api/a.py", "import cv2", "no pixels"),
    ("api/a.py", "from app.jobs.pool import WorkerPool", "api and jobs"),
    ("jobs/a.py", "import http.client", "jobs know"),
    ("targets/a.py", "if TYPE_CHECKING:\n    from app.geometry.pose import Pose", "one way"),
    ("errors.py", "from app.geometry import pose", "one way"),
    ("geometry/a.py", "from app.helpers import anything", "no place"),
)


@pytest.mark.parametrize(("path", "source", "wall"), BREACHES)
def test_a_breach_is_found(tmp_path: Path, path: str, source: str, wall: str) -> None:
    file = tmp_path / path
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(source)
    assert any(wall in breach for found in imports_of(tmp_path) for breach in breaches(found))


def test_each_wall_has_a_sample_that_breaks_it() -> None:
    unproven = [wall.name for wall in WALLS if not any(words in wall.name for _, _, words in BREACHES)]
    assert unproven == []
