"""The methods that a path takes: the framework names those of one route only, and a path has a route per method."""

from __future__ import annotations

from collections.abc import Sequence

from fastapi.routing import iter_route_contexts
from starlette.routing import BaseRoute, compile_path


def allowed_methods(routes: Sequence[BaseRoute], path: str) -> str:
    """What belongs into ``Allow`` of a 405 (RFC 9110, 15.5.6)."""
    methods: dict[str, set[str]] = {}
    for route in iter_route_contexts(routes):
        if route.path is not None and compile_path(route.path)[0].match(path):
            methods.setdefault(route.path, set()).update(route.methods or ())
    # Of "/sites/import" and "/sites/{site_id}" it is the first that was meant.
    meant = min(methods, key=lambda template: template.count("{"))
    return ", ".join(sorted(methods[meant]))
