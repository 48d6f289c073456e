"""The rules of the architecture: who may import what, and how long a file may be."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FILES = sorted((ROOT / "bench").rglob("*.py"))
ONLY_HERE = {
    "mujoco": {"bench/rig.py", "bench/mjcf.py", "bench/turntable.py"},
    "rerun": {
        "bench/record/_attitude_scene.py",
        "bench/record/_navigation_scene.py",
        "bench/record/attitude.py",
        "bench/record/damping.py",
        "bench/record/dual_euler.py",
        "bench/record/gyro_free.py",
        "bench/record/instrument.py",
        "bench/record/layout.py",
        "bench/record/navigation.py",
        "bench/record/stream.py",
        "bench/viewer.py",
    },
    "matplotlib": {"bench/figures.py"},
    "rich": {"bench/progress.py"},
    "tyro": {"bench/_cli_types.py", "bench/cli.py", "bench/cli_recordings.py"},
    "numba": {"bench/jit.py"},
}


def imports(path):
    """Yield (top-level?, full module name) of every import in a file."""
    tree = ast.parse(path.read_text())
    top = set(tree.body)
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((node in top, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node in top, node.module
            yield from ((node in top, f"{node.module}.{alias.name}") for alias in node.names)


def name_of(path):
    return path.relative_to(ROOT).as_posix()


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_packages_are_imported_in_one_place(path):
    for _, module in imports(path):
        package = module.split(".")[0]
        assert name_of(path) in ONLY_HERE.get(package, {name_of(path)}), f"imports {module}"


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_files_are_short(path):
    assert len(path.read_text().splitlines()) <= 400


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_first_line_says_what_the_file_is_for(path):
    first = (ast.get_docstring(ast.parse(path.read_text())) or "").splitlines()[:1]
    assert first
    assert 15 < len(first[0]) <= 130


@pytest.mark.parametrize("path", [p for p in FILES if "solvers" in p.parts], ids=name_of)
def test_solvers_know_neither_the_rig_nor_the_motion(path):
    forbidden = ("mujoco", "rerun", "bench.rig", "bench.mjcf", "bench.motion", "bench.record", "bench.experiment")
    for _, module in imports(path):
        assert not module.startswith(forbidden), module


@pytest.mark.parametrize("folder", ["motion", "imu", "solvers", "experiments", "formats", "starts"])
def test_what_discovery_imports_needs_numpy_only(folder):
    """Discovered files must not slow the command line: at the top they import the standard library, numpy and bench."""
    for path in sorted((ROOT / "bench" / folder).rglob("[!_]*.py")):
        for top, module in imports(path):
            package = module.split(".")[0]
            allowed = package in sys.stdlib_module_names or package in ("numpy", "bench")
            assert not top or allowed, f"{name_of(path)} imports {module} at the top"


def test_import_of_bench_loads_nothing_slow():
    slow = ["mujoco", "rerun", "numba", "scipy", "matplotlib", "rich", "tyro", "pyarrow"]
    code = f"import sys, bench; print([m for m in {slow} if m in sys.modules])"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert result.stdout.strip() == "[]"


def test_import_of_the_viewer_loads_no_recorder():
    """Who looks at a recording, or only names a colour, does not pay for rerun."""
    slow = ["rerun", "mujoco", "pyarrow", "scipy", "matplotlib"]
    code = f"import sys, bench.viewer, bench.record.traces; print([m for m in {slow} if m in sys.modules])"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert result.stdout.strip() == "[]"


def test_public_names_exist():
    import bench

    for name in bench.__all__:
        assert getattr(bench, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = bench.nothing
