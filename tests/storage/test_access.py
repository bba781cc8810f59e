"""Keys, sessions, the audit and what belongs to whom, in rows."""

from __future__ import annotations

import threading
import time

import pytest

from app.errors import NotFound
from app.storage.audit import Actor, AuditEntry, AuditRepository, identify, noting
from app.storage.belonging import OWNED, site_of
from app.storage.browser_sessions import BrowserSession, BrowserSessionRepository
from app.storage.cameras import CameraRepository
from app.storage.database import Database
from app.storage.keys import ApiKey, Fingerprint, KeyRepository, NewKey
from app.storage.paging import PageRequest
from app.storage.sites import SiteRepository
from app.storage.target_maps import TargetMapRepository
from app.storage.trajectories import TrajectoryRepository
from app.storage.trajectory_parts import TrajectoryFilter
from app.storage.trajectory_queries import TrajectoryQueries
from tests.storage import examples

GRANT = NewKey("hall phones", ("locate", "survey"), ("s1", "s2"), 2.5, 7, 4e9)
SOMEBODY = Actor("k1", "somebody", "192.0.2.1", "r1")
DIGEST = "d" * 64


def add_key(database: Database, grant: NewKey = GRANT, digest: str = DIGEST) -> ApiKey:
    with database.writing() as session:
        return KeyRepository(session).add(grant, Fingerprint(digest, "smk_abcd"))


def audit(database: Database) -> tuple[AuditEntry, ...]:
    with database.reading() as session:
        return AuditRepository(session).page(PageRequest()).items


def test_a_key_comes_back_as_it_was_made(database: Database) -> None:
    made = add_key(database)
    with database.reading() as session:
        keys = KeyRepository(session)
        assert keys.get(made.key_id) == keys.find(DIGEST) == made
        assert keys.find("e" * 64) is None
        assert keys.page(PageRequest()).items == (made,)
        with pytest.raises(NotFound):
            keys.get("nothing")
    assert made.grant == GRANT


def test_a_key_is_valid_until_its_end_and_until_it_is_revoked(database: Database) -> None:
    made = add_key(database)
    assert made.valid_at(4e9 - 1.0) and not made.valid_at(4e9)
    with database.writing() as session:
        keys = KeyRepository(session)
        assert keys.any_valid(4e9 - 1.0) and not keys.any_valid(4e9 + 1.0)
        revoked = keys.revoke(made.key_id)
        assert keys.revoke(made.key_id) == revoked
        assert not revoked.valid_at(time.time())
        assert not keys.any_valid(time.time())


def test_the_same_secret_is_one_key(database: Database) -> None:
    with database.writing() as session:
        keys = KeyRepository(session)
        assert not keys.any_administrator()
        assert keys.add_once(NewKey("first", ("admin",)), Fingerprint(DIGEST, "x"))
        assert not keys.add_once(NewKey("second", ("admin",)), Fingerprint(DIGEST, "x"))
        assert keys.any_administrator()


def test_the_last_use_never_goes_back(database: Database) -> None:
    made = add_key(database)
    for used_s, kept_s in ((10.0, 10.0), (5.0, 10.0), (20.0, 20.0)):
        with database.writing() as session:
            KeyRepository(session).note_use({made.key_id: used_s, "gone": used_s})
        with database.reading() as session:
            assert KeyRepository(session).get(made.key_id).last_used_s == kept_s


def test_a_session_is_its_key_for_a_while(database: Database) -> None:
    key = add_key(database)
    with database.writing() as session:
        sessions = BrowserSessionRepository(session)
        sessions.add("a" * 64, BrowserSession(key, 100.0))
        sessions.add("b" * 64, BrowserSession(key, 200.0))
        found = sessions.find("a" * 64)
        assert found is not None
        until = found.key_until_then()
        assert until.key_id == key.key_id
        assert until.valid_at(99.0) and not until.valid_at(100.0)
        sessions.remove_ended(150.0)
        assert sessions.find("a" * 64) is None
        sessions.remove("b" * 64)
        assert sessions.find("b" * 64) is None
    with pytest.raises(ValueError, match="at the latest"):
        BrowserSession(key, 5e9)


