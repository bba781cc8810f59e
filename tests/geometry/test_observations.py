import json

import numpy as np
import pytest

from app.geometry.observations import Detection, TargetObservation, observation_from_json, observation_to_json
from app.geometry.plate_sigmas import PlateSigmas
from app.targets.layout import DOT_COUNT


def an_observation(code: int = 389) -> TargetObservation:
    rng = np.random.default_rng(8)
    roots = rng.normal(size=(DOT_COUNT, 2, 2))
    return TargetObservation(
        code=code,
        centres_px=rng.uniform(0.0, 1000.0, (DOT_COUNT, 2)),
        covariances_px2=roots @ roots.transpose(0, 2, 1),
        measured=rng.random(DOT_COUNT) < 0.7,
        corrected=1,
        erased=2,
        rms_px=float(rng.random()),
        plate_sigmas=PlateSigmas(1.6, 1.3, 0.8),
    )


def test_json_keeps_every_bit() -> None:
    observation = an_observation()
    copy = observation_from_json(json.loads(json.dumps(observation_to_json(observation))))
    for name in ("centres_px", "covariances_px2", "measured"):
        written, read = getattr(observation, name), getattr(copy, name)
        np.testing.assert_array_equal(read, written)
        assert read.dtype == written.dtype
    for name in ("code", "corrected", "erased", "rms_px", "plate_sigmas"):
        assert getattr(copy, name) == getattr(observation, name)


def test_centre_is_the_middle_of_the_dots() -> None:
    observation = an_observation()
    np.testing.assert_allclose(observation.centre_px, observation.centres_px.sum(axis=0) / DOT_COUNT)


@pytest.mark.parametrize(
    ("centres_px", "covariances_px2", "measured", "complaint"),
    [
        (np.zeros((15, 2)), np.zeros((16, 2, 2)), np.ones(16, dtype=bool), "sixteen centres"),
        (np.zeros((16, 2)), np.zeros((16, 2)), np.ones(16, dtype=bool), "sixteen centres"),
        (np.zeros((16, 2)), np.zeros((16, 2, 2)), np.ones(16), "sixteen booleans"),
        (np.full((16, 2), np.inf), np.zeros((16, 2, 2)), np.ones(16, dtype=bool), "finite"),
    ],
)
def test_malformed_observations_are_refused(
    centres_px: np.ndarray, covariances_px2: np.ndarray, measured: np.ndarray, complaint: str
) -> None:
    with pytest.raises(ValueError, match=complaint):
        TargetObservation(389, centres_px, covariances_px2, measured)


def test_a_detection_names_each_code_once() -> None:
    assert len(Detection(640, 480, (an_observation(389), an_observation(778))).targets) == 2
    with pytest.raises(ValueError, match="stands once"):
        Detection(640, 480, (an_observation(), an_observation()))
