"""Adjust a growing network where it has just grown: the fresh photographs, what they see, and their neighbours.

A photograph that knows a few targets of one wall, each seen once before, leans by several degrees; what is placed from
it leans with it, and along a corridor that adds up until branches no longer meet. So nothing is built on a photograph
before it has been adjusted together with those around it. The rest is held, and the cost is that of the neighbourhood.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.equations import PoseEquations
from app.photogrammetry.free_adjustment import Part, adjust_narrowly, held_poses, part_problem, with_part_adjusted
from app.photogrammetry.growth import Growth

Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]

FEWEST_RAYS = 2  # a target that one photograph sees holds nothing
HELD_SHARE = 1e-6  # of the cameras' covariances: a neighbourhood says nothing of them


def adjust_locally(growth: Growth, fresh: Index) -> Growth:
    """Adjust fresh photographs with their neighbours; what does not fit there is taken out again.

    Parameters
    ----------
    growth : Growth
        Adjusted as a whole before, so that its cameras are known.
    fresh : ndarray of int
        Photographs oriented since the last adjustment.
    """
    part, free = _neighbourhood(growth, fresh)
    held = np.flatnonzero(~np.isin(part.photos, free))
    if not len(held) or not len(free):
        return growth
    network = growth.network.among(part.photos, part.targets)
    problem = _held_problem(growth, part, held_poses(network, held))
    network = adjust_narrowly(problem, network, growth.options)
    return with_part_adjusted(growth, part, problem, network)


def _neighbourhood(growth: Growth, fresh: Index) -> tuple[Part, Index]:
    """What is adjusted, and which of its photographs are free: the fresh ones and all that see what they see."""
    every = growth.problem.sightings
    stands = growth.oriented[every.photo] & growth.decided[every.target]
    photo, target = every.photo[stands], every.target[stands]
    is_fresh = _marked(fresh, every.photo_count)
    around = _marked(target[is_fresh[photo]], every.target_count)
    is_free = np.bincount(photo, around[target], minlength=every.photo_count) >= growth.options.fewest_agreeing
    wanted = _marked(target[is_free[photo]], every.target_count)
    wanted &= np.bincount(target, minlength=every.target_count) >= FEWEST_RAYS
    photos = np.unique(photo[wanted[target]])
    return Part(photos, np.flatnonzero(wanted)), photos[is_free[photos]]


def _marked(numbers: Index, count: int) -> Mask:
    marked = np.zeros(count, dtype=np.bool_)
    marked[numbers] = True
    return marked


def _held_problem(growth: Growth, part: Part, poses: PoseEquations) -> BundleProblem:
    """The neighbourhood's observations with cameras, print scales and the photographs around it held."""
    problem = part_problem(growth.problem, part)
    cameras = tuple(
        replace(known, camera=problem.camera_at(growth.network, number), covariance=HELD_SHARE * known.covariance)
        for number, known in enumerate(problem.cameras)
    )
    prints = replace(problem.prints, held=np.ones(problem.prints.count, dtype=np.bool_))
    return replace(problem, cameras=cameras, prints=prints, photo_poses=poses)
