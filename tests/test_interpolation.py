"""Trajectories at other times. Truth: a circle and a turn in closed form; rotations are scipy's."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bench.earth import WGS84
from bench.errors import InputError
from bench.interpolation import SAME_TIME, Comparison, sampled
from bench.trajectory import Trajectory

RADIUS, RATE = 6.4e6, 0.5  # m, rad/s
AXIS = np.array([0.6, 0.0, 0.8])


def circle(t: np.ndarray) -> Trajectory:
    """A circle round the centre of the Earth, with an attitude that swings by 1 rad about a fixed axis."""
    phase = RATE * t
    r_e = RADIUS * np.stack([np.cos(phase), np.sin(phase), 0.2 + 0 * t], axis=1)
    v_e = RADIUS * RATE * np.stack([-np.sin(phase), np.cos(phase), 0 * t], axis=1)
    q_eb = np.roll(Rotation.from_rotvec(np.sin(2 * t)[:, None] * AXIS).as_quat(), 1, axis=1)
    return Trajectory(WGS84, t, q_eb, v_e, r_e)


def angle(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    first, second = (Rotation.from_quat(np.roll(q, -1, axis=1)) for q in (a, b))
    return (first * second.inv()).magnitude()


def errors(step: float) -> np.ndarray:
    """Largest errors of r, v and attitude in the middle of the intervals, away from the ends."""
    own = circle(np.arange(0, 4 + step / 2, step))
    t = own.t[2:-2] + 0.5 * step
    found, true = sampled(own, t), circle(t)
    return np.array(
        [
            np.abs(found.r_e - true.r_e).max() / RADIUS,
            np.abs(found.v_e - true.v_e).max() / RADIUS,
            angle(found.q_eb, true.q_eb).max(),
        ]
    )


def test_the_error_goes_with_the_fourth_power_of_the_interval():
    coarse, fine = errors(0.1), errors(0.05)
    np.testing.assert_allclose(np.log2(coarse / fine), 4.0, atol=0.15)
    # 3/128 h^4 times the fourth derivative: of cos(0.5 t), 0.5 of it for v, and of sin(2 t).
    np.testing.assert_allclose(coarse, 3 / 128 * 0.1**4 * np.array([RATE**4, RATE**5, 2.0**4]), rtol=0.15)


def test_rows_that_match_keep_their_bits():
    own = circle(np.arange(0, 401) / 100)
    found = sampled(own, own.t[[0, 7, 400]] + [0.0, 0.5 * SAME_TIME, -0.5 * SAME_TIME])
    for name in ("q_eb", "v_e", "r_e"):
        np.testing.assert_array_equal(getattr(found, name), getattr(own, name)[[0, 7, 400]])


def test_the_sign_of_a_quaternion_does_not_matter():
    own = circle(np.arange(0, 41) / 10)
    flipped = Trajectory(WGS84, own.t, own.q_eb * np.where(np.arange(41) % 2, -1.0, 1.0)[:, None], own.v_e, own.r_e)
    t = np.array([0.03, 1.234, 3.99])
    assert angle(sampled(flipped, t).q_eb, sampled(own, t).q_eb).max() < 1e-15


@pytest.mark.parametrize(("rows", "order"), [(2, 2), (3, 3)])
def test_short_trajectories_use_the_rows_there_are(rows, order):
    def error(step):
        t = np.arange(rows) * step
        found, true = sampled(circle(t), [0.4 * step]), circle(np.array([0.4 * step]))
        return np.abs(found.v_e - true.v_e).max()

    assert np.log2(error(0.1) / error(0.05)) == pytest.approx(order, abs=0.2)


def test_times_outside_are_refused():
    own = circle(np.arange(0, 41) / 10)
    with pytest.raises(InputError, match=r"t must be within the trajectory, 0.0 to 4.0 s, got t\[1\] = 4.1"):
        sampled(own, [1.0, 4.1])


def test_a_comparison_is_made_at_the_references_rows():
    estimate = circle(np.arange(0, 401) / 100)
    shift = np.array([3.0, -2.0, 1.0])
    t = np.array([-1.0, 0.0, 0.5, 0.505, 3.995, 4.0, 4.5])
    true = circle(t)
    comparison = Comparison.of(estimate, Trajectory(WGS84, t, true.q_eb, true.v_e, true.r_e - shift))
    np.testing.assert_array_equal(comparison.errors.t, t[1:-1])
    assert comparison.matched == 3
    # Lengths do not depend on the frame; interpolation leaves 1e-10 of the radius.
    np.testing.assert_allclose(np.linalg.norm(comparison.errors.position, axis=1), np.linalg.norm(shift), atol=2e-3)
    matching = Comparison.of(estimate, comparison.reference, interpolate=False)
    np.testing.assert_array_equal(matching.errors.t, [0.0, 0.5, 4.0])
    assert matching.matched == 3


@pytest.mark.parametrize(("offset", "interpolate", "words"), [(100.0, True, "solution"), (0.003, False, "equal times")])
def test_nothing_in_common_is_refused(offset, interpolate, words):
    estimate = circle(np.arange(0, 401) / 100)
    with pytest.raises(InputError, match=f"reference must overlap the solution.*{words}.*scale of time"):
        Comparison.of(estimate, circle(np.array([1.0, 2.0]) + offset), interpolate=interpolate)
