"""Faults put into a synthetic survey, one kind at a time: what is wrong, and what its report must name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from app.geometry.control import ControlPoint
from app.geometry.observations import TargetObservation
from app.geometry.pose import Pose
from app.photogrammetry.survey import SurveyPhoto
from app.targets.layout import dots_target_m
from benchmarks.building import Building, BuildingOptions, build_building
from benchmarks.building_views import U_M, ViewOptions, photograph

Array = npt.NDArray[np.float64]

FEWEST_RAYS = 6  # of a plate that is made faulty: fewer cannot show a second place three times


@dataclass(frozen=True)
class Faulty:
    """A survey with faults.

    Attributes
    ----------
    photos : tuple of SurveyPhoto
    control : tuple of ControlPoint
    sightings : frozenset of (str, int)
        Photograph and code of sightings that are false.
    targets : frozenset of int
        Codes of plates that are wrong themselves.
    bad_photos : frozenset of str
        Photographs that are wrong as a whole.
    points : frozenset of str
        Control points that are wrong.
    reason : str
        What the report must call wrong targets.
    """

    photos: tuple[SurveyPhoto, ...]
    control: tuple[ControlPoint, ...]
    sightings: frozenset[tuple[str, int]] = frozenset()
    targets: frozenset[int] = frozenset()
    bad_photos: frozenset[str] = frozenset()
    points: frozenset[str] = frozenset()
    reason: str = ""

    @property
    def count(self) -> int:
        """How many things are wrong."""
        return len(self.sightings) + len(self.targets) + len(self.bad_photos) + len(self.points)


@dataclass(frozen=True)
class Sound:
    """A survey without faults, what it takes to photograph it again, and from what movement on plates are found."""

    options: BuildingOptions
    building: Building
    photos: tuple[SurveyPhoto, ...]
    control: tuple[ControlPoint, ...]
    seed: int
    detectable_m: Mapping[int, float] = field(default_factory=dict)
    views: ViewOptions = ViewOptions()

    def often_seen(self, count: int, rng: np.random.Generator) -> list[int]:
        """Some plates that enough photographs show and that carry no control point."""
        codes, rays = np.unique(
            [seen.code for photo in self.photos for seen in photo.detection.targets], return_counts=True
        )
        taken = [point.code for point in self.control]
        usable = codes[(rays >= FEWEST_RAYS) & ~np.isin(codes, taken)]
        return [int(code) for code in rng.choice(usable, count, replace=False)]

    def again(self, building: Building, plates_m: dict[int, Array] | None = None) -> tuple[SurveyPhoto, ...]:
        """The same photographs, noise included, of a building or of plates that are not as designed."""
        return photograph(building, self.views, self.seed, plates_m)


Fault = Callable[[Sound, np.random.Generator], Faulty]


def misread(share: float) -> Fault:
    """That share of all sightings carries the code of another plate of the site, which the photograph does not show."""

    def spoil(sound: Sound, rng: np.random.Generator) -> Faulty:
        codes, photos, false = np.array(list(sound.building.plates)), [], set()
        for photo in sound.photos:
            targets: list[TargetObservation] = []
            for seen in photo.detection.targets:
                if rng.random() < share:
                    shown = [one.code for one in (*photo.detection.targets, *targets)]
                    code = int(rng.choice(np.setdiff1d(codes, shown)))
                    false.add((photo.name, code))
                    seen = replace(seen, code=code)
                targets.append(seen)
            photos.append(replace(photo, detection=replace(photo.detection, targets=tuple(targets))))
        return Faulty(tuple(photos), sound.control, sightings=frozenset(false))

    return spoil


def moved(distance_m: float, count: int = 3) -> Fault:
    """Plates pushed along their wall when half of the photographs that show them were taken."""

    def spoil(sound: Sound, rng: np.random.Generator) -> Faulty:
        plates = sound.building.plates
        return pushed(sound, {code: distance_m * plates[code].rotation[:, 0] for code in sound.often_seen(count, rng)})

    return spoil


def moved_detectably(factor: float, count: int = 6) -> Fault:
    """Plates pushed anywhere by so many times their least detectable displacement, after half of their sightings."""

    def spoil(sound: Sound, rng: np.random.Generator) -> Faulty:
        codes = [code for code in sound.often_seen(2 * count, rng) if code in sound.detectable_m][:count]
        return pushed(sound, {code: factor * sound.detectable_m[code] * any_direction(rng) for code in codes})

    return spoil


def any_direction(rng: np.random.Generator) -> Array:
    """A vector of length 1, shape (3,)."""
    direction = rng.normal(size=3)
    return np.asarray(direction / np.linalg.norm(direction))


def pushed(sound: Sound, steps_m: Mapping[int, Array]) -> Faulty:
    """Plates that moved by so much, shape (3,) each, when half of the photographs that show them were taken."""
    plates = dict(sound.building.plates)
    for code, step_m in steps_m.items():
        plates[code] = Pose(plates[code].rotation, plates[code].position_m + step_m)
    later = sound.again(replace(sound.building, plates=plates))
    new = {(photo.name, seen.code): seen for photo in later for seen in photo.detection.targets}
    showing = {
        code: [photo.name for photo in sound.photos if any(one.code == code for one in photo.detection.targets)]
        for code in steps_m
    }
    after = {(name, code) for code, names in showing.items() for name in names[len(names) // 2 :]}
    photos = []
    for photo in sound.photos:
        keys = [(photo.name, seen.code) for seen in photo.detection.targets]
        pairs = zip(keys, photo.detection.targets, strict=True)
        targets = tuple(new.get(key, seen) if key in after else seen for key, seen in pairs)
        photos.append(replace(photo, detection=replace(photo.detection, targets=targets)))
    return Faulty(tuple(photos), sound.control, targets=frozenset(steps_m), reason="moved")


def wall_by_wall(sound: Sound, _rng: np.random.Generator) -> Faulty:
    """No plate is wrong, but every photograph of a corridor shows the wall across alone."""
    building = build_building(replace(sound.options, lengthwise=False), sound.seed)
    return Faulty(photograph(building, ViewOptions(), sound.seed), sound.control)


def bent(height_m: float, count: int = 3) -> Fault:
    """Plates whose left and right edges stand off the wall by so much."""

    def spoil(sound: Sound, rng: np.random.Generator) -> Faulty:
        plate_m = dots_target_m(U_M)
        plate_m[:, 2] = height_m * (plate_m[:, 0] / plate_m[:, 0].max()) ** 2
        return _reprinted(sound, sound.often_seen(count, rng), plate_m)

    return spoil


def resized(scale: float, count: int = 3) -> Fault:
    """Plates printed at another size than the rest."""

    def spoil(sound: Sound, rng: np.random.Generator) -> Faulty:
        return _reprinted(sound, sound.often_seen(count, rng), dots_target_m(U_M, (scale, scale)))

    return spoil


def batch(scale: float, share: float = 0.3) -> Fault:
    """A batch of that share of all plates printed at another size."""

    def spoil(sound: Sound, rng: np.random.Generator) -> Faulty:
        taken = [point.code for point in sound.control]
        codes = [code for code in sound.building.plates if code not in taken and rng.random() < share]
        return _reprinted(sound, codes, dots_target_m(U_M, (scale, scale)))

    return spoil


def _reprinted(sound: Sound, codes: list[int], plate_m: Array) -> Faulty:
    photos = sound.again(sound.building, dict.fromkeys(codes, plate_m))
    seen = {one.code for photo in photos for one in photo.detection.targets}
    return Faulty(photos, sound.control, targets=frozenset(codes) & seen, reason="deformed")


def swapped_control(sound: Sound, rng: np.random.Generator) -> Faulty:
    """Two control points with each other's coordinates."""
    first, second = rng.choice([at for at, point in enumerate(sound.control) if point.role == "control"], 2, False)
    points = list(sound.control)
    one, other = points[first], points[second]
    points[first], points[second] = replace(one, position_m=other.position_m), replace(other, position_m=one.position_m)
    return Faulty(sound.photos, tuple(points), points=frozenset({one.name, other.name}))


