"""The ``imaging`` of a plan: one phone at one setting, and how far its photographs differ from each other."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from app.planning.imaging import ImagingOptions
from app.planning.plan_fields import Field

CHROMAS = ("4:2:0", "4:2:2", "4:4:4")
# Least and greatest of each number that a plan may say.
RANGES = {
    "exposure_ev": (-6.0, 6.0),
    "lens_sigma_px": (0.0, 5.0),
    "defocus_radius_px": (0.0, 30.0),
    "vignetting": (0.0, 0.9),
    "veiling_glare": (0.0, 1.0),
    "full_well_electrons": (0.0, 1e6),
    "read_noise_electrons": (0.0, 1e3),
    "contrast": (0.0, 1.0),
    "sharpening": (0.0, 2.0),
    "focal_mm": (0.1, 1e3),
}
HABITS = {"exposure_jitter_ev": (0.0, 3.0), "shake_px": (0.0, 20.0), "exposure_s": (0.0, 1.0)}
TEXTS = ("make", "model")
IMAGING_FIELDS = (*RANGES, *HABITS, *TEXTS, "jpeg_quality", "chroma")
MOST_TEXT = 64
MOST_MOTION_PX = 60.0  # beyond that nothing is read, and the blur is a second's work


@dataclass(frozen=True)
class Habits:
    """How a phone takes photographs: what they share, and by how much they differ.

    Attributes
    ----------
    imaging : ImagingOptions
        What they share.
    exposure_jitter_ev : float
        Standard deviation of the metering.
    shake_px : float
        Standard deviation, along either axis, of how far the picture moves while it is exposed, beside a walk's part.
    exposure_s : float
        Exposure time, over which a walk smears its photographs.
    """

    imaging: ImagingOptions = field(default_factory=ImagingOptions)
    exposure_jitter_ev: float = 0.15
    shake_px: float = 0.3
    exposure_s: float = 1 / 120

    def one(self, motion_px: tuple[float, float], captured_at: str, rng: np.random.Generator) -> ImagingOptions:
        """The setting of one photograph that moves by so much besides the hand's shaking."""
        shake_px = rng.normal(0.0, self.shake_px, 2)
        total_px = np.clip(shake_px + motion_px, -MOST_MOTION_PX, MOST_MOTION_PX)
        return replace(
            self.imaging,
            exposure_ev=self.imaging.exposure_ev + float(rng.normal(0.0, self.exposure_jitter_ev)),
            motion_px=(float(total_px[0]), float(total_px[1])),
            captured_at=captured_at,
        )


def read_imaging(section: Field) -> Habits:
    """The object ``imaging``; what it leaves out is a steady hand in good light.

    Raises
    ------
    InvalidInput
        Naming line and field.
    """
    members = section.members(*IMAGING_FIELDS)
    settings: dict[str, Any] = {name: members[name].number(*RANGES[name]) for name in RANGES if name in members}
    settings |= {name: _short(members[name]) for name in TEXTS if name in members}
    if "jpeg_quality" in members:
        settings["jpeg_quality"] = members["jpeg_quality"].integer(1, 100)
    if "chroma" in members:
        settings["chroma"] = members["chroma"].one_of(CHROMAS)
    habits = {name: members[name].number(*HABITS[name]) for name in HABITS if name in members}
    return Habits(ImagingOptions(**settings), **habits)


def _short(text: Field) -> str:
    value = text.text().strip()
    if not value.isascii() or len(value) > MOST_TEXT:
        raise text.error(f"EXIF takes at most {MOST_TEXT} ASCII characters")
    return value
