"""Adjust a free network while it grows: what stands, held at one photograph, with the cameras as unknowns."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from app.photogrammetry.bundle import BundleOptions, adjust_bundle
from app.photogrammetry.bundle_normals import squared_residuals
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.equations import PoseEquations
from app.photogrammetry.found_batches import PlateScales, own_sizes
from app.photogrammetry.growth import Growth, GrowthOptions
from app.photogrammetry.network import POSE_COUNT, Network
from app.photogrammetry.plate_faults import fit_plates
from app.photogrammetry.robust import MEDIAN_LENGTH_2D, RobustLoss, robust_scale
from app.photogrammetry.sightings import Sightings

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]

SIZINGS = 3  # adjustments in which plates of another size are given it: each leaves a tenth of what was off
LEAST_SCALE = 0.1  # of the stated sigmas: exact observations are synthetic
ADJUSTED_RAYS = 2  # a target that one photograph sees adds nothing to an adjustment

# Weight of the held photograph's pose. It is the only thing that fixes the frame, so any weight holds it exactly; this
# one, a tenth of a millimetre and of a milliradian, is of the order of the photographs' own and keeps the numbers good.
HELD_INFORMATION = 1e8


@dataclass(frozen=True)
class Part:
    """Some photographs (ascending) and targets of a survey that are adjusted together."""

    photos: Index
    targets: Index


def held_photo(network: Network, photo: int) -> PoseEquations:
    """The equations that hold a free network in its frame by one photograph's present pose."""
    return held_poses(network, np.array([photo]))


def held_poses(network: Network, photos: Index) -> PoseEquations:
    """The equations that hold some photographs at their present poses."""
    information = np.tile(HELD_INFORMATION * np.eye(POSE_COUNT), (len(photos), 1, 1))
    return PoseEquations(photos, network.photo_rotations[photos], network.photo_positions_m[photos], information)


def part_problem(problem: BundleProblem, part: Part) -> BundleProblem:
    """The observations among a part, photographs and targets renumbered."""
    return replace(
        problem,
        sightings=problem.sightings.among(part.photos, part.targets),
        camera_of_photo=problem.camera_of_photo[part.photos],
        prints=problem.prints.among(part.targets),
    )


def rows_among(sightings: Sightings, part: Part) -> Index:
    """Rows of the sightings that ``Sightings.among`` keeps for a part, in its order."""
    return np.flatnonzero(np.isin(sightings.photo, part.photos) & np.isin(sightings.target, part.targets))


def adjust_growth(growth: Growth) -> Growth:
    """Adjust what stands; targets and photographs that have strayed are taken out again."""
    part = standing(growth)
    if not len(part.photos):
        return growth
    problem = part_problem(growth.problem, part)
    network = growth.network.among(part.photos, part.targets)
    problem = replace(problem, photo_poses=held_photo(network, 0))
    network = _adjusted_with_sizes(problem, network, growth)
    return replace(with_part_adjusted(growth, part, problem, network), adjusted_photos=int(growth.oriented.sum()))


def with_part_adjusted(growth: Growth, part: Part, problem: BundleProblem, network: Network) -> Growth:
    """The growth with a part's adjusted poses, without what has strayed in it."""
    squared = squared_residuals(problem, network)
    growth = replace(growth, network=growth.network.with_part(network, part.photos, part.targets))
    return _without_strays(_with_mirrors_moved(growth, part), problem, part, squared)


def _adjusted_with_sizes(problem: BundleProblem, network: Network, growth: Growth) -> Network:
    """The network adjusted, and again while plates turn out to be of another size than their batch."""
    for _ in range(SIZINGS):
        network = adjust_robustly(problem, network, growth.capture_loss, growth.options)
        scales = plate_scales(problem, network, growth.options)
        sized = own_sizes(problem.prints, network.print_scale, scales, growth.options.batches)
        changed = np.abs(sized - network.print_scale).max() > growth.options.batches.least_apart
        network = replace(network, print_scale=sized)
        if not changed:
            break
    return network


def plate_scales(problem: BundleProblem, network: Network, options: GrowthOptions) -> PlateScales:
    """The print scale of each plate by itself, as an adjusted network shows it."""
    sigma0 = max(robust_scale(_measured_squares(problem, network)), LEAST_SCALE)
    fits = fit_plates(problem, network, RobustLoss("cauchy", options.loss_width * sigma0))
    return PlateScales.of(fits, network.print_scale, sigma0, options.batches)


