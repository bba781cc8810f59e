"""``scattermark keys``: made, listed, shown, revoked, in the database itself and so without a key."""

from __future__ import annotations

import argparse
import json
import socket
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from app.cli.arguments import add_data_dir, add_json, at_least_one, positive
from app.cli.migrate import migrate, open_database, settings_of
from app.errors import InvalidInput

if TYPE_CHECKING:
    from app.storage.database import Session
    from app.storage.keys import ApiKey

HELP = "make, list, show and revoke the keys of the service"

# A test holds it equal to the service's list, whose import is slow.
SCOPES = ("locate", "survey", "analyse", "admin")
DAY_S = 24 * 3600.0
PAGE = 500
NAME = "command line"  # whoever sits there may read the database anyway


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's actions and their arguments."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="action")
    create = actions.add_parser("create", help="make a key; its secret is printed once")
    create.add_argument("name", help="who or what holds it, for people")
    create.add_argument(
        "--scope", action="append", required=True, choices=SCOPES, help="what it opens; admin opens everything"
    )
    create.add_argument("--site", action="append", metavar="ID", help="the only site that there is for it; repeat")
    create.add_argument("--rate", type=positive, help="requests a second (SCATTERMARK_KEY_RATE_PER_S)")
    create.add_argument("--burst", type=at_least_one, help="requests that may come at once (SCATTERMARK_KEY_BURST)")
    create.add_argument("--days", type=positive, help="after how many days it opens nothing any more (never)")
    listing = actions.add_parser("list", help="all keys, without their secrets")
    show = actions.add_parser("show", help="one key")
    revoke = actions.add_parser("revoke", help="let a key open nothing any more; running servers notice in seconds")
    for action in (show, revoke):
        action.add_argument("key_id")
    for action, run_action in ((create, _create), (listing, _list), (show, _show), (revoke, _revoke)):
        add_data_dir(action)
        add_json(action)
        action.set_defaults(run_action=run_action)


def run(arguments: argparse.Namespace) -> int:
    """Do one action, as one transaction."""
    with _key_session(arguments) as session:
        lines = arguments.run_action(session, arguments)
    print("\n".join(lines))
    return 0


@contextmanager
def _key_session(arguments: argparse.Namespace) -> Iterator[Session]:
    """A session in which whoever sits at the command line is who acts."""
    from app.storage.audit import Actor, noting
    from app.storage.migrate import check_tables

    settings = settings_of(arguments.data_dir)
    if settings.embedded:
        migrate(settings)
    database = open_database(settings)
    try:
        check_tables(database)
        if arguments.action in ("list", "show"):
            with database.reading() as session:
                yield session
        else:
            actor = Actor(None, NAME, socket.gethostname())
            with noting(actor, f"keys {arguments.action}", {}), database.writing() as session:
                yield session
    finally:
        database.close()


def _create(session: Session, arguments: argparse.Namespace) -> Sequence[str]:
    from app.api.schemas.keys import IssuedKeyAnswer
    from app.services.keys import create_key
    from app.storage.keys import NewKey

    wanted = NewKey(
        name=_checked_name(arguments.name),
        scopes=tuple(arguments.scope),
        site_ids=None if arguments.site is None else tuple(arguments.site),
        rate_per_s=arguments.rate,
        burst=arguments.burst,
        expires_s=None if arguments.days is None else time.time() + arguments.days * DAY_S,
    )
    issued = create_key(session, wanted)
    if arguments.json:
        return [IssuedKeyAnswer.of_issued(issued).model_dump_json()]
    return [*_lines(issued.key), f"secret   {issued.secret}", "Keep the secret now: nobody can look it up again."]


def _list(session: Session, arguments: argparse.Namespace) -> Sequence[str]:
    from app.storage.keys import KeyRepository
    from app.storage.paging import PageRequest

    keys: list[ApiKey] = []
    cursor = None
    while True:
        page = KeyRepository(session).page(PageRequest(PAGE, cursor))
        keys += page.items
        cursor = page.next_cursor
        if cursor is None:
            break
    if arguments.json:
        return [json.dumps({"keys": [_json(key) for key in keys]})]
    return [_line(key) for key in keys] or ["there are no keys; `scattermark keys create` makes one"]


def _show(session: Session, arguments: argparse.Namespace) -> Sequence[str]:
    from app.storage.keys import KeyRepository

    key = KeyRepository(session).get(arguments.key_id)
    return [json.dumps(_json(key))] if arguments.json else _lines(key)


def _revoke(session: Session, arguments: argparse.Namespace) -> Sequence[str]:
    from app.storage.keys import KeyRepository

    key = KeyRepository(session).revoke(arguments.key_id)
    return [json.dumps(_json(key))] if arguments.json else [f"{key.key_id} ({key.grant.name}) opens nothing any more"]


def _checked_name(name: str) -> str:
    from app.api.schemas.texts import NAME

    if not NAME.fullmatch(name) or len(name) > 200:
        raise InvalidInput("a key's name is 1 to 200 letters, digits, signs and spaces")
    return name.strip()


def _json(key: ApiKey) -> dict[str, Any]:
    from app.api.schemas.keys import KeyAnswer

    return KeyAnswer.of(key).model_dump()


def _lines(key: ApiKey) -> list[str]:
    return [f"{name:<9}{value}" for name, value in _facts(key).items()]


def _line(key: ApiKey) -> str:
    facts = _facts(key)
    return "  ".join([facts["key"], facts["state"], facts["begins"], facts["scopes"], facts["name"]])


def _facts(key: ApiKey) -> dict[str, str]:
    record = _json(key)
    state = "revoked" if key.revoked_s else "valid" if key.valid_at(time.time()) else "expired"
    return {
        "key": key.key_id,
        "name": key.grant.name,
        "state": state,
        "scopes": " ".join(key.grant.scopes),
        "sites": "all" if key.grant.site_ids is None else " ".join(key.grant.site_ids),
        "begins": key.hint,
        "made": record["created_at"],
        "expires": record["expires_at"] or "never",
        "used": record["last_used_at"] or "never",
    }
