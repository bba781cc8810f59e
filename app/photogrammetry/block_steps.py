"""Many small adjustments at once: each photograph against fixed targets, or each target against fixed photographs.

The blocks of the bundle's normal equations without what couples them; each block is damped and judged on its own.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.geometry.rotation import exp_rotation
from app.photogrammetry.bundle_normals import normal_equations, squared_residuals
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.network import POSE_COUNT, Network
from app.photogrammetry.robust import RobustLoss

Array = npt.NDArray[np.float64]

Kind = Literal["photos", "targets"]


@dataclass(frozen=True)
class BlockStepOptions:
    """How the blocks are iterated.

    Attributes
    ----------
    most_steps : int
        Steps; from a planar pose three reach the noise of a photograph.
    first_damping, damping_factor : float
        Levenberg-Marquardt damping as a fraction of each block's diagonal, and its change from step to step.
    converged_share : float
        The blocks are done when no step lowers any block's cost by more than this share of it.
    """

    most_steps: int = 8
    first_damping: float = 1e-4
    damping_factor: float = 10.0
    converged_share: float = 1e-3


def adjust_blocks(
    problem: BundleProblem, network: Network, kind: Kind, loss: RobustLoss, options: BlockStepOptions | None = None
) -> Network:
    """The network with each photograph (or target) moved to its own optimum.

    Every photograph (or target) of the problem needs at least one sighting of four dots.
    """
    options = options or BlockStepOptions()
    cost = _costs(problem, network, kind, loss)
    damping = np.full(len(cost), options.first_damping)
    for _ in range(options.most_steps):
        trial = _stepped(problem, network, kind, (loss, damping))
        trial_cost = _costs(problem, trial, kind, loss)
        better = trial_cost < cost
        network = _chosen(better, trial, network, kind)
        done = (cost - trial_cost) <= options.converged_share * cost
        cost = np.where(better, trial_cost, cost)
        damping *= np.where(better, 1.0 / options.damping_factor, options.damping_factor)
        if done.all():
            break
    return network


def _costs(problem: BundleProblem, network: Network, kind: Kind, loss: RobustLoss) -> Array:
    per_sighting = loss.cost(squared_residuals(problem, network)).sum(axis=-1)
    sightings = problem.sightings
    if kind == "photos":
        costs = np.bincount(sightings.photo, per_sighting, minlength=sightings.photo_count)
    else:
        costs = np.bincount(sightings.target, per_sighting, minlength=sightings.target_count)
    return costs.astype(np.float64)


def _stepped(problem: BundleProblem, network: Network, kind: Kind, how: tuple[RobustLoss, Array]) -> Network:
    loss, damping = how
    normals = normal_equations(problem, network, loss)
    blocks, gradient = (
        (normals.photos, normals.photo_gradient) if kind == "photos" else (normals.targets, normals.target_gradient)
    )
    np.einsum("...ii->...i", blocks)[...] *= 1.0 + damping[:, None]
    # A block whose dots all lie behind the camera is zero; the tiny ridge makes its step zero instead of undefined.
    ridge = np.finfo(np.float64).tiny ** 0.5 * np.eye(POSE_COUNT)
    step = -np.asarray(np.linalg.solve(blocks + ridge, gradient[..., None])[..., 0], dtype=np.float64)
    rotations = exp_rotation(step[:, 3:])
    if kind == "photos":
        return replace(
            network,
            photo_rotations=rotations @ network.photo_rotations,
            photo_positions_m=network.photo_positions_m + step[:, :3],
        )
    return replace(
        network,
        target_rotations=rotations @ network.target_rotations,
        target_positions_m=network.target_positions_m + step[:, :3],
    )


def _chosen(better: npt.NDArray[np.bool_], trial: Network, network: Network, kind: Kind) -> Network:
    names = ("photo_rotations", "photo_positions_m") if kind == "photos" else ("target_rotations", "target_positions_m")
    new, old = [getattr(trial, name) for name in names], [getattr(network, name) for name in names]
    rotations = np.where(better[:, None, None], new[0], old[0])
    return replace(network, **{names[0]: rotations, names[1]: np.where(better[:, None], new[1], old[1])})
