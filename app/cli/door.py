"""Who may come in to what ``scattermark serve`` serves: decided before anything listens for long, said in one line."""

from __future__ import annotations

import argparse
import dataclasses
import ipaddress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from app.cli.migrate import open_database
from app.errors import InvalidInput

if TYPE_CHECKING:
    from app.cli.certificate import Certificate
    from app.cli.lan import Invitation
    from app.settings import Settings
    from app.storage.database import Database

LOOPBACK = "127.0.0.1"
TLS_FOLDER = "tls"  # of the data's folder


@dataclass(frozen=True)
class Door:
    """How a service is reached: with TLS or without, and what is said to the phones of its network.

    Attributes
    ----------
    certificate : Certificate or None
        With one it speaks TLS.
    invitation : Invitation or None
    """

    certificate: Certificate | None = None
    invitation: Invitation | None = None

    @property
    def scheme(self) -> str:
        """Of its URL."""
        return "http" if self.certificate is None else "https"

    def greeting(self, url: str) -> str:
        """What is printed once it answers; the URL stands in the first line."""
        ready = f"Scattermark is ready at {url}"
        if self.certificate is None or self.invitation is None:
            return ready
        from app.cli.lan import welcome

        return f"{ready}\n{welcome(url, self.invitation, self.certificate)}"


def add_door(parser: argparse.ArgumentParser) -> None:
    """The arguments that say who may come in."""
    parser.add_argument("--host", help="address to bind to (127.0.0.1)")
    parser.add_argument(
        "--require-keys",
        action="store_true",
        help="ask for keys on 127.0.0.1 too, for a proxy there that lets others in",
    )
    parser.add_argument(
        "--insecure", action="store_true", help="bind to another address than this machine's own without keys"
    )
    parser.add_argument(
        "--lan", action="store_true", help="for the phones of this network: TLS, a certificate and a QR code with a key"
    )
    parser.add_argument("--site", metavar="ID", help="with --lan: where the phones locate (the only site)")


def host_of(arguments: argparse.Namespace) -> str:
    """The address to bind to.

    Raises
    ------
    InvalidInput
        When the arguments contradict each other, or this machine is in no network.
    """
    if arguments.lan and arguments.insecure:
        raise InvalidInput("--lan makes a key, and --insecure asks for none: leave one of them out")
    if arguments.site is not None and not arguments.lan:
        raise InvalidInput("--site says where the phones of --lan locate: say --lan, too")
    if arguments.host is not None or not arguments.lan:
        return str(arguments.host or LOOPBACK)
    from app.cli.lan import lan_address

    return lan_address()


def guarded(settings: Settings, arguments: argparse.Namespace, host: str) -> Settings:
    """Settings that ask for keys wherever others can reach the service, unless they shall not."""
    insecure = settings.insecure or arguments.insecure
    wanted = settings.require_keys or arguments.require_keys or arguments.lan
    required = wanted or not (insecure or is_loopback(host))
    return dataclasses.replace(settings, require_keys=required, insecure=insecure and not required)


def refuse_open_door(settings: Settings, arguments: argparse.Namespace, host: str) -> None:
    """Refuse before anything is made, where it is plain that there is no key.

    Raises
    ------
    InvalidInput
    """
    from sqlalchemy import make_url

    path = make_url(settings.sqlalchemy_url).database
    nothing_yet = settings.embedded and path is not None and not Path(path).exists()
    if settings.require_keys and nothing_yet and not settings.bootstrap_key and not arguments.lan:
        raise InvalidInput(_no_keys(host))


def open_door(settings: Settings, arguments: argparse.Namespace, host: str) -> Door:
    """Make what a guarded service needs; the database has its tables.

    Raises
    ------
    InvalidInput
        When keys are needed and there is none, or a setting of theirs cannot be used.
    NotFound
        When ``--site`` names none.
    """
    if not settings.require_keys:
        return Door()
    database = open_database(settings)
    try:
        return _guarded_door(database, settings, arguments, host)
    finally:
        database.close()


def _guarded_door(database: Database, settings: Settings, arguments: argparse.Namespace, host: str) -> Door:
    from app.services.keys import any_valid_key, ensure_bootstrap_key
    from app.storage.migrate import check_tables

    check_tables(database)
    if settings.bootstrap_key:
        ensure_bootstrap_key(database, settings.bootstrap_key)
    if arguments.lan:
        from app.cli.certificate import certificate_for
        from app.cli.lan import invite, names_of

        invitation = invite(database, arguments.site)
        return Door(certificate_for(names_of(host), settings.data_dir / TLS_FOLDER), invitation)
    if not any_valid_key(database):
        raise InvalidInput(_no_keys(host))
    return Door()


def _no_keys(host: str) -> str:
    return (
        f"{host} can be reached by others and there is no valid key yet: make one with `scattermark keys create` or "
        "SCATTERMARK_BOOTSTRAP_KEY, bind to 127.0.0.1, or say --insecure if you trust everyone who can reach it"
    )


def is_loopback(host: str) -> bool:
    """Whether an address is this machine's own."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
