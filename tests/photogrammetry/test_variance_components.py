"""Errors that the dots of a plate share: found in the residuals as large as they were put in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.geometry.plate_sigmas import PlateSigmas
from app.photogrammetry.bundle import BundleOptions, adjust_bundle
from app.photogrammetry.covariance import reduced_at
from app.photogrammetry.plate_correlation import PlateModes, plate_basis
from app.photogrammetry.sightings import Sightings
from app.photogrammetry.variance_components import ComponentOptions, Components, estimate_components
from tests.photogrammetry.survey_scene import build_room, ring_of_stations
from tests.photogrammetry.true_network import Truth, see

LOSS = BundleOptions().loss


def with_shared_errors(sightings: Sightings, sigmas: PlateSigmas, seed: int) -> Sightings:
    """Exact sightings with errors of these sizes, in units of their stated standard deviations."""
    rng = np.random.default_rng(seed)
    basis = plate_basis(sightings.whitening_per_px)
    dots = sigmas.dots * rng.normal(size=(len(sightings), 32, 1))
    modes = np.swapaxes(basis, -1, -2) @ dots
    drawn = sigmas.of_modes[:, None] * rng.normal(size=modes.shape)
    whitened = (dots + basis @ (drawn - modes)).reshape(-1, 16, 2, 1)
    colouring = np.zeros_like(sightings.whitening_per_px)
    colouring[sightings.measured] = np.linalg.inv(sightings.whitening_per_px[sightings.measured])
    return replace(sightings, dots_px=sightings.dots_px + (colouring @ whitened)[..., 0])


def components_of(truth: Truth, options: ComponentOptions = ComponentOptions()) -> Components:  # noqa: B008 (frozen)
    network = adjust_bundle(truth.problem, truth.network).network
    reduced = reduced_at(truth.problem, network, LOSS)
    return estimate_components(truth.problem, network, reduced, LOSS, options)


@pytest.mark.parametrize("sigmas", [PlateSigmas(1.0, 1.0, 1.0), PlateSigmas(2.0, 1.4, 0.8), PlateSigmas(0.5, 0.6, 0.5)])
def test_components_are_found_as_they_were_put_in(sigmas: PlateSigmas) -> None:
    exact = see(build_room(), ring_of_stations(24))
    found = []
    for seed in range(4):
        truth = replace(exact, sightings=with_shared_errors(exact.sightings, sigmas, seed))
        found.append(components_of(truth).sigmas)
    sightings = exact.sightings
    # A component of redundancy r is known to 1 / sqrt(2 r); four surveys, three of their standard errors. The unknowns
    # take about half of the shifts. Huber's loss takes a percent off errors that are as stated, more off greater ones.
    redundancies = np.array([2.0 * len(sightings) / 2.0, 4.0 * len(sightings) * 0.8, sightings.measured.sum() * 1.4])
    allowed = 3.0 / np.sqrt(2.0 * redundancies * 4.0) + 0.04
    for name, limit in zip(("shift", "linear", "dots"), allowed, strict=True):
        mean = np.mean([getattr(one, name) for one in found])
        assert mean == pytest.approx(getattr(sigmas, name), rel=limit), name


def test_too_little_redundancy_gives_one_component() -> None:
    exact = see(build_room(), ring_of_stations(12))
    sightings = with_shared_errors(exact.sightings, PlateSigmas(2.0, 1.0, 1.0), 1)
    found = components_of(replace(exact, sightings=sightings), ComponentOptions(fewest=2.0 * len(sightings)))
    assert found.sigmas.shift == found.sigmas.linear == found.sigmas.dots == pytest.approx(found.sigma0)


def test_decorrelated_rows_have_unit_covariance() -> None:
    sightings = see(build_room(4), ring_of_stations(4)).sightings
    sigmas = PlateSigmas(1.7, 1.3, 0.8)
    modes = PlateModes(plate_basis(sightings.whitening_per_px), sigmas)
    for row in range(3):
        basis = modes.basis[row]
        covariance = sigmas.dots**2 * (np.eye(32) - basis @ basis.T) + basis @ np.diag(sigmas.of_modes**2) @ basis.T
        one = PlateModes(modes.basis[[row]], sigmas)
        factor = np.linalg.cholesky(covariance).reshape(1, 16, 2, 32)
        white = one.decorrelate(factor).reshape(32, 32)
        np.testing.assert_allclose(white @ white.T, np.eye(32), atol=1e-12)
