from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from app.geometry.observations import Detection
from app.storage.blobs import array_of_blob, blob_of_array, blob_of_detection, detection_of_blob
from tests.storage import examples


@given(arrays.arrays(np.float64, st.tuples(st.integers(0, 5), st.integers(0, 5))))
def test_arrays_come_back_to_the_last_bit(array: np.ndarray) -> None:
    back = array_of_blob(blob_of_array(array), *array.shape)
    assert back.tobytes() == np.ascontiguousarray(array).tobytes()


def test_a_transposed_array_keeps_its_order() -> None:
    array = np.arange(6.0).reshape(2, 3).T
    np.testing.assert_array_equal(array_of_blob(blob_of_array(array), 3, 2), array)


def test_another_shape_is_an_error() -> None:
    with pytest.raises(ValueError, match="reshape"):
        array_of_blob(blob_of_array(np.zeros(6)), 7)


@pytest.mark.parametrize("detection", [examples.detection(), Detection(640, 480, ())])
def test_detections_come_back_whole(detection: Detection) -> None:
    back = detection_of_blob(blob_of_detection(detection))
    assert (back.width_px, back.height_px) == (detection.width_px, detection.height_px)
    assert len(back.targets) == len(detection.targets)
    assert len(back.rejected) == len(detection.rejected)
    for mine, theirs in zip(back.targets + back.rejected, detection.targets + detection.rejected, strict=True):
        assert vars(mine).keys() == vars(theirs).keys()
        for name, value in vars(theirs).items():
            np.testing.assert_array_equal(getattr(mine, name), value)
