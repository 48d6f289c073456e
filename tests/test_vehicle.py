"""Vehicles from velocity profiles: places against rhumb lines in closed form (mpmath), SciPy's DOP853 and pyins;
manoeuvres against the incomplete beta function of mpmath; what a passenger feels against hand-made cases.
"""

import math
import tracemalloc
from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import bench
from bench import rotation as rot
from bench.earth import SPHERE, WGS84
from bench.errors import AccuracyError, InputError
from bench.motion.manoeuvres import Accelerate, Climb, Manoeuvre, Straight, Turn, Weave
from bench.motion.sinusoidal_velocity import SinusoidalVelocity
from bench.motion.vehicle import Vehicle
from bench.units import DEG, STANDARD_GRAVITY
from tests.motion_examples import MANOEUVRES

EPS = float(np.finfo(float).eps)
A, F = 6378137.0, 1 / 298.257223563
E2 = F * (2 - F)


def radii(L):
    w2 = 1 - E2 * math.sin(L) ** 2
    return A * (1 - E2) / w2**1.5, A / math.sqrt(w2)


def dop853(velocity, place, t, restart=()):
    """Latitude, longitude, height at times t from v_n(t), integrated as metres from the start by DOP853."""
    L0, _, h0 = place
    scale = np.array([6.4e6, 6.4e6 * math.cos(L0), 1.0])

    def rate(time, y):
        L, h = L0 + y[0] / 6.4e6, h0 + y[2]
        (R_M, R_N), (east, north, up) = radii(L), velocity(time)
        return 6.4e6 * north / (R_M + h), scale[1] * east / ((R_N + h) * math.cos(L)), up

    y, out, edges = np.zeros(3), [], [0.0, *restart, float(t[-1])]
    for start, end in pairwise(edges):
        inside = t[(t > start) & (t <= end)]
        at = np.unique([*inside, end])
        steps = solve_ivp(rate, (start, end), y, "DOP853", at, rtol=3e-14, atol=1e-12).y.T
        y, out = steps[-1], [*out, *steps[: len(inside)]]
    return np.array(place) + np.array(out) / scale


def metres(difference, L):
    return difference * np.array([6.4e6, 6.4e6 * math.cos(L), 1.0])


# Sinusoidal velocity


@pytest.mark.parametrize("t", [0.0, 61.7, 3600.0])
def test_an_hour_along_a_rhumb_line_has_a_closed_form(t):
    """East and north in a fixed ratio, at height 0: the meridian arc is the integral of v_N, and the longitude the
    difference of isometric latitudes; in 40 digits. 2e-9 m is one or two roundings of an angle.
    """
    motion = SinusoidalVelocity(
        latitude=0.7,
        longitude=0.3,
        height=0.0,
        mean=(60.0, 80.0, 0.0),
        amplitude=(15.0, 20.0, 0.0),
        phase=(1.0, 1.0, 0.0),
    )
    with mp.workdps(40):
        f = 1 / mp.mpf("298.257223563")
        a, e2, L0, w = mp.mpf(6378137), f * (2 - f), mp.mpf(0.7), mp.mpf(motion.frequency[0])
        north = 80 * mp.mpf(t) + 20 / w * (mp.cos(1) - mp.cos(w * mp.mpf(t) + 1))

        def arc(L):
            return a * (1 - e2) * mp.quad(lambda x: (1 - e2 * mp.sin(x) ** 2) ** mp.mpf("-1.5"), [L0, L])

        def isometric(L):
            e = mp.sqrt(e2)
            return mp.atanh(mp.sin(L)) - e * mp.atanh(e * mp.sin(L))

        L = mp.findroot(lambda x: arc(x) - north, L0 + north / a)
        lon = mp.mpf(0.3) + mp.mpf(60) / 80 * (isometric(L) - isometric(L0))
        place = motion._path.places(np.array([t]))[0]
        errors = [6.4e6 * float(mp.mpf(place[0]) - L), 4.6e6 * float(mp.mpf(place[1]) - lon)]
    np.testing.assert_allclose(errors, 0.0, rtol=0, atol=2e-9)
    assert place[2] == 0.0