def mistyped_control(off_m: float) -> Fault:
    """One control point whose coordinates are off by so much."""

    def spoil(sound: Sound, rng: np.random.Generator) -> Faulty:
        at = int(rng.choice([at for at, point in enumerate(sound.control) if point.role == "control"]))
        points = list(sound.control)
        points[at] = replace(points[at], position_m=points[at].position_m + off_m * any_direction(rng))
        return Faulty(sound.photos, tuple(points), points=frozenset({points[at].name}))

    return spoil


def zoomed(factor: float, count: int = 2) -> Fault:
    """Photographs taken with another zoom than their file tells."""

    def spoil(sound: Sound, rng: np.random.Generator) -> Faulty:
        names, photos = _chosen_photos(sound, count, rng), []
        for photo in sound.photos:
            middle_px = np.array([photo.detection.width_px, photo.detection.height_px]) / 2.0
            targets = photo.detection.targets
            if photo.name in names:
                targets = tuple(
                    replace(seen, centres_px=middle_px + factor * (seen.centres_px - middle_px)) for seen in targets
                )
            photos.append(replace(photo, detection=replace(photo.detection, targets=targets)))
        return Faulty(tuple(photos), sound.control, bad_photos=frozenset(names))

    return spoil


def elsewhere(sound: Sound, rng: np.random.Generator) -> Faulty:
    """Two photographs of another room, in which the same codes hang in other places."""
    names, photos = _chosen_photos(sound, 2, rng), []
    for photo in sound.photos:
        targets = photo.detection.targets
        if photo.name in names:
            codes = rng.permutation([seen.code for seen in targets]).tolist()
            targets = tuple(replace(seen, code=code) for seen, code in zip(targets, codes, strict=True))
        photos.append(replace(photo, detection=replace(photo.detection, targets=targets)))
    return Faulty(tuple(photos), sound.control, bad_photos=frozenset(names))


def _chosen_photos(sound: Sound, count: int, rng: np.random.Generator) -> set[str]:
    """Photographs that show enough to be of use."""
    usable = [photo.name for photo in sound.photos if len(photo.detection.targets) >= FEWEST_RAYS]
    return {str(name) for name in rng.choice(usable, count, replace=False)}


FAULTS: dict[str, Fault] = {
    "1 % of codes misread": misread(0.01),
    "3 plates moved by 50 mm": moved(0.05),
    "3 plates moved by 10 mm": moved(0.01),
    "6 plates moved as far as is detectable": moved_detectably(1.0),
    "6 plates moved twice as far": moved_detectably(2.0),
    "3 plates bent by 5 mm": bent(0.005),
    "3 plates of 10 mm module": resized(10.0 / 14.0),
    "3 plates printed at 97 %": resized(0.97),
    "30 % of plates at 97 %": batch(0.97),
    "30 % of plates at 99.5 %": batch(0.995),
    "2 control points exchanged": swapped_control,
    "1 control point off by 30 mm": mistyped_control(0.03),
    "2 photographs of 10 % zoom": zoomed(1.1),
    "2 photographs of another room": elsewhere,
    "corridors wall by wall": wall_by_wall,
}
