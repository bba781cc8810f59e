"""The methods that a path takes: the framework names those of one route only, and a path has a route per method."""

from __future__ import annotations

from collections.abc import Sequence

from fastapi.routing import iter_route_contexts
from starlette.routing import BaseRoute, compile_path


def allowed_methods(routes: Sequence[BaseRoute], path: str) -> str:
    """What belongs into ``Allow`` of a 405 (RFC 9110, 15.5.6)."""
    methods: set[str] = set()
    for route in iter_route_contexts(routes):
        if route.path is not None and compile_path(route.path)[0].match(path):
            methods.update(route.methods or ())
    return ", ".join(sorted(methods))