def test_climbing_sinusoids_against_dop853():
    """With every component at its own frequency, for three minutes: 2e-9 m, a few roundings of DOP853 and the angles.

    Velocities to what math.sin loses of a phase of hundreds of radians.
    """
    motion = SinusoidalVelocity(
        latitude=-1.1, longitude=0.2, mean=(100.0, -50.0, 5.0), amplitude=(40.0, 30.0, 8.0), frequency=(0.31, 0.7, 1.3)
    )

    def velocity(t):
        return [
            m + a * math.sin(w * t + p)
            for m, a, w, p in zip(motion.mean, motion.amplitude, motion.frequency, motion.phase, strict=True)
        ]

    t = np.array([1.0, 60.0, 180.0])
    expected = dop853(velocity, (-1.1, 0.2, 1500.0), t)
    np.testing.assert_allclose(metres(motion._path.places(t) - expected, -1.1), 0, rtol=0, atol=2e-9)
    np.testing.assert_allclose(motion.trajectory(t).v_n, [velocity(x) for x in t], rtol=0, atol=1e-12)


def test_default_hour_is_that_of_pyins():
    """`generate_sine_velocity_motion` with the numbers of pyins' own integration test; north-east-down, degrees.

    Its longitudes and latitudes are cubic splines through 100 Hz samples, iterated to 1 cm; its roll is 0; its pitch
    has the other sign than the climb.
    """
    sim = pytest.importorskip("pyins.sim")
    theirs, _ = sim.generate_sine_velocity_motion(0.01, 60.01, [55, 37, 1500], [5, -3, 0.2], 1)
    mine = SinusoidalVelocity().trajectory(theirs.index.to_numpy())
    psi, P, R = rot.euler_from_quat(mine.q_nb)
    np.testing.assert_allclose(mine.latitude / DEG, theirs.lat, rtol=0, atol=1e-9)
    np.testing.assert_allclose(mine.longitude / DEG, theirs.lon, rtol=0, atol=1e-9)
    np.testing.assert_allclose(mine.height, theirs.alt, rtol=0, atol=1e-6)
    np.testing.assert_allclose(mine.v_n, theirs[["VE", "VN", "VD"]] * [1, 1, -1], rtol=0, atol=1e-11)
    np.testing.assert_allclose(-psi / DEG, theirs.heading, rtol=0, atol=1e-11)
    np.testing.assert_allclose(P / DEG, -theirs.pitch, rtol=0, atol=1e-11)
    np.testing.assert_allclose(R, 0, rtol=0, atol=1e-14)


def test_an_hour_at_a_kilohertz_in_flat_memory():
    """Chunks of 4096 samples at the end of the hour cost what they cost at its start; the path takes under 1 MB."""
    motion = SinusoidalVelocity()
    motion.kinematics([0.0, 3600.0])
    tracemalloc.start()
    peaks = []
    for start in (0.0, 1800.0, 3580.0):
        tracemalloc.reset_peak()
        motion.kinematics(start + np.arange(4096) / 1000)
        peaks.append(tracemalloc.get_traced_memory()[1])
    left = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    assert max(peaks) < 1.1 * min(peaks) < 10e6
    assert left < 1e5
    assert motion._path.change.nbytes < 1e6


def test_velocity_close_to_the_pole():
    """100 m from the pole the longitude runs fast; north of it the path is refused."""
    motion = SinusoidalVelocity(10.0, math.pi / 2 - 1.6e-5, 0.1, mean=(20.0, 0.0, 0.0), amplitude=(0.0, 1.0, 0.0))
    t = np.linspace(0.0, 10.0, 5)
    expected = dop853(lambda t: [20.0, math.sin(motion.frequency[1] * t), 0.0], (motion.latitude, 0.1, 1500.0), t[1:])
    np.testing.assert_allclose(metres(motion._path.places(t)[1:] - expected, motion.latitude), 0, rtol=0, atol=3e-9)
    towards = SinusoidalVelocity(60.0, math.pi / 2 - 1.6e-5, mean=(0.0, 5.0, 0.0))
    with pytest.raises(InputError, match=r"latitude of the path must stay 1e-06 rad away from the poles, got 1\.57"):
        towards.kinematics([1.0])


