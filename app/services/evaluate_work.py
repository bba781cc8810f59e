"""What a worker process does for one evaluation: read the trajectories, compare, keep."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from app.errors import Conflict, DegenerateGeometry, InvalidInput
from app.services.workbench import workbench
from app.storage.audit import PendingEntry, on_behalf_of
from app.storage.database import Session
from app.storage.evaluation_records import EvaluatedSystem, NewEvaluation, StoredEvaluation
from app.storage.evaluations import EvaluationRepository
from app.storage.pose_reading import all_poses
from app.storage.trajectories import TrajectoryRepository
from app.storage.trajectory_parts import StoredTrajectory
from app.trajectories.comparison import compare
from app.trajectories.evaluation import Evaluation, EvaluationOptions, evaluate
from app.trajectories.evaluation_options_record import record_of_options
from app.trajectories.evaluation_record import record_of_difference, record_of_evaluation
from app.trajectories.trajectory import Trajectory

GREATEST_NAME = 180  # characters; what tells two systems apart still fits into the column
TOLD_OF_ID = 8  # of an id's end, which is random


@dataclass(frozen=True)
class EvaluationWish:
    """Which systems are compared with which reference, and how.

    Attributes
    ----------
    title : str
        For people.
    """

    reference_id: str
    estimate_ids: tuple[str, ...]
    options: EvaluationOptions
    title: str = ""

    def __post_init__(self) -> None:
        if not self.estimate_ids or len(set(self.estimate_ids)) < len(self.estimate_ids):
            raise InvalidInput("name each system that is to be evaluated, once", field="estimate_ids")
        if self.reference_id in self.estimate_ids:
            raise InvalidInput("the reference is no system under test; name another trajectory", field="estimate_ids")


def make_evaluation(wish: EvaluationWish, audit: PendingEntry | None) -> StoredEvaluation:
    """Compare and keep.

    Raises
    ------
    NotFound
        When a trajectory does not exist.
    Conflict
        When they are of different sites.
    NothingMatched, DegenerateGeometry, InvalidInput
        As ``evaluate``; the system is named.
    """
    database = workbench().database
    with database.reading() as session:
        reference = TrajectoryRepository(session).get(wish.reference_id)
        systems = _systems(session, wish, reference.site_id)
        truth = all_poses(session, wish.reference_id)
        evaluations = {
            name: _evaluated(name, (truth, all_poses(session, system.trajectory_id)), wish.options)
            for name, system in systems.items()
        }
    new = _new_evaluation(wish, reference, systems, evaluations)
    with on_behalf_of(audit), database.writing() as session:
        return EvaluationRepository(session).add(new)


def _systems(session: Session, wish: EvaluationWish, site_id: str) -> dict[str, StoredTrajectory]:
    """The systems by names that tell them apart."""
    found = [TrajectoryRepository(session).get(trajectory_id) for trajectory_id in wish.estimate_ids]
    stranger = next((trajectory for trajectory in found if trajectory.site_id != site_id), None)
    if stranger is not None:
        raise Conflict(
            f"trajectory {stranger.trajectory_id} is of site {stranger.site_id} and the reference of {site_id}: they "
            "share no frame; import it for the reference's site",
            trajectory_id=stranger.trajectory_id,
        )
    names = [name_of(trajectory) for trajectory in found]
    return {
        name if names.count(name) == 1 else f"{name} ({trajectory.trajectory_id[-TOLD_OF_ID:]})": trajectory
        for name, trajectory in zip(names, found, strict=True)
    }


def name_of(trajectory: StoredTrajectory) -> str:
    """What a trajectory is called in tables and plots."""
    told = trajectory.name or trajectory.device_id or f"trajectory {trajectory.trajectory_id[-TOLD_OF_ID:]}"
    return told[:GREATEST_NAME]


def _evaluated(name: str, both: tuple[Trajectory, Trajectory], options: EvaluationOptions) -> Evaluation:
    reference, estimate = both
    try:
        return evaluate(reference, estimate, options)
    except (InvalidInput, DegenerateGeometry) as error:
        raise type(error)(f"{name}: {error.detail}", **error.fields, system=name) from error


def _new_evaluation(
    wish: EvaluationWish,
    reference: StoredTrajectory,
    systems: Mapping[str, StoredTrajectory],
    evaluations: Mapping[str, Evaluation],
) -> NewEvaluation:
    differences = compare(evaluations, wish.options.association.max_gap_s, wish.options.bootstrap)
    return NewEvaluation(
        site_id=reference.site_id,
        reference_id=reference.trajectory_id,
        reference_name=name_of(reference),
        title=wish.title or f"{', '.join(systems)} against {name_of(reference)}"[:GREATEST_NAME],
        options=record_of_options(wish.options),
        differences=[record_of_difference(difference) for difference in differences],
        systems=tuple(
            EvaluatedSystem(systems[name].trajectory_id, name, record_of_evaluation(evaluation))
            for name, evaluation in evaluations.items()
        ),
        pairs=tuple(evaluation.pairs for evaluation in evaluations.values()),
    )
