"""Published target maps: versions of a site that are written once and never changed."""

from __future__ import annotations

import time
from collections.abc import Collection
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from app.errors import Conflict, NotFound
from app.geometry.pose import Pose
from app.geometry.target_map import Datum, MappedTarget, TargetMap
from app.storage.blobs import array_of_blob, blob_of_array
from app.storage.cameras import CameraRepository
from app.storage.ids import new_id
from app.storage.models import MappedTargetRow, MapPhotoRow, SiteRow, TargetMapRow
from app.storage.paging import Page, PageRequest, page_of
from app.storage.records import MapVersion, PhotoResult, Publication
from app.storage.sites import find_site_row
from app.targets.layout import DOT_COUNT

GREATEST_VERSION = 2**31 - 1  # of the column; Postgres refuses to compare it with more


class TargetMapRepository:
    """Target maps of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def publish(self, site_id: str, publication: Publication) -> int:
        """Write a new version with its cameras, photographs and report; the version's number.

        A build that has published already gets the number of then, and nothing is written.
        """
        site = find_site_row(self._session, site_id, lock=True)
        query = select(TargetMapRow.version).where(TargetMapRow.job_id == publication.origin.job_id)
        published = self._session.scalar(query)
        if published is not None:
            return published
        site.last_version += 1
        row = _map_row(site_id, site.last_version, publication)
        self._session.add(row)
        self._session.flush()
        self._session.add_all(_target_row(row.id, target) for target in publication.target_map.targets)
        self._session.add_all(_photo_row(row.id, photo) for photo in publication.photos)
        cameras = CameraRepository(self._session)
        for camera in publication.cameras:
            cameras.add(camera, site_id, row.version)
        self._session.flush()
        return row.version

    def activate(self, site_id: str, version: int) -> None:
        """Make a version the one that snapshots are located in.

        Raises
        ------
        NotFound
            When the site or the version does not exist.
        """
        site = find_site_row(self._session, site_id, lock=True)
        self._row(site, version)
        site.active_version = version

    def versions(self, site_id: str, request: PageRequest) -> Page[MapVersion]:
        """Versions of a site, the first one first."""
        site = find_site_row(self._session, site_id)
        query = select(TargetMapRow).where(TargetMapRow.site_id == site_id).order_by(TargetMapRow.version)
        if request.after is not None:
            query = query.where(TargetMapRow.version > _version_of_cursor(request.after))
        rows = self._session.scalars(query.limit(request.limit + 1))
        return page_of([(str(row.version), _map_version(row, site.active_version)) for row in rows], request.limit)

    def version(self, site_id: str, version: int | None) -> MapVersion:
        """One version, the active one when none is named.

        Raises
        ------
        NotFound
            When the site or the version does not exist.
        Conflict
            When none is named and the site has no active version.
        """
        site = find_site_row(self._session, site_id)
        return _map_version(self._row(site, version), site.active_version)

    def load(self, site_id: str, version: int) -> TargetMap:
        """The targets of a version.

        Raises
        ------
        NotFound
        """
        row = self._row(find_site_row(self._session, site_id), version)
        query = select(MappedTargetRow).where(MappedTargetRow.map_id == row.id).order_by(MappedTargetRow.code)
        targets = tuple(_target(target_row) for target_row in self._session.scalars(query))
        datum = Datum(
            origin_m=array_of_blob(row.datum_origin, 3),
            covariance=array_of_blob(row.datum_covariance, 7, 7),
            assumed_scale=row.assumed_scale,
            assumed_orientation=row.assumed_orientation,
        )
        return TargetMap(targets, datum, row.code_family, row.u_m)

    def report(self, site_id: str, version: int) -> dict[str, Any]:
        """The adjustment report of a version, as JSON."""
        return self._row(find_site_row(self._session, site_id), version).report

    def photos(self, site_id: str, version: int) -> tuple[PhotoResult, ...]:
        """What became of each photograph of a version, by name."""
        row = self._row(find_site_row(self._session, site_id), version)
        query = select(MapPhotoRow).where(MapPhotoRow.map_id == row.id).order_by(MapPhotoRow.name)
        return tuple(_photo_result(photo_row) for photo_row in self._session.scalars(query))

    def photo_page(self, site_id: str, version: int, request: PageRequest) -> Page[PhotoResult]:
        """What became of the photographs of a version, page by page, by name.

        Raises
        ------
        NotFound
        """
        row = self._row(find_site_row(self._session, site_id), version)
        query = select(MapPhotoRow).where(MapPhotoRow.map_id == row.id).order_by(MapPhotoRow.name)
        if request.after is not None:
            query = query.where(MapPhotoRow.name > request.after)
        rows = self._session.scalars(query.limit(request.limit + 1))
        return page_of([(photo_row.name, _photo_result(photo_row)) for photo_row in rows], request.limit)

    def _row(self, site: SiteRow, version: int | None) -> TargetMapRow:
        wanted = site.active_version if version is None else version
        if wanted is None:
            raise Conflict(
                "the site has no target map yet; upload survey photographs and POST /surveys/{survey_id}/build",
                site_id=site.id,
            )
        query = select(TargetMapRow).where(TargetMapRow.site_id == site.id, TargetMapRow.version == wanted)
        row = self._session.scalars(query).one_or_none()
        if row is None:
            raise NotFound(
                f"the site has no target map version {wanted}; GET /sites/{site.id}/maps lists them",
                site_id=site.id,
                version=wanted,
            )
        return row


def newest_versions(session: Session, site_ids: Collection[str], limit: int) -> list[tuple[str, int]]:
    """Sites with their active and their newest version: the named ones, then the newest others up to a limit."""
    named = SiteRow.id.in_(sorted(site_ids))
    query = select(SiteRow.id, SiteRow.active_version, SiteRow.last_version).where(SiteRow.last_version > 0)
    rows = [
        *session.execute(query.where(named).order_by(SiteRow.id)),
        *session.execute(query.where(~named).order_by(SiteRow.id.desc()).limit(limit)),
    ]
    both = {(row.id, version): None for row in rows for version in (row.active_version, row.last_version) if version}
    return list(both)


def _version_of_cursor(key: str) -> int:
    return min(int(key), GREATEST_VERSION) if key.isdecimal() else 0


def _map_row(site_id: str, version: int, publication: Publication) -> TargetMapRow:
    target_map, origin = publication.target_map, publication.origin
    return TargetMapRow(
        id=new_id(),
        site_id=site_id,
        version=version,
        survey_id=origin.survey_id,
        job_id=origin.job_id,
        base_version=origin.base_version,
        code_family=target_map.code_family,
        u_m=target_map.u_m,
        target_count=len(target_map.targets),
        datum_origin=blob_of_array(target_map.datum.origin_m),
        datum_covariance=blob_of_array(target_map.datum.covariance),
        assumed_scale=target_map.datum.assumed_scale,
        assumed_orientation=target_map.datum.assumed_orientation,
        report=publication.report,
        created_s=time.time(),
    )


def _map_version(row: TargetMapRow, active_version: int | None) -> MapVersion:
    active = row.version == active_version
    return MapVersion(row.version, row.survey_id, row.base_version, row.target_count, row.created_s, active)


def _target_row(map_id: str, target: MappedTarget) -> MappedTargetRow:
    return MappedTargetRow(
        map_id=map_id,
        code=target.code,
        rotation=blob_of_array(target.site_from_target.rotation),
        position_m=blob_of_array(target.site_from_target.position_m),
        dots_m=blob_of_array(target.dots_m),
        covariance=blob_of_array(target.covariance),
        rays=target.rays,
        rms_px=target.rms_px,
    )


def _target(row: MappedTargetRow) -> MappedTarget:
    return MappedTarget(
        code=row.code,
        site_from_target=Pose(array_of_blob(row.rotation, 3, 3), array_of_blob(row.position_m, 3)),
        dots_m=array_of_blob(row.dots_m, DOT_COUNT, 3),
        covariance=array_of_blob(row.covariance, 6, 6),
        rays=row.rays,
        rms_px=row.rms_px,
    )


def _photo_row(map_id: str, photo: PhotoResult) -> MapPhotoRow:
    pose = photo.site_from_cam
    return MapPhotoRow(
        map_id=map_id,
        name=photo.name,
        camera_key=photo.camera_key,
        rotation=None if pose is None else blob_of_array(pose.rotation),
        position_m=None if pose is None else blob_of_array(pose.position_m),
        covariance=None if photo.covariance is None else blob_of_array(photo.covariance),
        rms_px=photo.rms_px,
        target_count=photo.target_count,
        codes=None if photo.codes is None else list(photo.codes),
        reason=photo.reason,
    )


def _photo_result(row: MapPhotoRow) -> PhotoResult:
    posed = row.rotation is not None and row.position_m is not None
    return PhotoResult(
        name=row.name,
        camera_key=row.camera_key,
        site_from_cam=Pose(array_of_blob(row.rotation, 3, 3), array_of_blob(row.position_m, 3)) if posed else None,  # type: ignore[arg-type]
        covariance=None if row.covariance is None else array_of_blob(row.covariance, 6, 6),
        rms_px=row.rms_px,
        target_count=row.target_count,
        reason=row.reason,
        codes=None if row.codes is None else tuple(row.codes),
    )
