"""Orient photographs in a growing network: starts from single targets, a vote of all, then each one's own optimum."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.photogrammetry.block_steps import adjust_blocks
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.growth import Growth
from app.photogrammetry.network import Network
from app.photogrammetry.sighted_poses import (
    CORNER_CELLS,
    SightedPoses,
    image_size,
    misfit,
    rms_in_tolerances,
    sighted_poses,
    turn_rad,
    votes,
)
from app.photogrammetry.sightings import Sightings

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]

STARTS = 2  # the best start and the best that differs from it


@dataclass(frozen=True)
class _Starts:
    """Two starts of one photograph: ``model_from_cam``, and which hypothesis of each known target they chose."""

    rotations: Array  # (2, 3, 3)
    positions_m: Array  # (2, 3)
    chosen: Index  # (2, n)


def orient_photos(growth: Growth, photos: Index) -> Growth:
    """Orient those of some photographs (ascending) whose known targets agree on one pose."""
    known = growth.problem.sightings.select(
        np.isin(growth.problem.sightings.photo, photos) & growth.placed[growth.problem.sightings.target]
    )
    seen = sighted_poses(growth.problem, growth.network, known)
    rows = [slice(*np.searchsorted(known.photo, [photo, photo + 1])) for photo in photos]
    starts = [_starts(growth, seen.select(row)) for row in rows]
    problem, network = _trial(growth, known, starts)
    network = adjust_blocks(problem, network, "photos", growth.capture_loss)
    best, good = _judged(growth, problem, network)
    return growth.with_photos(photos[good], network.photo_rotations[best[good]], network.photo_positions_m[best[good]])


def _starts(growth: Growth, seen: SightedPoses) -> _Starts:
    """The two best different poses among those that single known targets propose."""
    rotations, positions_m = growth.hypotheses(seen.sightings.target)
    decided = growth.decided[seen.sightings.target]
    voters = np.lexsort([-image_size(seen.sightings), ~decided])[: growth.options.voters]
    # model_from_cam = model_from_target . target_from_cam, for both hypotheses of the target and both planar poses.
    cam_from_target = seen.rotations[voters][:, None]
    from_cam = rotations[voters][:, :, None] @ np.swapaxes(cam_from_target, -1, -2)
    shift = (from_cam @ seen.positions_m[voters][:, None, :, :, None])[..., 0]
    centres_m = (positions_m[voters][:, :, None] - shift).reshape(-1, 3)
    from_cam = from_cam.reshape(-1, 3, 3)

    dots_m = _corners(growth, seen.sightings.target, (rotations, positions_m))
    cam_m = (dots_m - centres_m[:, None, None, None]) @ from_cam[:, None, None]
    misfits = misfit(cam_m, seen.normalised[:, None, CORNER_CELLS])
    cost = votes(misfits.min(axis=-1), growth.tolerance).sum(axis=-1)
    first = int(np.argmin(cost))
    other = turn_rad(from_cam[first], from_cam) > growth.options.other_angle_rad
    second = int(np.argmin(np.where(other, cost, np.inf))) if other.any() else first
    pair = [first, second]
    return _Starts(from_cam[pair], centres_m[pair], misfits[pair].argmin(axis=-1))


def _corners(growth: Growth, targets: Index, poses: tuple[Array, Array]) -> Array:
    """Corner dots of hypotheses (n, 2) of targets (n,) in the model frame, shape (n, 2, 4, 3)."""
    rotations, positions_m = poses
    plane_m = growth.problem.plane_m[CORNER_CELLS] * growth.network.print_scale[targets][:, None, None]
    return np.asarray(plane_m @ np.swapaxes(rotations[..., :2], -1, -2) + positions_m[..., None, :])


def _trial(growth: Growth, known: Sightings, starts: list[_Starts]) -> tuple[BundleProblem, Network]:
    """A problem in which each start is a photograph of its own and each of its sightings a fixed target of its own."""
    photos = np.unique(known.photo)
    counts = np.bincount(known.photo, minlength=known.photo_count)[photos]
    rows = np.concatenate([np.tile(row, STARTS) for row in np.split(np.arange(len(known)), np.cumsum(counts)[:-1])])
    chosen = np.concatenate([start.chosen.ravel() for start in starts])
    rotations, positions_m = growth.hypotheses(known.target[rows])
    every = np.arange(len(rows))
    sightings = replace(
        known,
        photo=np.repeat(np.arange(STARTS * len(photos)), np.repeat(counts, STARTS)),
        target=every,
        dots_px=known.dots_px[rows],
        whitening_per_px=known.whitening_per_px[rows],
        photo_count=STARTS * len(photos),
        target_count=len(rows),
    )
    problem = replace(
        growth.problem,
        sightings=sightings,
        camera_of_photo=np.repeat(growth.problem.camera_of_photo[photos], STARTS),
        prints=growth.problem.prints.among(known.target[rows]),
        photo_poses=None,
    )
    network = replace(
        growth.network,
        photo_rotations=np.concatenate([start.rotations for start in starts]),
        photo_positions_m=np.concatenate([start.positions_m for start in starts]),
        target_rotations=rotations[every, chosen],
        target_positions_m=positions_m[every, chosen],
        print_scale=growth.network.print_scale[known.target[rows]],
    )
    return problem, network


def _judged(growth: Growth, problem: BundleProblem, network: Network) -> tuple[Index, Mask]:
    """The better of each photograph's two trials; whether enough agrees with it, and the other is ruled out."""
    sightings = problem.sightings
    misfits = rms_in_tolerances(growth, problem, network)
    photo = sightings.photo
    cost = np.bincount(photo, votes(misfits, 1.0), minlength=sightings.photo_count).reshape(-1, STARTS)
    better = cost.argmin(axis=-1)
    row = STARTS * np.arange(len(cost))
    best, other = row + better, row + 1 - better

    # Both trials of a photograph hold the same sightings in the same order.
    counts = sightings.targets_per_photo()
    twin = np.arange(len(photo)) + np.where(photo % STARTS == 0, 1, -1) * counts[photo]
    agrees = misfits < 1.0
    own, others = (np.bincount(photo, agrees * values**2, minlength=len(counts)) for values in (misfits, misfits[twin]))
    ruled_out = others[best] > growth.options.decided_ratio * own[best]
    same = turn_rad(network.photo_rotations[best], network.photo_rotations[other]) <= growth.options.other_angle_rad
    agreeing = np.bincount(photo, agrees, minlength=len(counts))
    fewest = np.maximum(growth.options.least_agreeing * counts, growth.options.fewest_agreeing)
    return best, (same | ruled_out) & (agreeing >= fewest)[best]
