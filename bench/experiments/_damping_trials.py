"""What all parts of `damping-external-velocity` share: options, the ship, the filters, names of states and columns."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.earth import SPHERE
from bench.errors import Array, InputError, require_array, require_choice, require_flag, require_integer, require_scalar
from bench.motion.manoeuvres import Accelerate, Straight
from bench.motion.vehicle import Vehicle
from bench.solvers.damping import STATES, DampingModel
from bench.solvers.damping.bias_augmented import BiasAugmented
from bench.solvers.damping.double_filter import DoubleFilter
from bench.units import DEG

HOUR = 3600.0
STARTED, UNDER_WAY = 1000.0, 1100.0  # s: rest until, acceleration until
VELOCITY = (10.0, 8.0)  # m/s, east and north
SWAY = (1 * DEG, 2 * DEG, 5 * DEG)  # heading, pitch, roll
SWAY_RATE = (2 * np.pi / 12, 2 * np.pi / 8, 2 * np.pi / 10)  # rad/s
WINDOW = 4 * HOUR  # of Xbar
STEP = 300.0  # s, of which runs last a whole number
TRIALS_AN_ITEM = 5
EVERY = 120  # samples of the INS (s) from one kept row to the next
FREE, FIRST, SECOND, FUSION, AUGMENTED = "free INS", "filter 1", "filter 2", "fusion", "15 states"
FILTERS = (FIRST, SECOND, FUSION, AUGMENTED)
ERRORS = tuple(f"e_{name}" for name in STATES)
SIGMAS = tuple(f"s_{name}" for name in STATES)
WEIGHTS = tuple(f"w_{name}" for name in STATES[:13])
TEXTS = ("part", "case", "name", "label")
COLUMNS = (*TEXTS, "t_h", "reference_m_per_s", "value", "factor", "nees", "nis", "gamma", *ERRORS, *SIGMAS, *WEIGHTS)
Part = Literal["ins", "fast", "scan", "consistency", "undamped"]


@dataclass(frozen=True)
class Options:
    """Options of the experiment; the defaults are the conditions at which claims are judged.

    Attributes
    ----------
    duration : float
        Length of the run, h; a multiple of 300 s, as `undamped`.
    rate : float
        Rate of the inertial sensors, Hz.
    reference_errors : tuple of float
        Constant errors of the reference velocity, the same east and north, m/s, besides none; the figures show the
        middle one.
    latitude : float
        Where the ship lies at the start, deg, 5 to 70 north or south.
    tau : float
        Correlation time of the sensor errors in the filters, s.
    reference_noise : float
        White noise of the reference velocity, m/s for each value, one a second.
    signs : str
        13 signs of initial errors and sensor errors in the order of the error states: dv_E dv_N dL dlambda phi_E phi_N
        phi_U nabla_x nabla_y nabla_z eps_x eps_y eps_z; eps is minus the gyro's drift.
    mean : str
        Xbar of the fusion: "cumulative", or "window" of four hours.
    sway : bool
        Roll (5 deg, 10 s), pitch (2 deg, 8 s) and heading (1 deg, 12 s) of the ship in waves.
    latitudes : tuple of float
        Start latitudes over which the tables are scanned, deg.
    taus : tuple of float
        Correlation times over which the tables are scanned, s.
    trials : int
        Monte Carlo trials for the consistency of the filters.
    undamped : float
        Length of the undamped runs at rest, from which the periods are found, h.
    """

    duration: float = 24.0
    rate: float = 100.0
    reference_errors: tuple[float, ...] = (-0.1, -0.2, -0.3, -0.4, -0.5)
    latitude: float = 52.0
    tau: float = 3600.0
    reference_noise: float = 0.05
    signs: str = "++++-+--++-++"
    mean: str = "window"
    sway: bool = False
    latitudes: tuple[float, ...] = (40.0, 44.0, 48.0, 52.0, 56.0)
    taus: tuple[float, ...] = (1000.0, 3600.0, 10000.0)
    trials: int = 50
    undamped: float = 96.0

    def __post_init__(self) -> None:
        for name, least in (("duration", 0.5), ("undamped", 6.0), ("reference_noise", 0.0), ("tau", 200.0)):
            require_scalar(name, getattr(self, name), minimum=least)
            if (
                name in ("duration", "undamped")
                and abs((steps := getattr(self, name) * HOUR / STEP) - round(steps)) > 1e-6
            ):
                raise InputError(f"{name} must be a multiple of {STEP:g} s, got {getattr(self, name)} h")
        rate = require_scalar("rate", self.rate, minimum=2.0)
        if rate % 2:
            raise InputError(f"rate must be an even number of Hz, got {rate:g}")
        for name in ("reference_errors", "latitudes", "taus"):
            values = tuple(float(value) for value in require_array(name, getattr(self, name), (None,)))
            if not values or len(set(values)) < len(values):
                raise InputError(f"{name} must be different numbers, got {values}")
            object.__setattr__(self, name, values)
        if 0.0 in self.reference_errors:
            raise InputError(f"reference_errors must not be 0, which is run beside them, got {self.reference_errors}")
        for name, latitudes in (("latitude", (self.latitude,)), ("latitudes", self.latitudes)):
            for latitude in latitudes:
                if not 5 <= abs(require_scalar(name, latitude)) <= 70:  # Foucault's period; the levelled axes
                    raise InputError(f"{name} must be 5 to 70 deg north or south, got {latitude:g}")
        if min(self.taus) < 200:
            raise InputError(f"taus must be at least 200 s, got {self.taus}")
        require_choice("mean", self.mean, ("cumulative", "window"))
        require_flag("sway", self.sway)
        require_integer("trials", self.trials, minimum=2)
        if not isinstance(self.signs, str) or len(self.signs) != 13 or set(self.signs) - set("+-"):
            raise InputError(f"signs must be 13 characters + or -, got {self.signs!r}")

    @property
    def model(self) -> DampingModel:
        """What the filters believe."""
        return DampingModel.published(self.tau)

    @property
    def focus(self) -> float:
        """The reference error that figures and recording show."""
        return self.reference_errors[len(self.reference_errors) // 2]

    @property
    def initial(self) -> Array:
        """True errors at the start: the published ones with their signs, shape (13,)."""
        return DampingModel().initial_std * signed(self.signs)


@dataclass(frozen=True)
class Work:
    """One item: a part, and the index of its latitude (scan) or its first trial (consistency)."""

    options: Options
    seed: int
    part: Part
    index: int = 0


def signed(signs: str) -> Array:
    """Return +1 and -1 of a text of signs."""
    return np.array([1.0 if sign == "+" else -1.0 for sign in signs])


def place(latitude: float) -> str:
    """Return a latitude, deg, as text."""
    return f"{abs(latitude):g} deg {'N' if latitude > 0 else 'S'}"


def ship(options: Options, latitude: float | None = None) -> Vehicle:
    """Return the published motion: rest, acceleration, constant velocity, on a sphere."""
    speed, course = float(np.hypot(*VELOCITY)), float(np.arctan2(*VELOCITY))
    # Beyond the end, so that rounding of times does not matter.
    rest = max(options.duration * HOUR - UNDER_WAY, 1.0) + 10.0
    return Vehicle(
        segments=(Straight(STARTED), Accelerate(UNDER_WAY - STARTED, speed, 10.0), Straight(rest)),
        latitude=(options.latitude if latitude is None else latitude) * DEG,
        longitude=126 * DEG,
        height=0.0,
        speed=0.0,
        heading=course,
        follow=False,
        swing=SWAY if options.sway else (0.0, 0.0, 0.0),
        swing_frequency=SWAY_RATE,
        earth=SPHERE,
    )


def filters(options: Options, every: int = EVERY) -> tuple[DoubleFilter, BiasAugmented]:
    """Return the double filter (with filters 1 and 2 as its parts) and the one of 15 states."""
    double = DoubleFilter(model=options.model, covariance_every=every, mean=options.mean, window=WINDOW)
    return double, BiasAugmented(model=options.model, covariance_every=every)
