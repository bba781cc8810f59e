"""Place targets in a growing network: both mirror images of a target are kept until photographs decide between them."""

from __future__ import annotations

from dataclasses import replace

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
    normalised_dots,
    rms_in_tolerances,
    sighted_poses,
    turn_rad,
    votes,
)
from app.photogrammetry.sightings import Sightings

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]

MIRRORS = 2


def place_targets(growth: Growth, fresh: Index | None = None) -> Growth:
    """Place, anew if need be, every undecided target that oriented photographs see.

    Parameters
    ----------
    growth : Growth
    fresh : ndarray of int, optional
        Photographs oriented since the last time: only what they see can be placed better than before.
    """
    every = growth.problem.sightings
    wanted = ~growth.decided
    if fresh is not None:
        wanted = wanted & np.isin(np.arange(every.target_count), every.target[np.isin(every.photo, fresh)])
    seen = every.select(growth.oriented[every.photo] & wanted[every.target])
    proposals = sighted_poses(growth.problem, growth.network, seen.select(_largest(seen, growth.options.views)))
    proposals = proposals.select(np.asarray(proposals.exists.all(axis=-1)))
    if not len(proposals.sightings):
        return growth
    best = _elected(growth, seen, proposals)
    targets = proposals.sightings.target[best]
    problem, network = _trial(growth, seen, (targets, *_in_model(growth, proposals.select(best))))
    network = adjust_blocks(problem, network, "targets", growth.capture_loss)
    return _decided(growth, targets, problem, network)


def _largest(seen: Sightings, views: int) -> Mask:
    """The sightings that show their target largest, at most so many of each target."""
    order = np.lexsort([-image_size(seen), seen.target])
    target = seen.target[order]
    rank = np.arange(len(seen)) - np.searchsorted(target, target)
    mask = np.zeros(len(seen), dtype=np.bool_)
    mask[order[rank < views]] = True
    return mask


def _in_model(growth: Growth, seen: SightedPoses) -> tuple[Array, Array]:
    """Both planar poses as ``model_from_target``, shapes (m, 2, 3, 3) and (m, 2, 3)."""
    model_from_cam = growth.network.photo_rotations[seen.sightings.photo][:, None]
    centres_m = growth.network.photo_positions_m[seen.sightings.photo][:, None]
    return model_from_cam @ seen.rotations, (model_from_cam @ seen.positions_m[..., None])[..., 0] + centres_m


def _elected(growth: Growth, seen: Sightings, proposals: SightedPoses) -> Mask:
    """The sighting of each target one of whose poses agrees best with all its sightings; one row per target."""
    normalised = normalised_dots(growth.problem, growth.network, seen)[:, CORNER_CELLS]
    order = np.argsort(seen.target, kind="stable")
    borders = np.searchsorted(seen.target[order], [proposals.sightings.target, proposals.sightings.target + 1])
    counts = borders[1] - borders[0]
    proposal = np.repeat(np.arange(len(counts)), counts)
    view = order[np.arange(len(proposal)) - np.repeat(np.cumsum(counts) - counts - borders[0], counts)]

    rotations, positions_m = _in_model(growth, proposals)
    scale = growth.network.print_scale[proposals.sightings.target]
    plane_m = growth.problem.plane_m[CORNER_CELLS] * scale[:, None, None]
    dots_m = plane_m @ np.swapaxes(rotations[..., :2], -1, -2) + positions_m[..., None, :]
    photo = seen.photo[view]
    offsets_m = dots_m[proposal] - growth.network.photo_positions_m[photo][:, None, None]
    misfits = misfit(offsets_m @ growth.network.photo_rotations[photo][:, None], normalised[view][:, None])
    cost = np.zeros((len(counts), MIRRORS))
    np.add.at(cost, proposal, votes(misfits, growth.tolerance))

    ranked = np.lexsort([cost.min(axis=-1), proposals.sightings.target])
    _, first = np.unique(proposals.sightings.target[ranked], return_index=True)
    elected = np.zeros(len(counts), dtype=np.bool_)
    elected[ranked[first]] = True
    return elected


def _trial(growth: Growth, seen: Sightings, poses: tuple[Index, Array, Array]) -> tuple[BundleProblem, Network]:
    """A problem in which each mirror image is a target of its own, seen in all oriented photographs of its target."""
    targets, rotations, positions_m = poses
    place = np.full(seen.target_count, -1)
    place[targets] = np.arange(len(targets))
    seen = seen.select(place[seen.target] >= 0)
    rows, images = np.repeat(np.arange(len(seen)), MIRRORS), np.repeat(targets, MIRRORS)
    sightings = replace(
        seen,
        photo=seen.photo[rows],
        target=MIRRORS * place[seen.target[rows]] + np.tile(np.arange(MIRRORS), len(seen)),
        dots_px=seen.dots_px[rows],
        whitening_per_px=seen.whitening_per_px[rows],
        target_count=MIRRORS * len(targets),
    )
    network = replace(
        growth.network,
        target_rotations=rotations.reshape(-1, 3, 3),
        target_positions_m=positions_m.reshape(-1, 3),
        print_scale=growth.network.print_scale[images],
    )
    prints = growth.problem.prints.among(images)
    return replace(growth.problem, sightings=sightings, prints=prints, photo_poses=None), network


def _decided(growth: Growth, targets: Index, problem: BundleProblem, network: Network) -> Growth:
    """Put both images in place, the better first; one alone where the other is the same pose or ruled out."""
    misfits = rms_in_tolerances(growth, problem, network).reshape(-1, MIRRORS)  # one row per real sighting
    target = problem.sightings.target.reshape(-1, MIRRORS)[:, 0] // MIRRORS
    cost = np.stack([np.bincount(target, votes(image, 1.0), minlength=len(targets)) for image in misfits.T], axis=-1)
    order = cost.argsort(axis=-1)
    row = np.arange(len(targets))[:, None]
    rotations = network.target_rotations.reshape(-1, MIRRORS, 3, 3)[row, order]
    positions_m = network.target_positions_m.reshape(-1, MIRRORS, 3)[row, order]

    ranked = np.take_along_axis(misfits, order[target], axis=-1)
    agrees = ranked[:, 0] < 1.0
    rays = np.bincount(target, agrees, minlength=len(targets))
    best, other = (np.bincount(target, agrees * image**2, minlength=len(targets)) for image in ranked.T)
    same = turn_rad(rotations[:, 0], rotations[:, 1]) <= growth.options.other_angle_rad
    ruled_out = other > growth.options.decided_ratio * best
    return growth.with_targets(targets, rotations, positions_m, (same | ruled_out) & (rays > 1))
