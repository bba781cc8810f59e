"""Why a snapshot has no pose, in words: each refusal with its reason, what was seen and what to do."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from app.errors import NotLocated
from app.geometry.observations import TargetObservation

MORE_TARGETS = "turn or step back so that two or more targets are in view"
CLOSER = "move closer, so that a target fills more of the picture"


def check_dots(observations: Sequence[TargetObservation], known: Sequence[TargetObservation], min_dots: int) -> None:
    """Refuse a photograph without targets, without known ones, or with too few dots on them.

    Raises
    ------
    NotLocated
        Reason ``no-targets``, ``unknown-targets`` or ``too-few-dots``.
    """
    if not observations:
        raise _refusal("no-targets", "No target was found in the photograph", MORE_TARGETS, targets=0)
    if not known:
        codes = sorted(observation.code for observation in observations)
        raise _refusal(
            "unknown-targets",
            f"None of the targets seen ({', '.join(map(str, codes))}) stands in the site's target map",
            "check that this is the right site, or survey the new targets",
            codes=codes,
        )
    if _dots(known[:min_dots]) < min_dots and _dots(known) < min_dots:  # mostly the first few have enough
        raise too_few_dots(known)


def too_few_dots(known: Sequence[TargetObservation]) -> NotLocated:
    """No target shows enough dots, off one line, for a pose."""
    dots = _dots(known)
    return _refusal(
        "too-few-dots",
        f"The {dots} measured dots on {len(known)} known targets fix no pose",
        f"{CLOSER}, and let nothing cover it",
        targets=len(known),
        dots=dots,
    )


def undetermined(sigma_m: float, limit_m: float) -> NotLocated:
    """A pose too uncertain to be of use."""
    return _refusal(
        "too-few-dots",
        f"The dots fix the position to {sigma_m:.2f} m only (limit {limit_m:g} m)",
        f"{CLOSER}, or {MORE_TARGETS}",
        position_sigma_m=sigma_m,
    )


def ambiguous(ratio: float | None) -> NotLocated:
    """Two poses, mirror images about the line of sight, that explain the dots about as well."""
    return _refusal(
        "ambiguous",
        "Two poses, tilted to either side of the line of sight, explain the dots about equally well",
        f"{MORE_TARGETS}, or {CLOSER}",
        ambiguity_ratio=ratio,
    )


def seen_too_frontally(widening: float) -> NotLocated:
    """A plate so nearly parallel to the image that its tilt, and the position with it, stays open."""
    return _refusal(
        "ambiguous",
        "The targets are so small and seen so nearly from the front that their tilt, and the position with it, is open",
        f"{MORE_TARGETS}, look at the target from the side, or {CLOSER}",
        widening=widening,
    )


def inconsistent_targets(codes: npt.NDArray[np.int64], agreeing: npt.NDArray[np.bool_]) -> NotLocated:
    """No majority of targets agrees on one pose."""
    return _refusal(
        "inconsistent",
        f"Of {len(codes)} known targets no majority agrees on one pose: some were moved or misread since the survey",
        f"{MORE_TARGETS}; survey again what was moved",
        codes=[int(code) for code in codes],
        agreeing=[int(code) for code in codes[agreeing]],
    )


def inconsistent_residuals(sigma0: float, limit: float) -> NotLocated:
    """Residuals far greater than their covariances allow."""
    return _refusal(
        "inconsistent",
        f"The residuals are {sigma0:.1f} times what the dots' accuracy allows (limit {limit:g}), or no pose fits: the "
        "camera's intrinsics do not belong to this photograph, or targets were moved",
        "hold the phone still or send the sensor's readout_s, calibrate the camera on this site, or survey again what "
        "was moved",
        sigma0=sigma0,
    )


def outside_site(outside_m: float, limit_m: float) -> NotLocated:
    """A position far from every target of the map."""
    return _refusal(
        "outside-site",
        f"The position computed lies {outside_m:.0f} m outside the box of the site's targets (limit {limit_m:g} m)",
        f"check that this is the right site; {MORE_TARGETS}",
        outside_m=outside_m,
    )


def _dots(known: Sequence[TargetObservation]) -> int:
    return sum(int(np.count_nonzero(observation.measured)) for observation in known)


def _refusal(reason: str, what: str, advice: str, **seen: object) -> NotLocated:
    return NotLocated(f"{what}: {advice}.", reason=reason, advice=advice, seen=seen)
