"""Loops that are compiled (numba): when a module is imported, kept on disk, never while a photograph waits.

A kernel is a plain function over arrays, with its types given. Importing its module compiles it, or reads what was
compiled before. Processes that are forked from one that has imported it inherit it.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import tempfile
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

from llvmlite import binding
from numba import njit
from numba.core import config as numba_config

config: Any = numba_config  # its settings are made when it is imported, out of sight of a type checker

Function = TypeVar("Function", bound=Callable[..., Any])

APP_FOLDER = Path(__file__).parent
SOURCE_CACHE_FOLDER = APP_FOLDER / "__pycache__"
USER_CACHE_FOLDER = Path.home() / ".cache" if "HOME" in os.environ else Path(tempfile.gettempdir())
# Sums may be reordered, so that they run on vector registers; infinities and NaN stay what they are.
REORDERED = {"reassoc", "contract", "nsz", "arcp"}


def compiled(signature: str) -> Callable[[Function], Function]:
    """Compile a function of arrays and numbers for one signature, in numba's notation.

    Divisions by zero give infinities, as NumPy's do. Other types than the signature's raise TypeError: nothing is
    compiled later.
    """

    def compile_now(function: Function) -> Function:
        folder = _kept_in()
        before, config.CACHE_DIR = config.CACHE_DIR, "" if folder is None else str(folder)
        try:
            build = njit(signature, cache=folder is not None, error_model="numpy", fastmath=REORDERED)
            kernel = build(function)
        except RuntimeError as error:
            if not is_kept():
                raise
            note_lost()
            raise ImportError(f"{folder} has lost compiled loops: start again, which compiles them anew") from error
        finally:
            config.CACHE_DIR = before
        if is_kept():
            _forget_source(kernel)
        return cast(Function, kernel)

    return compile_now


def _forget_source(kernel: Any) -> None:
    """Let go of what numba would compile a kernel's callers from: of no use where all are kept, and 40 MB in all."""
    for compilation in kernel.overloads.values():
        compilation.library._shared_module = None


def can_be_kept() -> bool:
    """Whether there is a folder for compiled code; without one each process compiles for itself."""
    return _kept_in() is not None


def is_kept() -> bool:
    """Whether all kernels were compiled for this machine's processor, so that a start takes a second."""
    folder = _kept_in()
    return folder is not None and (folder / _complete()).exists()


def note_all_kept() -> None:
    """Say that every module with kernels was imported; what an older release kept beside the source goes."""
    folder = _kept_in()
    if folder is None:
        return
    folder.mkdir(parents=True, exist_ok=True)
    (folder / _complete()).touch()
    if folder.parent == SOURCE_CACHE_FOLDER:  # another folder may be shared with another installation
        for old in folder.parent.glob("kernels-*"):
            if old != folder:
                shutil.rmtree(old, ignore_errors=True)


def note_lost() -> None:
    """Say that not all is kept after all."""
    folder = _kept_in()
    if folder is not None:
        (folder / _complete()).unlink(missing_ok=True)


def _complete() -> str:
    return f"complete-{binding.get_host_cpu_name()}"


@cache
def _kept_in() -> Path | None:
    """Where compiled code is kept: beside the source, else in the user's cache; None when neither can be written.

    ``NUMBA_CACHE_DIR`` comes before both. The folder carries a digest of all kernels: numba looks at a kernel's own
    file, and not at those that it calls.
    """
    name = f"kernels-{_digest()}"
    if config.CACHE_DIR:
        return Path(config.CACHE_DIR) / name
    for parent in (SOURCE_CACHE_FOLDER, USER_CACHE_FOLDER / "scattermark"):
        with suppress(OSError):
            (parent / name).mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=parent / name).close()
            return parent / name
    return None


def _digest() -> str:
    """Of the sources of all kernels, of the layout that they know, and of how they are compiled."""
    digest = hashlib.sha256()
    for path in (Path(__file__), APP_FOLDER / "targets" / "layout.py", *sorted(APP_FOLDER.glob("*/kernels/*.py"))):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
