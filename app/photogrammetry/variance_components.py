"""How large the shared and the single errors of dots are, from the residuals of an adjustment itself.

Sources: Förstner, Ein Verfahren zur Schätzung von Varianz- und Kovarianzkomponenten, AVN 86, 1979; the redundancy of a
group of observations is their number less what the adjustment took from them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.plate_sigmas import LINEAR, SHIFT, PlateSigmas
from app.photogrammetry.bundle_problem import CHUNK_SIGHTINGS, BundleProblem
from app.photogrammetry.collinearity import (
    CAMERA_COLUMNS,
    COLUMN_COUNT,
    PRINT_COLUMNS,
    linearise,
    target_step_from_photo_step,
)
from app.photogrammetry.inverse_parts import TargetPart, inverse_parts
from app.photogrammetry.network import POSE_COUNT, Network
from app.photogrammetry.plate_correlation import plate_basis
from app.photogrammetry.reduced_system import ReducedSystem
from app.photogrammetry.robust import RobustLoss

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class ComponentOptions:
    """How variance components are estimated.

    Attributes
    ----------
    most_targets : int
        Targets, taken evenly, whose sightings are enough: a thousand with ten rays give each component to 1 %.
    fewest : float
        Redundancy that a component needs to be told from the others: 30 give it to 13 %. With less, all three are
        taken as one.
    least_sigma : float
        Residuals smaller than this share of their stated sigmas are taken as this: exact observations are synthetic.
    """

    most_targets: int = 1000
    fewest: float = 30.0
    least_sigma: float = 0.1


@dataclass(frozen=True)
class Components:
    """Standard deviation of unit weight of all image coordinates together, and of their three parts."""

    sigma0: float
    sigmas: PlateSigmas


def estimate_components(
    problem: BundleProblem, network: Network, reduced: ReducedSystem, loss: RobustLoss, options: ComponentOptions
) -> Components:
    """Standard deviations of shifts, linear deformations and single dots, as multiples of the stated ones.

    Parameters
    ----------
    problem : BundleProblem
        With independent dots, weighted as stated.
    network : Network
        Adjusted.
    reduced : ReducedSystem
        Its factored normal equations.
    loss : RobustLoss
    options : ComponentOptions
    """
    count = problem.sightings.target_count
    chosen = np.arange(count) % max(1, -(-count // options.most_targets)) == 0
    squares, redundancies = np.zeros(3), np.zeros(3)
    for camera, rows, covariances in _sampled(problem, network, reduced, chosen):
        part = problem.sightings.select(rows)
        equations = linearise(network, part, problem.camera_at(network, camera), problem.plane_m)
        weight = loss.weight((equations.residuals**2).sum(axis=-1))
        weighted = (equations.rows * np.sqrt(weight)[..., None, None]).reshape(len(part), -1, COLUMN_COUNT + 1)
        in_modes = np.swapaxes(plate_basis(part.whitening_per_px), -1, -2) @ weighted
        groups = in_modes[:, SHIFT], in_modes[:, LINEAR], weighted
        numbers = 2.0 * len(part), 4.0 * len(part), 2.0 * part.measured.sum()
        for group, (of_group, number) in enumerate(zip(groups, numbers, strict=True)):
            derivatives = of_group[..., :-1]
            squares[group] += (of_group[..., -1] ** 2).sum()
            redundancies[group] += number - ((derivatives @ covariances) * derivatives).sum()
    # What is left of all when the modes are taken out are the single dots.
    squares[2] -= squares[:2].sum()
    redundancies[2] -= redundancies[:2].sum()
    sigma0 = float(np.sqrt(squares.sum() / max(redundancies.sum(), 1.0)))
    apart = redundancies.min() >= options.fewest
    sigmas = np.sqrt(squares / redundancies) if apart else np.full(3, sigma0)
    return Components(sigma0, PlateSigmas(*np.maximum(sigmas, options.least_sigma).tolist()))


def _sampled(
    problem: BundleProblem, network: Network, reduced: ReducedSystem, chosen: Mask
) -> Iterator[tuple[int, Index, Array]]:
    """Sightings of the chosen targets by camera: rows (m,), and covariances (m, 17, 17) of what moves their images."""
    parts = [
        part for front in inverse_parts(reduced, problem.sightings) for part in front.targets if chosen[part.target]
    ]
    rows = np.concatenate([part.rows for part in parts])
    covariances = np.concatenate([_step_covariances(problem, network, reduced, part) for part in parts])
    camera = problem.camera_of_photo[problem.sightings.photo[rows]]
    for index in np.unique(camera):
        order = np.flatnonzero(camera == index)
        order = order[np.argsort(rows[order])]
        for start in range(0, len(order), CHUNK_SIGHTINGS):
            run = order[start : start + CHUNK_SIGHTINGS]
            yield int(index), rows[run], covariances[run]


def _step_covariances(problem: BundleProblem, network: Network, reduced: ReducedSystem, part: TargetPart) -> Array:
    """Covariances (rays, 17, 17) of the target's step against each photograph, of the print scale and the camera.

    A photograph's step is a target's step (see ``collinearity``), so the two act on the image as their sum.
    """
    sightings, rays = problem.sightings, len(part.rows)
    photo = sightings.photo[part.rows]
    offsets_m = network.target_positions_m[part.target] - network.photo_positions_m[photo]
    turned = target_step_from_photo_step(offsets_m)
    split = POSE_COUNT * rays
    by_photo = (part.gain @ part.inverse)[:, :split].reshape(POSE_COUNT, rays, POSE_COUNT).swapaxes(0, 1)
    with_border = (part.gain @ part.inverse)[:, split:]
    own = part.inverse[:split, :split].reshape(rays, POSE_COUNT, rays, POSE_COUNT)[np.arange(rays), :, np.arange(rays)]
    across = by_photo @ np.swapaxes(turned, -1, -2)
    shared = with_border + turned @ part.inverse[:split, split:].reshape(rays, POSE_COUNT, -1)
    covariances = np.zeros((rays, COLUMN_COUNT, COLUMN_COUNT))
    target = reduced.target_inverse[part.target] + part.gain @ part.inverse @ part.gain.T
    own = turned @ own @ np.swapaxes(turned, -1, -2)
    covariances[:, :POSE_COUNT, :POSE_COUNT] = target + own + across + np.swapaxes(across, -1, -2)
    for ray, camera in enumerate(problem.camera_of_photo[photo]):
        columns, places = shared_columns(problem, int(camera), int(problem.prints.batch[part.target]))
        covariances[ray, :POSE_COUNT, columns] = shared[ray][:, places].T
        covariances[ray, columns, :POSE_COUNT] = shared[ray][:, places].T
        covariances[ray][np.ix_(columns, columns)] = part.inverse[split:, split:][np.ix_(places, places)]
    return covariances


def shared_columns(problem: BundleProblem, camera: int, batch: int) -> tuple[Index, Index]:
    """Columns of a sighting's equations that belong to free shared unknowns, and the places of these among all."""
    every = np.r_[problem.camera_columns(camera), problem.print_columns(batch)]
    columns = np.r_[CAMERA_COLUMNS, PRINT_COLUMNS]
    free = problem.free_border
    return columns[free[every]], (np.cumsum(free) - 1)[every[free[every]]]
