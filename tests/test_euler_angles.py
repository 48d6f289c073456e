"""Forward and reverse Euler angles: conversion laws over all attitudes, tracking through the poles, active errors.

Truth: the conversion formulas as printed, written out here with atan2 and asin; SciPy's Rotation; paths given by their
angles.
"""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import bench
from bench.euler_angles import (
    HYSTERESIS,
    angle_errors,
    forward_from_reverse,
    quat_from_reverse,
    reverse_from_forward,
    reverse_from_quat,
    track,
)
from bench.rotation import quat_from_euler, quat_from_rotvec, quat_multiply, wrap
from bench.units import DEG

ROUNDING = 2e-15  # rad: a few units in the last place of pi
ANGLE = st.floats(-math.pi, math.pi)
MIDDLE = st.floats(-math.pi / 2, math.pi / 2)


def turn(q, p):
    """Angle between attitudes, rad, also where it is tiny."""
    q, p = np.broadcast_arrays(q, p)
    nearer = np.minimum(np.linalg.norm(q - p, axis=-1), np.linalg.norm(q + p, axis=-1))
    return 2 * nearer


def printed_reverse(psi, P, R):
    """Equation 21 as the convention of this project has it."""
    sP, cP, sR, cR, s, c = np.sin(P), np.cos(P), np.sin(R), np.cos(R), np.sin(psi), np.cos(psi)
    return np.arctan2(s * cR + c * sP * sR, c * cR - s * sP * sR), np.arctan2(sP, cP * cR), np.arcsin(cP * sR)


def printed_forward(psi_r, P_r, R_r):
    """Equation 22 as the convention of this project has it."""
    sP, cP, sR, cR, s, c = np.sin(P_r), np.cos(P_r), np.sin(R_r), np.cos(R_r), np.sin(psi_r), np.cos(psi_r)
    return np.arctan2(s * cP - c * sP * sR, c * cP + s * sP * sR), np.arcsin(cR * sP), np.arctan2(sR, cR * cP)


@given(ANGLE, ANGLE, MIDDLE)
def test_reverse_angles_are_yaw_roll_pitch_of_scipy(psi_r, P_r, R_r):
    q = Rotation.from_euler("ZYX", [psi_r, R_r, P_r]).as_quat(scalar_first=True)
    assert turn(quat_from_reverse(psi_r, P_r, R_r), q) < ROUNDING


@given(ANGLE, MIDDLE, ANGLE)
def test_conversion_keeps_the_attitude(psi, P, R):
    """Wherever it is, the singular points of both sets included."""
    q = quat_from_euler(psi, P, R)
    assert turn(quat_from_reverse(*reverse_from_quat(q)), q) < ROUNDING
    assert turn(quat_from_reverse(*reverse_from_forward(psi, P, R)), q) < ROUNDING
    assert turn(quat_from_euler(*forward_from_reverse(*reverse_from_quat(q))), q) < ROUNDING


@given(ANGLE, MIDDLE, ANGLE)
def test_conversion_is_the_printed_one(psi, P, R):
    """Where the reverse set is well determined the angles agree, elsewhere they may differ by rounding / cos R_r."""
    found = np.array(reverse_from_forward(psi, P, R))
    assert -math.pi / 2 <= found[2] <= math.pi / 2
    cosine = math.sqrt(1 - min(1.0, (math.cos(P) * math.sin(R)) ** 2))
    if cosine > 1e-3:
        np.testing.assert_allclose(wrap(found - printed_reverse(psi, P, R)), 0, atol=ROUNDING / cosine)
    back = np.array(forward_from_reverse(*found))
    if math.cos(P) > 1e-3:
        np.testing.assert_allclose(wrap(back - printed_forward(*found)), 0, atol=2 * ROUNDING / math.cos(P))
        np.testing.assert_allclose(wrap(back - [psi, P, R]), 0, atol=2 * ROUNDING / math.cos(P))


@given(ANGLE, st.floats(40 * DEG, 140 * DEG), ANGLE, st.sampled_from([-1, 1]))
def test_the_reverse_set_is_safe_wherever_it_may_be_active(psi, P, R, sign):
    """|R_r| <= 50 deg for |P| >= 40 deg, and so 1/cos R_r <= 1.56, whatever psi and R."""
    _, _, R_r = reverse_from_forward(psi, sign * P, R)
    assert abs(R_r) <= 50 * DEG + ROUNDING
    assert 1 / math.cos(R_r) < 1.56


def swing(P, psi=0.3, R=-0.4):
    return quat_from_euler(np.full(len(P), psi), P, np.full(len(P), R))


