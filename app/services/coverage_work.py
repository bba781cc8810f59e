"""What a worker process does for a site's predicted accuracy: look up map and camera, predict, draw."""

from __future__ import annotations

from dataclasses import dataclass

from app.geometry.camera import CalibratedCamera
from app.planning.dot_errors import Light
from app.planning.plan_camera import default_camera
from app.planning.plan_view import ViewWish
from app.planning.plan_walls import Wall
from app.planning.predicted_views import Seeing
from app.planning.suggestions import SuggestionOptions
from app.services.coverage_report.prediction import CoverageFormat, Prediction, predict, prediction_file
from app.services.workbench import workbench
from app.storage.cameras import CameraRepository
from app.storage.sites import SiteRepository
from app.storage.target_maps import TargetMapRepository


@dataclass(frozen=True)
class SiteView:
    """Which map of which site, and what stands there.

    Attributes
    ----------
    site_id : str
    version : int or None
        The active one when None.
    walls : tuple of Wall
    """

    site_id: str
    version: int | None
    walls: tuple[Wall, ...]


@dataclass(frozen=True)
class PhoneWish:
    """Whose photographs: a stored camera, a described one, or by default the survey's.

    Attributes
    ----------
    camera_id : str or None
    described : CalibratedCamera or None
    light : str
    """

    camera_id: str | None
    described: CalibratedCamera | None
    light: Light


@dataclass(frozen=True)
class CoverageTask:
    """A prediction for a site."""

    place: SiteView
    phone: PhoneWish
    wish: ViewWish
    suggestions: SuggestionOptions
    format: CoverageFormat


def predict_site(task: CoverageTask) -> bytes:
    """The prediction as the bytes of a file.

    Raises
    ------
    NotFound, Conflict
        When there is no such site, version or camera, or the site has no map.
    InvalidInput
        When the wish cannot be met.
    """
    place = task.place
    with workbench().database.reading() as session:
        version = TargetMapRepository(session).version(place.site_id, place.version).version
        title = f"{SiteRepository(session).get(place.site_id).name}, map {version}"
        camera = _camera(CameraRepository(session), task.phone, (place.site_id, version))
    asked = Prediction(
        title,
        workbench().target_map(place.site_id, version),
        place.walls,
        Seeing(camera, task.wish.limits, task.phone.light),
        task.wish,
        task.suggestions,
    )
    return prediction_file(asked, predict(asked), task.format)


def _camera(cameras: CameraRepository, phone: PhoneWish, map_version: tuple[str, int]) -> CalibratedCamera:
    if phone.camera_id is not None:
        return cameras.get(phone.camera_id).calibrated
    if phone.described is not None:
        return phone.described
    surveyed = cameras.of_map(*map_version)
    return surveyed[0].calibrated if surveyed else default_camera()
