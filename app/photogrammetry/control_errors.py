"""Gross errors in control points: which point, left out, or which two, exchanged, would make the rest agree."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, permutations
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.errors import InvalidControlPoints
from app.photogrammetry.control import FEWEST_POINTS, is_one_line
from app.photogrammetry.control_fit import ControlFit, PointPairs, fit_control

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]


@dataclass(frozen=True)
class ControlOptions:
    """When control points count as wrong.

    Attributes
    ----------
    doubt : float
        Residuals that chance exceeds less often than this are not chance: one survey in ten thousand is refused for
        nothing, and a point off by 10 of its sigmas is noticed.
    gross_sigmas : float
        Residuals that are larger than stated by more than this factor, and that no single error explains, refuse the
        survey; below it the points are taken as less accurate than stated.
    least_gain : float
        Fall of chi-square by which an error must explain the residuals to be named: 5 standard deviations.
    most_suspects : int
        Points of the greatest residuals that are suspected of an error: the targets of a whole map may be control.
    most_permuted : int
        Points up to which all exchanges are tried for a hidden symmetry of the layout: 5 are 120.
    """

    doubt: float = 1e-4
    gross_sigmas: float = 5.0
    least_gain: float = 25.0
    most_suspects: int = 8
    most_permuted: int = 5


@dataclass(frozen=True)
class Suspicion:
    """An error that would explain the residuals.

    Attributes
    ----------
    kind : str
        ``mistyped``: one point's coordinates or dot; ``swapped``: two points exchanged.
    points : tuple of int
        Places in the list.
    fit : ControlFit
        Without the error.
    off_m : float
        By how much the point is off, or how far the two stand apart.
    """

    kind: Literal["mistyped", "swapped"]
    points: tuple[int, ...]
    fit: ControlFit
    off_m: float


def judge_control(pairs: PointPairs, names: tuple[str, ...], options: ControlOptions) -> tuple[ControlFit, float]:
    """The fit of all points, and the factor by which their sigmas are too small (1 when they are credible).

    Raises
    ------
    InvalidControlPoints
        Reason ``contradiction``; ``fields['suspects']`` names the points that explain it, when any do.
    """
    fit = fit_control(pairs)
    if fit.is_credible(options.doubt):
        return fit, 1.0
    suspicions = [
        found
        for found in _suspicions(pairs, _suspects(fit, options))
        if found.fit.is_credible(options.doubt) and fit.chi2 - found.fit.chi2 > options.least_gain
    ]
    factor = float(np.sqrt(fit.chi2 / fit.redundancy))
    if suspicions or factor > options.gross_sigmas:
        raise _contradiction(fit, names, sorted(suspicions, key=lambda found: found.fit.chi2))
    return fit, factor


def _suspects(fit: ControlFit, options: ControlOptions) -> list[int]:
    """Places of the points with the greatest residuals, ascending."""
    sizes_m = np.linalg.norm(fit.residuals_m, axis=1)
    return sorted(np.argsort(-sizes_m)[: options.most_suspects].tolist())


def _suspicions(pairs: PointPairs, suspects: list[int]) -> Iterator[Suspicion]:
    """Single errors of the suspects that leave enough points to judge by; with three points there are none."""
    every = np.arange(len(pairs))
    if len(pairs) <= FEWEST_POINTS:
        return
    for first, second in combinations(suspects, 2):
        order = every.copy()
        order[[first, second]] = second, first
        apart_m = float(np.linalg.norm(pairs.site_m[first] - pairs.site_m[second]))
        yield Suspicion("swapped", (first, second), fit_control(pairs.permuted(order)), apart_m)
    for point in suspects:
        rest = pairs.select(np.delete(every, point))
        if not is_one_line(rest.site_m, rest.sigma_m):
            without = fit_control(rest)
            place_m = without.site_from_model.apply(pairs.model_m[[point]])[0]
            off_m = float(np.linalg.norm(place_m - pairs.site_m[point]))
            yield Suspicion("mistyped", (point,), without, off_m)


def _contradiction(fit: ControlFit, names: tuple[str, ...], suspicions: list[Suspicion]) -> InvalidControlPoints:
    sizes_mm = 1e3 * np.linalg.norm(fit.residuals_m, axis=1)
    listed = ", ".join(f"{name} {size:.1f} mm" for name, size in zip(names, sizes_mm, strict=True))
    if suspicions:
        advice = " or ".join(_sentence(found, names) for found in suspicions) + ". Correct the list or leave them out."
    elif len(names) == FEWEST_POINTS:
        advice = "With three points the wrong one cannot be told: check all three, or add a fourth."
    else:
        advice = "No single wrong or exchanged point explains it: check all, their codes, dots and unit."
    return InvalidControlPoints(
        f"The control points contradict the photographs; residuals of the best fit: {listed}. {advice}",
        reason="contradiction",
        residuals_m={name: row.tolist() for name, row in zip(names, fit.residuals_m, strict=True)},
        suspects=[{"kind": found.kind, "points": [names[point] for point in found.points]} for found in suspicions],
    )


def _sentence(found: Suspicion, names: tuple[str, ...]) -> str:
    if found.kind == "swapped":
        return f"{names[found.points[0]]} and {names[found.points[1]]} seem to be exchanged"
    return f"{names[found.points[0]]} seems to be off by {1e3 * found.off_m:.1f} mm"


def hidden_exchanges(pairs: PointPairs, names: tuple[str, ...], options: ControlOptions) -> tuple[str, ...]:
    """Exchanges of control points that no residual would show, because the layout is symmetric, in words."""
    if len(pairs) > options.most_permuted:
        return ()
    found = []
    for order in permutations(range(len(pairs))):
        moved = [place for place, other in enumerate(order) if place != other]
        if moved and fit_control(pairs.permuted(np.array(order))).is_credible(options.doubt):
            found.append(", ".join(f"{names[place]} for {names[order[place]]}" for place in moved))
    return tuple(found)
