"""Alerts and evidence as they are kept."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.errors import NotFound
from app.geometry.camera import Camera
from app.photogrammetry.evidence import Movements, SnapshotEvidence
from app.storage.alerts import Alert, AlertFilter, AlertRepository, Trouble
from app.storage.database import Database
from app.storage.evidence_blob import blob_of_evidence, evidence_of_blob
from app.storage.map_evidence import EvidenceRepository
from app.storage.paging import PageRequest
from app.storage.records import Site
from app.storage.snapshot_group import Entry, record_snapshots
from app.storage.snapshot_removal import SnapshotFilter, SnapshotRemoval
from app.storage.snapshots import NotFoundPose, Snapshot
from tests.storage import examples

SINGLE = np.finfo(np.float32).eps


@pytest.fixture
def site(database: Database) -> Site:
    return examples.site_with_survey(database)[0]


def settle(database: Database, site: Site, troubles: list[Trouble], now_s: float, version: int = 1) -> list[Alert]:
    with database.writing() as session:
        alerts = AlertRepository(session)
        alerts.settle(site.site_id, version, troubles, now_s)
        return list(alerts.page(AlertFilter(site.site_id), PageRequest()).items)


def evidence(count: int = 3) -> SnapshotEvidence:
    random = np.random.default_rng(1)
    roots = random.normal(size=(count, 6, 6))
    movements = Movements(
        np.arange(count) + 100, np.arange(count) % 2 == 0, random.normal(size=(count, 6)), roots @ roots.mT
    )
    camera = Camera(1280, 720, examples.calibrated().camera.intrinsics)
    seen = frozenset([*movements.codes.tolist(), 7, 8])
    return SnapshotEvidence(examples.pose(4), camera, 1.25, movements, (7,), seen)


def test_a_trouble_is_raised_once_and_follows_what_is_found(database: Database, site: Site) -> None:
    (first,) = settle(database, site, [examples.trouble()], now_s=100.0)
    assert (first.trouble, first.state, first.raised_s, first.note) == (examples.trouble(), "open", 100.0, "")
    later = replace(examples.trouble(), snapshots=9, last_s=30.0)
    (again,) = settle(database, site, [later], now_s=200.0)
    assert again == replace(first, trouble=later)


def test_what_is_found_no_more_is_over_and_comes_back_under_its_id(database: Database, site: Site) -> None:
    (first,) = settle(database, site, [examples.trouble()], now_s=100.0)
    (over,) = settle(database, site, [], now_s=200.0)
    assert (over.state, over.resolved_s) == ("resolved", 200.0)
    (back,) = settle(database, site, [examples.trouble()], now_s=300.0)
    assert back == replace(first, raised_s=300.0)


def test_an_acknowledged_alert_stays_so_until_it_is_over(database: Database, site: Site) -> None:
    (alert,) = settle(database, site, [examples.trouble()], now_s=100.0)
    with database.writing() as session:
        known = AlertRepository(session).acknowledge(alert.alert_id, "the door", 150.0)
    assert (known.state, known.acknowledged_s, known.note) == ("acknowledged", 150.0, "the door")
    assert settle(database, site, [examples.trouble()], now_s=200.0) == [known]
    (over,) = settle(database, site, [], now_s=300.0)
    with database.writing() as session:
        assert AlertRepository(session).acknowledge(alert.alert_id, "too late", 400.0) == over


def test_alerts_of_another_version_are_over(database: Database, site: Site) -> None:
    settle(database, site, [examples.trouble()], now_s=100.0)
    new, old = settle(database, site, [examples.trouble(None)], now_s=200.0, version=2)
    assert (old.map_version, old.state, new.map_version, new.trouble.code) == (1, "resolved", 2, None)


def test_filters_and_pages(database: Database, site: Site) -> None:
    troubles = [examples.trouble(code) for code in (1, 2, 3)]
    newest_first = settle(database, site, [*troubles, replace(troubles[0], kind="misfit-target")], now_s=1.0)
    with database.reading() as session:
        alerts, wanted = AlertRepository(session), AlertFilter(site.site_id)
        first = alerts.page(wanted, PageRequest(3))
        second = alerts.page(wanted, PageRequest(3, first.next_cursor))
        assert [*first.items, *second.items] == newest_first
        assert len(alerts.page(replace(wanted, kind="misfit-target"), PageRequest()).items) == 1
        assert alerts.page(replace(wanted, state="resolved"), PageRequest()).items == ()
        assert alerts.page(replace(wanted, map_version=2), PageRequest()).items == ()
        with pytest.raises(NotFound, match="there is no alert"):
            alerts.get("none")


def test_evidence_survives_in_seven_digits() -> None:
    told = evidence()
    read = evidence_of_blob(blob_of_evidence(told))
    assert (read.sigma0, read.unknown_codes, read.seen_codes) == (told.sigma0, told.unknown_codes, told.seen_codes)
    assert np.array_equal(read.site_from_cam.rotation, told.site_from_cam.rotation)
    assert np.array_equal(read.camera.intrinsics, told.camera.intrinsics)
    assert np.array_equal(read.movements.codes, told.movements.codes)
    assert np.array_equal(read.movements.used, told.movements.used)
    np.testing.assert_allclose(read.movements.values, told.movements.values, rtol=SINGLE)
    np.testing.assert_allclose(read.movements.information, told.movements.information, rtol=SINGLE)


def test_evidence_is_written_with_its_snapshot_and_goes_with_it(database: Database, site: Site) -> None:
    located = replace(examples.snapshot(site, examples.located()), evidence=blob_of_evidence(evidence()))
    silent = examples.snapshot(site, examples.located())
    contradicting = examples.snapshot(site, NotFoundPose("inconsistent", "no majority agrees", "survey again"))
    refused = examples.snapshot(site, examples.REFUSED)
    recorded = record_snapshots(database, [Entry(item) for item in (located, silent, contradicting, refused)])
    assert all(isinstance(item, Snapshot) for item in recorded)
    with database.reading() as session:
        told = EvidenceRepository(session)
        found = told.newest(site.site_id, 3, 10)
        assert sorted(item.evidence is None for item in found) == [False, True]
        assert {item.device_id for item in found} == {located.heading.device_id}
        assert told.state(site.site_id, 3).count == 2
        assert told.newest(site.site_id, 4, 10) == ()
        assert told.watched_maps() == ((site.site_id, 3),)
    with database.writing() as session:
        SnapshotRemoval(session).some(SnapshotFilter(site.site_id, device_id="phone-1"))
        assert EvidenceRepository(session).state(site.site_id, 3).count == 0


def test_old_evidence_is_forgotten(database: Database, site: Site) -> None:
    told = replace(examples.snapshot(site, examples.located()), evidence=blob_of_evidence(evidence()))
    poses = [item for _ in range(5) for item in record_snapshots(database, [Entry(told)])]
    with database.writing() as session:
        repository = EvidenceRepository(session)
        assert repository.forget_older(site.site_id, 3, keep=2) == 3
        assert repository.forget_older(site.site_id, 3, keep=2) == 0
        state = repository.state(site.site_id, 3)
    newest_id = max(item.pose_id for item in poses if isinstance(item, Snapshot))
    assert (state.count, state.newest_id) == (2, newest_id)
