"""The tool evo, run as a program, reads our archives and shows our numbers."""

from __future__ import annotations

import io
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from app.services.evaluation_report.files import zip_report
from app.services.evaluation_report.material import ReportMaterial

SHOWN_DIGITS = 1e-5  # of evo's table


def evo_res(folder: Path, *files: Path) -> str:
    """What evo says of result files."""
    program = Path(sys.executable).with_name("evo_res")
    home = {**os.environ, "HOME": str(folder), "MPLBACKEND": "agg"}  # evo writes its settings there
    run = subprocess.run([program, *files], cwd=folder, env=home, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return run.stdout


def row(said: str, name: str) -> list[float]:
    """The numbers of a row of evo's table."""
    return [float(text) for text in next(line for line in said.splitlines() if line.startswith(name)).split()[1:]]


def test_evo_reads_one_and_several(material: ReportMaterial, single: ReportMaterial, tmp_path: Path) -> None:
    one = tmp_path / "one.zip"
    one.write_bytes(zip_report(single))
    with zipfile.ZipFile(io.BytesIO(zip_report(material))) as archive:
        archive.extractall(tmp_path)
    spatial = single.evaluations["UWB"].accuracy.spatial
    expected = {
        "rmse": spatial.rms,
        "mean": spatial.mean,
        "median": spatial.median,
        "std": spatial.std,
        "min": spatial.least,
        "max": spatial.greatest,
        "sse": spatial.sum_of_squares,
    }
    said = evo_res(tmp_path, one)
    titles = next(line for line in said.splitlines() if "rmse" in line).split()
    told = dict(zip(titles, row(said, "UWB"), strict=True))
    assert told == pytest.approx(expected, abs=SHOWN_DIGITS)
    both = evo_res(tmp_path, tmp_path / "evo" / "UWB.zip", tmp_path / "evo" / "ARKit.zip")
    shown = row(both, "UWB")  # its first columns: evo breaks wide tables
    assert shown == row(said, "UWB")[: len(shown)]
    assert row(both, "ARKit") != shown


def test_evo_reads_our_trajectories(single: ReportMaterial, tmp_path: Path) -> None:
    with zipfile.ZipFile(io.BytesIO(zip_report(single))) as archive:
        archive.extractall(tmp_path)
    program = Path(sys.executable).with_name("evo_ape")
    home = {**os.environ, "HOME": str(tmp_path), "MPLBACKEND": "agg"}
    command = [program, "tum", "reference.tum", "estimate.tum"]
    run = subprocess.run(command, cwd=tmp_path, env=home, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    (rmse,) = (line.split()[1] for line in run.stdout.splitlines() if line.split()[:1] == ["rmse"])
    assert float(rmse) == pytest.approx(single.evaluations["UWB"].accuracy.spatial.rms, abs=SHOWN_DIGITS)