def test_attitude_cannot_follow_no_velocity():
    stopping = SinusoidalVelocity(mean=(0.0, 0.0, 0.0), amplitude=(0.0, 1.0, 0.0), phase=(0.0, 0.0, 0.0))
    with pytest.raises(
        InputError, match=r"velocity that vanishes or is vertical, as it does at t = 0.0 s.*follow=False"
    ):
        stopping.kinematics([1.0, 0.0])
    SinusoidalVelocity(mean=(0.0, 0.0, 0.0), amplitude=(0.0, 0.0, 0.0), follow=False).kinematics([0.0])


def test_a_frequency_beyond_reach_is_refused():
    with pytest.raises(AccuracyError, match=r"the path would need 45\d+ segments of 8e-09 s, more than 131072"):
        SinusoidalVelocity(frequency=(1e9, 1.0, 1.0)).kinematics([0.0])


def test_a_velocity_that_jumps_is_refused():
    @dataclass(frozen=True)
    class Bump(Straight):
        def change(self, tau):
            zero = np.zeros(tau.shape)
            return np.where(tau > 0.3, 1.0, 0.0), zero, zero, zero

    with pytest.raises(AccuracyError, match=r"the velocity is not smooth enough near t = 0\.(3|29999)"):
        Vehicle((Bump(1.0),)).kinematics([0.0])


# Manoeuvres

PARTS = [
    Straight(3.0),
    Accelerate(10.0, -7.0, 4.0),
    Accelerate(4.0, 2.0),
    Turn(12.0, 400 * DEG, 0.5),
    Climb(9.0, -0.3, 3.0),
    Weave(20.0, 0.4, 7.0, 6.0),
]


def step(tau, ramp):
    """The step with slope (1 - y^2)^7 is the regularised incomplete beta function I_x(8, 8)."""
    return mp.betainc(8, 8, 0, min(max(tau / ramp, mp.mpf(0)), mp.mpf(1)), regularized=True)


def step_integral(tau, ramp):
    """By parts: the integral of I_x(8, 8) is x I_x(8, 8) - I_x(9, 8) / 2."""
    x = min(max(tau / ramp, mp.mpf(0)), mp.mpf(1))
    part = x * mp.betainc(8, 8, 0, x, regularized=True) - mp.betainc(9, 8, 0, x, regularized=True) / 2
    return ramp * part + max(tau - ramp, mp.mpf(0))


def expected_change(part, tau):
    """What the manoeuvre is documented to do, in mpmath."""
    if isinstance(part, Straight):
        return mp.mpf(0)
    ramp, duration = mp.mpf(part.ramp), mp.mpf(part.duration)

    def window(shape):
        return shape(tau, ramp) - shape(tau - duration + ramp, ramp)

    if isinstance(part, Climb):
        return mp.mpf(part.path_angle) * window(step)
    if isinstance(part, Weave):
        return -mp.mpf(part.amplitude) * window(step) * mp.sin(2 * mp.pi / mp.mpf(part.period) * tau)
    total = part.speed_change if isinstance(part, Accelerate) else -part.heading_change
    return mp.mpf(total) / (duration - ramp) * window(step_integral)


@pytest.mark.parametrize("part", PARTS, ids=repr)
def test_manoeuvres_and_their_derivatives(part):
    """Values, and three derivatives by mpmath's, at times inside ramps, between them, and at the ends."""
    tau = np.array([0.0, 0.11, 0.3, 0.47, 0.8, 0.999, 1.0]) * part.duration
    found = part.change(tau)
    scale = max(abs(float(expected_change(part, mp.mpf(x)))) for x in tau) + abs(part.total)
    fastest = 10 / getattr(part, "ramp", 1.0)
    with mp.workdps(30):
        for k, x in enumerate(map(mp.mpf, tau)):
            for order in range(4):
                # At the very ends the formula is not smooth across, and all derivatives of a ramp vanish.
                inside = 0 < x < part.duration
                truth = mp.diff(lambda y: expected_change(part, y), x, order) if inside or not order else 0
                assert found[order][k] == pytest.approx(float(truth), abs=16 * EPS * scale * fastest**order, rel=0)
    assert part.change(np.array([part.duration]))[0][0] == pytest.approx(part.total, abs=4 * EPS * abs(part.total))


