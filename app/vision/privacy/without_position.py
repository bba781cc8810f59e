"""A photograph without any position on the Earth. One that holds none is returned as it came, bit by bit."""

from __future__ import annotations

from app.vision.heic_file import is_heic
from app.vision.privacy import heic, jpeg, png, webp

REWRITERS = (
    (jpeg.SIGNATURE, 0, jpeg.without_position),
    (png.SIGNATURE, 0, png.without_position),
    (webp.SIGNATURE, webp.SIGNATURE_AT, webp.without_position),
)


def without_position(data: bytes) -> bytes:
    """The same picture without position, place names and what may hide them.

    When a photograph holds a position, all of its metadata is left out but what the pixels' meaning and the survey
    need: colour profile, camera, lens, exposure, orientation, times. Maker's notes, serial numbers, owners, captions,
    previews and further pictures behind the first go with the position, for they may repeat it.

    Parameters
    ----------
    data : bytes
        A photograph whose header was read by ``app.vision.photo.read_header``.

    Returns
    -------
    bytes
        ``data`` itself when it holds no position. Applied once more, nothing changes.
    """
    if is_heic(data):
        return heic.without_position(data)
    for signature, at, rewritten in REWRITERS:
        if data[at : at + len(signature)] == signature:
            return rewritten(data)
    return data
