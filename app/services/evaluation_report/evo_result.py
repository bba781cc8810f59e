"""An evaluation as the tool evo keeps its results, so that evo's tables and plots take it beside their own."""

from __future__ import annotations

import io
import json
import re

import numpy as np
import numpy.typing as npt

from app.trajectories.evaluation import Evaluation
from app.trajectories.robotics_formats import tum_text
from app.trajectories.trajectory import Trajectory

Array = npt.NDArray[np.float64]

TITLE = "APE w.r.t. translation part (m)"  # evo sets results side by side that have one title
LABEL = "APE (m)"
UNSAFE = re.compile(r"[^\w.-]+")


def file_name(name: str) -> str:
    """A name as a file's: letters, digits, points, hyphens and underscores, with no way out of its folder."""
    return UNSAFE.sub("_", name).lstrip(".") or "system"


def evo_files(reference_name: str, name: str, evaluation: Evaluation) -> dict[str, bytes]:
    """Contents by file name, as evo 1.38 reads them.

    The errors are those of positions in space (evo's translation part). Trajectories are left out where
    orientations are missing: evo's formats have no word for that.
    """
    spatial, errors = evaluation.accuracy.spatial, evaluation.errors
    info = {"title": f"{TITLE}\n({_aligned(evaluation)})", "ref_name": reference_name, "est_name": name, "label": LABEL}
    stats = {
        "rmse": spatial.rms,
        "mean": spatial.mean,
        "median": spatial.median,
        "std": spatial.std,
        "min": spatial.least,
        "max": spatial.greatest,
        "sse": spatial.sum_of_squares,
    }
    return {
        "info.json": json.dumps(info).encode(),
        "stats.json": json.dumps(stats).encode(),
        "error_array.npy": _npy(errors.spatial_m),
        "timestamps.npy": _npy(errors.times_s),
        "seconds_from_start.npy": _npy(errors.times_s - errors.times_s[0]),
        "alignment_transformation_sim3.npy": _npy(_matrix(evaluation)),
        **_trajectory("reference.tum", evaluation.pairs.reference),
        **_trajectory("estimate.tum", evaluation.pairs.estimate),
    }


def _aligned(evaluation: Evaluation) -> str:
    kind = evaluation.alignment.kind
    return "not aligned" if kind == "none" else f"aligned: {kind}"


def _matrix(evaluation: Evaluation) -> Array:
    similarity = evaluation.alignment.site_from_estimate
    matrix = np.eye(4)
    matrix[:3, :3] = similarity.scale * similarity.rotation
    matrix[:3, 3] = similarity.translation_m
    return matrix


def _npy(array: Array) -> bytes:
    out = io.BytesIO()
    np.save(out, array, allow_pickle=False)
    return out.getvalue()


def _trajectory(name: str, trajectory: Trajectory) -> dict[str, bytes]:
    if trajectory.orientations_xyzw is None:
        return {}
    return {name: "".join(tum_text([trajectory])).encode()}
