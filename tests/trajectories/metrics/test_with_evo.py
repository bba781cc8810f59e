"""The tool evo, run as a program on our TUM files, gives our numbers."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.trajectories.alignment import AlignmentKind, AlignmentOptions, align
from app.trajectories.association import AssociationOptions, Pairs, associate
from app.trajectories.metrics.absolute_pose_error import Part, absolute_pose_errors
from app.trajectories.metrics.pose_errors import pose_errors_of
from app.trajectories.metrics.relative_pose_error import Stretch, Unit, relative_pose_errors
from app.trajectories.metrics.summary import Summary, summarise
from app.trajectories.reading.tum import read_tum
from app.trajectories.robotics_formats import tum_text
from app.trajectories.trajectory import Array, Trajectory
from tests.trajectories.walks import noisy, walk

AGREEMENT = 1e-9
PARTS: dict[Part, str] = {"trans": "trans_part", "rot_deg": "angle_deg", "rot_rad": "angle_rad", "full": "full"}
UNITS: dict[Unit, str] = {"frames": "f", "metres": "m"}
NEAREST = AssociationOptions("nearest", max_gap_s=0.01)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A reference and an estimate in our TUM format."""
    folder = tmp_path_factory.mktemp("evo")
    reference = walk(30.0, 10.0)
    estimate = noisy(reference, 0.05)
    assert estimate.orientations_xyzw is not None
    shaken = estimate.orientations_xyzw + np.random.default_rng(8).normal(0.0, 0.01, estimate.orientations_xyzw.shape)
    shaken /= np.linalg.norm(shaken, axis=1, keepdims=True)
    astray = replace(estimate, orientations_xyzw=shaken).take(np.arange(0, len(estimate), 2))
    for name, trajectory in (("reference", reference), ("estimate", astray)):
        (folder / f"{name}.tum").write_text("".join(tum_text([trajectory])))
    return folder


def evo(program: str, files: Path, *arguments: str) -> tuple[dict[str, float], Array]:
    """Statistics and the single errors of one run of evo."""
    result = files / "result.zip"
    result.unlink(missing_ok=True)
    command = [Path(sys.executable).with_name(program), "tum", "reference.tum", "estimate.tum", *arguments]
    home = {**os.environ, "HOME": str(files), "MPLBACKEND": "agg"}  # evo writes its settings there
    run = subprocess.run(
        [*command, "--save_results", result], cwd=files, env=home, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    with zipfile.ZipFile(result) as archive:
        return json.loads(archive.read("stats.json")), np.load(archive.open("error_array.npy"))


def pairs_of(files: Path, alignment: AlignmentOptions) -> Pairs:
    reference, estimate = (_read(files / f"{name}.tum") for name in ("reference", "estimate"))
    pairs = associate(reference, estimate, NEAREST)
    return replace(pairs, estimate=align(pairs, alignment).apply(pairs.estimate))


def _read(path: Path) -> Trajectory:
    return read_tum(path.read_bytes()).trajectory


@pytest.mark.parametrize(
    ("part", "kind", "flags"),
    [
        ("trans", "se3", ["--align"]),
        ("full", "sim3", ["--align", "--correct_scale"]),
        ("rot_deg", "none", []),
        ("rot_rad", "origin", ["--align_origin"]),
    ],
)
def test_absolute_pose_errors(files: Path, part: Part, kind: AlignmentKind, flags: list[str]) -> None:
    statistics, errors = evo("evo_ape", files, "--pose_relation", PARTS[part], *flags)
    ours = absolute_pose_errors(pairs_of(files, AlignmentOptions(kind)), part)
    np.testing.assert_allclose(ours, errors, atol=AGREEMENT)
    assert_same(summarise(ours), statistics)


def assert_same(summary: Summary, statistics: dict[str, float]) -> None:
    """All that evo tells of a series."""
    told = {
        "rmse": summary.rms,
        "mean": summary.mean,
        "median": summary.median,
        "std": summary.std,
        "min": summary.least,
        "max": summary.greatest,
        "sse": summary.sum_of_squares,
    }
    assert told == pytest.approx(statistics, abs=AGREEMENT)


@pytest.mark.parametrize(
    ("part", "unit"), [("trans", "metres"), ("full", "frames"), ("rot_deg", "frames"), ("rot_rad", "metres")]
)
def test_relative_pose_errors(files: Path, part: Part, unit: Unit) -> None:
    arguments = "--pose_relation", PARTS[part], "--delta", "2", "--delta_unit", UNITS[unit]
    statistics, errors = evo("evo_rpe", files, *arguments, "--pairs_from_reference")
    ours = relative_pose_errors(pairs_of(files, AlignmentOptions()), part, Stretch(2.0, unit))
    np.testing.assert_allclose(ours.values, errors, atol=AGREEMENT)
    assert_same(summarise(ours.values), statistics)


def test_what_an_evaluation_tells_is_what_evo_tells(files: Path) -> None:
    found = pose_errors_of(pairs_of(files, AlignmentOptions()))
    arguments = "--pose_relation", "angle_deg", "--delta", "1", "--delta_unit", "m", "--pairs_from_reference"
    assert_same(found.relative["metres"]["rot_deg"], evo("evo_rpe", files, *arguments)[0])


def test_all_pairs_of_frames(files: Path) -> None:
    _, errors = evo("evo_rpe", files, "--delta", "5", "--delta_unit", "f", "--all_pairs")
    ours = relative_pose_errors(pairs_of(files, AlignmentOptions()), stretch=Stretch(5, "frames", all_pairs=True))
    np.testing.assert_allclose(ours.values, errors, atol=AGREEMENT)
