import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from app import compiled as subject
from app.compiled import compiled

KERNEL = """
from app.compiled import compiled

@compiled("float64(float64)")
def halved(value: float) -> float:
    return value / 2.0

print(halved(3.0), sum(halved.stats.cache_hits.values()), sum(halved.stats.cache_misses.values()))
"""


CALLER = """
from app.compiled import compiled, note_all_kept

@compiled("float64(float64)")
def halved(value: float) -> float:
    return value / 2.0

@compiled("float64(float64)")
def quartered(value: float) -> float:
    return halved(halved(value))

(library,) = (compilation.library for compilation in halved.overloads.values())
print(quartered(6.0), library._shared_module is None)
note_all_kept()
"""


def doubled(values: np.ndarray) -> float:
    return float(2.0 * values.sum())


def test_a_kernel_takes_its_signature_and_nothing_else() -> None:
    kernel = compiled("float64(float64[::1])")(doubled)
    assert kernel(np.ones(4)) == 8.0
    for other in (np.ones(4, dtype=np.float32), np.ones(8)[::2], np.ones((2, 2))):
        with pytest.raises(TypeError):
            kernel(other)


def test_compiled_code_is_read_by_the_next_process(tmp_path: Path) -> None:
    (tmp_path / "kernel.py").write_text(KERNEL)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": os.pathsep.join(sys.path)}
    for expected in ("1.5 0 1", "1.5 1 0"):
        run = subprocess.run(
            [sys.executable, tmp_path / "kernel.py"], env=environment, capture_output=True, text=True, check=True
        )
        assert run.stdout.strip() == expected


def test_what_callers_are_compiled_from_is_let_go_where_all_is_kept(tmp_path: Path) -> None:
    (tmp_path / "caller.py").write_text(CALLER)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": os.pathsep.join(sys.path)}

    def run() -> subprocess.CompletedProcess[str]:
        command = [sys.executable, tmp_path / "caller.py"]
        return subprocess.run(command, env=environment, capture_output=True, text=True, check=False)

    assert run().stdout.split() == ["1.5", "False"]
    assert run().stdout.split() == ["1.5", "True"]
    for lost in (tmp_path / "cache").rglob("*quartered*"):
        lost.unlink()
    assert "has lost compiled loops: start again" in run().stderr
    assert run().stdout.split() == ["1.5", "False"]


def test_where_nothing_can_be_written_kernels_are_compiled_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("no folder can be made below this")
    for name in ("SOURCE_CACHE_FOLDER", "USER_CACHE_FOLDER"):
        monkeypatch.setattr(subject, name, tmp_path / "file")
    monkeypatch.setattr(subject.config, "CACHE_DIR", "")
    monkeypatch.setattr(subject, "_kept_in", subject._kept_in.__wrapped__)
    monkeypatch.setattr(subject, "_digest", lambda: "0")
    assert subject._kept_in() is None
    assert compiled("float64(float64[::1])")(doubled)(np.ones(3)) == 6.0


def test_another_kernel_has_another_digest(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Numba looks at a kernel's own file, and not at those that it calls."""
    (tmp_path / "targets").mkdir()
    (tmp_path / "targets" / "layout.py").write_text("DOT_COUNT = 16")
    (tmp_path / "vision" / "kernels").mkdir(parents=True)
    monkeypatch.setattr(subject, "APP_FOLDER", tmp_path)
    digests = set()
    for source in ("a = 1", "a = 2"):
        (tmp_path / "vision" / "kernels" / "a.py").write_text(source)
        digests.add(subject._digest())
    assert len(digests) == 2
