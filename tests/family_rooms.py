"""Small rooms of each code family, photographed once for all tests of a run."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from app.geometry.pose import Pose
from app.planning.survey_plan import SurveyPlan, look_at, small_room
from app.planning.synthetic import RenderedPhoto, render
from app.targets.family import family_by_name

U_M = 0.02
EVERY = 2  # half of the stations: enough for half of the targets to be seen three times
LEAST_RAYS = 3
EYE = look_at(np.array([1.9, 2.0, 1.4]), np.array([0.6, 0.5, 1.3]))


@dataclass(frozen=True)
class FamilyRoom:
    """A room whose targets carry codes of one family.

    Attributes
    ----------
    plan : SurveyPlan
    photos : dict of str to RenderedPhoto
        The survey's, by file name.
    snapshot : RenderedPhoto
        Taken from where no survey photograph was.
    """

    plan: SurveyPlan
    photos: dict[str, RenderedPhoto]
    snapshot: RenderedPhoto

    @property
    def codes(self) -> set[int]:
        """All that hang in the room."""
        return {target.code for target in self.plan.scene.targets}

    @property
    def carried(self) -> set[int]:
        """Codes that enough of the survey's photographs show wholly."""
        rays = Counter(code for photo in self.photos.values() for code in photo.whole_codes())
        return {code for code, count in rays.items() if count >= LEAST_RAYS}

    @property
    def site_from_cam(self) -> Pose:
        """Where the snapshot was taken."""
        return self.snapshot.site_from_cam


@cache
def family_room(family_name: str) -> FamilyRoom:
    plan = small_room(family_by_name(family_name))
    plan = replace(plan, stations=plan.stations[::EVERY])
    photos = {f"photo{index}.jpg": plan.photograph(index) for index in range(len(plan.stations))}
    return FamilyRoom(plan, photos, render(plan.scene, plan.camera, EYE, plan.imaging, seed=77))
