from dataclasses import replace

import numpy as np

from app.vision.centres import locate_dots
from app.vision.ink_noise import noise_factors, weigh_by_ink
from app.vision.inks import read_inks
from app.vision.measurement import SizedPatches
from app.vision.patches import Pyramid
from tests.vision.scenes import Shot, true_homographies


def test_brighter_inks_are_noisier_in_light(plates_shot: Shot) -> None:
    fits = SizedPatches.of(Pyramid.of(plates_shot.bgr, 1), true_homographies(plates_shot)).fit(0.7)
    inks = read_inks(fits.amplitudes)
    white, green = inks.digits == 2, inks.digits == 1
    factors = np.delete(noise_factors(fits), [0, 3, 5, 12, 15], axis=1)
    assert factors[white].min() > factors[green].max()
    dots = locate_dots(fits, inks, (640, 480))
    weighed = weigh_by_ink(fits, dots)
    ratio = (weighed.covariances_u2 / dots.covariances_u2)[..., 0, 0]
    means = (ratio * dots.measured).sum(axis=1) / dots.measured.sum(axis=1)
    np.testing.assert_allclose(means, 1.0)  # the plate's own noise is what the fit has found


def test_dots_alike_keep_their_variances(plates_shot: Shot) -> None:
    fits = SizedPatches.of(Pyramid.of(plates_shot.bgr, 1), true_homographies(plates_shot)).fit(0.7)
    alike = replace(fits, amplitudes=np.full_like(fits.amplitudes, 80.0))
    dots = locate_dots(alike, read_inks(fits.amplitudes), (640, 480))
    np.testing.assert_allclose(weigh_by_ink(alike, dots).covariances_u2, dots.covariances_u2)
