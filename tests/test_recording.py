"""Recordings: checks of times and values, and rates integrated by named rules, against closed forms."""

import numpy as np
import pytest

import bench
from bench._timestamps import check_times
from bench.errors import InputError, UnknownNameError
from bench.motion.coning import Coning
from bench.recording import Recording
from bench.rotation import quat_conjugate, quat_multiply, rotvec_from_quat
from bench.signals import Increments, Readings


def times(n=101, rate=100.0, t0=0.0):
    return t0 + np.arange(n) / rate


def recording(t=None, kind="rates", **options):
    t = times() if t is None else np.asarray(t)
    angular = np.column_stack([np.sin(t), np.cos(t), 0.1 * t])
    specific = np.column_stack([np.cos(2 * t), np.sin(2 * t), 9.8 + 0 * t])
    return Recording(t, angular, specific, kind, **options)


# The interval.


@pytest.mark.parametrize("t0", [0.0, 0.01, 4.0e5])
@pytest.mark.parametrize("rate", [50.0, 100.0, 200.0, 400.0, 1000.0, 300.0])
def test_the_interval_of_a_round_rate_is_found_to_the_bit(rate, t0):
    assert check_times(times(2001, rate, t0)) == 1 / rate


def test_the_interval_of_a_drifting_clock_is_the_measured_one():
    rate = 100.0 * (1 + 50e-6)
    assert check_times(times(10001, rate)) == pytest.approx(1 / rate, rel=1e-12)


def test_declared_interval_is_taken_as_it_is():
    assert check_times(times(101, 100.005), 0.01) == 0.01


@pytest.mark.parametrize("declared", [1 / 200, 1 / 99.8, 0.01e-3, 10.0])
def test_wrong_rate_is_refused(declared):
    with pytest.raises(InputError, match=r"the times tell 100 Hz \(interval 0\.01 s\); declare the true rate"):
        check_times(times(501), declared)


def test_gaps_and_repeats_do_not_move_the_measured_rate():
    t = np.delete(times(501), [100, 101, 102, 300])
    assert check_times(t, longest_gap=1.0) == 0.01


# Irregular times: what, how often, where.


def test_every_irregularity_is_counted_in_one_message():
    t = times(200)
    t = np.concatenate([t[:20], t[23:50], t[49:80], t[70:100], t[103:]])
    t[150] += 0.002
    with pytest.raises(InputError) as refused:
        check_times(t, source="imu.txt")
    message = str(refused.value)
    assert message.startswith("imu.txt: times are not regular at dt = 0.01 s: ")
    for part in (
        "steps back: 1, first after row 77 (t = 0.79 to 0.7 s)",
        "repeated times: 1, first after row 46",
        "gaps (6 missing samples): 2, first after row 19 (t = 0.19 to 0.23 s)",
        "intervals off by more than 0.1 dt: 2, first after row 149",
        "sort it by time",
        "drop_repeats=True",
        "longest_gap",
        "jitter admits more",
    ):
        assert part in message


def test_a_sample_too_many_is_refused():
    with pytest.raises(InputError, match=r"intervals below 0\.5 dt: 1, first after row 50"):
        check_times(np.insert(times(), 51, 0.5021))


def test_jitter_is_admitted_as_declared_and_no_more():
    t = times() + 1e-2 * np.random.default_rng(0).uniform(-0.1, 0.1, 101)
    assert check_times(t, jitter=0.2) == pytest.approx(0.01, rel=2e-3)  # two ends, 0.1 dt each, over 100 dt
    with pytest.raises(InputError, match=r"intervals off by more than 0\.05 dt"):
        check_times(t, jitter=0.05)
    with pytest.raises(InputError, match=r"jitter must be below 0\.5"):
        check_times(t, jitter=0.5)


def test_stamps_rounded_to_milliseconds_at_400_hz():
    t = np.round(times(401, 400.0), 3)
    assert check_times(t, jitter=0.25) == pytest.approx(1 / 400, rel=1e-12)


def test_rounding_of_late_times_is_no_jitter():
    """Unix times in s: 1.7e9 s has steps of 2.4e-7 s, which is 0.5 % of dt at 20 kHz."""
    assert check_times(times(1001, 20e3, 1.7e9), jitter=0.001) == pytest.approx(5e-5, rel=1e-5)


