"""Discovery: one file, one algorithm; duplicates are refused; private modules are left alone."""

import subprocess
import sys

import pytest

import bench
from bench.motion import Motion, motions
from bench.registry import discover, discover_objects, first_line

MODULE = '''"""A module."""
from bench.motion import Motion


class {cls}(Motion):
    """{cls}: does nothing.

    More words.
    """

    name = "{name}"

    def kinematics(self, t):
        raise ArithmeticError


ANSWER = 42
'''


@pytest.fixture
def package(tmp_path, monkeypatch):
    """Return a function that makes an importable package of modules, file name -> (class, registered name)."""

    def make(name, **modules):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "__init__.py").write_text('"""A package."""\n')
        for module, (cls, registered) in modules.items():
            (folder / f"{module}.py").write_text(MODULE.format(cls=cls, name=registered))
        monkeypatch.syspath_prepend(tmp_path)
        return name

    yield make
    for module in [m for m in sys.modules if m.startswith("madeup")]:
        del sys.modules[module]


def test_finds_classes_and_skips_private_modules(package):
    found = discover(package("madeup_a", one=("One", "one"), two=("Two", "two"), _three=("Three", "three")), Motion)
    assert sorted(found) == ["one", "two"]
    assert issubclass(found["one"], Motion)
    assert first_line(found["one"]) == "does nothing"


def test_refuses_duplicate_names(package):
    with pytest.raises(bench.BenchError, match="two definitions are named 'one'"):
        discover(package("madeup_b", one=("One", "one"), two=("Two", "one")), Motion)


def test_finds_objects(package):
    class Named(str):
        @property
        def name(self):
            return str(self)

    assert discover_objects(package("madeup_c", one=("One", "one")), Named) == {}


def test_every_motion_of_the_package_is_named_like_its_file():
    assert motions()
    for name, cls in motions().items():
        assert cls.__module__ == f"bench.motion.{name.replace('-', '_')}"


def test_unknown_solver_and_kind_list_the_valid_ones():
    with pytest.raises(bench.UnknownNameError, match=r"unknown kind .*'gyrofree'.*valid: attitude, damping, gyro-free"):
        bench.solver("gyrofree", "nine-accelerometer")
    with pytest.raises(bench.UnknownNameError, match=r"did you mean 'nine-accelerometer'.*six-accelerometer"):
        bench.solver("gyro-free", "nine-acelerometer")


def test_unknown_solver_option_lists_the_valid_ones():
    with pytest.raises(bench.InputError, match="nine-accelerometer has no option 'order'; options: integration"):
        bench.solver("gyro-free", "nine-accelerometer", order=4)


def test_modules_are_there_without_an_import_of_their_own():
    code = "import bench; print(bench.euler_angles.track.__name__, 'turntable' in dir(bench)); bench.nothing"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.stdout == "track True\n"
    assert "module 'bench' has no attribute 'nothing'" in run.stderr