def standing(growth: Growth, fewest_targets: int = 1) -> Part:
    """Decided targets that two oriented photographs see, and the photographs that see so many of them.

    What has come apart since it grew is parted again: the part with most photographs stands.
    """
    every = growth.problem.sightings
    seen = every.select(growth.oriented[every.photo] & growth.decided[every.target])
    while True:
        enough = seen.rays()[seen.target] >= ADJUSTED_RAYS
        enough &= seen.targets_per_photo()[seen.photo] >= fewest_targets
        if enough.all():
            break
        seen = seen.select(enough)
    if not len(seen):
        return Part(seen.photo, seen.target)
    size = seen.photo_count + seen.target_count
    links = csr_array((np.ones(len(seen)), (seen.photo, seen.photo_count + seen.target)), shape=(size, size))
    _, label = connected_components(links, directed=False)
    photos = np.unique(seen.photo)
    held = label[photos] == np.bincount(label[photos]).argmax()
    seen = seen.select(np.isin(seen.photo, photos[held]))
    return Part(photos[held], np.unique(seen.target))


def adjust_robustly(problem: BundleProblem, network: Network, capture: RobustLoss, options: GrowthOptions) -> Network:
    """The network adjusted twice, the second time with a loss as narrow as the residuals of the first allow.

    A growing network drifts. Where two of its branches meet, true sightings are off by many standard deviations, and
    a narrow loss lets go of just these. So what is strained is adjusted again with the wide loss ``capture`` first,
    which draws branches together, but also bends to false codes: the better of the two is taken.
    """
    found = adjust_narrowly(problem, network, options)
    squared = _measured_squares(problem, found)
    narrow = RobustLoss("cauchy", options.loss_width * max(robust_scale(squared), 1.0))
    if not (squared > (options.strayed * narrow.width) ** 2).any():
        return found
    drawn = adjust_narrowly(problem, _adjusted_with(problem, network, capture, options), options)
    better = narrow.cost(_measured_squares(problem, drawn)).sum() < narrow.cost(squared).sum()
    return drawn if better else found


def adjust_narrowly(problem: BundleProblem, network: Network, options: GrowthOptions) -> Network:
    """The network adjusted with a loss as narrow as its residuals allow, twice."""
    for _ in range(2):
        width = options.loss_width * max(robust_scale(_measured_squares(problem, network)), 1.0)
        network = _adjusted_with(problem, network, RobustLoss("cauchy", width), options)
    return network


def _measured_squares(problem: BundleProblem, network: Network) -> Array:
    return squared_residuals(problem, network)[problem.sightings.measured]


def _adjusted_with(problem: BundleProblem, network: Network, loss: RobustLoss, options: GrowthOptions) -> Network:
    steps = BundleOptions(loss=loss, most_steps=options.adjustment_steps, converged_share=options.adjusted_share)
    return adjust_bundle(problem, network, steps).network


def _with_mirrors_moved(growth: Growth, part: Part) -> Growth:
    """Decided targets have one pose, which the adjustment has moved."""
    mirrors, positions_m = growth.mirror_rotations.copy(), growth.mirror_positions_m.copy()
    mirrors[part.targets] = growth.network.target_rotations[part.targets]
    positions_m[part.targets] = growth.network.target_positions_m[part.targets]
    return replace(growth, mirror_rotations=mirrors, mirror_positions_m=positions_m)


def _without_strays(growth: Growth, problem: BundleProblem, part: Part, squared: Array) -> Growth:
    sightings = problem.sightings
    measured = sightings.measured
    limit = growth.options.strayed * robust_scale(squared[measured])
    of_target = _median_per(sightings.target, squared, measured, len(part.targets))
    of_photo = _median_per(sightings.photo, squared, measured, len(part.photos))
    decided, oriented = growth.decided.copy(), growth.oriented.copy()
    decided[part.targets[of_target > limit]] = False
    oriented[part.photos[of_photo > max(limit, growth.capture_loss.width)]] = False
    return replace(growth, decided=decided, oriented=oriented)


def _median_per(index: Index, squared: Array, measured: Mask, count: int) -> Array:
    """Robust standard deviation of the measured dots of each photograph or target, shape (count,)."""
    owner = np.broadcast_to(index[:, None], squared.shape)[measured]
    values = squared[measured]
    order = np.lexsort([values, owner])
    starts = np.searchsorted(owner[order], np.arange(count))
    sizes = np.bincount(owner, minlength=count)
    middle = np.minimum(starts + sizes // 2, len(values) - 1)
    return np.where(sizes > 0, np.sqrt(values[order][middle]) / MEDIAN_LENGTH_2D, 0.0)
