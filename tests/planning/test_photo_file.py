import cv2
import numpy as np
import pytest

from app.planning.imaging import Chroma, ImagingOptions
from app.planning.photo_file import encode_jpeg
from app.planning.survey_plan import phone_camera
from app.planning.synthetic import identity_of


@pytest.mark.parametrize(("chroma", "columns_lost", "rows_lost"), [("4:4:4", 0, 0), ("4:2:2", 1, 0), ("4:2:0", 1, 1)])
def test_files_keep_as_much_of_the_colour_as_they_say(chroma: Chroma, columns_lost: bool, rows_lost: bool) -> None:
    """Red and green of like brightness, alternating: what is halved along an axis averages them."""
    imaging = ImagingOptions(jpeg_quality=100, chroma=chroma, write_exif=False)
    for axis, lost in ((1, columns_lost), (0, rows_lost)):
        rgb = np.full((32, 32, 3), (200, 0, 0), dtype=np.uint8)
        odd = (slice(None), slice(1, None, 2)) if axis == 1 else (slice(1, None, 2),)
        rgb[odd] = (0, 102, 0)
        jpeg = encode_jpeg(rgb, imaging, identity_of(phone_camera(32, 32), imaging))
        red = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)[8:24, 8:24, 2]
        assert (np.ptp(red) < 60) == bool(lost)
