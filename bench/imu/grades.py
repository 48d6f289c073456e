"""Published sensor grades: classes of instruments from data sheets, and the sensors of the five papers.

A grade says which of its numbers its source states and what had to be assumed; an error that
the source does not give is left out, not guessed, unless it is listed as assumed.
"""

import math
from dataclasses import dataclass

from bench.errors import require_choice
from bench.imu import SensorErrors
from bench.imu.gauss_markov import ALLAN_PEAK, GaussMarkov
from bench.imu.misalignment import Misalignment
from bench.imu.quantisation import Quantisation
from bench.imu.saturation import Saturation
from bench.imu.scale_factor import ScaleFactor
from bench.imu.turn_on_bias import TurnOnBias
from bench.imu.white_noise import WhiteNoise
from bench.references import ADIS16495, HG1700, HG9900, LYU, QIN, WANG, XU, ZHAO, Source
from bench.registry import discover_objects
from bench.units import (
    ARCSEC,
    DEG,
    DEG_PER_H,
    DEG_PER_S,
    DEG_PER_SQRT_H,
    FOOT,
    M_PER_S_PER_SQRT_H,
    MICRO_G,
    MILLI_G,
    PPM,
    STANDARD_GRAVITY,
)


@dataclass(frozen=True)
class Grade:
    """The errors of one published set of sensors.

    Attributes
    ----------
    name, summary : str
    gyro, accelerometer : SensorErrors
        Per gyro, and per triad or single-axis array; no models = a perfect sensor, or none.
    source : Source
    stated : tuple of str
        The numbers taken from the source, in its own units.
    assumed : tuple of str
        What the source does not give, and what was done about it.
    """

    name: str
    summary: str
    gyro: SensorErrors
    accelerometer: SensorErrors
    source: Source
    stated: tuple[str, ...]
    assumed: tuple[str, ...] = ()


def grades() -> dict[str, Grade]:
    """Return all grades, by name."""
    return discover_objects("bench.imu", Grade)


def grade(name: str) -> Grade:
    """Return a grade by name.

    Raises
    ------
    UnknownNameError
        If there is none of that name; it lists the names.
    """
    return grades()[require_choice("sensor grade", name, grades())]


NAVIGATION = Grade(
    name="navigation",
    summary="ring laser gyros and quartz accelerometers of an aircraft's inertial reference (Honeywell HG9900)",
    gyro=SensorErrors(
        (ScaleFactor(std=5 * PPM), TurnOnBias(std=0.0035 * DEG_PER_H), WhiteNoise(density=0.002 * DEG_PER_SQRT_H))
    ),
    accelerometer=SensorErrors((ScaleFactor(std=100 * PPM), TurnOnBias(std=25 * MICRO_G))),
    source=HG9900,
    stated=(
        "gyro: bias 0.0035 deg/h, angle random walk 0.002 deg/sqrt(h), scale factor 5 ppm (1 sigma)",
        "accelerometer: bias 25 micro-g, scale factor 100 ppm (1 sigma)",
    ),
    assumed=(
        "the numbers of the brochure were read in the documentation of NavToolkit, which quotes them",
        "velocity random walk, bias instability, misalignment, range, bandwidth: not given, left out",
    ),
)

TACTICAL = Grade(
    name="tactical",
    summary="ring laser gyros and vibrating beam accelerometers of a guided missile (Honeywell HG1700)",
    gyro=SensorErrors((TurnOnBias(std=1 * DEG_PER_H), WhiteNoise(density=0.125 * DEG_PER_SQRT_H))),
    accelerometer=SensorErrors((TurnOnBias(std=1 * MILLI_G), WhiteNoise(density=0.065 * FOOT * M_PER_S_PER_SQRT_H))),
    source=HG1700,
    stated=(
        "gyro: bias 1 deg/h (1 sigma), angle random walk 0.125 deg/sqrt(h) at most",
        "accelerometer: bias 1 mg (1 sigma), velocity random walk 0.065 (ft/s)/sqrt(h) at most",
    ),
    assumed=(
        "the numbers of the brochure were read in the documentation of NavToolkit, which quotes them",
        "scale factor, bias instability, misalignment, range, bandwidth: not given, left out",
    ),
)

