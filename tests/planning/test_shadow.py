import numpy as np
import pytest

from app.planning.shadow import ShadowedSurface
from app.planning.surfaces import PlainSurface, Samples

GREY = PlainSurface((128, 128, 128))


def shares(surface: ShadowedSurface, x_m: np.ndarray) -> np.ndarray:
    samples = Samples(x_m[None], np.zeros((1, len(x_m))), np.zeros((1, len(x_m), 2, 2)))
    return (surface.albedo(samples) / GREY.albedo(samples))[0, :, 0]


def test_light_falls_over_the_penumbra_to_its_share() -> None:
    surface = ShadowedSurface(GREY, (1.0, 0.0), edge_m=0.1, penumbra_m=0.02, share=0.25)
    x_m = np.array([-1.0, 0.09, 0.095, 0.1, 0.105, 0.11, 1.0])
    np.testing.assert_allclose(shares(surface, x_m), [1.0, 1.0, 0.8125, 0.625, 0.4375, 0.25, 0.25])
    assert surface.detail_m is None


@pytest.mark.parametrize(("penumbra_m", "share"), [(0.0, 0.5), (0.1, -0.1), (0.1, 1.1)])
def test_what_is_no_shadow_is_refused(penumbra_m: float, share: float) -> None:
    with pytest.raises(ValueError, match="penumbra"):
        ShadowedSurface(GREY, (1.0, 0.0), 0.0, penumbra_m, share)
