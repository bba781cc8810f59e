"""From the free network to the site: the similarity to control, the control points' own equations, one adjustment."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from app.errors import InvalidControlPoints
from app.geometry.camera import INTRINSIC_COUNT
from app.geometry.control import ControlPoint
from app.photogrammetry.bundle import Adjusted, BundleOptions, adjust_bundle
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.cleaning import CleanNetwork
from app.photogrammetry.control import MatchedPoints, StandingTargets, check_carries_datum, match_points
from app.photogrammetry.control_errors import ControlOptions, hidden_exchanges, judge_control
from app.photogrammetry.control_fit import PointPairs
from app.photogrammetry.covariance import point_covariance, reduced_at
from app.photogrammetry.datum import AssumedDatum, assume_datum
from app.photogrammetry.free_adjustment import held_photo
from app.photogrammetry.network import POSE_COUNT, Network
from app.photogrammetry.variance_components import ComponentOptions, Components, estimate_components

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class SiteOptions:
    """How the network is referred to the site.

    Attributes
    ----------
    control : ControlOptions
    components : ComponentOptions
    doubted_print : float
        Print scales further from 1 than this are warned of, and no longer believed in advance: five times the prior.
    possible_print : float
        Print scales further from 1 than this are no print's: the list's unit or the plates' module is wrong.
    """

    control: ControlOptions = field(default_factory=ControlOptions)
    components: ComponentOptions = field(default_factory=ComponentOptions)
    doubted_print: float = 0.01
    possible_print: float = 0.2


@dataclass(frozen=True)
class SiteNetwork:
    """An adjusted network in the frame ``site``.

    Attributes
    ----------
    problem : BundleProblem
        All equations, image weights scaled to what the residuals showed.
    adjusted : Adjusted
    components : Components
        Of the image coordinates: residuals over what the dots' covariances promise.
    control : MatchedPoints or None
        The control points that fix the datum.
    assumed : AssumedDatum or None
        What fixes it when there are none.
    warnings : tuple of str
    """

    problem: BundleProblem
    adjusted: Adjusted
    components: Components
    control: MatchedPoints | None
    assumed: AssumedDatum | None
    warnings: tuple[str, ...]


def redundancy(problem: BundleProblem) -> int:
    """Observations minus unknowns, weighted equations of cameras, print, poses and points counted as observations."""
    sightings = problem.sightings
    equations = 2 * int(sightings.measured.sum()) + INTRINSIC_COUNT * len(problem.cameras)
    equations += int(problem.prints.free.sum())
    for poses in (problem.photo_poses, problem.target_poses):
        equations += POSE_COUNT * (0 if poses is None else len(poses.index))
    equations += 3 * (0 if problem.points is None else len(problem.points))
    unknowns = POSE_COUNT * (sightings.photo_count + sightings.target_count) + int(problem.free_border.sum())
    return max(equations - unknowns, 1)


def refer_to_site(
    clean: CleanNetwork,
    points: Sequence[ControlPoint],
    standing: StandingTargets,
    options: SiteOptions,
    on_step: Callable[[], None],
) -> SiteNetwork:
    """Put a clean network in the site's frame and adjust it there.

    Parameters
    ----------
    clean : CleanNetwork
    points : sequence of ControlPoint
        With one of role ``control`` they fix the datum; without any it is assumed.
    standing : StandingTargets
    options : SiteOptions
    on_step : callable
        Called before each step of the adjustment; may raise to stop.

    Raises
    ------
    InvalidControlPoints
        When the control points cannot carry a datum or contradict the photographs.
    """
    bundle = BundleOptions()
    network = clean.adjusted.network
    components = estimate_components(
        clean.problem, network, reduced_at(clean.problem, network, bundle.loss), bundle.loss, options.components
    )
    problem = clean.problem.with_sightings(clean.problem.sightings.correlated(components.sigmas))
    if not any(point.role == "control" for point in points):
        assumed = assume_datum(network, standing.published)
        network = network.transformed(assumed.site_from_model)
        problem = replace(problem, photo_poses=held_photo(network, 0))
        adjusted = adjust_bundle(problem, network, bundle, on_step)
        return SiteNetwork(problem, adjusted, components, None, assumed, _assumed_warnings(assumed))
    control = match_points(points, "control", standing, problem.u_m)
    check_carries_datum(control)
    problem, network, warnings = _with_control(problem, network, control, options)
    if not match_points(points, "check", standing, problem.u_m).points:
        warnings += _hidden_warnings(network, control, options)
    adjusted = adjust_bundle(problem, network, bundle, on_step)
    return SiteNetwork(problem, adjusted, components, control, None, warnings)


def _with_control(
    problem: BundleProblem, network: Network, control: MatchedPoints, options: SiteOptions
) -> tuple[BundleProblem, Network, tuple[str, ...]]:
    """The problem with the control points' equations instead of a held photograph, and the network in the site."""
    equations, bundle = control.equations, BundleOptions()
    covariance = point_covariance(reduced_at(problem, network, bundle.loss), network, equations)
    pairs = PointPairs(equations.computed_m(network), covariance, equations.position_m, equations.sigma_m)
    _check_unit(pairs, options)
    fit, factor = judge_control(pairs, control.names, options.control)
    off = abs(fit.site_from_model.scale - 1.0)
    warnings: tuple[str, ...] = ()
    if factor > 1.0:
        warnings += (
            f"The control points agree with the photographs {factor:.1f} times worse than their sigmas say; they were "
            "weighted accordingly. Check how they were measured.",
        )
    if off > options.doubted_print:
        warnings += (
            f"The plates are printed at {100.0 * fit.site_from_model.scale:.1f} % of the size they should have: "
            "measure the bars of their sheets and enter them as a print batch, or give the site the module that was "
            "printed.",
        )
    prints = problem.prints.freed()
    problem = replace(
        problem,
        photo_poses=None,
        points=replace(equations, sigma_m=equations.sigma_m * factor),
        prints=prints if off <= options.doubted_print else prints.doubted(options.possible_print),
    )
    return problem, network.transformed(fit.site_from_model), warnings