INDUSTRIAL_MEMS = Grade(
    name="industrial-mems",
    summary="the best of calibrated silicon (Analog Devices ADIS16495-1)",
    gyro=SensorErrors(
        (
            Misalignment(std=0.05 * DEG),
            GaussMarkov(std=0.8 * DEG_PER_H / ALLAN_PEAK, tau=1000.0),
            WhiteNoise(density=0.09 * DEG_PER_SQRT_H),
            Saturation(limit=125 * DEG_PER_S),
        )
    ),
    accelerometer=SensorErrors(
        (
            GaussMarkov(std=3.2 * MICRO_G / ALLAN_PEAK, tau=1000.0),
            WhiteNoise(density=0.008 * M_PER_S_PER_SQRT_H),
            Saturation(limit=8 * STANDARD_GRAVITY),
        )
    ),
    source=ADIS16495.at("page 1"),
    stated=(
        "gyro: range 125 deg/s, in-run bias stability 0.8 deg/h, angle random walk 0.09 deg/sqrt(h), axis-to-axis "
        "misalignment 0.05 deg",
        "accelerometer: range 8 g, in-run bias stability 3.2 micro-g",
    ),
    assumed=(
        "in-run bias stability is the peak of a Gauss-Markov process' Allan deviation, correlation time 1000 s",
        "misalignment 0.05 deg is the standard deviation of each of the gyro's six angles; the accelerometer's is "
        "left out, so that the grade also serves single-axis arrays",
        "velocity random walk 0.008 (m/s)/sqrt(h): not on page 1, typical of the class",
        "turn-on bias, scale factor, g-sensitivity, bandwidth: not on page 1, left out",
    ),
)

XU_SENSORS = Grade(
    name="xu",
    summary="increments quantised to 1 arcsec, otherwise perfect",
    gyro=SensorErrors((Quantisation(quantum=1 * ARCSEC),)),
    accelerometer=SensorErrors(),
    source=XU,
    stated=("gyro: quantisation 1 arcsec",),
    assumed=("a pulse counter that carries its residue, zero at the start",),
)

WANG_SENSORS = Grade(
    name="wang",
    summary="perfect sensors",
    gyro=SensorErrors(),
    accelerometer=SensorErrors(),
    source=WANG,
    stated=(),
    assumed=("the simulation section is lost; algorithms are compared on perfect sensors",),
)

ZHAO_SENSORS = Grade(
    name="zhao",
    summary="constant drifts of a ship's inertial navigation system",
    gyro=SensorErrors((TurnOnBias(value=0.005 * DEG_PER_H),)),
    accelerometer=SensorErrors((TurnOnBias(value=5e-5 * STANDARD_GRAVITY),)),
    source=ZHAO.at("section 3"),
    stated=("gyro: constant drift 0.005 deg/h", "accelerometer: bias 5e-5 g"),
    assumed=("all signs are positive", "no noise: none is stated besides the filters' own Q"),
)

LYU_SENSORS = Grade(
    name="lyu",
    summary="the flexible gyros of the turntable test",
    gyro=SensorErrors((TurnOnBias(std=0.025 * DEG_PER_H), WhiteNoise(density=0.01 * DEG_PER_SQRT_H))),
    accelerometer=SensorErrors((TurnOnBias(std=0.1 * MILLI_G), WhiteNoise(density=0.05 * MILLI_G))),
    source=LYU,
    stated=(
        "gyro: random constant drift 0.025 deg/h, random noise 0.01 deg/sqrt(h)",
        "accelerometer: random constant bias 0.1 mg, random noise 0.05 mg/sqrt(Hz)",
    ),
    assumed=("the random constants are normal with these standard deviations",),
)

_QIN_BIAS = TurnOnBias(value=1.5e-5, random_sign=True)

QIN_VARIANCE = Grade(
    name="qin-variance",
    summary="accelerometers of the gyro-free system, 2e-10 read as the variance of a sample",
    gyro=SensorErrors(),
    accelerometer=SensorErrors((_QIN_BIAS, WhiteNoise(sample_std=math.sqrt(2e-10)))),
    source=QIN.at("section 2"),
    stated=("accelerometer: bias 1.5e-5 m/s^2, noise 'power spectral density (variance)' 2e-10 (m/s^2)^2",),
    assumed=("the sign of each bias is random", "2e-10 (m/s^2)^2 is the variance of each sample"),
)

QIN_DENSITY = Grade(
    name="qin-density",
    summary="accelerometers of the gyro-free system, 2e-10 read as a power spectral density",
    gyro=SensorErrors(),
    accelerometer=SensorErrors((_QIN_BIAS, WhiteNoise(density=math.sqrt(2e-10)))),
    source=QIN.at("section 2"),
    stated=QIN_VARIANCE.stated,
    assumed=("the sign of each bias is random", "2e-10 (m/s^2)^2/Hz is a two-sided density"),
)
