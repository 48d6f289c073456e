"""The dual-Euler INS: attitudes through both poles on the turning Earth, against the truth and the quaternion INS.

Truth: motions on the Earth in closed form; increments of MuJoCo.
"""

import math

import numpy as np
import pytest

import bench
from bench.euler_angles import track
from bench.evaluation import attitude_error
from bench.motion.earth_rest import EarthRest
from bench.motion.fast_vehicle import FastVehicle
from bench.solvers.navigation.dual_euler import DualEuler
from bench.solvers.navigation.navigation_frame import NavigationFrame
from bench.units import DEG
from tests.inertial_cases import flown, largest

# Pitch through both poles every 6 s, with yaw and roll, where the paper's turntable stood.
SWING = EarthRest(
    32.06 * DEG,
    118.8 * DEG,
    swing=(1.0, 130 * DEG, 0.8),
    swing_frequency=(2 * math.pi / 17, 2 * math.pi / 12, 2 * math.pi / 9),
    swing_phase=(0.3, 0.0, 1.0),
)
FAST = FastVehicle(
    7000.0, attitude=(0.5, 60 * DEG, 0.2), swing=(10 * DEG, 40 * DEG, 10 * DEG), swing_frequency=(2.0, 1.5, 1.2)
)


@pytest.mark.parametrize(("samples", "error"), [(2, 2e-8), (4, 1e-10)])
def test_attitude_through_both_poles(samples, error):
    """2 samples leave the error of the fitted rate, 4 the sixth order of 1 rad/s swings."""
    estimate = flown(SWING, 60.0, "dual-euler", samples=samples)
    attitude, velocity, position = largest(estimate, SWING)
    assert attitude.max() < error
    assert velocity.max() < 1e-5
    assert position.max() < 1e-3
    found = DualEuler(samples).angles(estimate)
    assert (np.diff(found.flag) != 0).sum() >= 16
    assert np.abs(found.forward - track(SWING.trajectory(estimate.t).q_nb).forward).max() < 1e-4  # near the poles


def test_it_is_the_quaternion_ins_but_for_the_attitude_algorithm():
    """The same increments: what differs is the third order of the rotation vector, 1e-8 rad at 1 rad/s."""
    dual, quaternion = (flown(SWING, 60.0, name, samples=2) for name in ("dual-euler", "navigation-frame"))
    assert np.linalg.norm(attitude_error(dual.q_eb, quaternion.q_eb), axis=1).max() < 5e-8
    assert np.abs(dual.v_e - quaternion.v_e).max() < 1e-5
    assert np.abs(dual.r_e - quaternion.r_e).max() < 1e-3


@pytest.mark.parametrize("azimuth", ["north", "wander"])
def test_the_turn_of_the_navigation_frame_is_subtracted_all_along_the_update(azimuth):
    """n turns by 1.2 mrad/s at 7 km/s: held in a body that turns by 1 rad/s that were 1 urad in every update."""
    options = {"samples": 4, "azimuth": azimuth}
    attitude, velocity, position = largest(flown(FAST, 20.0, "dual-euler", **options), FAST)
    reference = largest(flown(FAST, 20.0, "navigation-frame", **options), FAST)
    assert attitude.max() < 2e-9
    assert velocity.max() < 2 * reference[1].max() + 1e-6
    assert position.max() < 2 * reference[2].max() + 1e-5


def test_angles_are_against_north_whatever_the_azimuth():
    found = [
        DualEuler(4, azimuth=azimuth).angles(flown(FAST, 20.0, "dual-euler", samples=4, azimuth=azimuth)).active
        for azimuth in ("north", "wander")
    ]
    np.testing.assert_allclose(found[0], found[1], rtol=0, atol=1e-9)


def test_the_order_is_that_of_the_navigation_frame():
    for samples in (1, 2, 5):
        assert DualEuler(samples).order_periodic == NavigationFrame(samples).order_periodic


def test_bad_options_are_named():
    with pytest.raises(bench.UnknownNameError, match=r"unknown azimuth 'south'.*valid: north, wander"):
        DualEuler(azimuth="south")
    with pytest.raises(bench.InputError, match=r"hysteresis must be below pi/4 rad, got 0\.8"):
        DualEuler(hysteresis=0.8)
