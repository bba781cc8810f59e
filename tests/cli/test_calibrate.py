"""A phone that the survey never saw is calibrated with a map file, and located with what was written."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from app.cli import main
from app.cli.camera_file import read_camera
from app.errors import InvalidInput
from app.geometry.map_file import MapFile, write_map
from app.targets.layout import DEFAULT_U_M
from benchmarks.calibration_scene import true_map
from benchmarks.new_phone import new_phone, photographs, room_scene, stations_of

PHONE = new_phone(960, 720)
PHOTOS = 6
SURE = 5.0  # standard deviations that no honest estimate is off


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("calibrate")
    for index, photo in enumerate(photographs(PHONE, stations_of(PHOTOS, seed=4), seed=4)):
        (place / f"photo{index}.jpg").write_bytes(photo.jpeg)
    write_map(place / "map.json", MapFile(true_map(room_scene(), DEFAULT_U_M)))
    return place


def test_the_camera_is_written_and_read_again(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    photos = [str(path) for path in sorted(folder.glob("*.jpg"))]
    out = folder / "camera.json"
    arguments = ["--map", str(folder / "map.json"), "--out", str(out), "--readout-s", "0.02", "--json"]
    assert main(["calibrate", *photos, *arguments]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record == json.loads(out.read_text())
    camera = read_camera(out)
    sigmas = np.sqrt(np.diag(camera.covariance))
    assert (np.abs(camera.camera.intrinsics - PHONE.camera.intrinsics) < SURE * sigmas).all()
    assert (camera.source, camera.readout.duration_s if camera.readout else None) == ("calibration", 0.02)
    main(["locate", photos[0], "--map", str(folder / "map.json"), "--camera", str(out), "--json"])
    (located,) = json.loads(capsys.readouterr().out)
    assert located["camera_source"] == "calibration"
    assert located["rolling_shutter"]["modelled"]


def test_too_few_photographs_are_refused_in_one_line(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    photos = [str(path) for path in sorted(folder.glob("*.jpg"))[:3]]
    assert main(["calibrate", *photos, "--map", str(folder / "map.json")]) == 1
    told = capsys.readouterr().err.splitlines()[-1]
    assert told.startswith("scattermark calibrate: 3 photographs")


@pytest.mark.parametrize(
    "text", ["{}", "no JSON", '{"width_px": 10, "height_px": 10, "fx": -1, "fy": 1, "cx": 0, "cy": 0}']
)
def test_a_file_that_describes_no_camera_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "camera.json"
    path.write_text(text)
    with pytest.raises(InvalidInput, match="describes no camera"):
        read_camera(path)