# Vehicles


def corners_of(motion):
    """Times where the eighth derivative jumps."""
    inner = [start + np.array(part.corners) for start, part in zip(motion.borders, motion.segments, strict=False)]
    return np.unique(np.concatenate([motion.borders[1:-1], *inner]).round(9))


def test_states_at_the_ends_of_manoeuvres():
    """Speed, heading and path angle after each part; heading clockwise, path angle back to level."""
    motion = Vehicle(MANOEUVRES, speed=50.0, heading=30 * DEG)
    tr = motion.trajectory(motion.borders)
    speed, heading = [50, 50, 80, 80, 80, 80, 30], np.array([30, 30, 30, 230, 230, 230, 230]) * DEG
    expected = speed * np.array([np.sin(heading), np.cos(heading), 0 * heading])
    np.testing.assert_allclose(tr.v_n, expected.T, rtol=0, atol=1e-13)
    np.testing.assert_allclose(
        np.abs((tr.q_nb * rot.quat_from_euler(-heading, 0, 0)).sum(axis=1)), 1, rtol=0, atol=8 * EPS
    )
    assert motion.duration == 60.0
    assert 215 < motion.height - tr.height[-1] < 225  # 20 deg down at 80 m/s for about 8 s


def test_vehicle_path_against_dop853():
    """A minute of manoeuvres, restarted at the corners: 2e-9 m, a few roundings of DOP853 and the angles."""
    motion = Vehicle(MANOEUVRES, longitude=0.2)
    t = np.array([3.0, 17.0, 31.0, 44.0, 60.0])
    place = motion.latitude, 0.2, motion.height
    expected = dop853(lambda x: motion.trajectory(np.array([x])).v_n[0], place, t, corners_of(motion))
    np.testing.assert_allclose(metres(motion._path.places(t) - expected, motion.latitude), 0, rtol=0, atol=2e-9)


def test_nothing_pulls_sideways_in_a_coordinated_turn():
    """On a slowly turning sphere without Coriolis the lateral force is that of g against 9.80665 only; the bank is
    atan(v psi'/g), to the right in a turn to the right, and the seat pulls g / cos(bank).
    """
    still = SPHERE.__class__("still", 6371000.0, 0.0, STANDARD_GRAVITY * 6371000.0**2, 0.0, 0.0, "j2", SPHERE.source)
    motion = Vehicle((Turn(22.0, 90 * DEG),), latitude=0.0, speed=100.0, height=0.0, earth=still)
    rate = 90 * DEG / 20
    bank = math.atan(100 * rate / STANDARD_GRAVITY)
    t = np.array([5.0, 11.0, 17.0])
    f = bench.Rig.load("imu", threads=1).sample(motion, t).accelerometers
    psi, P, R = rot.euler_from_quat(motion.trajectory(t).q_nb)
    np.testing.assert_allclose(R, bank, rtol=0, atol=1e-13)
    np.testing.assert_allclose(P, 0, rtol=0, atol=1e-13)
    assert (np.diff(psi) < 0).all()
    relief = 100.0**2 / 6371000  # of the weight, along the Earth's curvature
    np.testing.assert_allclose(f[:, 0], relief * math.sin(bank), rtol=0, atol=2e-5)
    np.testing.assert_allclose(f[:, 2], STANDARD_GRAVITY / math.cos(bank) - relief * math.cos(bank), rtol=0, atol=2e-5)
    np.testing.assert_allclose(f[:, 1], 0, rtol=0, atol=1e-4)


