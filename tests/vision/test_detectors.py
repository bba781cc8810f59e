from typing import get_args

import numpy as np
import pytest

from app.errors import InvalidInput
from app.targets.family import CodeFamily
from app.vision.detector import DetectorOptions, detect
from app.vision.detectors import DETECTOR_NAMES, DetectorName, choose_detector
from app.vision.paper import detect_paper
from app.vision.reading import Strictness
from tests.vision.scenes import Shot, found


def test_each_name_is_a_detector_that_says_so() -> None:
    detectors = [choose_detector(name) for name in DETECTOR_NAMES]
    assert [detector.name for detector in detectors] == list(DETECTOR_NAMES) == list(get_args(DetectorName))
    assert len({detector.version for detector in detectors}) == len(detectors)


def test_the_names_stand_for_the_two_methods(plates_shot: Shot, family: CodeFamily) -> None:
    for name, expected in (
        ("default", detect(plates_shot.bgr, family)),
        ("paper", detect_paper(plates_shot.bgr, family)),
    ):
        detection = choose_detector(name).detect(plates_shot.bgr, family)
        assert found(detection).keys() == found(expected).keys()
        for code, target in found(detection).items():
            np.testing.assert_array_equal(target.centres_px, found(expected)[code].centres_px)


@pytest.mark.parametrize("strictness", get_args(Strictness))
def test_the_default_takes_strictness_and_known_codes(strictness: Strictness) -> None:
    detector = choose_detector("default", strictness, frozenset({389}))
    assert repr(DetectorOptions(strictness=strictness)) in repr(detector)
    assert repr(frozenset({389})) in repr(detector)


@pytest.mark.parametrize("strictness", ["normal", "eager"])
def test_the_published_method_cannot_be_told_to_mend(strictness: Strictness) -> None:
    assert choose_detector("paper", "strict") == choose_detector("paper")
    with pytest.raises(InvalidInput, match="mends no misread dot"):
        choose_detector("paper", strictness)


def test_an_unknown_name_is_told_the_known_ones() -> None:
    with pytest.raises(InvalidInput, match="default, paper"):
        choose_detector("newest")  # type: ignore[arg-type]
