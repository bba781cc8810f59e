"""A worker's place: one process at a time, free the moment it dies."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

from app.jobs.slot import held_slot

HOLD = """
import sys, time
from pathlib import Path
from app.jobs.slot import held_slot
with held_slot(Path(sys.argv[1])) as slot:
    print(slot.key, flush=True)
    time.sleep(600)
"""


def test_places_are_taken_in_order_and_keep_their_keys(tmp_path: Path) -> None:
    with held_slot(tmp_path / "workers") as first:
        with held_slot(tmp_path / "workers") as second:
            assert first.name.endswith("/0")
            assert second.name.endswith("/1")
            assert first.key != second.key
        with held_slot(tmp_path / "workers") as again:
            assert again == second
    with held_slot(tmp_path / "elsewhere") as other:
        assert other.name == first.name
        assert other.key != first.key


def test_a_killed_process_frees_its_place(tmp_path: Path) -> None:
    holder = subprocess.Popen([sys.executable, "-c", HOLD, str(tmp_path)], stdout=subprocess.PIPE, text=True)
    assert holder.stdout is not None
    key = holder.stdout.readline().strip()
    with held_slot(tmp_path) as beside:
        assert beside.key != key
    os.kill(holder.pid, signal.SIGKILL)
    holder.communicate()
    with held_slot(tmp_path) as after:
        assert after.key == key