def test_a_pitch_through_both_poles_and_all_round_is_followed():
    """The pitch itself is the truth: with yaw and roll fixed it passes +90, 180, 270 deg ... without a jump."""
    P = np.linspace(0, 25, 4001)
    P = np.concatenate([P, P[::-1] - 1e-3])
    q = swing(P) * np.where(np.arange(len(P)) % 7 < 3, -1, 1)[:, None]  # signs mean nothing
    found = track(q)
    # Yaw and roll are as uncertain as rounding / cos P.
    near = np.abs(np.cos(P)) > 1e-2
    np.testing.assert_allclose(found.forward[:, 1], P, rtol=0, atol=1e-14 * 25)
    np.testing.assert_allclose(found.forward[near], np.stack([0 * P + 0.3, P, 0 * P - 0.4], axis=1)[near], atol=1e-12)
    np.testing.assert_array_equal(found.flag[np.abs(np.cos(P)) > math.cos(40 * DEG)], 1)
    np.testing.assert_array_equal(found.flag[np.abs(np.cos(P)) < math.cos(50 * DEG)], -1)
    assert len(found) == len(P)


def test_touching_a_pole_exactly_loses_neither_set():
    """At P = 90 deg only psi + R is left; the roll is that of the attitude before."""
    P = np.array([80, 89.9, 90, 90, 90.1, 100, 90, 80]) * DEG
    found = track(swing(P))
    np.testing.assert_allclose(found.forward[:, 1], P, rtol=0, atol=1e-8)
    np.testing.assert_allclose(found.forward[:, 0], 0.3, rtol=0, atol=1e-6)
    np.testing.assert_allclose(found.forward[:, 2], -0.4, rtol=0, atol=1e-6)


@pytest.mark.parametrize("seed", range(5))
def test_angles_never_jump_on_any_path(seed):
    """Wherever a path leads, the active angles change by no more than the body turns / cos 50 deg."""
    rng = np.random.default_rng(seed)
    q = np.empty((4000, 4))
    q[0] = quat_from_rotvec(rng.normal(size=3))
    step = quat_from_rotvec(0.02 * rng.normal(size=(4000, 3)))
    for k in range(1, len(q)):
        q[k] = quat_multiply(q[k - 1], step[k])
        q[k] /= np.linalg.norm(q[k])
    found = track(q)
    assert set(found.flag) == {1, -1}
    size = 2 * np.arccos(np.clip(step[1:, 0], -1, 1))
    stay = found.flag[1:] == found.flag[:-1]
    change = np.abs(np.diff(found.active, axis=0)).max(axis=1)
    assert (change <= 1.7 * size + 1e-12)[stay].all()
    for angles, rebuilt in ((found.forward, quat_from_euler), (found.reverse, quat_from_reverse)):
        assert turn(rebuilt(*angles.T), q).max() < 1e-12  # angles of hundreds of radians
        assert np.abs(np.diff(angles, axis=0)).max() < math.pi + 1e-9


def test_the_flag_keeps_its_set_inside_the_band():
    P = np.array([0, 44, 46, 49, 51, 46, 44, 41, 39, 44, 49]) * DEG
    np.testing.assert_array_equal(track(swing(P)).flag, [1, 1, 1, 1, -1, -1, -1, -1, 1, 1, 1])
    np.testing.assert_array_equal(track(swing(P), 0.0).flag, [1, 1, -1, -1, -1, -1, 1, 1, 1, 1, -1])
    np.testing.assert_array_equal(track(swing(math.pi - P)).flag, track(swing(P)).flag)
    assert track(swing(P[3:])).flag[0] == -1  # what starts inside is divided at 45 deg


def test_errors_are_taken_in_the_active_set():
    """0.3 arcmin of attitude error at P = 89.99 deg are degrees of forward heading, 0.3 arcmin of reverse angles."""
    P = np.concatenate([np.linspace(-60, 60, 121), np.linspace(60, 130, 701), [89.99, 175.0, 178.0]]) * DEG
    q = swing(P, R=0.0)
    small = 0.3 / 60 * DEG
    est = quat_multiply(quat_from_rotvec([small, small, small]), q)
    errors, truth = angle_errors(est, -q)
    assert len(errors) == len(truth) == len(P)
    assert np.abs(errors).max() < 1.56 * 2.5 * small
    assert np.abs(errors).max() > 0.9 * small
    row = len(P) - 3
    assert truth.flag[row] == -1
    forward = np.abs(
        wrap(
            np.array(forward_from_reverse(*truth.reverse[row]))
            - np.stack(forward_from_reverse(*reverse_from_quat(est[row])))
        )
    )
    assert forward[0] > 10 * DEG


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: track(np.ones((3, 4))), r"q_nb must be unit quaternions \(wxyz\), got norm 2.0 in row 0"),
        (lambda: track([1.0, 0, 0, 0]), r"q_nb must have shape \(n, 4\), got \(4,\)"),
        (lambda: track([[1.0, 0, 0, 0]], -0.1), "hysteresis must be a number >= 0, got -0.1"),
        (lambda: track([[1.0, 0, 0, 0]], 45 * DEG), "hysteresis must be below pi/4 rad, got 0.785"),
        (
            lambda: angle_errors([[1.0, 0, 0, 0]], [[1.0, 0, 0, 0]] * 2),
            "q_est and q_true must have the same length, got 1 and 2",
        ),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(bench.InputError, match=message):
        call()


def test_the_hysteresis_is_five_degrees():
    assert HYSTERESIS == 5 * DEG
