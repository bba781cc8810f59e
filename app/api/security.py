"""What routes say about who may call them: ``dependencies=[needs("survey")]``, or a ``Principal`` as an argument.

A key that is bound to sites gets through ``needs`` only where the address names one of its sites, or a survey, job or
trajectory of one. A route whose address names none takes the principal as an argument (``Locating``, ``Surveying``,
``Analysing``, ``Reading``, ``Administering``) and answers for the sites itself: ``principal.site(body.site_id)``,
or a list filtered by ``principal.site_ids``.
"""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import Security
from fastapi.security import SecurityScopes
from starlette.requests import HTTPConnection

from app.services.principal import ANYONE, Principal, Scope


async def principal_of(_connection: HTTPConnection, _wanted: SecurityScopes) -> Principal:
    """Who asks; also on WebSockets.

    Raises
    ------
    NotAuthenticated
        Without a key that is valid.
    NotAllowed
        When the key has none of the wanted scopes.
    NotFound
        When the address names something of a site that is none of the key's.
    """
    return ANYONE


async def guard(connection: HTTPConnection, wanted: SecurityScopes) -> None:
    """Let those through who may call this route.

    Raises
    ------
    NotAuthenticated, NotAllowed, NotFound
        As ``principal_of``; NotAllowed also for a key of some sites where the address names no site.
    """
    await principal_of(connection, wanted)


def needs(*any_of: Scope) -> Any:
    """For ``dependencies=[...]`` of a route: who holds one of these scopes may call it."""
    return Security(guard, scopes=any_of)


Locating = Annotated[Principal, Security(principal_of, scopes=["locate"])]
Surveying = Annotated[Principal, Security(principal_of, scopes=["survey"])]
Analysing = Annotated[Principal, Security(principal_of, scopes=["analyse"])]
Administering = Annotated[Principal, Security(principal_of, scopes=["admin"])]
# Sites, target maps and cameras are read by all who work with them.
Reading = Annotated[Principal, Security(principal_of, scopes=["locate", "survey", "analyse"])]
# A phone opens its trajectory, and so does an analyst.
Recording = Annotated[Principal, Security(principal_of, scopes=["locate", "analyse"])]
