"""A snapshot to a pose: start, adjust, refuse what does not agree, look for the mirror image, judge.

No pose is better than a wrong one: what cannot be trusted raises NotLocated with the reason and what to do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.camera import INTRINSIC_COUNT, CalibratedCamera, CameraSource
from app.geometry.observations import TargetObservation
from app.geometry.pose import Pose
from app.geometry.target_map import TargetMap
from app.photogrammetry.resection_adjustment import AdjustmentOptions
from app.photogrammetry.resection_ambiguity import AmbiguityOptions, better_side, look_for_mirror
from app.photogrammetry.resection_consensus import Problem, movements_chi2
from app.photogrammetry.resection_doubt import DoubtOptions, doubt_targets
from app.photogrammetry.resection_equations import POSE_COUNT, CameraPrior, State, linearise, residuals_of
from app.photogrammetry.resection_input import sight_targets
from app.photogrammetry.resection_judgement import JudgementOptions, Solution, check_consensus, judge
from app.photogrammetry.resection_refusals import check_dots, too_few_dots
from app.photogrammetry.resection_sampling import SamplingOptions, find_consensus
from app.photogrammetry.resection_start import Start, StartOptions, find_start
from app.photogrammetry.resection_uncertainty import UncertaintyOptions, pose_uncertainty, posterior_camera

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class ResectionOptions:
    """Options of a resection and of its steps.

    Attributes
    ----------
    min_dots : int
        Fewer measured dots of mapped targets give no pose: six leave six coordinates to check six unknowns by.
    sure_targets : int
        So many targets that stand where a planar pose sees them leave no doubt on which side of its plate the camera
        is.
    start, adjustment, sampling, ambiguity, doubt, uncertainty, judgement
        Options of the steps, in their order.
    """

    min_dots: int = 6
    sure_targets: int = 6
    start: StartOptions = StartOptions()
    adjustment: AdjustmentOptions = AdjustmentOptions()
    sampling: SamplingOptions = SamplingOptions()
    ambiguity: AmbiguityOptions = AmbiguityOptions()
    doubt: DoubtOptions = DoubtOptions()
    uncertainty: UncertaintyOptions = UncertaintyOptions()
    judgement: JudgementOptions = JudgementOptions()


@dataclass(frozen=True)
class UsedTarget:
    """What became of one observed target.

    Attributes
    ----------
    code : int
    rms_px : float or None
        Root mean square residual of its measured dots per coordinate; None when it has no image from the pose.
    used : bool
    reason : str or None
        Why it was not used: ``unknown-target`` (not in the map) or ``moved-or-misread``.
    """

    code: int
    rms_px: float | None
    used: bool
    reason: str | None = None


@dataclass(frozen=True)
class Resection:
    """The pose of a snapshot.

    Attributes
    ----------
    site_from_cam : Pose
    covariance : ndarray of shape (6, 6)
        Position (m), small rotation (rad), site axes; of dots, map, datum and camera together.
    sigma0 : float
        Root of the sum of squared residuals in units of their covariance over the redundancy; 1 when all is as said.
    variance_factor : float
        What the covariance (without the datum) was scaled by: 1 unless residuals are significantly too great.
    redundancy : int
        Measured coordinates less six; the camera's and the map's errors are weighted unknowns and cost none.
    rms_residual_px : float
        Of the used dots, per coordinate.
    targets : tuple of UsedTarget
        In the order of the observations.
    ambiguity_ratio : float or None
        Residuals of the mirror image over those of the pose; None when the view is not ambiguous.
    camera : CalibratedCamera
        What this photograph and the prior together say of the camera.
    """

    site_from_cam: Pose
    covariance: Array
    sigma0: float
    variance_factor: float
    redundancy: int
    rms_residual_px: float
    targets: tuple[UsedTarget, ...]
    ambiguity_ratio: float | None
    camera: CalibratedCamera


def resect(
    observations: Sequence[TargetObservation],
    target_map: TargetMap,
    camera: CalibratedCamera,
    options: ResectionOptions | None = None,
) -> Resection:
    """Pose of a photograph from the targets seen in it.

    Parameters
    ----------
    observations : sequence of TargetObservation
        Codes unique; targets that the map does not hold are reported and take no part.
    target_map : TargetMap
    camera : CalibratedCamera
        For the photograph's size; its intrinsics are weighted unknowns.
    options : ResectionOptions, optional

    Raises
    ------
    NotLocated
        ``no-targets``, ``unknown-targets``, ``too-few-dots``, ``inconsistent``, ``ambiguous`` or ``outside-site``.

    Notes
    -----
    Sensors 2019 (robust visual encoded targets), section 3.4, equations 7, 8 and 17, adjusted by small rotations. The
    covariance of the adjustment is scaled by the variance factor where that is significantly above one, and the
    datum's, which all targets share, is added once.
    """
    options = options or ResectionOptions()
    known = [observation for observation in observations if observation.code in target_map.by_code]
    check_dots(observations, known, options.min_dots)
    problem = Problem(sight_targets(known, target_map), CameraPrior.of(camera), options.adjustment)
    start = find_start(problem.sighted, camera.camera, options.start)
    if start is None:
        raise too_few_dots(known)
    solution = _solve(problem, start, options)
    judge(solution, target_map, options.judgement, options.ambiguity)
    return _report(solution, observations, target_map, camera.source)


def _solve(problem: Problem, start: Start, options: ResectionOptions) -> Solution:
    """Adjust the largest targets, which are few, then all who agree with them, then the mirror image."""
    agreeing = start.agreeing(start.elected)
    state = State(start.pose(start.elected), np.zeros(INTRINSIC_COUNT))
    largest = np.zeros_like(agreeing)
    largest[start.proposers] = agreeing[start.proposers]
    if np.count_nonzero(agreeing) < options.sure_targets:
        state = better_side(problem, largest, state, options.ambiguity)
    else:
        state = problem.adjust(largest, state, free_camera=False).state
    consensus = find_consensus(problem, start, state, options.sampling)
    check_consensus(problem, consensus)
    ambiguity = look_for_mirror(problem, consensus.agreeing, consensus.adjusted, options.ambiguity)
    sighted = problem.sighted.where(consensus.agreeing)
    uncertainty = pose_uncertainty(sighted, problem.prior, ambiguity.adjusted, options.uncertainty)
    mirrored = ambiguity.adjusted is not consensus.adjusted
    chi2 = movements_chi2(ambiguity.adjusted) if mirrored else consensus.chi2[consensus.agreeing]
    doubt = doubt_targets(ambiguity.adjusted, chi2, sighted.freedoms, options.doubt)
    return Solution(problem, consensus, ambiguity, uncertainty, doubt)


def _report(
    solution: Solution, observations: Sequence[TargetObservation], target_map: TargetMap, source: CameraSource
) -> Resection:
    """The solution as its user sees it: with the datum's uncertainty and the fate of each observed target."""
    adjusted, problem, state = solution.ambiguity.adjusted, solution.problem, solution.state
    squares_px2 = (residuals_of(problem.sighted, problem.prior, state) ** 2).sum(axis=(1, 2))
    used_px2 = float(squares_px2[solution.consensus.agreeing].sum())
    return Resection(
        site_from_cam=state.site_from_cam,
        covariance=solution.covariance + target_map.datum.pose_covariance(solution.position_m),
        sigma0=solution.sigma0,
        variance_factor=solution.uncertainty.variance_factor,
        redundancy=adjusted.redundancy,
        rms_residual_px=float(np.sqrt(used_px2 / (adjusted.redundancy + POSE_COUNT))),
        targets=_fates(solution, squares_px2, observations),
        ambiguity_ratio=solution.ambiguity.ratio,
        camera=posterior_camera(problem.prior, adjusted, source),
    )


def _fates(solution: Solution, squares_px2: Array, observations: Sequence[TargetObservation]) -> tuple[UsedTarget, ...]:
    """What became of each observed target; ``squares_px2`` are those of the mapped ones, shape (K,)."""
    problem, agreeing, adjusted = solution.problem, solution.consensus.agreeing, solution.ambiguity.adjusted
    seen = np.ones(len(agreeing), dtype=np.bool_)
    if not agreeing.all():
        seen[~agreeing] = linearise(problem.sighted.take(~agreeing), problem.prior, adjusted.state).seen_from_front
    rms_px = np.sqrt(squares_px2 / (2 * np.maximum(problem.sighted.dot_counts, 1)))
    rows = zip(problem.sighted.codes.tolist(), rms_px.tolist(), seen.tolist(), agreeing.tolist(), strict=True)
    fates = {
        code: UsedTarget(code, rms if imaged else None, used, None if used else "moved-or-misread")
        for code, rms, imaged, used in rows
    }
    return tuple(fates.get(target.code) or _unknown(target.code) for target in observations)


def _unknown(code: int) -> UsedTarget:
    return UsedTarget(code, rms_px=None, used=False, reason="unknown-target")
