"""A film for Chromium's fake camera, of photographs that are rendered already."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import cv2

FRAMES_PER_S = 4
HELD_FRAMES = 4  # each photograph stays for a second


def film(photographs: Iterable[Path], path: Path) -> Path:
    """Write a Y4M file (uncompressed: every frame is as good as the next) that the browser plays over and over."""
    with path.open("wb") as file:
        for photograph in photographs:
            picture = cv2.imread(str(photograph))
            assert picture is not None, photograph
            if file.tell() == 0:
                height, width = picture.shape[:2]
                file.write(f"YUV4MPEG2 W{width} H{height} F{FRAMES_PER_S}:1 Ip A1:1 C420jpeg\n".encode())
            file.write((b"FRAME\n" + cv2.cvtColor(picture, cv2.COLOR_BGR2YUV_I420).tobytes()) * HELD_FRAMES)
    return path


def fake_camera(path: Path) -> tuple[str, ...]:
    """Arguments that make Chromium's camera play a film."""
    return ("--use-fake-device-for-media-stream", f"--use-file-for-fake-video-capture={path}")