def test_a_gap_up_to_the_longest_is_admitted():
    t = np.delete(times(), [10, 11])
    assert check_times(t, longest_gap=0.03) == 0.01
    with pytest.raises(InputError, match=r"gaps \(2 missing samples\): 1, first after row 9"):
        check_times(t, longest_gap=0.029)


def test_a_gap_to_be_filled_holds_whole_intervals():
    t = np.concatenate([times(10), 0.09 + 0.016 + times(10)])
    with pytest.raises(InputError, match=r"intervals off by more than 0\.1 dt: 1, first after row 9"):
        check_times(t, longest_gap=1.0)


@pytest.mark.parametrize("t", [[0.0], [1.0, 1.0, 1.0], [3.0, 2.0, 1.0]])
def test_times_without_an_interval_are_refused(t):
    with pytest.raises(InputError, match=r"at least two samples|times must increase"):
        check_times(t)


# The record.


def test_bad_rows_are_counted_and_named():
    good = recording()
    angular = good.angular.copy()
    angular[[7, 9], 1] = np.nan
    specific = good.specific.copy()
    specific[9] = np.inf
    with pytest.raises(InputError, match=r"flight: 2 of 101 rows hold NaN or infinity \(row 7, row 9\)"):
        Recording(good.t, angular, specific, "rates", source="flight")


@pytest.mark.parametrize(
    ("field", "value", "rule"),
    [
        ("angular", np.zeros((101, 2)), r"angular must have shape \(101, 3\)"),
        ("specific", np.zeros((100, 3)), r"specific must have shape \(101, 3\)"),
        ("kind", "samples", "unknown kind 'samples'"),
        ("dt", -1.0, "dt must be"),
        ("epoch_ns", 0.5, "epoch_ns must be an integer"),
    ],
)
def test_bad_fields_are_refused(field, value, rule):
    good = recording()
    fields = {"t": good.t, "angular": good.angular, "specific": good.specific, "kind": "rates", field: value}
    with pytest.raises(InputError, match=rule):
        Recording(**fields)


def test_start_is_where_the_first_interval_begins():
    assert recording(times(t0=5.0)).start == 5.0
    assert recording(times(t0=5.0), "increments").start == pytest.approx(4.99, abs=1e-12)


def test_between_keeps_the_interval():
    part = recording(times(1001)).between(2.0, 3.0)
    assert (len(part), part.t[0], part.t[-1], part.dt) == (101, 2.0, 3.0, 0.01)
    with pytest.raises(InputError, match="start and stop must enclose two samples"):
        part.between(5.0, 6.0)


def test_simulated_increments_are_kept_to_the_bit():
    rig = bench.Rig.load("imu", threads=1)
    increments = rig.increments(Coning(), 100.0, 0.2, t0=3.0)
    made = Recording.from_increments(increments)
    dtheta_b, dvel_b, dt = made.increments()
    assert dtheta_b.tobytes() == increments.dtheta_b.tobytes()
    assert dvel_b.tobytes() == increments.dvel.tobytes()
    assert (dt, made.start, made.kind) == (0.01, pytest.approx(3.0, abs=1e-12), "increments")


def test_simulated_readings_are_rates():
    readings = bench.Rig.load("imu", threads=1).sample(Coning(), times())
    made = Recording.from_readings(readings)
    assert made.kind == "rates"
    np.testing.assert_array_equal(made.angular, readings.gyro)


@pytest.mark.parametrize("part", ["gyro", "channels"])
def test_a_rig_without_gyro_or_triad_makes_no_recording(part):
    t = times(5)
    if part == "gyro":
        with pytest.raises(InputError, match="no gyro and 3 channels"):
            Recording.from_increments(Increments(0.01, t, np.zeros((5, 3)), None, 0.0, 3))
    else:
        with pytest.raises(InputError, match="a gyro and 9 channels"):
            Recording.from_readings(Readings(t, np.zeros((5, 9)), np.zeros((5, 3))))


# Rates to increments.