def test_whoever_acts_signs_the_transaction(database: Database) -> None:
    with noting(SOMEBODY, "POST /sites", {"note": "n" * 500}), database.writing() as session:
        site = SiteRepository(session).add("hall", "golay", 0.014, None)
    (entry,) = audit(database)
    assert entry.actor == SOMEBODY
    assert (entry.action, entry.outcome) == ("POST /sites", "done")
    assert entry.subject == {"site_id": site.site_id, "note": "n" * 200}


def test_one_row_for_what_takes_several_transactions(database: Database) -> None:
    with noting(SOMEBODY, "x", {}):
        for name in ("one", "two"):
            with database.writing() as session:
                SiteRepository(session).add(name, "golay", 0.014, None)
    assert len(audit(database)) == 1


def test_nobody_s_change_and_a_change_that_fails_leave_no_row(database: Database) -> None:
    with database.writing() as session:
        SiteRepository(session).add("hall", "golay", 0.014, None)
    with pytest.raises(NotFound), noting(SOMEBODY, "x", {}), database.writing() as session:
        SiteRepository(session).rename("nowhere", "x")
    with noting(SOMEBODY, "x", {}), database.recording() as session:
        SiteRepository(session).add("quick", "golay", 0.014, None)
    assert audit(database) == ()


def test_who_acts_may_come_out_late_and_stays_with_its_thread(database: Database) -> None:
    """A request's session is opened before its key is looked at; another request knows nothing of it."""

    def of_another_request() -> None:
        with database.writing() as session:
            SiteRepository(session).add("other", "golay", 0.014, None)

    with noting(Actor(None, "nobody", "192.0.2.1"), "x", {}):
        thread = threading.Thread(target=of_another_request)
        thread.start()
        thread.join()
        with database.writing() as session:
            identify("k2", "late")
            SiteRepository(session).add("hall", "golay", 0.014, None)
    (entry,) = audit(database)
    assert (entry.actor.key_id, entry.actor.name) == ("k2", "late")


def test_entries_by_key_by_site_and_by_page(database: Database) -> None:
    with database.writing() as session:
        rows = AuditRepository(session)
        for number in range(4):
            actor = Actor(f"k{number % 2}", "x", "here")
            rows.add(AuditEntry(actor, f"{number}", {"site_id": f"s{number // 2}"}, "done", at_s=float(number)))
    with database.reading() as session:
        rows = AuditRepository(session)
        assert {entry.action for entry in rows.page(PageRequest(), key_id="k0").items} == {"0", "2"}
        assert {entry.action for entry in rows.page(PageRequest(), site_id="s1").items} == {"2", "3"}
        first = rows.page(PageRequest(3))
        rest = rows.page(PageRequest(3, first.next_cursor))
        assert len({entry.action for entry in (*first.items, *rest.items)}) == 4
    with database.writing() as session:
        AuditRepository(session).remove_before(2.0)
    assert {entry.action for entry in audit(database)} == {"2", "3"}


def test_what_belongs_to_a_site_is_found_and_lists_show_it_alone(database: Database) -> None:
    site, survey_id = examples.site_with_survey(database)
    other, other_survey_id = examples.site_with_survey(database)
    with database.writing() as session:
        for place, survey in ((site, survey_id), (other, other_survey_id)):
            TargetMapRepository(session).publish(place.site_id, examples.publication(place.site_id, survey))
        trajectory = TrajectoryRepository(session).default(site.site_id, "phone")
        TrajectoryRepository(session).default(other.site_id, "phone")
    with database.reading() as session:
        assert site_of(session, "survey_id", survey_id) == site.site_id
        assert site_of(session, "trajectory_id", trajectory.trajectory_id) == site.site_id
        assert {site_of(session, id_name, "nothing") for id_name in OWNED} == {None}
        mine, page = {site.site_id}, PageRequest()
        assert SiteRepository(session).page(page, mine).items == (SiteRepository(session).get(site.site_id),)
        cameras = CameraRepository(session).page(None, None, page, mine).items
        assert cameras and {camera.site_id for camera in cameras} == mine
        assert TrajectoryQueries(session).page(TrajectoryFilter(), page, mine).items == (trajectory,)
        assert SiteRepository(session).page(page, set()).items == ()
        assert len(SiteRepository(session).page(page, None).items) == 2
