"""Readers of square tags: what is timed does read tags where there are some."""

from __future__ import annotations

import sys
from importlib.util import find_spec

import cv2
import numpy as np
import pytest

from benchmarks.peers import PeerMissing, open_peers

TAG_PX, BORDER_PX = 120, 60

needs_april_tag = pytest.mark.skipif(find_spec("pupil_apriltags") is None, reason="the extra bench is not installed")


@needs_april_tag
def test_each_peer_reads_a_tag_and_none_where_there_is_none() -> None:
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    tag = cv2.aruco.generateImageMarker(dictionary, 7, TAG_PX)
    picture = cv2.copyMakeBorder(tag, *[BORDER_PX] * 4, cv2.BORDER_CONSTANT, value=255)
    peers = open_peers()
    assert [peer.count_tags(picture) for peer in peers] == [1] * 4
    assert [peer.count_tags(np.full_like(picture, 255)) for peer in peers] == [0] * 4
    assert len({peer.name for peer in peers}) == 4


def test_a_missing_library_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pupil_apriltags", None)
    with pytest.raises(PeerMissing, match="leave --peers out"):
        open_peers()
