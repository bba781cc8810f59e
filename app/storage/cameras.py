"""Calibrated cameras in the database."""

from __future__ import annotations

import time
from collections.abc import Collection, Iterable
from dataclasses import asdict
from typing import cast

from sqlalchemy import ColumnElement, or_, select
from sqlalchemy.orm import Session

from app.errors import NotFound
from app.geometry.camera import INTRINSIC_COUNT, CalibratedCamera, Camera, CameraIdentity, CameraSource
from app.geometry.readout import Readout
from app.storage.belonging import within
from app.storage.blobs import array_of_blob, blob_of_array
from app.storage.ids import new_id
from app.storage.models import CameraRow
from app.storage.paging import Page, PageRequest, page_of
from app.storage.records import NewCamera, StoredCamera

NEWEST = 200  # cameras of one site or device that a snapshot is compared with; a site's survey has a handful


class CameraRepository:
    """Cameras of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def add(self, camera: NewCamera, site_id: str | None, map_version: int | None) -> StoredCamera:
        """Keep a camera as it was calibrated."""
        row = CameraRow(
            id=new_id(),
            site_id=site_id,
            map_version=map_version,
            device_id=camera.device_id,
            source=camera.calibrated.source,
            identity=asdict(camera.identity),
            intrinsics=blob_of_array(camera.calibrated.camera.intrinsics),
            covariance=blob_of_array(camera.calibrated.covariance),
            readout_s=None if camera.calibrated.readout is None else camera.calibrated.readout.duration_s,
            created_s=time.time(),
        )
        self._session.add(row)
        self._session.flush()
        return _camera(row)

    def get(self, camera_id: str) -> StoredCamera:
        """One camera.

        Raises
        ------
        NotFound
        """
        return _camera(self._row(camera_id))

    def delete(self, camera_id: str) -> None:
        """Forget a camera.

        Raises
        ------
        NotFound
        """
        self._session.delete(self._row(camera_id))
        self._session.flush()

    def _row(self, camera_id: str) -> CameraRow:
        row = self._session.get(CameraRow, camera_id)
        if row is None:
            raise NotFound(f"there is no camera {camera_id}; GET /cameras lists them", camera_id=camera_id)
        return row

    def page(
        self,
        site_id: str | None,
        device_id: str | None,
        request: PageRequest,
        site_ids: Collection[str] | None = None,
    ) -> Page[StoredCamera]:
        """Cameras in the order they were calibrated, of one site or device when named, and of these sites alone."""
        query = (
            select(CameraRow).where(within(CameraRow.site_id, site_ids)).order_by(CameraRow.id).limit(request.limit + 1)
        )
        if site_id is not None:
            query = query.where(CameraRow.site_id == site_id)
        if device_id is not None:
            query = query.where(CameraRow.device_id == device_id)
        if request.after is not None:
            query = query.where(CameraRow.id > request.after)
        return page_of([(row.id, _camera(row)) for row in self._session.scalars(query)], request.limit)

    def of_map(self, site_id: str, version: int) -> tuple[StoredCamera, ...]:
        """Cameras that were calibrated with a map version."""
        query = select(CameraRow).where(CameraRow.site_id == site_id, CameraRow.map_version == version)
        return tuple(_camera(row) for row in self._session.scalars(query.order_by(CameraRow.id)))

    def candidates(self, site_id: str, device_id: str | None) -> tuple[StoredCamera, ...]:
        """Cameras that may have taken a snapshot: the site's, and the device's from anywhere; newest first."""
        conditions: list[ColumnElement[bool]] = [CameraRow.site_id == site_id]
        if device_id is not None:
            conditions.append(CameraRow.device_id == device_id)
        query = select(CameraRow).where(or_(*conditions)).order_by(CameraRow.id.desc()).limit(NEWEST)
        return tuple(_newest_of_each(_camera(row) for row in self._session.scalars(query)))


def _newest_of_each(cameras: Iterable[StoredCamera]) -> Iterable[StoredCamera]:
    """Of each camera of each device the first that comes of each source: one does not stand for the other."""
    seen: set[tuple[str, str | None, str]] = set()
    for camera in cameras:
        key = camera.identity.key, camera.device_id, camera.calibrated.source
        if key not in seen:
            seen.add(key)
            yield camera


def _camera(row: CameraRow) -> StoredCamera:
    identity = CameraIdentity(**row.identity)
    camera = Camera(identity.width_px, identity.height_px, array_of_blob(row.intrinsics, INTRINSIC_COUNT))
    covariance = array_of_blob(row.covariance, INTRINSIC_COUNT, INTRINSIC_COUNT)
    readout = None if row.readout_s is None else Readout(row.readout_s)
    return StoredCamera(
        camera_id=row.id,
        identity=identity,
        calibrated=CalibratedCamera(camera, covariance, cast(CameraSource, row.source), readout),
        device_id=row.device_id,
        site_id=row.site_id,
        map_version=row.map_version,
        created_s=row.created_s,
    )
