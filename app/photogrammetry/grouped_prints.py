"""The plates of a free network put into the print batches that the network shows, and those that it does not bear
out dissolved again.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from app.photogrammetry.bundle import BundleOptions
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.covariance import reduced_at
from app.photogrammetry.found_batches import BatchOptions, regrouped
from app.photogrammetry.free_adjustment import Part, plate_scales
from app.photogrammetry.growth import Growth
from app.photogrammetry.network import Network
from app.photogrammetry.prints import PRINT_COUNT, Prints

Array = npt.NDArray[np.float64]


def with_batches(growth: Growth, part: Part, problem: BundleProblem) -> Growth | None:
    """The growth with the plates of a part in the batches that they show; None where each is in its batch already."""
    network = growth.network.among(part.photos, part.targets)
    scales = plate_scales(problem, network, growth.options)
    prints, sizes = regrouped(problem.prints, network.print_scale, scales, growth.options.batches)
    apart = np.abs(sizes - network.print_scale).max() > growth.options.batches.least_apart / 2.0
    if prints.count == problem.prints.count and not apart:
        return None
    return with_prints(growth, part, prints, sizes)


def with_prints(growth: Growth, part: Part, prints: Prints, sizes: Array) -> Growth:
    """The growth with batches and scales (t, 2) of a part's targets; those beside it stay in theirs."""
    batch, listed = growth.problem.prints.batch.copy(), growth.problem.prints.listed
    print_scale = growth.network.print_scale.copy()
    batch[part.targets], print_scale[part.targets] = prints.batch, sizes
    held = np.ones(prints.count, dtype=np.bool_)
    return replace(
        growth,
        problem=replace(growth.problem, prints=replace(prints, batch=batch, listed=listed, held=held)),
        network=replace(growth.network, print_scale=print_scale),
    )


def dissolved(problem: BundleProblem, network: Network, options: BatchOptions) -> tuple[Prints, Array] | None:
    """The batches without those that are no further from the batch they were taken from than chance allows.

    Notes
    -----
    A single plate's scale is judged with the photographs held. What the whole network says of a batch's scale takes
    its drift into account: a wing that hangs at one door may seem to be of another size as a whole.
    """
    prints = problem.prints
    if not prints.found.any():
        return None
    scale = prints.expected + prints.off(network.print_scale)
    free = int(prints.free.sum())
    variances = np.zeros(PRINT_COUNT * prints.count)
    border = reduced_at(problem, network, BundleOptions().loss).factor.border_inverse()
    variances[prints.free] = np.diag(border)[len(border) - free :]
    sigma = np.sqrt(variances.reshape(-1, PRINT_COUNT))
    batch, main = prints.batch.copy(), int(np.where(prints.found, 0, prints.sizes).argmax())
    for number in np.flatnonzero(prints.found):
        off, doubt = np.abs(scale[number] - scale[main]), options.stranger_sigmas * (sigma[number] + sigma[main])
        if prints.sizes[number] and ((off < doubt) | (off < options.least_apart / 2.0)).all():
            batch[batch == number] = prints.listed[batch == number]
    if (batch == prints.batch).all():
        return None
    return replace(prints, batch=batch), scale[batch]
