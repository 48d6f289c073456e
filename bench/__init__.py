"""strapbench: a test bench that tells the truth about strapdown navigation algorithms.

A prescribed motion goes through a MuJoCo rig to become what the sensors feel,
through error models to become what they report, through a solver to become an
estimate, and through an evaluation to become evidence::

    motion -> rig (MuJoCo) -> imu errors -> solver -> evaluation -> result -> record / report

Frames
    i inertial (MuJoCo's world), e Earth-fixed (i and e agree at t = 0), n navigation (east, north, up),
    b body (x right, y forward, z up). Superscript frame last: ``omega_ib_b`` is the
    rate of b relative to i, in b-components.
Attitude
    ``q_nb`` and ``C_nb`` take b-components to n-components. Quaternions are Hamilton,
    wxyz. Euler angles: yaw psi about z (anticlockwise, zero when body y points north),
    pitch P about x, roll R about y, ``C_nb = Rz(psi) Rx(P) Ry(R)``.
Earth
    Models are frozen (`WGS84`, others in ``bench.earth``). Navigation solvers are told a `NavigationInitial` and give a
    `Trajectory`; what they know of the Earth is the model that they are given. Gravitation is the attraction alone,
    gravity includes the centrifugal part.
Units
    SI and radians. Any other unit is in the name (``half_angle_deg``).
Arrays
    ``(n, k)``, time first, float64. Times are ``t0 + k / rate`` from integers.
Inputs of solvers
    `Readings` are instantaneous (rad/s, m/s^2); `Increments` are integrals over each
    sampling interval (rad, m/s). They are different inputs and never mixed.
Seeds
    One ``numpy.random.SeedSequence``; trial k alone or in a campaign has the same bits.
"""

from importlib import import_module
from pkgutil import iter_modules
from typing import TYPE_CHECKING, Any

from bench.earth import WGS84, Earth
from bench.errors import (
    AccuracyError,
    BenchError,
    InputError,
    ObservabilityError,
    OutputError,
    UnknownNameError,
)
from bench.motion import Motion
from bench.signals import Accelerometers, GyroFreeSolution, Increments, Initial, Kinematics, Readings
from bench.trajectory import NavigationErrors, NavigationInitial, Trajectory, navigation_errors

if TYPE_CHECKING:
    from bench.rig import Rig
    from bench.runner import run
    from bench.solvers import solver

__version__ = "0.1.0"

# Imported when first used, because they need more than numpy: `import bench` stays fast.
_LAZY = {"Rig": "bench.rig", "solver": "bench.solvers", "run": "bench.runner"}
_MODULES = tuple(module.name for module in iter_modules(__path__) if not module.name.startswith("_"))

__all__ = [
    "WGS84",
    "Accelerometers",
    "AccuracyError",
    "BenchError",
    "Earth",
    "GyroFreeSolution",
    "Increments",
    "Initial",
    "InputError",
    "Kinematics",
    "Motion",
    "NavigationErrors",
    "NavigationInitial",
    "ObservabilityError",
    "OutputError",
    "Readings",
    "Rig",
    "Trajectory",
    "UnknownNameError",
    "navigation_errors",
    "run",
    "solver",
]


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        return getattr(import_module(_LAZY[name]), name)
    if name in _MODULES:
        return import_module(f"bench.{name}")
    raise AttributeError(f"module 'bench' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*__all__, *_MODULES})
