"""Runs what a Dockerfile says in a folder instead of a container: its COPY and RUN, then its commands."""

from __future__ import annotations

import os
import re
import shutil
import site
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from numba.core.caching import _CacheLocator

from app.compiled import _kept_in
from tests.containers.dockerfile import Stage, sent_to_engine

COMMAND_S = 300.0
# Where the Dockerfile works; each becomes a folder of the same name below the root.
FOLDERS = ("/src", "/wheels", "/opt/scattermark", "/data")
ACCOUNT = "10001"


@dataclass(frozen=True)
class Image:
    """A folder that takes the place of a container's root.

    Attributes
    ----------
    root, checkout : Path
    """

    root: Path
    checkout: Path

    def here(self, text: str) -> str:
        """Paths and the account of the image as they are in this place."""
        for folder in FOLDERS:
            text = re.sub(rf"(?<![\w./]){re.escape(folder)}(?![\w-])", str(self.root / folder[1:]), text)
        return re.sub(rf"\b{ACCOUNT}\b", str(os.getuid()), text)

    def build(self, stage: Stage) -> None:
        """Do what a stage says; what it copies from another stage is there already."""
        folder = self.root
        for instruction in stage.instructions:
            if instruction.name == "WORKDIR":
                folder = Path(self.here(instruction.text))
                folder.mkdir(parents=True, exist_ok=True)
            elif instruction.name == "COPY" and not instruction.text.startswith("--from"):
                self._copy(instruction.words, folder)
            elif instruction.name == "RUN":
                self.run(["sh", "-ec", self.here(instruction.text)], folder, _builder_environment())

    def run(self, command: list[str], folder: Path, environment: dict[str, str]) -> None:
        done = subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, text=True, timeout=COMMAND_S, check=False
        )
        assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"

    def environment(self, stage: Stage) -> dict[str, str]:
        """What a process of the image finds, and nothing of this one's but where the system's commands are."""
        found = {"PATH": "/usr/bin:/bin", "LANG": "C.UTF-8"}
        for name, value in stage.environment.items():
            found[name] = self.here(value.replace("$PATH", found["PATH"]))
        return found

    def lend_dependencies(self) -> None:
        """Let the image's Python see the packages of this one, after its own: a download would cost a minute.

        A path in a ``.pth`` file brings packages but not the ``.pth`` files beside them, so an editable checkout stays
        out of sight.
        """
        (own,) = (self.root / "opt/scattermark/lib").glob("python*/site-packages")
        (own / "lent.pth").write_text("\n".join(site.getsitepackages()) + "\n")

    def lend_compiled(self) -> None:
        """Let it find the kernels compiled, as this checkout has them: to compile them again would cost a minute, too.

        Numba knows a source by its folder, its time and its size.
        """
        (package,) = (self.root / "opt/scattermark/lib").glob("python*/site-packages/app")
        kept = _kept_in()
        assert kept is not None, "no folder can be written for compiled code"
        lent = package / "__pycache__" / kept.name
        shutil.copytree(kept, lent)
        for source in (self.checkout / "app").rglob("kernels/*.py"):
            copied = package / source.relative_to(self.checkout / "app")
            shutil.copystat(source, copied)
            ours, its = (lent / _CacheLocator.get_suitable_cache_subpath(str(path)) for path in (source, copied))
            if ours.exists():
                ours.rename(its)

    def _copy(self, words: list[str], folder: Path) -> None:
        *sources, target = words
        for source in sources:
            files = [self.checkout / source]
            if files[0].is_dir():
                files = [path for path in files[0].rglob("*") if path.is_file()]
            relatives = [path.relative_to(self.checkout) for path in files]
            sent = [relative for relative in relatives if sent_to_engine(self.checkout, relative)]
            assert sent, f"COPY {source}: .dockerignore keeps it from the engine"
            place = folder / target if len(words) > 2 or target == "." else None
            for relative in sent:
                below = relative.relative_to(Path(source)) if (self.checkout / source).is_dir() else None
                copied = (folder / target / below) if below else ((place or folder) / relative.name)
                copied.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(self.checkout / relative, copied)


def _builder_environment() -> dict[str, str]:
    """This Python as the image's, and a pip that asks no index."""
    return {
        "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
        "HOME": os.environ.get("HOME", "/"),
        "PIP_NO_DEPS": "1",
        "PIP_NO_INDEX": "1",
        "PIP_NO_BUILD_ISOLATION": "0",  # pip reads it the other way round: 0 means that nothing is fetched
        "PIP_DISABLE_PIP_VERSION_CHECK": "1",
        "PIP_ROOT_USER_ACTION": "ignore",
    }
