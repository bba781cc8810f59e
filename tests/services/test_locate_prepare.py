"""What a snapshot meets is what the database holds at that moment, whichever server changed it."""

from __future__ import annotations

import uuid
from dataclasses import replace

import pytest

from app.errors import Conflict, NotFound
from app.services.locate_prepare import Preparation, Prepared
from app.services.locate_request import LocateRequest
from app.storage.cameras import CameraRepository
from app.storage.database import Database
from app.storage.records import NewCamera, Site
from app.storage.sites import SiteRepository
from app.storage.snapshots import Snapshot
from app.storage.target_maps import TargetMapRepository
from app.storage.trajectories import TrajectoryRepository
from tests.storage import examples


@pytest.fixture
def site(database: Database) -> Site:
    """With a map and the camera of its survey."""
    made, survey_id = examples.site_with_survey(database)
    with database.writing() as session:
        maps = TargetMapRepository(session)
        maps.activate(made.site_id, maps.publish(made.site_id, examples.publication("job", survey_id)))
        return SiteRepository(session).get(made.site_id)


def request(site: Site, **fields: str) -> LocateRequest:
    return LocateRequest(b"", site.site_id, **fields)  # type: ignore[arg-type]


def prepared(preparation: Preparation, asked: LocateRequest) -> Prepared:
    found = preparation.prepare(asked)
    assert isinstance(found, Prepared)
    return found


def add_camera(database: Database, site_id: str | None, device_id: str | None, seed: int) -> str:
    identity = replace(examples.IDENTITY, model=f"Model {seed}")
    camera = NewCamera(identity, examples.calibrated("calibration", seed), device_id)
    with database.writing() as session:
        return CameraRepository(session).add(camera, site_id, None).camera_id


def test_a_new_camera_is_known_at_once(database: Database, site: Site) -> None:
    preparation = Preparation(database)
    assert len(prepared(preparation, request(site)).cameras.stored) == 1
    of_site = add_camera(database, site.site_id, None, 6)
    assert prepared(preparation, request(site)).cameras.stored[0].camera_id == of_site
    mine = request(site, device_id="phone-7")
    assert len(prepared(preparation, mine).cameras.stored) == 2
    of_device = add_camera(database, None, "phone-7", 7)
    assert of_device in [camera.camera_id for camera in prepared(preparation, mine).cameras.stored]
    others = prepared(preparation, request(site, device_id="phone-8")).cameras
    assert of_device not in [camera.camera_id for camera in others.stored]
    assert others.device_id == "phone-8"


def test_what_did_not_change_is_not_read_again(database: Database, site: Site, monkeypatch: pytest.MonkeyPatch) -> None:
    preparation = Preparation(database)
    first = prepared(preparation, request(site))
    monkeypatch.setattr(CameraRepository, "candidates", lambda *_args: pytest.fail("read again"))
    assert prepared(preparation, request(site)).cameras.stored is first.cameras.stored
    assert prepared(preparation, request(site, device_id="never calibrated")).cameras.stored is first.cameras.stored


def test_a_named_camera_is_held_while_it_is_there(database: Database, site: Site) -> None:
    preparation = Preparation(database)
    with database.writing() as session:
        elsewhere = SiteRepository(session).add("other", "golay", 0.014, None).site_id
    named = add_camera(database, elsewhere, None, 9)
    for _ in range(2):
        assert prepared(preparation, request(site, camera_id=named)).cameras.named is not None
    with database.writing() as session:
        SiteRepository(session).delete(elsewhere)
    with pytest.raises(NotFound, match="no camera"):
        preparation.prepare(request(site, camera_id=named))


def test_another_version_holds_from_its_activation_on(database: Database, site: Site) -> None:
    preparation = Preparation(database)
    assert prepared(preparation, request(site)).heading.map_version == 1
    with database.writing() as session:
        survey = examples.publication("second job", "")
        publication = replace(survey, origin=replace(survey.origin, survey_id=None))
        maps = TargetMapRepository(session)
        second = maps.publish(site.site_id, publication)
    assert prepared(preparation, request(site)).heading.map_version == 1
    with database.writing() as session:
        TargetMapRepository(session).activate(site.site_id, second)
    assert prepared(preparation, request(site)).heading.map_version == second


def test_what_cannot_be_right_is_said(database: Database, site: Site) -> None:
    preparation = Preparation(database)
    empty, _ = examples.site_with_survey(database)
    with database.writing() as session:
        trajectories = TrajectoryRepository(session)
        closed = trajectories.add(site.site_id, None, "").trajectory_id
        trajectories.close(closed)
        taken = trajectories.add(site.site_id, None, "").trajectory_id
    with pytest.raises(NotFound, match="no site"):
        preparation.prepare(LocateRequest(b"", "nowhere"))
    with pytest.raises(Conflict, match="no target map yet"):
        preparation.prepare(request(empty))
    with pytest.raises(Conflict, match="is closed"):
        preparation.prepare(request(site, trajectory_id=closed))
    with pytest.raises(NotFound, match="no trajectory"):
        preparation.prepare(request(site, trajectory_id="nowhere"))
    prepared(preparation, request(site, trajectory_id=taken))


def test_a_repeat_gets_the_first_answer(database: Database, site: Site) -> None:
    preparation = Preparation(database)
    name = str(uuid.uuid4())
    prepared(preparation, request(site, snapshot_id=name))
    with database.writing() as session:
        trajectories = TrajectoryRepository(session)
        trajectory_id = trajectories.add(site.site_id, None, "").trajectory_id
        first = trajectories.record(trajectory_id, examples.snapshot(site, examples.REFUSED, name))
    found = preparation.prepare(request(site, snapshot_id=name))
    assert isinstance(found, Snapshot)
    assert found.pose_id == first.pose_id