def _check_unit(pairs: PointPairs, options: SiteOptions) -> None:
    """Refuse lists in another unit, or plates of another module: all distances are wrong by one factor."""
    first, second = np.triu_indices(len(pairs), 1)
    ratios = np.linalg.norm(pairs.site_m[first] - pairs.site_m[second], axis=1) / np.linalg.norm(
        pairs.model_m[first] - pairs.model_m[second], axis=1
    )
    ratio = float(np.median(ratios))
    alike = ratios.max() - ratios.min() < options.possible_print * ratio
    if alike and not 1.0 - options.possible_print < ratio < 1.0 + options.possible_print:
        raise InvalidControlPoints(
            f"The control points stand {ratio:.4g} times as far apart as the photographs show by the plates' nominal "
            "size: give coordinates in metres, and the site the module that was printed.",
            reason="scale",
            ratio=ratio,
        )


def _hidden_warnings(network: Network, control: MatchedPoints, options: SiteOptions) -> tuple[str, ...]:
    """Whether the layout maps onto itself, so that exchanged names would not show."""
    computed_m, sigma_m = control.equations.computed_m(network), control.equations.sigma_m
    exact = PointPairs(computed_m, np.zeros((computed_m.size, computed_m.size)), computed_m, sigma_m)
    found = hidden_exchanges(exact, control.names, options.control)
    if not found:
        return ()
    return (
        "The layout of the control points is symmetric, as a rectangle is after half a turn: the map would fit as well "
        f"with their names exchanged ({'; or '.join(found)}). Give a check point, or a control point off the symmetry.",
    )


def _assumed_warnings(assumed: AssumedDatum) -> tuple[str, ...]:
    scale = "No control points: the scale is taken from the plates' nominal size."
    upright = (
        "z is taken along the plates' upright edges, because all plates face one way."
        if assumed.from_edges
        else "z is taken along the axis most nearly in all plates' planes."
    )
    return scale, upright + " Origin and azimuth are arbitrary."
