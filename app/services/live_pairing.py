"""Samples of a running system beside a reference that still grows: paired as soon as a pose lies on either side."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.geometry.rotation import log_rotation, rotation_of_quaternion
from app.storage.database import Session
from app.storage.live_evaluations import LiveEvaluationRepository
from app.storage.live_records import LiveEvaluation, LiveOptions, LivePair, Sample
from app.storage.pose_reading import all_poses
from app.storage.trajectories import TrajectoryRepository
from app.storage.trajectory_parts import StoredTrajectory, TimeRange
from app.trajectories.interpolation import find_between, interpolate
from app.trajectories.lever_arm import with_lever_arm
from app.trajectories.trajectory import Array, Trajectory

SAMPLES_AT_A_TIME = 2000  # as many as two requests bring
# A snapshot may be recorded after others that were taken later: by its upload and the time limit of its location.
LATE_S = 15.0
BEYOND_S = 1e-3  # a range of time leaves out its end


def pair_waiting(session: Session, live_id: str) -> LiveEvaluation:
    """Pair what can be paired by now; the live evaluation as it stands then.

    Its row is locked until the transaction ends, so that pairs are numbered once, whichever servers ask.

    Raises
    ------
    NotFound
    """
    repository = LiveEvaluationRepository(session)
    live = repository.get(live_id, lock=True)
    reference = TrajectoryRepository(session).get(live.reference_id)
    waiting = repository.waiting(live_id, SAMPLES_AT_A_TIME)
    if waiting:
        found = _paired(session, live, [sample for _, sample in waiting])
        pairs = {sample_id: pair for (sample_id, _), pair in zip(waiting, found, strict=True) if pair is not None}
        lost = [
            sample_id for sample_id, sample in waiting if sample_id not in pairs and _passed_by(sample, live, reference)
        ]
        repository.settle(live_id, pairs, lost, reference.snapshot_count)
    return repository.get(live_id)


def _passed_by(sample: Sample, live: LiveEvaluation, reference: StoredTrajectory) -> bool:
    """Whether no pose for a sample can come any more."""
    if live.closed_s is not None or reference.closed_s is not None:
        return True
    by_reference_s = sample.time_s + live.options.time_offset_s
    return reference.last_s is not None and reference.last_s > by_reference_s + live.options.max_gap_s + LATE_S


def _paired(session: Session, live: LiveEvaluation, samples: Sequence[Sample]) -> list[LivePair | None]:
    """What came of each sample, which are in the order of time; None for one that has no pose on both sides."""
    options = live.options
    times_s = np.array([sample.time_s for sample in samples]) + options.time_offset_s
    around = TimeRange(float(times_s[0]) - options.max_gap_s, float(times_s[-1]) + options.max_gap_s + BEYOND_S)
    poses = all_poses(session, live.reference_id, around)
    if options.lever_arm_m is not None and len(poses):
        poses = with_lever_arm(poses, np.array(options.lever_arm_m))
    inside = find_between(poses.times_s, times_s, options.max_gap_s).inside
    there = interpolate(poses, times_s, options.max_gap_s)
    found: list[LivePair | None] = [None] * len(samples)
    for row, place in enumerate(np.flatnonzero(inside).tolist()):
        found[place] = _pair(samples[place], there.take(np.array([row])), options)
    return found


def _pair(sample: Sample, there: Trajectory, options: LiveOptions) -> LivePair:
    """A sample beside the one pose of the reference at its moment."""
    x_m, y_m, z_m = there.positions_m[0].tolist()
    sigmas = there.sigmas
    return LivePair(
        time_s=sample.time_s,
        position_m=(sample.x_m, sample.y_m, sample.z_m),
        error_m=(sample.x_m - x_m, sample.y_m - y_m, None if sample.z_m is None else sample.z_m - z_m),
        angle_rad=_angle_rad(sample, None if there.rotations is None else there.rotations[0]),
        reference_sigma_m=None if sigmas is None else float(sigmas[0, :3].max()),
        right_floor=_right_floor(sample, there, options.floor_height_m),
        arrived_s=sample.arrived_s,
    )


def _angle_rad(sample: Sample, rotation: Array | None) -> float | None:
    if sample.orientation_xyzw is None or rotation is None:
        return None
    turned = rotation_of_quaternion(np.array(sample.orientation_xyzw))
    return float(np.linalg.norm(log_rotation(turned @ rotation.T)))


def _right_floor(sample: Sample, there: Trajectory, floor_height_m: float | None) -> bool | None:
    """Whether the storey is right; None where one of the two is not known."""
    told, true = sample.floor, None if there.floors is None else int(there.floors[0])
    if floor_height_m is not None:
        true = int(np.floor(there.positions_m[0, 2] / floor_height_m)) if true is None else true
        told = int(np.floor(sample.z_m / floor_height_m)) if told is None and sample.z_m is not None else told
    return None if told is None or true is None else told == true
