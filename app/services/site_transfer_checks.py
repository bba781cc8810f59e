"""A site that came in an archive, read as it will be read here: whatever that would stumble over is refused now."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from functools import partial
from itertools import pairwise
from typing import Any, get_args

import numpy as np
import numpy.typing as npt
from pydantic import TypeAdapter

from app.errors import ScattermarkError
from app.geometry.camera import CameraIdentity, CameraSource
from app.geometry.target_map import TargetMap
from app.services.surveys import checked_filename
from app.storage.archive_format import BadArchive
from app.storage.archive_site_imported import check_imported
from app.storage.archive_site_photos import named_photos
from app.storage.archive_site_totals import check_totals, snapshots_of
from app.storage.cameras import CameraRepository
from app.storage.database import Session
from app.storage.marks import every_mark
from app.storage.paging import every
from app.storage.print_batches import every_batch
from app.storage.records import GeoAnchor, Site, StoredCamera
from app.storage.sites import SiteRepository
from app.storage.snapshots import Located, NotFoundPose, RollingShutter, Seen
from app.storage.target_maps import TargetMapRepository
from app.targets.family import CodeFamily, family_by_name

Array = npt.NDArray[np.float64]

PLATE_U_M = (0.001, 1.0)  # as for a site that is made here
SYMMETRY = 1e-9  # of the greatest member of a covariance, which rounding may leave
MOTION_COUNT = 6  # velocity and angular velocity
ANY_JSON = TypeAdapter(dict[str, Any])
SEEN, IDENTITY, ANCHOR = TypeAdapter(Seen), TypeAdapter(CameraIdentity), TypeAdapter(GeoAnchor)


def check_site(session: Session) -> Site:
    """The site of a scratch database.

    Raises
    ------
    BadArchive
        Naming the part that cannot be right.
    """
    with _told("site"):
        site = SiteRepository(session).get(check_totals(session))
        family = _checked_site(site)
    with _told("control points"):
        _check_codes((point.code for point in SiteRepository(session).control_points(site.site_id)), family)
    with _told("print batches"):
        _check_codes((code for batch in every_batch(session) for code in batch.codes), family)
    with _told("photographs"):
        for name, _ in named_photos(session):
            _require(checked_filename(name) == name, f"the name {name!r:.80}")
    with _told("marks"):
        _check_codes((mark.code for mark in every_mark(session)), family)
    with _told("target maps"):
        _check_maps(session, site, family)
    with _told("cameras"):
        for camera in every(partial(CameraRepository(session).page, site.site_id, None)):
            _check_camera(camera)
    with _told("snapshots"):
        for snapshot in snapshots_of(session):
            _check_outcome(snapshot.outcome)
            _strictly(SEEN, asdict(snapshot.seen))
    with _told("imported trajectories"):
        check_imported(session)
    return site


def _checked_site(site: Site) -> CodeFamily:
    _require(PLATE_U_M[0] <= site.plate_u_m <= PLATE_U_M[1], f"plates of {site.plate_u_m} m")
    _require(bool(site.name.strip()) and site.name.isprintable(), "its name")
    if site.geo_anchor is not None:
        _strictly(ANCHOR, asdict(site.geo_anchor))
        _require(abs(site.geo_anchor.latitude_deg) <= 90 and abs(site.geo_anchor.longitude_deg) <= 180, "its anchor")
    return family_by_name(site.code_family)


def _check_maps(session: Session, site: Site, family: CodeFamily) -> None:
    maps = TargetMapRepository(session)
    versions = list(every(partial(maps.versions, site.site_id)))
    numbers = [version.version for version in versions]
    _require(all(earlier < later for earlier, later in pairwise([0, *numbers])), "their versions")
    _require(site.active_version in (None, *numbers), "the active version")
    for version in versions:
        _require(version.base_version is None or version.base_version in numbers, "the version that one extends")
        target_map = maps.load(site.site_id, version.version)
        _require(len(target_map.targets) == version.target_count > 0, "how many targets there are")
        _require(target_map.code_family == site.code_family, "the code family")
        _check_codes(target_map.by_code, family)
        _check_geometry(target_map)
        _strictly(ANY_JSON, maps.report(site.site_id, version.version))
        for photo in maps.photos(site.site_id, version.version):
            if photo.covariance is not None:
                _check_covariance(photo.covariance)


def _check_geometry(target_map: TargetMap) -> None:
    _require(target_map.u_m > 0, "the size of the plates")
    _check_covariance(target_map.datum.covariance)
    for target in target_map.targets:
        _check_covariance(target.covariance)
        _require(target.rays >= 0 and target.rms_px >= 0, f"target {target.code}")


def _check_camera(camera: StoredCamera) -> None:
    _strictly(IDENTITY, asdict(camera.identity))
    _require(camera.calibrated.source in get_args(CameraSource), f"the source {camera.calibrated.source!r:.40}")
    _check_covariance(camera.calibrated.covariance)


def _check_outcome(outcome: Located | NotFoundPose) -> None:
    if isinstance(outcome, NotFoundPose):
        _require(all(isinstance(text, str) for text in asdict(outcome).values()), "a refusal")
        return
    _check_covariance(outcome.covariance)
    numbers = (outcome.sigma0, outcome.rms_residual_px, outcome.ambiguity_ratio or 0.0)
    _require(type(outcome.redundancy) is int and all(type(value) in (int, float) for value in numbers), "a pose's fit")
    _require(bool(np.isfinite(numbers).all()) and isinstance(outcome.camera_source, str), "a pose's fit")
    _check_shutter(outcome.rolling_shutter)


def _check_shutter(told: RollingShutter | None) -> None:
    if told is not None:
        fixed = (told.readout_s, told.position_m_per_m_s, told.position_m_per_rad_s)
        numbers = (*fixed, *(told.motion or ()), *(told.motion_sigmas or ()))
        _require(all(type(value) in (int, float) for value in numbers), "a movement")
        _require(
            all(part is None or len(part) == MOTION_COUNT for part in (told.motion, told.motion_sigmas)), "a movement"
        )


def _check_covariance(covariance: Array) -> None:
    scale = float(np.abs(covariance).max())
    _require(bool((np.diag(covariance) >= 0).all()), "a variance")
    _require(float(np.abs(covariance - covariance.T).max()) <= SYMMETRY * scale, "a covariance")


def _check_codes(codes: Iterable[int], family: CodeFamily) -> None:
    for code in codes:
        _require(family.contains(code), f"code {code}, which is none of family {family.name}")


def _strictly(adapter: TypeAdapter[Any], value: Any) -> None:
    """See that each member is of its type; JSON's lists are our tuples."""
    adapter.validate_json(json.dumps(value, allow_nan=False), strict=True)


def _require(sound: bool, what: str) -> None:
    if not sound:
        raise ValueError(f"{what} cannot be right")


@contextmanager
def _told(part: str) -> Iterator[None]:
    try:
        yield
    except BadArchive:
        raise
    except (ValueError, TypeError, KeyError, IndexError, AttributeError, RecursionError, ScattermarkError) as error:
        said = " ".join(str(error).split())
        raise BadArchive(f"the {part} of the archive cannot be taken ({said:.300}); nothing was imported") from error
