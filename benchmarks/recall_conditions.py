"""The rows of the recall matrix: each a hard condition in steps of severity."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from app.geometry.camera import Camera
from app.planning.imaging import ImagingOptions
from app.planning.scene import Gloss
from app.planning.survey_plan import phone_camera
from app.targets.family import FAMILY_NAMES
from benchmarks.recall_views import Condition

Row = Mapping[str, Condition]

DOT_RADIUS_PX = 4.0  # at the matrix' usual 4 px per u: a dot's radius is one u
# A sixteenth, and a sixty-fourth, of the electrons at base ISO.
ISO_1600 = {"full_well_electrons": 310.0, "read_noise_electrons": 4.0}
ISO_6400 = {"full_well_electrons": 78.0, "read_noise_electrons": 4.0}
DIAGONAL = np.sqrt(0.5)


def _imaged(**settings: object) -> Condition:
    return Condition(imaging=ImagingOptions(**settings))  # type: ignore[arg-type]


def _moving(length_px: float) -> Condition:
    return _imaged(motion_px=(DIAGONAL * length_px, DIAGONAL * length_px))


def _lamp(off_u: float) -> Condition:
    """The metering looks at the wall; the phone's exposure has come down for what the lamps light."""
    return Condition(lamp_off_u=off_u, imaging=ImagingOptions(exposure_ev=-1.5))


def _over(exposure_ev: float) -> Condition:
    return Condition(imaging=ImagingOptions(exposure_ev=exposure_ev, veiling_glare=0.05), window=True)


def _cast(red: float, green: float, blue: float) -> Condition:
    return _imaged(white_balance_rgb=(red, green, blue))


def _jpeg(quality: int, chroma: str) -> Condition:
    return Condition(px_per_u=3.5, imaging=ImagingOptions(jpeg_quality=quality, chroma=chroma))  # type: ignore[arg-type]


def _lens(camera: Camera, px_per_u: float) -> Condition:
    return Condition(px_per_u=px_per_u, camera=camera)


def wide_camera(width_px: int, height_px: int) -> Camera:
    """An ultra-wide lens: 100 degrees across, barrel distortion of a tenth in the corners."""
    focal_px = 0.42 * width_px
    distortion = (-0.12, 0.03, 4e-4, -3e-4, -0.004)
    middle_px = ((width_px - 1) / 2 + 3.0, (height_px - 1) / 2 - 2.0)
    return Camera(width_px, height_px, np.array([focal_px, focal_px, *middle_px, *distortion]))


def matrix() -> dict[str, Row]:
    """All rows by name, each with its cells by their severity."""
    return {**_geometry(), **_light(), **_sharpness(), **_files_and_cameras(), **_together()}


def _geometry() -> dict[str, Row]:
    return {
        "size, px per u": {f"{size:g}": Condition(px_per_u=size) for size in (8.0, 3.0, 2.5, 2.0)},
        "incidence, deg": {
            f"{angle}": Condition(px_per_u=5.0, incidence_deg=(angle - 1.0, angle)) for angle in (45, 60, 70, 75)
        },
        "hidden, part of a side": {f"{share:g}": Condition(hidden_share=share) for share in (0.1, 0.25, 0.5)},
        "one base dot hidden": {"": Condition(hidden_base_dot=True)},
        "touching the border": {"": Condition(at_border=True, plates_max=8)},
        "on a pillar, radius in u": {
            f"{radius:g}": Condition(pillar_u=radius, plates_max=10) for radius in (40.0, 20.0, 12.0)
        },
    }


def _light() -> dict[str, Row]:
    return {
        "gradient, lamp so many u off": {f"{off:g}": _lamp(off) for off in (20.0, 10.0, 6.0)},
        "shadow's edge, light left": {f"{share:g}": Condition(shadow_share=share) for share in (0.5, 0.25, 0.1)},
        "dim, ISO 1600, EV": {f"{ev:g}": _imaged(exposure_ev=ev, **ISO_1600) for ev in (-1.0, -2.0, -3.0)},
        "dim, ISO 6400, EV": {f"{ev:g}": _imaged(exposure_ev=ev, **ISO_6400) for ev in (0.0, -1.0, -2.0, -2.5)},
        "over-exposed by a window, EV": {f"{ev:g}": _over(ev) for ev in (1.0, 2.0, 3.0)},
        "reflections, exponent": {f"{sharp:g}": Condition(glare=Gloss(0.04, sharp)) for sharp in (50.0, 300.0, 2000.0)},
        "casts": {
            "green": _cast(0.65, 1.0, 0.65),
            "blue": _cast(0.6, 0.8, 1.3),
            "warm": _cast(1.35, 1.0, 0.5),
        },
    }


def _sharpness() -> dict[str, Row]:
    return {
        "defocus radius, px": {f"{radius:g}": _imaged(defocus_radius_px=radius) for radius in (1.0, 2.0, 3.0)},
        "motion, dot radii": {f"{share:g}": _moving(share * DOT_RADIUS_PX) for share in (0.5, 1.0, 1.5)},
    }


def _files_and_cameras() -> dict[str, Row]:
    return {
        "JPEG 4:2:0, quality": {f"{quality}": _jpeg(quality, "4:2:0") for quality in (95, 75, 50, 35)},
        "JPEG 4:4:4, quality": {f"{quality}": _jpeg(quality, "4:4:4") for quality in (95, 75, 50, 35)},
        "family": {name: Condition(px_per_u=3.0, family=name) for name in FAMILY_NAMES},
        "camera": {
            "720p": _lens(phone_camera(1280, 720), 3.0),
            "upright 1080p": _lens(phone_camera(1080, 1920), 4.0),
            "wide 1080p": _lens(wide_camera(1920, 1080), 3.5),
            "12 MP": _lens(phone_camera(4000, 3000), 14.0),
        },
    }


def _together() -> dict[str, Row]:
    """What comes together: a dim room and a hand that shakes, small plates in a small file."""
    return {
        "together": {
            "dim and shaken": _imaged(exposure_ev=-1.0, motion_px=(1.5, 1.5), **ISO_1600),
            "small and JPEG 60": Condition(px_per_u=2.5, imaging=ImagingOptions(jpeg_quality=60)),
            "slanted and soft": Condition(
                px_per_u=5.0, incidence_deg=(60.0, 65.0), imaging=ImagingOptions(defocus_radius_px=1.5)
            ),
        }
    }
