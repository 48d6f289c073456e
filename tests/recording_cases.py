"""Recordings for tests: a run in closed form, and reading back with rerun's own reader."""

from pathlib import Path

import mujoco
import numpy as np
import pyarrow as pa
from rerun.chunk import RrdReader
from scipy.spatial.transform import Rotation

from bench.record.attitude import AttitudeEstimate, AttitudeRun
from bench.record.gyro_free import GyroFreeRun
from bench.signals import Accelerometers, GyroFreeSolution, Kinematics, Readings

MODELS = Path(__file__).parents[1] / "models"
RATE = 1000.0  # Hz
N = 5001  # more than one chunk of 4096 rows
FLOAT32 = 2e-7  # relative rounding of poses and arrows, with a margin


def wxyz(rotation: Rotation) -> np.ndarray:
    return np.roll(rotation.as_quat(), 1, axis=-1)


def rotation(q: np.ndarray) -> Rotation:
    return Rotation.from_quat(np.roll(q, -1, axis=-1))


def make_gyro_free_run(model: str = "nine_accelerometer", n: int = N) -> GyroFreeRun:
    """A circle of 10 m with a constant rate, and two estimates with known errors."""
    t = np.arange(n) / RATE
    zero, phase = np.zeros((n, 3)), 0.4 * t
    position = 10 * np.stack([np.cos(phase), np.sin(phase), 0 * t], axis=1)
    omega = np.tile([2.0, 1.0, -0.5], (n, 1))
    q = wxyz(Rotation.from_rotvec(omega * t[:, None]))
    truth = Kinematics(position, zero, -0.16 * position, q, omega, zero, np.array([0.0, 0.0, -9.8]))
    compiled = mujoco.MjModel.from_xml_path(str(MODELS / f"{model}.xml"))
    data = mujoco.MjData(compiled)
    mujoco.mj_forward(compiled, data)
    sites = compiled.sensor_objid[:-1]
    names = tuple(compiled.site(k).name for k in sites)
    array = Accelerometers(names, data.site_xpos[sites], data.site_xmat[sites].reshape(-1, 3, 3)[:, :, 2])
    rng = np.random.default_rng(3)
    readings = Readings(t, 10 * np.sin(t[:, None] + np.arange(len(names))) + rng.normal(size=(n, len(names))))
    estimates = {}
    for name, size in (("nine accelerometers", 1e-3), ("six/accelerometers", 1e-2)):
        error = size * t[:, None] * np.array([1.0, -2.0, 0.5])
        estimates[name] = GyroFreeSolution(
            omega + size * rng.normal(size=(n, 3)),
            zero,
            zero,
            wxyz(Rotation.from_rotvec(error) * rotation(q)),
            zero,
            position + 3 * error,
        )
    return GyroFreeRun(
        "a test",
        compiled,
        array,
        readings,
        truth,
        estimates,
        "# Configuration\n\nmade up",
        "# Results\n\nnone",
        {"seed": 3},
    )


def make_attitude_run(n: int = 2000, **options: object) -> AttitudeRun:
    """Coning of 5 degrees, 2 Hz, closed form, sampled at 1 kHz; three estimates with known errors in n.

    One updates every sample and drifts about z, one every third and swings about x and y, one every fourth is exact.
    """
    estimates = {}
    for name, samples, error in (
        ("drifts/slowly", 1, lambda t: 1e-4 * t[:, None] * [0.0, 0.0, 1.0]),
        ("swings", 3, lambda t: 1e-7 * np.stack([np.sin(12 * t), np.cos(12 * t), 0 * t], axis=1)),
        ("exact", 4, lambda t: np.zeros((len(t), 3))),
    ):
        t = np.arange(0, n + 1, samples) / RATE
        half, phase = np.radians(5.0) / 2, 4 * np.pi * t
        truth = np.stack([np.cos(half) + 0 * t, np.sin(half) * np.sin(phase), np.sin(half) * np.cos(phase), 0 * t], 1)
        estimates[name] = AttitudeEstimate(t, wxyz(Rotation.from_rotvec(error(t)) * rotation(truth)), truth)
    return AttitudeRun("coning", estimates, "# Configuration\n\nmade up", "# Results\n\nnone", {"seed": 3}, **options)


def column(path: Path, entity: str, component: str, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Times, ns, and values (n, width) of one component, sorted by time, as chunks come in any order."""
    times, values = [], []
    chunks = RrdReader(str(path)).stream().filter(content=entity, components=component, has_timeline="sim_time")
    for chunk in chunks:
        batch = chunk.to_record_batch()
        times.append(batch.column("sim_time").cast(pa.int64()).to_numpy())
        flat = batch.column(component)
        while pa.types.is_list(flat.type) or pa.types.is_fixed_size_list(flat.type):
            flat = flat.flatten()
        values.append(flat.to_numpy().reshape(len(batch), width))
    t, v = np.concatenate(times), np.concatenate(values)
    order = np.argsort(t)
    return t[order], v[order]


def entities(path: Path) -> set[str]:
    return {chunk.entity_path for chunk in RrdReader(str(path)).stream()}


def static_text(path: Path, entity: str) -> str:
    (chunk,) = RrdReader(str(path)).stream().filter(content=entity)
    return chunk.to_record_batch().column("TextDocument:text").to_pylist()[0][0]
