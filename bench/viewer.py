"""Looking at a recording: in the native viewer, or as a picture made without a display.

Pictures are made by the native viewer without a window, on the loopback interface
only, with a software Vulkan driver; the same recording gives the same bytes.
"""

import os
import socket
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from bench.errors import BenchError, InputError, OutputError, require_choice, require_integer, require_scalar
from bench.record.traces import TIMELINE

VULKAN_PACKAGES = "mesa-vulkan-drivers libvulkan1"
START_TIMEOUT = 30.0  # s
SAME_PICTURES = 3  # the viewer loads in the background: a picture counts when it no longer changes
SETTLE_TIMEOUT = 60.0  # s


def check_recording(path: str | Path) -> Path:
    """Return the path if it is a complete recording.

    Raises
    ------
    InputError
        If there is no such file, or it is not a recording, or is cut off.
    """
    from rerun.chunk import RrdReader

    path = Path(path)
    if not path.is_file():
        raise InputError(f"recording {str(path)!r} is not a file")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # a missing footer is only a warning to rerun
            found = RrdReader(str(path)).recordings()
    except (RuntimeError, Warning) as error:
        raise InputError(f"recording {str(path)!r} is not a complete .rrd file: {error}") from error
    if not found:
        raise InputError(f"recording {str(path)!r} holds no recording")
    return path


def has_display() -> bool:
    """Return whether windows can be opened here."""
    if sys.platform.startswith("linux"):
        return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return True


def open_recording(path: str | Path) -> None:
    """Open a recording in the native viewer and return at once.

    Raises
    ------
    InputError
        If the file is missing, not a recording, or cut off.
    BenchError
        If there is no display; the message says what to do instead.
    """
    path = check_recording(path)
    if not has_display():
        raise BenchError(
            f"there is no display (DISPLAY and WAYLAND_DISPLAY are not set), so the viewer cannot open {path}. "
            f"Either copy the file to a machine with a display and run: rerun {path.name}   "
            f"or make a picture here: strapbench view {path} --screenshot {path.stem}.png"
        )
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    command = [_binary(), str(path.resolve()), "--bind", "127.0.0.1", "--port", "auto"]
    subprocess.Popen(command, start_new_session=True, **quiet)  # type: ignore[call-overload]


def screenshot(
    path: str | Path,
    png: str | Path,
    *,
    at: float | None = None,
    size: tuple[int, int] = (1600, 1000),
    tab: str | None = None,
) -> Path:
    """Write a picture of a recording, without a display.

    Parameters
    ----------
    path : str or Path
        The recording.
    png : str or Path
        The picture.
    at : float, s, optional
        Where the time cursor stands; the default is the end.
    size : tuple of int
        Width and height, pixels, at least 200 each.
    tab : str, optional
        Name of the tab that is shown; the default is the first one.

    Raises
    ------
    InputError
        If the file is missing, not a recording, or cut off, or an option breaks a rule.
    UnknownNameError
        If there is no such tab; it lists the tabs.
    OutputError
        If the picture cannot be written.
    BenchError
        If no Vulkan driver is installed, or the viewer does not start or settle.
    """
    path, png = check_recording(path), Path(png)
    width, height = (require_integer(f"size[{k}]", v, minimum=200) for k, v in enumerate(size))
    if at is not None:
        at = require_scalar("at", at)
    if not png.absolute().parent.is_dir():
        raise OutputError(f"picture {str(png)!r} cannot be written: there is no such folder")
    with _headless_viewer(f"{width}x{height}") as client:
        client.open(str(path.resolve()))
        _wait_until_loaded(client)
        client.set_time(TIMELINE, duration=_end(client) if at is None else at, play_state="paused")
        if tab is not None:
            _select_tab(client, tab)
        picture = _settled(client)
    try:
        png.write_bytes(picture)
    except OSError as error:
        raise OutputError(f"picture {str(png)!r} cannot be written: {error}") from error
    return png


def _binary() -> str:
    import rerun_cli

    folder = Path(rerun_cli.__file__).parent
    return str(next(p for p in (folder / "rerun", folder / "rerun.exe") if p.exists()))


