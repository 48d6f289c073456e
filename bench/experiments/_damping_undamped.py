"""The undamped INS: long runs at rest that show the Schuler, Foucault and 24 h oscillations, and their periods."""

import numpy as np

from bench.earth import SPHERE
from bench.errors import Array
from bench.experiments._damping_runs import free_ins, make_rows
from bench.experiments._damping_trials import ERRORS, FREE, HOUR, STEP, Options, Work
from bench.motion.earth_rest import EarthRest
from bench.table import Table
from bench.units import ARCMIN, DEG, DEG_PER_H

RATE = 0.5  # Hz; at rest increments are smooth
PERIODS = ("Schuler", "Foucault", "24 h")
VELOCITY_CASE, GYRO_CASE = "0.5 m/s north at the start", "east gyro drift 0.005 deg/h"
SPEED, DRIFT = 0.5, 0.005 * DEG_PER_H


def theory(options: Options) -> dict[str, float]:
    """Return the periods of theory, s: 2 pi sqrt(R/g), 2 pi/(omega sinL), 2 pi/omega."""
    L = options.latitude * DEG
    g = -float(SPHERE.gravity_n(np.array(L), np.array(0.0))[2])
    radius, _ = SPHERE.radii(np.array(L))
    return {
        "Schuler": 2 * np.pi * float(np.sqrt(radius / g)),
        "Foucault": 2 * np.pi / (SPHERE.rate * abs(np.sin(L))),
        "24 h": 2 * np.pi / SPHERE.rate,
    }


def measure_undamped(work: Work) -> Table:
    """Return the errors of two free runs at rest, and the periods found in them."""
    options = work.options
    motion = EarthRest(latitude=options.latitude * DEG, longitude=126 * DEG, earth=SPHERE)
    causes = {VELOCITY_CASE: (1, SPEED), GYRO_CASE: (10, -DRIFT)}
    tables, found = [], {}
    for case, (state, size) in causes.items():
        errors = np.zeros(13)
        errors[state] = size
        runs = list(free_ins(motion, RATE, options.undamped * HOUR, errors, work.seed, STEP))
        t = np.concatenate([part.ins.t for part in runs])
        found[case] = t, np.concatenate([part.errors for part in runs])
        values = {ERRORS[k]: found[case][1][:, k].copy() for k in range(13)}
        tables.append(make_rows(len(t), part=work.part, case=case, name=FREE, t_h=t / HOUR, **values))
    periods = find_periods(*found[VELOCITY_CASE], *found[GYRO_CASE], theory(options))
    tables.append(
        make_rows(
            len(periods),
            part=work.part,
            case="period",
            name=np.array(list(periods)),
            value=np.array(list(periods.values())),
        )
    )
    return Table.concatenate(tables)


def find_periods(t: Array, velocity: Array, t_gyro: Array, gyro: Array, near: dict[str, float]) -> dict[str, float]:
    """Return the periods, s, by least squares.

    An initial velocity makes products of a fast and a slow oscillation, Schuler's and Foucault's; a gyro drift adds
    the slow one of the Earth's turn to the latitude. Frequencies are searched round the theory's, +-30 %.

    Parameters
    ----------
    t, t_gyro : ndarray, shape (n,), s
    velocity, gyro : ndarray, shape (n, 13)
        True errors of the run with an initial velocity, and of that with a gyro drift.
    near : dict of str to float
        Periods to search around, s.
    """
    w = {name: 2 * np.pi / period for name, period in near.items()}

    def products(at: Array, schuler: float, foucault: float) -> list[Array]:
        sums = schuler + foucault, schuler - foucault
        return [wave(rate * at) for rate in sums for wave in (np.cos, np.sin)]

    def left(rates: Array) -> Array:
        basis = np.stack([*products(t, *rates), np.ones(len(t)), *_slow(t, w["24 h"])], axis=1)
        return _residual(basis, velocity[:, :2] / SPEED)

    schuler, foucault = _search(left, np.array([w["Schuler"], w["Foucault"]]))

    def left_slow(rates: Array) -> Array:
        waves = [*products(t_gyro, schuler, foucault), np.ones(len(t_gyro)), *_slow(t_gyro, rates[0])]
        return _residual(np.stack(waves, axis=1), gyro[:, 2:3] / ARCMIN)

    (earth,) = _search(left_slow, np.array([w["24 h"]]))
    return {name: 2 * np.pi / rate for name, rate in zip(PERIODS, (schuler, foucault, earth), strict=True)}


def _slow(t: Array, rate: float) -> list[Array]:
    return [np.cos(rate * t), np.sin(rate * t)]


def _residual(basis: Array, values: Array) -> Array:
    amplitudes, *_ = np.linalg.lstsq(basis, values, rcond=None)
    return np.asarray((values - basis @ amplitudes).ravel())


def _search(left, near: Array) -> Array:  # type: ignore[no-untyped-def]
    """Return the rates with the smallest residual: the best of a grid, refined."""
    from itertools import product

    from scipy.optimize import least_squares

    # Between starts a fast oscillation must not lose a turn over the run: the grid is finer for the first rate.
    grids = [rate * np.linspace(0.7, 1.3, 241 if k == 0 else 13) for k, rate in enumerate(near)]
    best = min(product(*grids), key=lambda rates: float(np.sum(left(np.array(rates)) ** 2)))
    return np.asarray(least_squares(left, best, x_scale=near * 1e-4, xtol=1e-14, ftol=1e-14).x)
