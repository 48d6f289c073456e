"""MJCF models: where they are, which sensors they carry and where, and the model that senses.

The model as written is what people look at. What senses is a bare copy: one free
body of unit mass and unit isotropic inertia that carries only the sensing sites, so
that the generalised force is the acceleration. Specific force does not depend on
the mass properties.
"""

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from bench.errors import Array, Indices, InputError, UnknownNameError
from bench.signals import Accelerometers

ACCELEROMETER, GYRO = mujoco.mjtSensor.mjSENS_ACCELEROMETER, mujoco.mjtSensor.mjSENS_GYRO
AXES = "xyz"


def models_dir() -> Path:
    """Return the folder of the models: inside the installed package, or beside it in a checkout."""
    package = Path(__file__).parent
    installed = package / "models"
    return installed if installed.is_dir() else package.parent / "models"


def model_names() -> list[str]:
    """Return the names of the models that come with the package."""
    return sorted(path.stem for path in models_dir().glob("*.xml"))


def model_summary(name: str) -> str:
    """Return the first sentence of the first comment of a model that comes with the package."""
    parser = ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
    root = ElementTree.parse(models_dir() / f"{name}.xml", parser).getroot()
    comment = next(node.text for node in root.iter() if node.tag is ElementTree.Comment)
    return " ".join((comment or "").split()).split(". ")[0].rstrip(".")


def compile_model(model: "str | Path | mujoco.MjSpec") -> mujoco.MjModel:
    """Compile a model given by its name in ``models/``, a path to an MJCF file, or an MjSpec.

    Raises
    ------
    UnknownNameError
        If there is neither such a model nor such a file.
    InputError
        If the MJCF does not parse or compile, or the argument is of another kind.
    """
    if isinstance(model, mujoco.MjSpec):
        spec, label = model.copy(), f"MjSpec {model.modelname!r}"
    elif isinstance(model, (str, Path)):
        path = _path(model)
        label = str(path)
        try:
            spec = mujoco.MjSpec.from_file(str(path))
        except (ValueError, OSError) as error:
            raise InputError(f"model {label!r} is not valid MJCF: {error}") from error
    else:
        raise InputError(f"model must be a name, a path to an MJCF file or an MjSpec, got {model!r}")
    try:
        return spec.compile()
    except ValueError as error:
        raise InputError(f"model {label!r} does not compile: {error}") from error


def _path(model: str | Path) -> Path:
    if isinstance(model, str) and model in model_names():
        return models_dir() / f"{model}.xml"
    if "<" in str(model):
        raise InputError("model must be a name or a path, got XML text: use mujoco.MjSpec.from_string")
    path = Path(model)
    try:
        if path.is_file():
            return path
    except OSError as error:  # a name that no file can have
        raise InputError(f"model {str(model)[:40]!r}... is not a file: {error.strerror}") from error
    if path.suffix or len(path.parts) > 1:
        raise InputError(f"model {str(model)!r} is not a file")
    raise UnknownNameError("model", str(model), model_names(), ", or a path to an MJCF file")


@dataclass(frozen=True)
class Instrument:
    """The sensors of a model: sensing sites in the body frame, and the channels they give.

    Attributes
    ----------
    body : str
        Name of the instrumented body.
    site_position, site_quat : ndarray, shape (s, 3), m, and (s, 4), wxyz
        One MuJoCo accelerometer each.
    columns : ndarray of int, shape (m,)
        Where each channel stands in the 3 s outputs of these accelerometers.
    accelerometers : Accelerometers
        The channels.
    has_gyro : bool
    """

    body: str
    site_position: Array
    site_quat: Array
    columns: Indices
    accelerometers: Accelerometers
    has_gyro: bool

    def remounted(self, accelerometers: Accelerometers) -> "Instrument":
        """Return the instrument with every channel at a given position and direction, a sensor of its own."""
        if not isinstance(accelerometers, Accelerometers):
            raise InputError(f"accelerometers must be bench.Accelerometers, got {accelerometers!r}")
        m = len(self.accelerometers)
        if len(accelerometers) != m:
            raise InputError(f"accelerometers must have {m} channels like the rig, got {len(accelerometers)}")
        quat = np.array([_quat_from_z_axis(d) for d in accelerometers.direction]).reshape(-1, 4)
        columns = 3 * np.arange(m) + 2
        return Instrument(self.body, accelerometers.position, quat, columns, accelerometers, self.has_gyro)


