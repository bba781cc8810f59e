"""Bundle adjustment: Levenberg-Marquardt over photographs, targets, cameras and the print scales.

Sources: Sensors 2019, eq. 8 and 17 (least squares, iterated); Triggs et al., Bundle adjustment: a modern synthesis,
2000, section 6 (Schur complement); Nocedal and Wright, Numerical Optimization, chapter 10 (damping).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from app.photogrammetry.bundle_normals import NormalEquations, normal_equations, prior_cost, squared_residuals
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.elimination_tree import EliminationNode
from app.photogrammetry.network import POSE_COUNT, Network, NetworkStep
from app.photogrammetry.prints import PRINT_COUNT
from app.photogrammetry.reduced_system import Unknowns, photo_graph_tree, reduce_normals
from app.photogrammetry.robust import RobustLoss

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class BundleOptions:
    """How a bundle is iterated.

    Attributes
    ----------
    loss : RobustLoss
        Huber beyond 3 standard deviations: a dot in a hundred of clean ones, so that its efficiency stays at 99 %.
    most_steps : int
        Steps tried; a network that starts near its solution takes four.
    first_damping, least_damping, most_damping : float
        Levenberg-Marquardt damping, a fraction of the diagonal: at the start, where it stops mattering, and where no
        step is left to try.
    damping_factor : float
        Change of the damping after a good and after a bad step.
    converged : float
        The adjustment ends when a step lowers the weighted squares by less than this: one of 1e-6 moves no unknown
        by more than a thousandth of its standard deviation.
    converged_share : float
        Or by less than this share of them, which is what rounding leaves of millions of squares.
    """

    loss: RobustLoss = field(default_factory=lambda: RobustLoss("huber", 3.0))
    most_steps: int = 50
    first_damping: float = 1e-6
    least_damping: float = 1e-12
    most_damping: float = 1e3
    damping_factor: float = 10.0
    converged: float = 1e-6
    converged_share: float = 1e-9


@dataclass(frozen=True)
class Adjusted:
    """A network after its adjustment.

    Attributes
    ----------
    network : Network
    squared : ndarray of shape (M, 16)
        Squared residual of each dot, in variances.
    cost : float
        Robust weighted squares of all equations.
    steps : int
        Steps tried.
    converged : bool
        False when the steps ran out.
    """

    network: Network
    squared: Array
    cost: float
    steps: int
    converged: bool


def adjust_bundle(
    problem: BundleProblem,
    start: Network,
    options: BundleOptions | None = None,
    on_step: Callable[[], None] | None = None,
) -> Adjusted:
    """The network of least robust weighted squares near a start.

    Parameters
    ----------
    problem : BundleProblem
        Something in it must hold the datum: known poses or control points.
    start : Network
    options : BundleOptions, optional
    on_step : callable, optional
        Called before each step; may raise to stop.
    """
    options = options or BundleOptions()
    nodes = photo_graph_tree(problem.sightings)
    present = _evaluated(problem, start, options.loss)
    damping = options.first_damping
    normals = normal_equations(problem, start, options.loss)
    for step in range(1, options.most_steps + 1):
        if on_step is not None:
            on_step()
        trial = _tried(problem, present, (normals, nodes, damping), options.loss)
        gain = -np.inf if trial is None else present.cost - trial.cost
        if trial is not None and gain > 0:
            present = trial
        if abs(gain) <= max(options.converged, options.converged_share * present.cost):
            # Where rounding is all that is left a step may be worse; it does not matter either.
            return replace(present, steps=step, converged=True)
        if gain > 0:
            damping = max(damping / options.damping_factor, options.least_damping)
            normals = normal_equations(problem, present.network, options.loss)
        elif damping > options.most_damping:
            break
        else:
            damping *= options.damping_factor
    return replace(present, steps=step)


def _evaluated(problem: BundleProblem, network: Network, loss: RobustLoss) -> Adjusted:
    squared = squared_residuals(problem, network)
    cost = float(loss.cost(squared).sum()) + prior_cost(problem, network)
    return Adjusted(network, squared, cost, steps=0, converged=False)


def _tried(
    problem: BundleProblem,
    present: Adjusted,
    system: tuple[NormalEquations, Sequence[EliminationNode], float],
    loss: RobustLoss,
) -> Adjusted | None:
    """The network one damped step on; None when the damped equations do not fix it."""
    normals, nodes, damping = system
    try:
        reduced = reduce_normals(_damped(normals, damping), problem.sightings, problem.free_border, nodes)
    except np.linalg.LinAlgError:
        return None
    free = problem.free_border
    right = Unknowns(
        -normals.photo_gradient.reshape(-1, 1),
        -normals.target_gradient.reshape(-1, 1),
        -normals.border_gradient[free][:, None],
    )
    network = present.network.moved(_as_step(problem, reduced.solve(right)))
    if not _possible(network):
        return None
    return _evaluated(problem, network, loss)


def _as_step(problem: BundleProblem, solution: Unknowns) -> NetworkStep:
    border = np.zeros(problem.border_count)
    border[problem.free_border] = solution.border[:, 0]
    return NetworkStep(
        solution.photos.reshape(-1, POSE_COUNT),
        solution.targets.reshape(-1, POSE_COUNT),
        border[: problem.print_columns().start].reshape(len(problem.cameras), -1),
        border[problem.print_columns()].reshape(-1, PRINT_COUNT)[problem.prints.batch],
    )


def _possible(network: Network) -> bool:
    """Focal lengths and print scales are lengths."""
    return bool(network.intrinsics[:, :2].min() > 0 and network.print_scale.min() > 0)


def _damped(normals: NormalEquations, damping: float) -> NormalEquations:
    """Marquardt's damping: each diagonal entry grown by a fraction of itself and of one, which keeps a target that lies
    behind all its cameras, and so has no equations, from stopping all others.
    """
    photos, targets, border = normals.photos.copy(), normals.targets.copy(), normals.border.copy()
    for blocks in (photos, targets, border):
        diagonal = np.einsum("...ii->...i", blocks)
        diagonal += damping * (diagonal + 1.0)
    return replace(normals, photos=photos, targets=targets, border=border)
