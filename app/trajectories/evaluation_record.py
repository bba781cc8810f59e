"""An evaluation as JSON: every number with its unit in its name."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from app.trajectories.comparison import Difference
from app.trajectories.evaluation import Evaluation
from app.trajectories.metrics.accuracy import Accuracy
from app.trajectories.metrics.summary import Summary


def record_of_evaluation(evaluation: Evaluation) -> dict[str, Any]:
    """The whole evaluation but its series."""
    verdict, floors = evaluation.verdict, evaluation.floors
    similarity = evaluation.alignment.site_from_estimate
    return {
        "pairs": len(evaluation.pairs),
        "estimate_poses": evaluation.pairs.estimate_count,
        "time_offset": asdict(evaluation.time_offset),
        "alignment": {
            "kind": evaluation.alignment.kind,
            "pairs_used": evaluation.alignment.pairs_used,
            "scale": similarity.scale,
            "rotation": similarity.rotation.tolist(),
            "translation_m": similarity.translation_m.tolist(),
        },
        "accuracy": record_of_accuracy(evaluation.accuracy),
        "intervals_m": asdict(evaluation.intervals),
        "evaal": {"third_quartile_m": evaluation.evaal.quantile_75, "mean_m": evaluation.evaal.mean},
        "floor_detection_probability": None if floors is None else floors.detection_probability,
        "availability": asdict(evaluation.availability),
        "pose_errors": asdict(evaluation.pose_errors),
        "zones": {name: record_of_accuracy(accuracy) for name, accuracy in evaluation.zones.items()},
        "verdict": None if verdict is None else {**asdict(verdict), "sentence": verdict.sentence},
    }


def record_of_accuracy(accuracy: Accuracy) -> dict[str, Any]:
    """The metrics of ISO/IEC 18305 by their names there."""
    named = {
        f"{letter}E{share}_m": value
        for letter, summary in (("C", accuracy.horizontal), ("V", accuracy.vertical), ("S", accuracy.spatial))
        for share, value in ((50, summary.median), (95, summary.quantile_95))
    }
    return {
        "bias_m": accuracy.bias_m.tolist(),
        "rms_m": accuracy.rms_m.tolist(),
        "covariance_m2": accuracy.covariance_m2.tolist(),
        **named,
        "horizontal_m": asdict(accuracy.horizontal),
        "vertical_m": asdict(accuracy.vertical),
        "spatial_m": asdict(accuracy.spatial),
        "rotation_rad": _optional(accuracy.rotation),
    }


def _optional(summary: Summary | None) -> dict[str, Any] | None:
    return None if summary is None else asdict(summary)


def record_of_difference(difference: Difference) -> dict[str, Any]:
    """Two systems beside each other."""
    return {**asdict(difference), "better": difference.better}


def series_of_evaluation(evaluation: Evaluation) -> dict[str, list[Any]]:
    """The errors pair by pair, for plots."""
    errors = evaluation.errors
    angles_rad = errors.angles_rad
    return {
        "time_s": errors.times_s.tolist(),
        "reference_m": evaluation.pairs.reference.positions_m.tolist(),
        "error_m": errors.vectors_m.tolist(),
        "angle_rad": [] if angles_rad is None else angles_rad.tolist(),
    }