def exact(start, end):
    """Integrals of the rates that `recording` samples."""
    angular = [np.cos(start) - np.cos(end), np.sin(end) - np.sin(start), 0.05 * (end**2 - start**2)]
    specific = [np.sin(2 * end) / 2 - np.sin(2 * start) / 2, np.cos(2 * start) / 2 - np.cos(2 * end) / 2]
    return np.column_stack([*angular, *specific, 9.8 * (end - start)])


@pytest.mark.parametrize(("rule", "order"), [("trapezoid", 2), ("simpson", 4), ("spline", 4), ("average", 1)])
def test_rules_have_their_order(rule, order):
    """Error of the mean rate over an interval, as the interval is halved."""
    errors = []
    for rate in (50.0, 100.0, 200.0):
        made = recording(times(int(2 * rate) + 1, rate)).as_increments(rule)
        truth = exact(made.t - made.dt, made.t)
        errors.append(np.abs(np.hstack([made.angular, made.specific]) - truth).max() / made.dt)
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(slopes, order, atol=0.2)


@pytest.mark.parametrize(
    ("rule", "n", "count", "dt"),
    [("trapezoid", 8, 7, 0.01), ("simpson", 9, 4, 0.02), ("simpson", 8, 3, 0.02), ("spline", 8, 7, 0.01)],
)
def test_rules_give_intervals_from_the_first_sample_on(rule, n, count, dt):
    made = recording(times(n, t0=1.0)).as_increments(rule)
    assert (len(made), made.dt, made.kind) == (count, dt, "increments")
    assert made.start == pytest.approx(1.0, abs=1e-15)


def test_average_keeps_every_sample():
    made = recording(times(8)).as_increments("average")
    assert (len(made), made.start) == (8, -0.01)


def test_rates_are_never_integrated_silently():
    with pytest.raises(InputError, match="rule must say how to integrate the rates of recording: trapezoid, simpson"):
        recording().increments()
    with pytest.raises(UnknownNameError, match="unknown rule 'rectangle'"):
        recording().increments("rectangle")
    with pytest.raises(InputError, match="rule must not be given for recording: it holds increments"):
        recording(kind="increments").increments("spline")


@pytest.mark.parametrize(("rule", "least"), [("trapezoid", 3), ("simpson", 5), ("spline", 4)])
def test_too_few_samples_are_refused(rule, least):
    recording(times(least)).increments(rule)
    with pytest.raises(InputError, match=f"rule '{rule}' needs at least {least} samples"):
        recording(times(least - 1)).increments(rule)


def test_mean_rates_are_the_inverse_of_average():
    start = recording(kind="increments")
    back = start.as_mean_rates().as_increments("average")
    np.testing.assert_allclose(back.angular, start.angular, rtol=4e-16, atol=0)  # one division, one product
    np.testing.assert_allclose(back.specific, start.specific, rtol=4e-16, atol=0)
    with pytest.raises(InputError, match="recording holds rates"):
        start.as_mean_rates().as_mean_rates()


def test_what_rates_cost_on_coning():
    """The factors that the rules' documentation names; truth in closed form, increments by the rig."""
    motion, rate = Coning(), 100.0
    rig = bench.Rig.load("imu", threads=1)
    solver = bench.solver("attitude", "rotation-vector", samples=2)

    def error(dtheta_b, dt):
        q = solver.solve(dtheta_b[: len(dtheta_b) // 2 * 2], dt, motion.kinematics(np.zeros(1)).q_ib[0])
        truth = motion.kinematics(np.arange(len(q)) * 2 * dt).q_ib
        return np.linalg.norm(rotvec_from_quat(quat_multiply(q, quat_conjugate(truth))), axis=1).max()

    rates = Recording.from_readings(rig.sample(motion, times(1001)))
    best = error(*Recording.from_increments(rig.increments(motion, rate, 10.0)).increments()[::2])
    for rule, factor in (("trapezoid", 320), ("simpson", 16), ("spline", 1.1)):
        assert error(*rates.increments(rule)[::2]) / best == pytest.approx(factor, rel=0.1), rule
    dtheta_b, _, dt = rates.increments("average")
    assert error(dtheta_b[1:], dt) / best == pytest.approx(2800, rel=0.1)