def test_joints_are_smooth():
    """Across borders and ramps force and rate change by their slope times the gap, not by jumps; and the rig's residual
    meets its tolerance at 20 Hz with intervals that do not fit the borders.
    """
    motion = Vehicle(MANOEUVRES, speed=50.0)
    before, after = (motion.kinematics(corners_of(motion) + d) for d in (-1e-7, 1e-7))
    for field, tolerance in (("acceleration", 1e-4), ("omega_ib_b", 1e-5), ("alpha_ib_b", 1e-4)):
        np.testing.assert_allclose(getattr(before, field), getattr(after, field), rtol=0, atol=tolerance)
    inc = bench.Rig.load("imu", threads=1).increments(motion, 20.0, 55.0, t0=0.0123, check_every=1)
    assert inc.residual < 1e-12


def test_given_attitude_does_not_follow():
    motion = Vehicle(MANOEUVRES, speed=50.0, follow=False, attitude=(0.3, 0.1, -0.2))
    q = motion.trajectory(np.linspace(0, 60, 50)).q_nb
    np.testing.assert_allclose(np.abs(q @ rot.quat_from_euler(0.3, 0.1, -0.2)), 1, rtol=0, atol=8 * EPS)


def test_a_manoeuvre_of_ones_own():
    """A steady slope: the yaw grows as tau^2 / 2."""

    @dataclass(frozen=True)
    class Spiral(Manoeuvre):
        quantity: ClassVar[str] = "yaw"
        corners: ClassVar[tuple[float, ...]] = ()
        duration: float = 10.0

        @property
        def total(self):
            return 0.01 * self.duration**2 / 2

        def change(self, tau):
            zero = np.zeros(tau.shape)
            return 0.01 * tau**2 / 2, 0.01 * tau, zero + 0.01, zero

    motion = Vehicle((Spiral(), Straight(1.0)), heading=0.0, speed=20.0)
    east, north, _ = motion.trajectory(np.array([10.5])).v_n[0]
    assert math.atan2(-east, north) == pytest.approx(0.5, abs=1e-14)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Straight(0.0), "duration must be a positive number, got 0.0"),
        (lambda: Turn(3.0, 1.0), "ramp must be at most half the duration of 3.0 s, got 2.0"),
        (lambda: Turn(5.0, math.nan), "heading_change must be finite"),
        (lambda: Accelerate(5.0, 1.0, -1.0), "ramp must be a positive number, got -1.0"),
        (lambda: Climb(9.0, 8.0), r"path_angle must be within \+-pi/2 rad, got 8.0 \(degrees\?\)"),
        (lambda: Weave(9.0, 0.1, 0.0), "period must be a positive number, got 0.0"),
        (lambda: Vehicle(()), r"segments must be one or more manoeuvres, got \(\)"),
        (lambda: Vehicle((Straight(1.0), 5.0)), "segments must be one or more manoeuvres, got 5.0"),
        (lambda: Vehicle(3.0), "segments must be one or more manoeuvres, got 3.0"),
        (lambda: Vehicle(latitude=math.pi / 2), "latitude must stay 1e-06 rad away from the poles"),
        (lambda: Vehicle(speed=math.inf), "speed must be finite"),
        (lambda: Vehicle(follow=1), "follow must be True or False, got 1"),
        (lambda: SinusoidalVelocity(duration=0.0), "duration must be a positive number"),
        (lambda: SinusoidalVelocity(frequency=1.0), r"frequency must have shape \(3,\)"),
        (lambda: SinusoidalVelocity(follow="yes"), "follow must be True or False, got 'yes'"),
    ],
)
def test_bad_options_are_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()


@pytest.mark.parametrize("motion", [Vehicle((Straight(7.0),)), SinusoidalVelocity(7.0)], ids=["vehicle", "sinusoidal"])
@pytest.mark.parametrize("t", [-1e-6, 7.1])
def test_times_outside_are_refused(motion, t):
    with pytest.raises(InputError, match=rf"t must lie in the motion's span \[0.0, 7.0\] s, got t\[1\] = {t}"):
        motion.kinematics([3.0, t])


def test_vehicles_are_values():
    assert Vehicle() == Vehicle([*Vehicle().segments])
    assert hash(SinusoidalVelocity(mean=[1, 2, 3])) == hash(SinusoidalVelocity(mean=(1.0, 2.0, 3.0)))
    assert Vehicle().earth is WGS84
