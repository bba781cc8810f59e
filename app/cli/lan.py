"""``serve --lan``: for the phones of one site, in the network of this machine: a certificate, a key, a QR code."""

from __future__ import annotations

import io
import socket
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING
from urllib.parse import urlencode

from app.errors import InvalidInput

if TYPE_CHECKING:
    from app.cli.certificate import Certificate
    from app.storage.database import Database, Session

# Of TEST-NET-1 (RFC 5737): a datagram socket that is meant for it sends nothing, and knows which way it would.
ELSEWHERE = ("192.0.2.1", 9)
KEY_LASTS_S = 24 * 3600.0
NAME = "serve --lan"
SITES_NAMED = 5


@dataclass(frozen=True)
class Invitation:
    """What a phone needs: the site and a key that locates there and opens nothing else."""

    site_id: str
    site_name: str
    secret: str

    def link(self, url: str) -> str:
        """Where the code leads; what stands behind ``#`` is never sent, so that no log has the key."""
        return f"{url}/#{urlencode({'site_id': self.site_id, 'key': self.secret})}"


def lan_address() -> str:
    """The address of this machine in its network.

    Raises
    ------
    InvalidInput
        When it is in none.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(ELSEWHERE)
        except OSError as error:
            raise InvalidInput("this machine is in no network; name its address with --host") from error
        return str(probe.getsockname()[0])


def names_of(address: str) -> tuple[str, ...]:
    """What phones may call this machine: its address, its name, and its name as neighbours find it (mDNS)."""
    name = socket.gethostname().split(".")[0]
    return (address, name, f"{name}.local") if name.isascii() and name else (address,)


def invite(database: Database, site_id: str | None) -> Invitation:
    """A new key for the phones of a site; it ends after a day.

    Parameters
    ----------
    database : Database
    site_id : str or None
        None for the only site that there is.

    Raises
    ------
    NotFound
        When there is no such site.
    InvalidInput
        When none is named and there is not exactly one.
    """
    from app.services.keys import create_key
    from app.storage.audit import Actor, noting
    from app.storage.keys import NewKey
    from app.storage.sites import SiteRepository

    with noting(Actor(None, NAME, socket.gethostname()), NAME, {}), database.writing() as session:
        site = SiteRepository(session).get(_only_site(session) if site_id is None else site_id)
        wanted = NewKey("phones in the network", ("locate",), (site.site_id,), expires_s=time.time() + KEY_LASTS_S)
        return Invitation(site.site_id, site.name, create_key(session, wanted).secret)


def welcome(url: str, invitation: Invitation, certificate: Certificate) -> str:
    """What is printed: what people compare, and what phones read."""
    import segno

    code = io.StringIO()
    segno.make_qr(invitation.link(url)).terminal(out=code, compact=True)
    return "\n".join(
        [
            f"Phones that read this code locate themselves in {invitation.site_name}; the key in it ends in 24 hours.",
            code.getvalue(),
            invitation.link(url),
            "The phone warns that it does not know the certificate: its SHA-256 fingerprint must be",
            certificate.fingerprint,
        ]
    )


def _only_site(session: Session) -> str:
    from app.storage.paging import PageRequest
    from app.storage.sites import SiteRepository

    sites = SiteRepository(session).page(PageRequest(SITES_NAMED)).items
    if not sites:
        raise InvalidInput("there is no site yet: make one and survey it first, without --lan")
    if len(sites) > 1:
        named = ", ".join(f"{site.site_id} ({site.name})" for site in sites)
        raise InvalidInput(f"there are several sites: name one with --site, such as {named}")
    return sites[0].site_id
