from __future__ import annotations

import asyncio
import time
from dataclasses import replace

import pytest

from app.errors import NotAuthenticated, TooManyRequests
from app.services import key_ring
from app.services.access_upkeep import AccessUpkeep, remove_what_is_over
from app.services.gatekeeper import AccessRules, Credentials, Gatekeeper, is_this_machine
from app.services.keys import IssuedKey, create_key, digest_of
from app.services.principal import ANYONE
from app.services.rates import Rate
from app.services.sessions import BrowserSessions
from app.storage.audit import Actor, AuditEntry, AuditRepository
from app.storage.database import Database
from app.storage.keys import KeyRepository, NewKey
from app.storage.models import BrowserSessionRow, KeyRow
from app.storage.paging import PageRequest
from tests.storage.examples import site_with_survey

HERE, ELSEWHERE = "127.0.0.1", "192.0.2.7"
OPEN = AccessRules(keys_required=False, trusts_network=False, key_rate=Rate(1000.0, 1000))
GUARDED = replace(OPEN, keys_required=True)


def issue(database: Database, *scopes: str, **grant: float) -> IssuedKey:
    with database.writing() as session:
        return create_key(session, NewKey("test", scopes or ("locate",), **grant))  # type: ignore[arg-type]


def revoke_elsewhere(database: Database, key_id: str) -> None:
    """As another process does it."""
    with database.writing() as session:
        KeyRepository(session).revoke(key_id)


async def refused(gatekeeper: Gatekeeper, shown: Credentials, address: str = HERE) -> bool:
    try:
        await gatekeeper.admit(shown, address)
    except NotAuthenticated:
        return True
    return False


def test_only_this_machine_needs_no_key_and_only_where_none_is_asked_for(database: Database) -> None:
    async def story() -> None:
        nothing = Credentials()
        assert await Gatekeeper(database, OPEN).admit(nothing, HERE) is ANYONE
        assert await Gatekeeper(database, OPEN).admit(nothing, "::1") is ANYONE
        assert await refused(Gatekeeper(database, OPEN), nothing, ELSEWHERE)
        assert await refused(Gatekeeper(database, OPEN), nothing, "unknown")
        assert await refused(Gatekeeper(database, GUARDED), nothing, HERE)
        trusting = Gatekeeper(database, replace(OPEN, trusts_network=True))
        assert await trusting.admit(nothing, ELSEWHERE) is ANYONE

    asyncio.run(story())


