"""What routes say about who may call them: ``dependencies=[needs("survey")]``, or a ``Principal`` as an argument.

A key that is bound to sites gets through ``needs`` only where the address names one of its sites, or a survey, job or
trajectory of one. A route whose address names none takes the principal as an argument (``Locating``, ``Surveying``,
``Analysing``, ``Reading``, ``Administering``) and answers for the sites itself: ``principal.site(body.site_id)``,
or a list filtered by ``principal.site_ids``.
"""

from __future__ import annotations

import asyncio
from typing import Annotated, Any

from fastapi import Depends, Security
from fastapi.security import SecurityScopes
from starlette.requests import HTTPConnection

from app.api.admission import PRINCIPAL, admitted, gatekeeper_of, principal_of_state
from app.api.credentials import CookieOfSession, KeyInHeader, address_of
from app.api.request_id import present_request_id
from app.errors import NotAllowed, NotFound
from app.services.audit import note_refusal
from app.services.principal import ANYONE, Principal, Scope
from app.storage.audit import Actor, expect_change
from app.storage.belonging import OWNED

SAFE_METHODS = ("GET", "HEAD", "OPTIONS")
# A snapshot is its own record: its trajectory says when, where and by which device. A row more would double its cost.
# So is a position that a running system sends.
NOT_AUDITED = ("/locate", "/evaluations/live/{live_id}/samples")
NAMES_SITE = ("site_id", *OWNED)

SHOWS_KEY = KeyInHeader()
SHOWS_COOKIE = CookieOfSession()


async def principal_of(
    connection: HTTPConnection,
    wanted: SecurityScopes,
    _key: Annotated[str | None, Security(SHOWS_KEY)] = None,
    _cookie: Annotated[str | None, Security(SHOWS_COOKIE)] = None,
) -> Principal:
    """Who asks; also on WebSockets.

    Raises
    ------
    NotAuthenticated
        Without a key that is valid.
    TooManyRequests
        When it asks more often than it may.
    NotAllowed
        When the key has none of the wanted scopes.
    NotFound
        When the address names something of a site that is none of the key's.
    """
    principal = principal_of_state(connection) or await admitted(connection)
    setattr(connection.state, PRINCIPAL, principal)  # the log names the key
    try:
        _check_scopes(principal, wanted.scopes)
        await _check_sites(connection, principal)
    except (NotAllowed, NotFound) as refusal:
        await _note_refusal(connection, principal)
        raise refusal
    if _is_audited(connection):
        expect_change(_actor(connection, principal), _action(connection), await _subject(connection))
    return principal


async def guard(connection: HTTPConnection, principal: Annotated[Principal, Depends(principal_of)]) -> None:
    """Let those through who may call this route.

    Raises
    ------
    NotAuthenticated, TooManyRequests, NotAllowed, NotFound
        As ``principal_of``; NotAllowed also for a key of some sites where the address names no site.
    """
    if principal.site_ids is not None and not _named(connection):
        await _note_refusal(connection, principal)
        raise NotAllowed(
            "this call is about the whole installation, and the key is bound to sites; use one that is not"
        )


async def visitor(connection: HTTPConnection) -> None:
    """For routes that take whoever comes: the visit is counted, and what it changes goes into the audit.

    Raises
    ------
    TooManyRequests
    """
    gatekeeper_of(connection).count_visit(address_of(connection))
    expect_change(_actor(connection, ANYONE), _action(connection), await _subject(connection))


def needs(*any_of: Scope) -> Any:
    """For ``dependencies=[...]`` of a route: who holds one of these scopes may call it."""
    return Security(guard, scopes=any_of)


may_read = needs("locate", "survey", "analyse")  # what all who work with a site read

Locating = Annotated[Principal, Security(principal_of, scopes=["locate"])]
Surveying = Annotated[Principal, Security(principal_of, scopes=["survey"])]
Analysing = Annotated[Principal, Security(principal_of, scopes=["analyse"])]
Administering = Annotated[Principal, Security(principal_of, scopes=["admin"])]
# Sites, target maps and cameras are read by all who work with them.
Reading = Annotated[Principal, Security(principal_of, scopes=["locate", "survey", "analyse"])]
# A phone opens its trajectory, and so does an analyst.
Recording = Annotated[Principal, Security(principal_of, scopes=["locate", "analyse"])]


def _check_scopes(principal: Principal, wanted: list[str]) -> None:
    if not principal.may(*wanted):
        raise NotAllowed(
            f"this call needs a key with the scope {' or '.join(wanted)}; {principal.name} has "
            f"{', '.join(sorted(principal.scopes))}",
            needs=wanted,
        )


async def _check_sites(connection: HTTPConnection, principal: Principal) -> None:
    """What is of another site is answered exactly as what does not exist: a key learns nothing of other sites."""
    if principal.site_ids is None:
        return
    for id_name, identifier in _named(connection).items():
        site_id = await gatekeeper_of(connection).site_of(id_name, identifier)
        if site_id is None or not principal.sees(site_id):
            kind = id_name.removesuffix("_id")
            raise NotFound(f"there is no {kind} {identifier} that this key may see", **{id_name: identifier})


def _named(connection: HTTPConnection) -> dict[str, str]:
    """What of sites the address names."""
    given = {**connection.query_params, **connection.path_params}
    return {name: str(given[name]) for name in NAMES_SITE if name in given}


def _is_audited(connection: HTTPConnection) -> bool:
    scope = connection.scope
    return scope["type"] == "http" and scope["method"] not in SAFE_METHODS and scope["route"].path not in NOT_AUDITED


async def _note_refusal(connection: HTTPConnection, principal: Principal) -> None:
    if _is_audited(connection):
        told = (_actor(connection, principal), _action(connection), await _subject(connection))
        await asyncio.to_thread(note_refusal, connection.state.services.database, *told)


def _actor(connection: HTTPConnection, principal: Principal) -> Actor:
    return Actor(principal.key_id, principal.name, address_of(connection), present_request_id())


def _action(connection: HTTPConnection) -> str:
    return f"{connection.scope['method']} {connection.scope['route'].path}"


async def _subject(connection: HTTPConnection) -> dict[str, str]:
    """What the address names, and the site that it belongs to."""
    named = {name: str(value) for name, value in connection.path_params.items()}
    for id_name in OWNED.keys() & named.keys():
        site_id = await gatekeeper_of(connection).site_of(id_name, named[id_name])
        named |= {} if site_id is None else {"site_id": site_id}
    return named