def instrument(model: mujoco.MjModel) -> Instrument:
    """Return the sensors of a compiled model.

    Raises
    ------
    InputError
        If there is no accelerometer and no gyro, more than one gyro, a ``user`` value other than 0 or 1, or the
        sites sit on several bodies or on the world.
    """
    sensors = [model.sensor(k) for k in range(model.nsensor)]
    accelerometers = [s for s in sensors if s.type[0] == ACCELEROMETER]
    gyros = [s for s in sensors if s.type[0] == GYRO]
    if not accelerometers and not gyros:
        raise InputError(f"model must have an <accelerometer> or a <gyro>, got {len(sensors)} other sensors")
    if len(gyros) > 1:
        names = ", ".join(s.name or "unnamed" for s in gyros)
        raise InputError(f"model must have at most one <gyro>, got {len(gyros)}: {names}")
    body = _common_body(model, [*accelerometers, *gyros])
    sites = np.array([s.objid[0] for s in accelerometers], dtype=np.intp)
    frames = np.array([_matrix(model.site_quat[k]) for k in sites]).reshape(-1, 3, 3)
    channel_names: list[str] = []
    columns: list[int] = []
    for k, sensor in enumerate(accelerometers):
        axes = (2,) if _is_single_axis(sensor) else (0, 1, 2)
        columns += [3 * k + axis for axis in axes]
        name = sensor.name or f"accelerometer {k + 1}"
        channel_names += [name] if len(axes) == 1 else [f"{name}_{AXES[axis]}" for axis in axes]
    channels = np.array(columns, dtype=np.intp)
    geometry = Accelerometers(
        tuple(channel_names), model.site_pos[sites[channels // 3]], frames[channels // 3, :, channels % 3]
    )
    return Instrument(body, model.site_pos[sites], model.site_quat[sites], channels, geometry, bool(gyros))


def _is_single_axis(sensor: mujoco.MjModel) -> bool:
    user = float(sensor.user[0]) if len(sensor.user) else 0.0
    if user not in (0.0, 1.0):
        raise InputError(f"user of accelerometer {sensor.name!r} must be 1 (single axis) or 0 (triad), got {user:g}")
    return user == 1.0


def _common_body(model: mujoco.MjModel, sensors: list[mujoco.MjModel]) -> str:
    bodies = sorted({int(model.site_bodyid[s.objid[0]]) for s in sensors})
    names = [model.body(k).name or f"body {k}" for k in bodies]
    if len(bodies) > 1:
        raise InputError(f"the sites of all sensors must sit on one body, got {', '.join(names)}")
    if bodies == [0]:
        raise InputError("the sites of the sensors must sit on a moving body, got the world")
    return names[0]


def sensing_model(sensors: Instrument) -> mujoco.MjModel:
    """Return the bare model that senses: one free body of unit mass and isotropic inertia at its frame's origin."""
    spec = mujoco.MjSpec()
    spec.option.disableflags = mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    body = spec.worldbody.add_body(name="b", mass=1.0, inertia=[1.0, 1.0, 1.0], explicitinertial=True)
    body.add_freejoint()
    sites = zip(sensors.site_position, sensors.site_quat, strict=True)
    for k, (position, quat) in enumerate(sites):
        body.add_site(name=f"a{k}", pos=position, quat=quat)
        spec.add_sensor(type=ACCELEROMETER, objtype=mujoco.mjtObj.mjOBJ_SITE, objname=f"a{k}")
    if sensors.has_gyro:  # at the origin and along the body's axes: all of a rigid body has one angular rate
        body.add_site(name="g")
        spec.add_sensor(type=GYRO, objtype=mujoco.mjtObj.mjOBJ_SITE, objname="g")
    return spec.compile()


def _matrix(quat: Array) -> Array:
    out = np.empty(9)
    mujoco.mju_quat2Mat(out, quat)
    return out.reshape(3, 3)


def _quat_from_z_axis(direction: Array) -> Array:
    out = np.empty(4)
    mujoco.mju_quatZ2Vec(out, direction)
    return out
