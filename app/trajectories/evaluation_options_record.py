"""Options of an evaluation as JSON and back: what a stored evaluation was made with."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from app.trajectories.alignment import AlignmentOptions
from app.trajectories.association import AssociationOptions
from app.trajectories.evaluation import EvaluationOptions
from app.trajectories.metrics.bootstrap import BootstrapOptions
from app.trajectories.metrics.zones import Zone


def record_of_options(options: EvaluationOptions) -> dict[str, Any]:
    """Options with nothing left out; a ``time_offset_s`` of null is estimated."""
    return {
        "association": asdict(options.association),
        "alignment": asdict(options.alignment),
        "time_offset_s": options.time_offset_s,
        "lever_arm_m": None if options.lever_arm_m is None else options.lever_arm_m.tolist(),
        "floor_height_m": options.floor_height_m,
        "zones": [{"name": zone.name, "corners_m": zone.corners_m.tolist()} for zone in options.zones],
        "bootstrap": asdict(options.bootstrap),
    }


def options_of_record(record: dict[str, Any]) -> EvaluationOptions:
    """The options of ``record_of_options``."""
    arm_m = record["lever_arm_m"]
    return EvaluationOptions(
        association=AssociationOptions(**record["association"]),
        alignment=AlignmentOptions(**record["alignment"]),
        time_offset_s=record["time_offset_s"],
        lever_arm_m=None if arm_m is None else np.array(arm_m, dtype=np.float64),
        floor_height_m=record["floor_height_m"],
        zones=tuple(Zone(zone["name"], np.array(zone["corners_m"], dtype=np.float64)) for zone in record["zones"]),
        bootstrap=BootstrapOptions(**record["bootstrap"]),
    )
