"""Who comes in: the one place that says who a request is from, and whether they ask too often."""

from __future__ import annotations

import asyncio
import ipaddress
from collections import OrderedDict
from dataclasses import dataclass

from app.errors import NotAuthenticated
from app.services.key_ring import Holder, KeyRing
from app.services.principal import ANYONE, Principal
from app.services.rates import Rate, RateLimiter
from app.storage.belonging import site_of
from app.storage.database import Database
from app.storage.keys import ApiKey, KeyRepository

REMEMBERED = 10_000  # things whose site is known: a survey or a trajectory never changes its site


@dataclass(frozen=True)
class AccessRules:
    """How this installation is guarded.

    Attributes
    ----------
    keys_required : bool
        Otherwise everyone at this machine may do everything.
    trusts_network : bool
        Without required keys: everyone who can reach the service may do everything, from wherever.
    key_rate : Rate
        Of keys that name none.
    address_rate : Rate or None
        Of each address that asks without a key.
    """

    keys_required: bool
    trusts_network: bool
    key_rate: Rate
    address_rate: Rate | None = None


@dataclass(frozen=True)
class Credentials:
    """What a request shows: a key, the cookie of a session, or neither."""

    key: str | None = None
    cookie: str | None = None


class Gatekeeper:
    """Admits requests; used from one event loop.

    Parameters
    ----------
    database : Database
    rules : AccessRules
    """

    def __init__(self, database: Database, rules: AccessRules) -> None:
        self.rules = rules
        self.ring = KeyRing(database, rules.key_rate)
        self._database = database
        self._rates = RateLimiter()
        self._sites: OrderedDict[tuple[str, str], str] = OrderedDict()

    async def admit(self, shown: Credentials, address: str) -> Principal:
        """Who asks; the request is counted.

        Raises
        ------
        NotAuthenticated
            For a key that opens nothing, or for none where one is needed.
        TooManyRequests
        """
        holder = await self._holder(shown)
        if holder is not None:
            self._rates.spend(holder.key.key_id, holder.rate)
            return holder.principal
        self._check_open(address)
        self.count_visit(address)
        return ANYONE

    def count_visit(self, address: str) -> None:
        """Count a request that shows no key.

        Raises
        ------
        TooManyRequests
        """
        if self.rules.address_rate is not None:
            self._rates.spend(address, self.rules.address_rate)

    async def revoke(self, key_id: str) -> ApiKey:
        """Let a key and its sessions open nothing from now on.

        Raises
        ------
        NotFound
        """
        revoked = await asyncio.to_thread(self._revoke, key_id)
        self.ring.forget(key_id)
        return revoked

    async def site_of(self, id_name: str, identifier: str) -> str | None:
        """The site of a survey, job, trajectory, camera or pose; None when there is no such thing."""
        if id_name == "site_id":
            return identifier
        known = self._sites.get((id_name, identifier))
        if known is not None:
            return known
        site_id = await asyncio.to_thread(self._look_up_site, id_name, identifier)
        if site_id is not None:
            self._sites[id_name, identifier] = site_id
            if len(self._sites) > REMEMBERED:
                self._sites.popitem(last=False)
        return site_id

    async def _holder(self, shown: Credentials) -> Holder | None:
        """The holder of what is shown; a cookie that has ended is as good as none, a key that opens nothing is not."""
        if shown.key is not None:
            holder = await self.ring.holder_of_key(shown.key)
            if holder is None:
                raise NotAuthenticated("this key is unknown, expired or revoked; ask the operator for another one")
            return holder
        return None if shown.cookie is None else await self.ring.holder_of_cookie(shown.cookie)

    def _check_open(self, address: str) -> None:
        rules = self.rules
        if not rules.keys_required and (rules.trusts_network or is_this_machine(address)):
            return
        raise NotAuthenticated(
            "this call needs a key: send it as `Authorization: Bearer smk_...`, or open a session with POST /session; "
            "`scattermark keys create` makes one"
        )

    def _revoke(self, key_id: str) -> ApiKey:
        with self._database.writing() as session:
            return KeyRepository(session).revoke(key_id)

    def _look_up_site(self, id_name: str, identifier: str) -> str | None:
        with self._database.reading() as session:
            return site_of(session, id_name, identifier)


def is_this_machine(address: str) -> bool:
    """Whether an address is one that only this machine itself can ask from."""
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return False