def test_a_key_is_known_for_seconds_and_its_end_at_once(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    ends_s = time.time() + 1000.0
    issued = issue(database, expires_s=ends_s)
    shown = Credentials(issued.secret)

    async def story() -> None:
        gatekeeper = Gatekeeper(database, GUARDED)
        assert (await gatekeeper.admit(shown, HERE)).key_id == issued.key.key_id
        revoke_elsewhere(database, issued.key.key_id)
        assert not await refused(gatekeeper, shown)  # known for a few seconds
        with monkeypatch.context() as later:
            later.setattr("app.services.key_ring.time.time", lambda: ends_s + 1.0)
            assert await refused(gatekeeper, shown)
        monkeypatch.setattr(key_ring, "KNOWN_S", 0.0)
        assert await refused(gatekeeper, shown)

    asyncio.run(story())


def test_who_revokes_here_is_heeded_here_at_once(database: Database) -> None:
    issued = issue(database)

    async def story() -> None:
        gatekeeper = Gatekeeper(database, GUARDED)
        sessions = BrowserSessions(database, gatekeeper.ring, 3600.0)
        cookie = (await sessions.open(issued.secret)).secret
        for shown in (Credentials(issued.secret), Credentials(None, cookie)):
            assert not await refused(gatekeeper, shown)
        await gatekeeper.revoke(issued.key.key_id)
        for shown in (Credentials(issued.secret), Credentials(None, cookie)):
            assert await refused(gatekeeper, shown)

    asyncio.run(story())


def test_a_cookie_is_no_key_and_a_key_no_cookie(database: Database) -> None:
    issued = issue(database)

    async def story() -> None:
        gatekeeper = Gatekeeper(database, GUARDED)
        cookie = (await BrowserSessions(database, gatekeeper.ring, 3600.0).open(issued.secret)).secret
        assert await refused(gatekeeper, Credentials(cookie))
        assert await refused(Gatekeeper(database, GUARDED), Credentials(None, issued.secret))
        # Not even after the other way was asked for, so that each is known.
        assert not await refused(gatekeeper, Credentials(None, cookie))
        assert await refused(gatekeeper, Credentials(cookie))
        assert await refused(gatekeeper, Credentials(None, issued.secret))

    asyncio.run(story())


def test_a_session_never_outlasts_its_key(database: Database) -> None:
    issued = issue(database, expires_s=time.time() + 100.0)

    async def story() -> float:
        gatekeeper = Gatekeeper(database, GUARDED)
        return (await BrowserSessions(database, gatekeeper.ring, 3600.0).open(issued.secret)).expires_s

    assert asyncio.run(story()) == issued.key.grant.expires_s


def test_each_key_has_its_rate_and_each_address_without_one(database: Database) -> None:
    hasty, calm = issue(database, rate_per_s=0.001, burst=2), issue(database)

    async def story() -> None:
        gatekeeper = Gatekeeper(database, replace(OPEN, trusts_network=True, address_rate=Rate(0.001, 2)))
        for shown, address in ((Credentials(hasty.secret), HERE), (Credentials(), ELSEWHERE)):
            await gatekeeper.admit(shown, address)
            await gatekeeper.admit(shown, address)
            with pytest.raises(TooManyRequests):
                await gatekeeper.admit(shown, address)
        await gatekeeper.admit(Credentials(calm.secret), HERE)
        await gatekeeper.admit(Credentials(), HERE)

    asyncio.run(story())


def test_a_flood_of_wrong_keys_fills_no_memory(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(key_ring, "REMEMBERED", 5)

    async def story() -> int:
        gatekeeper = Gatekeeper(database, GUARDED)
        for number in range(20):
            assert await refused(gatekeeper, Credentials(f"smk_{number}"))
        assert await refused(gatekeeper, Credentials("x" * 10_000))
        return len(gatekeeper.ring._known)

    assert asyncio.run(story()) == 5


def test_the_site_of_everything_is_found(database: Database) -> None:
    site, survey_id = site_with_survey(database)

    async def story() -> None:
        gatekeeper = Gatekeeper(database, GUARDED)
        for _ in range(2):  # asked, and remembered
            assert await gatekeeper.site_of("survey_id", survey_id) == site.site_id
        assert await gatekeeper.site_of("job_id", survey_id) is None
        assert await gatekeeper.site_of("site_id", "any") == "any"

    asyncio.run(story())


def test_uses_are_written_when_the_service_ends(database: Database) -> None:
    issued = issue(database)
    began_s = time.time()

    async def story() -> None:
        gatekeeper = Gatekeeper(database, GUARDED)
        async with AccessUpkeep(database, gatekeeper.ring, audit_kept_s=100.0).running():
            await gatekeeper.admit(Credentials(issued.secret), HERE)

    asyncio.run(story())
    with database.reading() as session:
        used_s = session.query(KeyRow).one().last_used_s
    assert used_s is not None and used_s >= began_s


def test_what_is_over_is_forgotten(database: Database) -> None:
    issued = issue(database)
    now_s = time.time()
    with database.writing() as session:
        for digest, expires_s in (("a" * 64, now_s - 1.0), ("b" * 64, now_s + 1000.0)):
            session.add(BrowserSessionRow(digest=digest, key_id=issued.key.key_id, created_s=0.0, expires_s=expires_s))
        for at_s in (now_s - 2000.0, now_s):
            AuditRepository(session).add(AuditEntry(Actor(None, "x", HERE), f"{at_s}", {}, "done", at_s=at_s))
    remove_what_is_over(database, audit_kept_s=1000.0)
    with database.reading() as session:
        assert [row.digest for row in session.query(BrowserSessionRow)] == ["b" * 64]
        assert [entry.action for entry in AuditRepository(session).page(PageRequest()).items] == [f"{now_s}"]


def test_digests_are_of_whatever_was_sent() -> None:
    assert digest_of("\udcff") != digest_of("?")


@pytest.mark.parametrize(("address", "here"), [("127.0.0.9", True), ("::1", True), ("10.0.0.1", False), ("", False)])
def test_addresses_of_this_machine(address: str, here: bool) -> None:
    assert is_this_machine(address) is here
