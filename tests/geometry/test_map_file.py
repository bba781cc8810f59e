"""A map file gives back what was written, and says what is wrong with any other file."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from app.errors import InvalidInput
from app.geometry.camera import CalibratedCamera, Camera, CameraIdentity
from app.geometry.map_file import MapCamera, MapFile, map_to_json, read_map, write_map
from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.geometry.target_map import Datum, MappedTarget, TargetMap
from app.targets.layout import dots_target_m

ROUNDING = 1e-12  # a rotation travels as a quaternion; everything else is exact


def covariance(rng: np.random.Generator, size: int) -> np.ndarray:
    root = rng.normal(size=(size, size))
    return root @ root.T * 1e-6


def a_map(rng: np.random.Generator) -> MapFile:
    targets = []
    for code in (389, 16925):
        pose = Pose(exp_rotation(rng.normal(size=3)), rng.normal(size=3))
        targets.append(MappedTarget(code, pose, pose.apply(dots_target_m(0.014)), covariance(rng, 6), 7, 0.06))
    datum = Datum(rng.normal(size=3), covariance(rng, 7), assumed_scale=True)
    identity = CameraIdentity("Google", "Pixel 2", 1280, 720, 4.4, 26.0)
    intrinsics = np.array([921.6, 921.6, 643.1, 357.4, 0.074, -0.151, -0.0003, 0.0005, 0.036])
    calibrated = CalibratedCamera(Camera(1280, 720, intrinsics), covariance(rng, 9), "survey")
    return MapFile(TargetMap(tuple(targets), datum, "golay", 0.014), (MapCamera(identity, calibrated),))


def test_a_file_gives_back_what_was_written(tmp_path: Path) -> None:
    written = a_map(np.random.default_rng(1))
    write_map(tmp_path / "map.json", written)
    read = read_map(tmp_path / "map.json")
    assert (read.target_map.code_family, read.target_map.u_m) == ("golay", 0.014)
    for target, other in zip(written.target_map.targets, read.target_map.targets, strict=True):
        assert (target.code, target.rays, target.rms_px) == (other.code, other.rays, other.rms_px)
        np.testing.assert_array_equal(target.dots_m, other.dots_m)
        np.testing.assert_array_equal(target.covariance, other.covariance)
        np.testing.assert_allclose(target.site_from_target.rotation, other.site_from_target.rotation, atol=ROUNDING)
    np.testing.assert_array_equal(written.target_map.datum.covariance, read.target_map.datum.covariance)
    np.testing.assert_array_equal(written.target_map.datum.origin_m, read.target_map.datum.origin_m)
    assert read.target_map.datum.assumed_scale
    assert not read.target_map.datum.assumed_orientation
    camera, other_camera = written.cameras[0], read.cameras[0]
    assert camera.identity == other_camera.identity
    assert other_camera.calibrated.source == "survey"
    np.testing.assert_array_equal(camera.calibrated.camera.intrinsics, other_camera.calibrated.camera.intrinsics)
    np.testing.assert_array_equal(camera.calibrated.covariance, other_camera.calibrated.covariance)


def test_sigma_holds_the_target_and_the_datum() -> None:
    content = a_map(np.random.default_rng(2))
    target, datum = content.target_map.targets[0], content.target_map.datum
    record = map_to_json(content)["targets"][0]
    both = target.covariance[:3, :3] + datum.pose_covariance(target.site_from_target.position_m)[:3, :3]
    np.testing.assert_allclose(np.square(record["sigma_m"]), np.diag(both))


def test_a_failed_write_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "map.json"
    path.write_text("the old one")

    def full_disk(*_: object) -> None:
        raise OSError("no space left on device")

    monkeypatch.setattr(json, "dump", full_disk)
    with pytest.raises(OSError, match="no space"):
        write_map(path, a_map(np.random.default_rng(3)))
    assert [file.read_text() for file in tmp_path.iterdir()] == ["the old one"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "no JSON"),
        ("[]", "no target map"),
        ("{}", "'format'"),
        ('{"format": "ply"}', "its format is 'ply'"),
        ('{"format": "scattermark-map-1"}', "'datum'"),
    ],
)
def test_another_file_is_refused(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "map.json"
    path.write_text(text)
    with pytest.raises(InvalidInput, match=message):
        read_map(path)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match=r"absent\.json"):
        read_map(tmp_path / "absent.json")


def test_a_twisted_target_is_refused(tmp_path: Path) -> None:
    record = map_to_json(a_map(np.random.default_rng(4)))
    record["targets"][1]["code"] = record["targets"][0]["code"]
    path = tmp_path / "map.json"
    path.write_text(json.dumps(record))
    with pytest.raises(InvalidInput, match="one code stands once"):
        read_map(path)
