"""Looking at recordings: complete files only, clear errors, and pictures without a display."""

import sys
from pathlib import Path

import numpy as np
import pytest

from bench import viewer
from bench.errors import BenchError, InputError, OutputError, UnknownNameError
from bench.record.gyro_free import write_gyro_free_recording
from tests.recording_cases import make_gyro_free_run


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_gyro_free_recording(tmp_path_factory.mktemp("recording") / "run.rrd", make_gyro_free_run())


def test_only_complete_recordings_are_opened(recording: Path, tmp_path: Path) -> None:
    assert viewer.check_recording(recording) == recording
    whole = recording.read_bytes()
    for name, content in (
        ("cut", whole[:-1000]),
        ("half", whole[: len(whole) // 2]),
        ("text", b"hello"),
        ("empty", b""),
    ):
        path = tmp_path / f"{name}.rrd"
        path.write_bytes(content)
        with pytest.raises(InputError, match=rf"{name}\.rrd' is not a complete \.rrd file"):
            viewer.open_recording(path)
    with pytest.raises(InputError, match=r"none\.rrd' is not a file"):
        viewer.screenshot(tmp_path / "none.rrd", tmp_path / "x.png")


def test_without_a_display_it_says_what_to_do(recording: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(BenchError, match=r"no display.*rerun run\.rrd.*strapbench view .* --screenshot run\.png"):
        viewer.open_recording(recording)


def test_with_a_display_the_native_viewer_starts(recording: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[list[str]] = []
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(viewer.subprocess, "Popen", lambda command, **_: started.append(command))
    viewer.open_recording(recording)
    (command,) = started
    assert command[1] == str(recording)
    assert command[command.index("--bind") + 1] == "127.0.0.1"


def test_bad_screenshot_options(recording: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"size\[1\] must be an integer >= 200, got 10"):
        viewer.screenshot(recording, tmp_path / "x.png", size=(800, 10))
    with pytest.raises(InputError, match="at must be"):
        viewer.screenshot(recording, tmp_path / "x.png", at=float("nan"))
    with pytest.raises(OutputError, match="no such folder"):
        viewer.screenshot(recording, tmp_path / "no" / "x.png")


def test_without_a_vulkan_driver_it_names_the_package(
    recording: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for variable in ("VK_DRIVER_FILES", "VK_ICD_FILENAMES"):  # the loader looks nowhere else
        monkeypatch.setenv(variable, str(tmp_path / "none.json"))
    with pytest.raises(BenchError, match="mesa-vulkan-drivers"):
        viewer.screenshot(recording, tmp_path / "x.png")


@pytest.mark.slow
def test_screenshot(recording: Path, tmp_path: Path) -> None:
    from matplotlib import image

    try:
        scene = viewer.screenshot(recording, tmp_path / "scene.png", at=2.5, size=(900, 600))
    except BenchError as error:
        if "Vulkan" not in str(error):
            raise
        pytest.skip(f"no Vulkan driver: {error}")
    errors = viewer.screenshot(recording, tmp_path / "errors.png", size=(900, 600), tab="Errors")
    pictures = [image.imread(path)[:, :, :3] for path in (scene, errors)]
    for picture in pictures:
        assert picture.shape == (600, 900, 3)
        assert picture.std() > 0.02  # not one colour
    # The orange of the first estimate, (235, 137, 32), is drawn in both: lines and axes, within its shading.
    for picture in pictures:
        assert (np.abs(picture - np.array([235, 137, 32]) / 255).max(axis=2) < 0.1).sum() > 50
    assert np.abs(pictures[0] - pictures[1]).mean() > 0.01
    with pytest.raises(
        UnknownNameError, match="unknown tab 'Nonsense'; valid: Configuration, Errors, Errors by axis, Rate, "
    ):
        viewer.screenshot(recording, tmp_path / "x.png", tab="Nonsense")