@contextmanager
def _headless_viewer(size: str) -> Iterator[Any]:
    """Start a viewer without a window; the client steers it."""
    from rerun.experimental import ViewerClient

    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        port = s.getsockname()[1]
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    environment.setdefault("XDG_RUNTIME_DIR", tempfile.gettempdir())
    environment["RUST_LOG"] = "error"
    command = [_binary(), "--headless", "--bind", "127.0.0.1", "--port", str(port), "--window-size", size]
    with tempfile.TemporaryFile() as said:
        viewer = subprocess.Popen(
            [*command, "--hide-welcome-screen"], env=environment, stdout=subprocess.DEVNULL, stderr=said
        )
        try:
            _wait_for_port(viewer, port)
            yield ViewerClient.connect(f"rerun+http://127.0.0.1:{port}/proxy")
        except ConnectionError as error:  # the port opens before the graphics adapter is tried
            with suppress(subprocess.TimeoutExpired):
                viewer.wait(2)  # it may still be saying why
            _stop(viewer)
            said.seek(0)
            raise _explain(said.read().decode(errors="replace")) from error
        finally:
            _stop(viewer)


def _stop(viewer: "subprocess.Popen[bytes]") -> None:
    viewer.terminate()
    try:
        viewer.wait(10)
    except subprocess.TimeoutExpired:
        viewer.kill()
        viewer.wait()


def _explain(said: str) -> BenchError:
    if "render context" in said or "adapter" in said:
        return BenchError(
            "a picture needs a Vulkan driver, and none is usable here; on Debian or Ubuntu: "
            f"apt-get install -y --no-install-recommends {VULKAN_PACKAGES}"
        )
    return BenchError(f"the viewer stopped: {said.strip()[:500] or 'it said nothing'}")


def _wait_for_port(viewer: "subprocess.Popen[bytes]", port: int) -> None:
    deadline = time.monotonic() + START_TIMEOUT
    while True:
        try:
            socket.create_connection(("127.0.0.1", port), 0.2).close()
            return
        except OSError:
            if viewer.poll() is not None:
                raise ConnectionError("the viewer stopped") from None
            if time.monotonic() > deadline:
                raise BenchError(f"the viewer did not start within {START_TIMEOUT:g} s") from None
            time.sleep(0.05)


def _wait_until_loaded(client: Any) -> None:
    deadline = time.monotonic() + SETTLE_TIMEOUT
    while time.monotonic() < deadline:
        state = client.get_state()
        if state.recordings and not state.loading and state.recordings[0].timelines:
            return
        time.sleep(0.05)
    raise BenchError(f"the viewer did not load the recording within {SETTLE_TIMEOUT:g} s")


def _end(client: Any) -> float:
    """Return the last time of the recording, s."""
    timelines = {t.name: t for t in client.get_state().recordings[0].timelines}
    return float(timelines[require_choice("timeline", TIMELINE, timelines)].end) * 1e-9


def _select_tab(client: Any, tab: str) -> None:
    blueprint = client.get_blueprint("recording").blueprint
    root = blueprint["/viewport"]["ViewportBlueprint"]["root_container"]
    tabs = blueprint[f"/container/{root}"]["ContainerBlueprint"]
    by_name = {_display_name(blueprint, content): content for content in tabs["contents"]}
    tabs["active_tab"] = by_name[require_choice("tab", tab, by_name)]
    client.set_blueprint(blueprint, "recording")


def _display_name(blueprint: dict[str, Any], content: str) -> str:
    parts = blueprint[f"/{content}"]
    return next(str(part["display_name"]) for part in parts.values() if "display_name" in part)


def _settled(client: Any) -> bytes:
    """Return the picture that came out the same several times in a row."""
    deadline, last, same = time.monotonic() + SETTLE_TIMEOUT, b"", 0
    while time.monotonic() < deadline:
        picture: bytes = client.take_screenshot()
        same = same + 1 if picture == last and not client.get_state().loading else 1
        if same >= SAME_PICTURES:
            return picture
        last = picture
        time.sleep(0.3)
    raise BenchError(f"the picture did not settle within {SETTLE_TIMEOUT:g} s")
