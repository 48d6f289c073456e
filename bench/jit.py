"""numba's njit, with a compilation cache that notices every change of the sources.

numba's own cache does not notice a change in a kernel imported from another file,
and tests would pass against stale code. The cache folder is therefore keyed by a
hash of the package's sources. Kernel modules import `njit` from here only.
"""

import hashlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba

F = TypeVar("F", bound=Callable[..., Any])


def _sources_digest() -> str:
    digest = hashlib.sha256()
    root = Path(__file__).parent
    for path in sorted(root.rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def cache_dir() -> Path:
    """Return the folder of compiled kernels: in the user's cache folder or, if not writable, a temporary one."""
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser())
    for parent in (
        base,
        Path(tempfile.gettempdir()) / f"strapbench-{os.getuid() if hasattr(os, 'getuid') else 'user'}",
    ):
        folder = parent / "strapbench" / f"numba-{_sources_digest()}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                return folder
        except OSError:
            continue
    return Path(tempfile.mkdtemp(prefix="strapbench-numba-"))


CACHE_DIR = Path(os.environ.get("NUMBA_CACHE_DIR") or cache_dir())
numba.config.CACHE_DIR = str(CACHE_DIR)  # read when a function is decorated


def njit(function: F) -> F:
    """Compile a kernel: cached, nopython, releasing the GIL, IEEE arithmetic (no fastmath)."""
    compiled: F = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    return compiled


def is_compiled() -> bool:
    """Return whether this version's kernels have been compiled on this machine before."""
    return CACHE_DIR.is_dir() and any(CACHE_DIR.rglob("*.nbi"))
