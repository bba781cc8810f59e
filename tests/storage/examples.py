"""Domain values with every field set to something that a careless mapping would lose."""

from __future__ import annotations

import numpy as np

from app.geometry.camera import CalibratedCamera, Camera, CameraIdentity
from app.geometry.observations import Detection, Rejected, TargetObservation
from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.geometry.target_map import Datum, MappedTarget, TargetMap
from app.storage.alerts import AlertFigures, Trouble
from app.storage.database import Database
from app.storage.records import NewCamera, Origin, PhotoResult, Publication, Site, StoredPhoto
from app.storage.sites import SiteRepository
from app.storage.snapshots import (
    Heading,
    Located,
    Moment,
    NewSnapshot,
    NotFoundPose,
    RefusedBlob,
    Seen,
    SeenTarget,
)
from app.storage.surveys import SurveyRepository
from app.targets.layout import dots_target_m

U_M = 0.0137
CODES = (389, 1006, 2007)
IDENTITY = CameraIdentity("Maker", "Model 3", 1280, 720, 4.25, 27.0, "rear lens", 1.5)


def covariance(size: int, seed: int) -> np.ndarray:
    root = np.random.default_rng(seed).normal(size=(size, size)) * 1e-3
    return np.asarray(root @ root.T + np.eye(size) * 1e-9)


def pose(seed: int) -> Pose:
    values = np.random.default_rng(seed).normal(size=6)
    return Pose(exp_rotation(values[:3]), values[3:])


def mapped_target(code: int) -> MappedTarget:
    site_from_target = pose(code)
    dots_m = site_from_target.apply(dots_target_m(U_M, (1.001, 0.999)))
    return MappedTarget(code, site_from_target, dots_m, covariance(6, code), rays=code % 7 + 3, rms_px=0.07)


def target_map(codes: tuple[int, ...] = CODES) -> TargetMap:
    datum = Datum(np.array([1.0, 2.0, 0.3]), covariance(7, 1), assumed_scale=True, assumed_orientation=False)
    return TargetMap(tuple(mapped_target(code) for code in codes), datum, "golay", U_M)


def calibrated(source: str = "survey", seed: int = 5) -> CalibratedCamera:
    intrinsics = np.array([1000.0 + seed, 1001.0, 639.5, 359.5, 0.1, -0.2, 1e-4, -2e-4, 0.05])
    return CalibratedCamera(Camera(1280, 720, intrinsics), covariance(9, seed), source)  # type: ignore[arg-type]


def publication(job_id: str, survey_id: str, codes: tuple[int, ...] = CODES) -> Publication:
    posed = PhotoResult("a.jpg", IDENTITY.key, pose(8), covariance(6, 8), 0.06, 3, codes=(101, 389, 420))
    lost = PhotoResult("b.jpg", reason="sees no target that another photograph sees")
    camera = NewCamera(IDENTITY, calibrated(), "phone-1")
    return Publication(target_map(codes), Origin(survey_id, job_id), (camera,), (posed, lost), {"sigma0": 0.97})


def detection() -> Detection:
    random = np.random.default_rng(3)
    observation = TargetObservation(
        code=389,
        centres_px=random.normal(size=(16, 2)) * 100,
        covariances_px2=np.tile(np.eye(2) * 0.01, (16, 1, 1)),
        measured=random.random(16) > 0.3,
        corrected=1,
        erased=2,
        rms_px=0.123,
    )
    plain = Rejected("code-not-in-family", np.array([10.5, 20.25]))
    full = Rejected("off-plate", np.array([1.0, 2.0]), "gaps are not black", 77, random.normal(size=(5, 2)))
    return Detection(1280, 720, (observation,), (plain, full))


def photo(name: str = "a.jpg", sha256: str = "a" * 64) -> StoredPhoto:
    return StoredPhoto(name, sha256, 12345, sha256[::-1], 23456, IDENTITY, "2026:05:01 09:30:00", 1777627800.25)


def located() -> Located:
    return Located(pose(4), covariance(6, 4), 0.95, 340, 0.05, "survey", 7.5)


REFUSED = NotFoundPose("too-few-dots", "only four dots were seen", "move closer")


def trouble(code: int | None = 389) -> Trouble:
    figures = AlertFigures((0.012, -0.003, 0.0001), ((1e-6, 2e-8, 0.0), (2e-8, 2e-6, 0.0), (0.0, 0.0, 3e-6)), 4.5)
    return Trouble("moved-target", code, "critical", 10.0, 20.0, 7, 5, 2, figures)


def snapshot(site: Site, outcome: Located | NotFoundPose, snapshot_id: str | None = None) -> NewSnapshot:
    heading = Heading(site.site_id, 3, Moment(1777627800.25, "client", 0.02), 1777627801.5, "phone-1", snapshot_id)
    seen = Seen(
        (SeenTarget(389, 1, 0.06, True), SeenTarget(1006, 0, None, False, "unknown-target")),
        (RefusedBlob("off-plate", (1.5, 2.5), 77), RefusedBlob("no-code", (3.0, 4.0))),
        (("decode", 9.25), ("total", 19.5)),
    )
    return NewSnapshot(heading, outcome, seen)


def site_with_survey(database: Database) -> tuple[Site, str]:
    with database.writing() as session:
        site = SiteRepository(session).add("room", "golay", U_M, None)
        return site, SurveyRepository(session).add(site.site_id, "first", "phone-1").survey_id
