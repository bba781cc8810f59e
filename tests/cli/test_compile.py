"""A first start compiles once, says so, and the next one finds what was kept."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from app.cli import compile_, main
from app.compiled import is_kept


def test_after_the_command_all_is_kept() -> None:
    assert main(["compile"]) == 0
    assert is_kept()


def test_what_is_kept_is_not_compiled_again(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(compile_, "COMMAND", "no-such-command")  # would fail
    compile_.compile_first()
    assert capsys.readouterr().err == ""


def test_a_machine_that_has_nothing_yet_is_told_and_a_failure_is_one(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.compiled.is_kept", lambda: False)
    monkeypatch.setattr(compile_, "COMMAND", "no-such-command")
    with pytest.raises(compile_.CannotCompile, match="did not compile"):
        compile_.compile_first()
    assert "once on this machine" in capsys.readouterr().err


def test_a_place_of_ones_own_is_looked_at(tmp_path: Path) -> None:
    code = "from app.compiled import is_kept, note_all_kept; print(is_kept()); note_all_kept(); print(is_kept())"
    (tmp_path / "kept").mkdir()
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "kept")}
    run = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["False", "True"]
