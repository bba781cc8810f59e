"""Alerts for people: what is the matter, and what to do about it."""

from __future__ import annotations

import numpy as np

from app.storage.alerts import Alert, AlertFigures, Trouble

MM_PER_M = 1000.0
REPAIR = "build a new map with base_version and without the code (exclude), or with new photographs of it"


def detail_of(alert: Alert) -> str:
    """What is the matter, in one sentence."""
    trouble = alert.trouble
    return f"{_DETAILS[trouble.kind](trouble)} (map version {alert.map_version}, {_counted(trouble)})"


def advice_of(alert: Alert) -> str:
    """What to do."""
    return _ADVICE[alert.trouble.kind]


def distance_mm(figures: AlertFigures) -> tuple[float, float] | None:
    """How far a target stands from where the map has it, and the standard deviation of that along the way."""
    if figures.displacement_m is None or figures.covariance_m2 is None:
        return None
    moved_m, spread_m2 = np.array(figures.displacement_m), np.array(figures.covariance_m2)
    distance_m = float(np.linalg.norm(moved_m))
    if distance_m == 0.0:
        return 0.0, MM_PER_M * float(np.sqrt(np.trace(spread_m2) / len(moved_m)))
    direction = moved_m / distance_m
    return MM_PER_M * distance_m, MM_PER_M * float(np.sqrt(direction @ spread_m2 @ direction))


def _moved(trouble: Trouble) -> str:
    distance = distance_mm(trouble.figures)
    assert distance is not None and trouble.figures.displacement_m is not None, "what moved has a displacement"
    x_mm, y_mm, z_mm = (MM_PER_M * value_m for value_m in trouble.figures.displacement_m)
    return (
        f"Target {trouble.code} stands {distance[0]:.1f} mm (+- {distance[1]:.1f}) from where the map has it: "
        f"x {x_mm:+.1f}, y {y_mm:+.1f}, z {z_mm:+.1f} mm"
    )


def _misfit(trouble: Trouble) -> str:
    return f"Target {trouble.code} is refused again and again, though no displacement explains it"


def _vanished(trouble: Trouble) -> str:
    return f"Target {trouble.code} is not seen any more where its neighbours are"


def _unknown(trouble: Trouble) -> str:
    return f"Code {trouble.code} is read and is not in the map"


def _whole(trouble: Trouble) -> str:
    if trouble.figures.excess is not None and trouble.figures.excess > 1.0:
        return "The poses of the newest snapshots fit the map worse than they should"
    return "In most of the newest snapshots no majority of targets agrees on a pose"


def _counted(trouble: Trouble) -> str:
    return f"{trouble.snapshots} snapshots from {trouble.places} places, {trouble.devices} devices"


_DETAILS = {
    "moved-target": _moved,
    "misfit-target": _misfit,
    "vanished-target": _vanished,
    "unknown-target": _unknown,
    "map-misfit": _whole,
}
_ADVICE = {
    "moved-target": f"Post it again where it was, or {REPAIR}; poses leave it out where the other targets outvote it.",
    "misfit-target": f"See whether it was turned, bent, covered in part or printed anew; put it right, or {REPAIR}.",
    "vanished-target": f"See whether it was taken down or covered; put it back exactly, or {REPAIR}.",
    "unknown-target": (
        "If it is new, photograph it together with mapped targets and build a new map with base_version; if it stands "
        "where another code should, it was printed wrongly: print that code."
    ),
    "map-misfit": (
        "If one device took the snapshots, calibrate its camera on this site; if several did, the room or the targets "
        "changed: survey the site again."
    ),
}
