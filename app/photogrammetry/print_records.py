"""What the report says of the print batches: how large each one was printed, and whose bars should be measured."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from app.photogrammetry.prints import PRINT_COUNT
from app.photogrammetry.report import PrintBatchRecord, PrintRecord
from app.photogrammetry.survey_solution import Solution

Array = npt.NDArray[np.float64]

DOUBT_SIGMAS = 4.0  # further than this from what was measured, a bar was measured wrongly or the batch mixed up
CODES_TOLD = 12  # in a warning; the record holds them all
PERCENT = 100.0


def print_scales(solution: Solution) -> tuple[Array, Array]:
    """Printed over nominal length of each batch, shape (B, 2), and their variances; zero where a scale is held."""
    prints = solution.problem.prints
    scale = prints.expected + prints.off(solution.network.print_scale)
    variances = np.zeros(PRINT_COUNT * prints.count)
    free = int(prints.free.sum())
    variances[prints.free] = np.diag(solution.border_covariance)[len(solution.border_covariance) - free :]
    return scale, variances.reshape(-1, PRINT_COUNT)


def largest_print(solution: Solution) -> PrintRecord:
    """The print scale of the batch of most targets."""
    prints = solution.problem.prints
    scale, variances = print_scales(solution)
    largest = int(prints.sizes.argmax())
    return PrintRecord(scale[largest], np.sqrt(variances[largest]), bool(prints.held[largest]))


def batch_records(
    solution: Solution, codes: npt.NDArray[np.intp], names: Sequence[str]
) -> tuple[PrintBatchRecord, ...]:
    """All batches that targets of the network are of; codes of shape (T,), names of the listed batches."""
    prints = solution.problem.prints
    scale, variances = print_scales(solution)
    return tuple(
        PrintBatchRecord(
            "" if prints.found[batch] else names[batch],
            bool(prints.found[batch]),
            tuple(sorted(codes[prints.batch == batch].tolist())),
            scale[batch],
            np.sqrt(variances[batch]),
            bool(prints.held[batch]),
            None if prints.found[batch] or not names[batch] else prints.expected[batch],
            float(prints.sigma[batch]),
        )
        for batch in np.flatnonzero(prints.sizes).tolist()
    )


def batch_warnings(records: Sequence[PrintBatchRecord]) -> tuple[str, ...]:
    """Whose bars should be measured: of batches that nobody listed, and of those that are not as measured."""
    found = [_found(one) for one in records if one.found]
    doubted = [_doubted(one) for one in records if _is_doubted(one)]
    return (*found, *doubted)


def _found(record: PrintBatchRecord) -> str:
    return (
        f"{len(record.codes)} targets are printed at {_percent(record)} of their nominal size, unlike the others: "
        f"{_told(record.codes)}. If they are a batch of their own, measure the check bars of their sheets and enter "
        "the batch; the map takes them as they are."
    )


def _doubted(record: PrintBatchRecord) -> str:
    assert record.measured is not None
    x, y = PERCENT * record.measured
    return (
        f"The bars of print batch {record.name} were measured at {x:.2f} % by {y:.2f} % of their nominal length, and "
        f"the photographs show {_percent(record)}: measure them again, and check which sheets belong to the batch."
    )


def _is_doubted(record: PrintBatchRecord) -> bool:
    if record.measured is None:
        return False
    off = np.abs(record.scale - record.measured)
    return bool((off > DOUBT_SIGMAS * np.hypot(record.sigmas, record.measured_sigma)).any())


def _percent(record: PrintBatchRecord) -> str:
    axes = [
        f"{PERCENT * scale:.2f} ± {PERCENT * sigma:.2f} %"
        for scale, sigma in zip(record.scale, record.sigmas, strict=True)
    ]
    return " by ".join(axes)


def _told(codes: Sequence[int]) -> str:
    listed = ", ".join(str(code) for code in codes[:CODES_TOLD])
    return listed if len(codes) <= CODES_TOLD else f"{listed} and {len(codes) - CODES_TOLD} more"
