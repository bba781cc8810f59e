"""The library example of docs/evaluation.md runs as it stands and prints the paper's figures."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def test_the_example_of_the_docs_runs(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    (block,) = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "evaluation.md").read_text(), re.DOTALL)
    monkeypatch.chdir(ROOT)
    exec(compile(block, "docs/evaluation.md", "exec"), {"__name__": "example"})
    told = capsys.readouterr().out
    assert "samsung-galaxy-s8-1: RMS 0.0847 m" in told
    assert "huawei-p10-1: RMS 0.0918 m" in told
    assert "neither is better beyond doubt" in told
