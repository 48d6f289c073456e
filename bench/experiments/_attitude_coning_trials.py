"""The work of `attitude-coning`: options, one item per sampling rate, and the errors of all algorithms at it."""

from dataclasses import dataclass

from bench.campaign import Item
from bench.errors import Array, InputError, require_array, require_integer, require_scalar
from bench.experiments._attitude_trials import ALL, UPDATE, error_rows
from bench.motion.coning import Coning
from bench.table import Table

RATES = (100.0, 150.0, 210.0, 300.0, 450.0, 700.0, 1000.0, 1500.0, 2100.0, 3000.0, 4500.0, 7000.0, 10000.0)
DURATION = 60.0  # s, stated
MOTION = Coning()  # its defaults are the paper's


@dataclass(frozen=True)
class Options:
    """Options of the experiment; the defaults are the paper's conditions.

    Attributes
    ----------
    phases : int
        Phases of the quantiser over which quantised results are taken.
    duration : float
        Length of the run, s.
    rates : tuple of float
        Sampling rates, Hz.
    """

    phases: int = 20
    duration: float = DURATION
    rates: tuple[float, ...] = RATES

    def __post_init__(self) -> None:
        from bench.rig import whole_intervals

        require_integer("phases", self.phases, minimum=1)
        require_scalar("duration", self.duration, positive=True)
        rates = tuple(float(rate) for rate in require_array("rates", self.rates, (None,)))
        object.__setattr__(self, "rates", rates)
        for rate in rates:
            n = whole_intervals(require_scalar("rates", rate, positive=True), self.duration)
            if n % UPDATE:
                raise InputError(
                    f"duration must hold a multiple of {UPDATE} intervals (whole updates of 3 to 6 and 8 samples), "
                    f"got {n} at {rate:g} Hz"
                )
        if len(set(rates)) < len(rates):
            raise InputError(f"rates must differ, got {rates}")


@dataclass(frozen=True)
class Work:
    """All errors at one sampling rate."""

    options: Options
    seed: int
    rate: float


def items(options: Options, seed: int) -> list[Item]:
    """Cut the work by rate: the lowest first (it compiles), then from the highest down, so that no worker waits."""
    falling = sorted(options.rates, reverse=True)
    order = [falling[-1], *falling[:-1]]
    return [Item(f"rate-{rate:g}", Work(options, seed, rate)) for rate in order]


def ideal(rate: float, duration: float) -> Array:
    """Return the increments, by MuJoCo, shape (n, 3), rad."""
    from bench.rig import Rig

    dtheta = Rig.load("imu", threads=1).increments(MOTION, rate, duration).dtheta_b
    assert dtheta is not None  # the model has a gyro
    return dtheta


def measure(work: Work) -> Table:
    """Return the errors of all algorithms at one rate."""
    options = work.options
    return error_rows(MOTION, ideal(work.rate, options.duration), work.rate, ALL, work.seed, options.phases)
