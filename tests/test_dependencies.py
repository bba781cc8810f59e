"""What app/ and migrations/ import is what pyproject.toml declares: a wheel brings all that it needs."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).parents[1]
# Used by name alone: a driver that a URL names.
BY_NAME = {"psycopg"}
# Brought and meant to be used by another package: starlette is the ground of fastapi, llvmlite that of numba.
BROUGHT = {"starlette": "fastapi", "llvmlite": "numba"}
# Declared for what other packages do with them: fastapi reads forms with one, uvicorn speaks WebSocket with the other.
FOR_OTHERS = {"python-multipart", "websockets"}


def normalised(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def requirement_name(requirement: str) -> str:
    found = re.match(r"[\w.-]+", requirement)
    assert found is not None
    return normalised(found[0])


@pytest.fixture(scope="module")
def declared() -> dict[str, set[str]]:
    """Names of the declared requirements; the extras by their names, the package's own under the empty one."""
    project = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())["project"]
    groups = {"": project["dependencies"], **project["optional-dependencies"]}
    return {name: {requirement_name(one) for one in requirements} for name, requirements in groups.items()}


def imported_modules(folder: Path) -> set[str]:
    """Top-level names that a folder's files import, also inside functions."""
    names: set[str] = set()
    for path in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                names |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                names.add(node.module.split(".")[0])
    return names - set(sys.stdlib_module_names) - {"app", "migrations", "benchmarks", "tests"}


@cache
def installed() -> Mapping[str, list[str]]:
    """Distributions by the modules they bring; looking at all of them takes a while."""
    return packages_distributions()


def distribution_of(module: str) -> str:
    return normalised(installed().get(module, [module])[0])


def test_every_import_of_the_package_is_declared(declared: dict[str, set[str]]) -> None:
    modules = imported_modules(CHECKOUT / "app") | imported_modules(CHECKOUT / "migrations")
    for module in modules:
        distribution = normalised(BROUGHT.get(module, distribution_of(module)))
        anywhere = declared[""] | declared["postgres"] | declared["heic"]
        assert distribution in anywhere, f"{module} is imported and not declared"


def test_every_requirement_of_the_package_is_imported(declared: dict[str, set[str]]) -> None:
    modules = imported_modules(CHECKOUT / "app") | imported_modules(CHECKOUT / "migrations")
    used = {distribution_of(module) for module in modules} | FOR_OTHERS
    assert declared[""] <= used
    assert declared["postgres"] <= used | BY_NAME
    assert declared["heic"] <= used


def test_peers_are_never_part_of_the_package(declared: dict[str, set[str]]) -> None:
    assert not declared["bench"] & declared[""]
    assert "pupil_apriltags" not in imported_modules(CHECKOUT / "app")
