"""A calibration against a site of this installation: its active map, and the camera beside those of its surveys."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from app.cli.installation import installation
from app.cli.migrate import settings_of
from app.errors import Conflict
from app.geometry.readout import Readout
from app.geometry.target_map import TargetMap
from app.photogrammetry.calibration.calibrate import Calibration
from app.storage.cameras import CameraRepository
from app.storage.records import NewCamera
from app.storage.sites import SiteRepository
from app.storage.target_maps import TargetMapRepository


@dataclass(frozen=True)
class SiteOfInstallation:
    """A site and the installation that holds it."""

    data_dir: Path | None
    site_id: str

    def active_map(self) -> tuple[int, TargetMap]:
        """The site's active map and its version.

        Raises
        ------
        NotFound
            When there is no such site.
        Conflict
            When it has no map.
        """
        with installation(settings_of(self.data_dir)) as there, there.database.reading() as session:
            version = SiteRepository(session).get(self.site_id).active_version
            if version is None:
                raise Conflict(
                    "the site has no target map yet, and a camera is calibrated against one: survey it first"
                )
            return version, TargetMapRepository(session).load(self.site_id, version)

    def keep(self, calibration: Calibration, version: int, device_id: str | None, readout_s: float | None) -> str:
        """Keep the camera; its id."""
        readout = None if readout_s is None else Readout(readout_s)
        new = NewCamera(calibration.identity, replace(calibration.calibrated, readout=readout), device_id)
        with installation(settings_of(self.data_dir)) as there, there.database.writing() as session:
            return CameraRepository(session).add(new, self.site_id, version).camera_id
