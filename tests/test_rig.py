"""MuJoCo's readings against hand-written kinematics; exact increments against closed forms and SciPy's quadrature."""

import pickle

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad_vec

import bench
from bench.mjcf import model_names
from tests.kinematics_reference import Tumble, readings

RIGS = {name: bench.Rig.load(name) for name in model_names()}


@pytest.fixture
def rig():
    return RIGS["nine_accelerometer"]


def random_array(seed, channels):
    """An MjSpec with single-axis accelerometers anywhere on one body, in nested frames, and a gyro."""
    rng = np.random.default_rng(seed)
    spec = mujoco.MjSpec()
    body = spec.worldbody.add_body(name="pod", pos=rng.normal(size=3), quat=rng.normal(size=4))
    body.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 1, 0])
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.1, 0.2, 0.3], pos=rng.normal(size=3))
    for k in range(channels):
        body.add_site(name=f"s{k}", pos=rng.normal(size=3), quat=rng.normal(size=4))
        spec.add_sensor(
            name=f"a{k}",
            type=mujoco.mjtSensor.mjSENS_ACCELEROMETER,
            objtype=mujoco.mjtObj.mjOBJ_SITE,
            objname=f"s{k}",
            userdata=[1.0],
        )
    spec.add_sensor(name="gyro", type=mujoco.mjtSensor.mjSENS_GYRO, objtype=mujoco.mjtObj.mjOBJ_SITE, objname="s0")
    return spec


class TestSample:
    @pytest.mark.parametrize("name", model_names())
    @pytest.mark.parametrize("seed", range(3))
    def test_models_agree_with_hand_written_kinematics(self, name, seed):
        rig, motion = RIGS[name], Tumble(seed)
        t = np.sort(np.random.default_rng(seed).uniform(-5, 50, 5000))
        truth = motion.kinematics(t)
        got = rig.sample(motion, t)
        expected = readings(truth, rig.accelerometers.position, rig.accelerometers.direction)
        scale = np.abs(expected).max()
        np.testing.assert_allclose(got.accelerometers, expected, rtol=0, atol=1e-14 * scale)
        np.testing.assert_allclose(got.gyro, truth.omega_ib_b, rtol=0, atol=1e-14 * np.abs(truth.omega_ib_b).max())

    @settings(max_examples=25, deadline=None)
    @given(seed=st.integers(0, 2**32 - 1), channels=st.integers(1, 15))
    def test_random_arrays_and_motions(self, seed, channels):
        rig, motion = bench.Rig.load(random_array(seed, channels)), Tumble(seed)
        t = np.linspace(0, 3, 200)
        expected = readings(motion.kinematics(t), rig.accelerometers.position, rig.accelerometers.direction)
        got = rig.sample(motion, t)
        # The promise is 1e-12 relative; the largest channel sets the scale of the rounding in all of them.
        np.testing.assert_allclose(got.accelerometers, expected, rtol=0, atol=1e-14 * np.abs(expected).max())
        np.testing.assert_allclose(got.gyro, motion.kinematics(t).omega_ib_b, rtol=0, atol=1e-14 * 20)

    def test_distance_and_speed_cost_no_digits(self, rig):
        near, far = Tumble(1), Tumble(1, shift=6.4e6, speed=7e3)
        t = np.linspace(0, 10, 1000)
        # Not equal in every bit only because amplitudes are unaffected: the rig never sees position or velocity.
        np.testing.assert_array_equal(rig.sample(near, t).accelerometers, rig.sample(far, t).accelerometers)

    def test_free_fall_reads_zero(self):
        class FreeFall(bench.Motion):
            def kinematics(self, t):
                return bench.Kinematics(
                    [7e6, 0, 0],
                    [0, 7.5e3, 0],
                    [-8.1, 0.3, 0.2],
                    [1, 0, 0, 0],
                    [0, 0, 0],
                    [0, 0, 0],
                    [-8.1, 0.3, 0.2],
                )

        got = RIGS["imu"].sample(FreeFall(), np.arange(3.0))
        assert np.abs(got.accelerometers).max() < 1e-15

    def test_each_row_has_its_own_gravity(self):
        class Swing(bench.Motion):
            def kinematics(self, t):
                gravity = np.stack([np.sin(t), np.cos(t), -9 - t], axis=1)
                return bench.Kinematics([0, 0, 0], [0, 0, 0], [0, 0, 0], [1, 0, 0, 0], [0, 0, 0], [0, 0, 0], gravity)

        t = np.linspace(0, 1, 5000)
        got = RIGS["imu"].sample(Swing(), t).accelerometers
        np.testing.assert_allclose(got, -Swing().kinematics(t).gravity, rtol=0, atol=4e-15)

    def test_turned_gyro_site_still_gives_body_axes(self):
        rig, motion = bench.Rig.load(random_array(5, 3)), Tumble(2)
        t = np.linspace(0, 1, 50)
        np.testing.assert_allclose(rig.sample(motion, t).gyro, motion.kinematics(t).omega_ib_b, rtol=0, atol=1e-13)

    def test_threads_and_repetition_do_not_change_the_bits(self, rig):
        t = np.linspace(0, 20, 30_001)
        first = rig.sample(Tumble(3), t).accelerometers
        np.testing.assert_array_equal(first, rig.sample(Tumble(3), t).accelerometers)
        single = bench.Rig.load("nine_accelerometer", threads=1)
        np.testing.assert_array_equal(first, single.sample(Tumble(3), t).accelerometers)
        assert np.array_equal(first[7:9], rig.sample(Tumble(3), t[7:9]).accelerometers)

    def test_pickled_rig_gives_the_same_bits(self, rig):
        t = np.linspace(0, 1, 100)
        copy = pickle.loads(pickle.dumps(rig))
        np.testing.assert_array_equal(copy.sample(Tumble(), t).accelerometers, rig.sample(Tumble(), t).accelerometers)


class TestRemount:
    def test_senses_with_the_new_geometry(self, rig):
        rng = np.random.default_rng(0)
        nominal = rig.accelerometers
        direction = nominal.direction + 1e-3 * rng.normal(size=(9, 3))
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        moved = bench.Accelerometers(nominal.names, nominal.position + 1e-3 * rng.normal(size=(9, 3)), direction)
        t = np.linspace(0, 2, 500)
        motion = Tumble(4)
        got = rig.remount(moved).sample(motion, t)
        expected = readings(motion.kinematics(t), moved.position, moved.direction)
        np.testing.assert_allclose(got.accelerometers, expected, rtol=0, atol=1e-14 * np.abs(expected).max())
        assert rig.accelerometers is nominal

    def test_unmoved_triads_read_the_same(self):
        rig = RIGS["twelve_accelerometer"]
        t = np.linspace(0, 2, 100)
        got = rig.remount(rig.accelerometers).sample(Tumble(), t).accelerometers
        expected = rig.sample(Tumble(), t).accelerometers
        np.testing.assert_allclose(got, expected, rtol=0, atol=1e-15 * np.abs(expected).max())

    def test_wrong_number_of_channels(self, rig):
        with pytest.raises(bench.InputError, match="9 channels like the rig, got 12"):
            rig.remount(RIGS["twelve_accelerometer"].accelerometers)


class Cone(bench.Motion):
    """Classical coning; its increments are known in closed form."""

    def __init__(self, half_angle, omega):
        self.a, self.w = half_angle, omega

    def kinematics(self, t):
        a, w = self.a, self.w
        c, s, one = np.cos(w * t), np.sin(w * t), np.ones_like(t)
        q = np.stack([np.cos(a / 2) * one, np.sin(a / 2) * s, np.sin(a / 2) * c, 0 * t], axis=1)
        omega = np.stack([w * np.sin(a) * c, -w * np.sin(a) * s, 2 * w * np.sin(a / 2) ** 2 * one], axis=1)
        alpha = np.stack([-(w**2) * np.sin(a) * s, -(w**2) * np.sin(a) * c, 0 * t], axis=1)
        return bench.Kinematics([0, 0, 0], [0, 0, 0], [0, 0, 0], q, omega, alpha, [0, 0, -9.8])

    def dtheta(self, rate, n):
        a, w, h = self.a, self.w, 1 / rate
        middle = (np.arange(n) + 0.5) / rate
        amplitude = 2 * np.sin(a) * np.sin(w * h / 2)
        slow = np.full(n, 2 * w * h * np.sin(a / 2) ** 2)
        return np.stack([amplitude * np.cos(w * middle), -amplitude * np.sin(w * middle), slow], axis=1)


class TestIncrements:
    @pytest.mark.parametrize("rate", [100.0, 1000.0, 10_000.0])
    def test_coning_closed_form(self, rig, rate):
        motion = Cone(np.deg2rad(5), 4 * np.pi)
        got = rig.increments(motion, rate, 6.0)
        expected = motion.dtheta(rate, len(got))
        np.testing.assert_allclose(got.dtheta_b, expected, rtol=0, atol=1e-14)
        # The sum over 6 s shows a systematic error that single increments hide.
        np.testing.assert_allclose(got.dtheta_b.sum(0), expected.sum(0), rtol=0, atol=1e-13)
        assert got.residual < 1e-14
        assert got.dt == 1 / rate
        np.testing.assert_array_equal(got.t, np.arange(1, len(got) + 1) / rate)

    def test_velocity_increments_against_adaptive_quadrature(self, rig):
        motion, array = Tumble(6), rig.accelerometers

        def field(t):
            return readings(motion.kinematics(np.array([t])), array.position, array.direction)[0]

        got = rig.increments(motion, 50.0, 0.1, t0=1.25)
        for k, row in enumerate(got.dvel):
            expected, _ = quad_vec(field, 1.25 + k / 50, 1.25 + (k + 1) / 50, epsabs=1e-15, epsrel=1e-14)
            np.testing.assert_allclose(row, expected, rtol=0, atol=5e-15)

    @pytest.mark.parametrize("chunk", [1, 7, 1000, 16384])
    def test_stream_gives_the_same_bits(self, rig, chunk):
        whole = rig.increments(Tumble(), 1000.0, 3.0 if chunk > 1 else 0.05)
        parts = list(rig.stream(Tumble(), 1000.0, 3.0 if chunk > 1 else 0.05, chunk=chunk))
        for name in ("t", "dvel", "dtheta_b"):
            np.testing.assert_array_equal(np.concatenate([getattr(p, name) for p in parts]), getattr(whole, name))
        assert {p.residual for p in parts} == {whole.residual}

    def test_low_rate_raises_the_node_count(self, rig):
        motion = Cone(np.deg2rad(5), 4 * np.pi)
        got = rig.increments(motion, 2.0, 5.0)
        assert got.nodes > 4
        assert got.residual < 1e-12
        np.testing.assert_allclose(got.dtheta_b, motion.dtheta(2.0, 10), rtol=0, atol=1e-13)

    def test_residual_bounds_the_error(self, rig):
        motion = Cone(np.deg2rad(5), 4 * np.pi)
        got = rig.increments(motion, 8.0, 5.0, tolerance=1e-3, check_every=1)
        error = np.abs(got.dtheta_b - motion.dtheta(8.0, 40)).max()
        assert 1e-13 < error <= got.residual  # 4 nodes are not enough here, and the residual says so

    def test_corner_inside_an_interval_is_refused(self, rig):
        class Corner(bench.Motion):
            def kinematics(self, t):
                velocity = np.where(t < 0.505, 0.0, t - 0.505)[:, None] * [1.0, 0, 0]
                acceleration = (t >= 0.505)[:, None] * [1.0, 0, 0]
                return bench.Kinematics(
                    [0, 0, 0], velocity, acceleration, [1, 0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, -9.8]
                )

        with pytest.raises(bench.AccuracyError, match="not smooth within one interval"):
            rig.increments(Corner(), 100.0, 1.0, check_every=1)
        rig.increments(Corner(), 200.0, 1.0, check_every=1)  # the corner is on a border

    def test_short_pulse_in_an_unchecked_interval_is_found(self, rig):
        """A smooth push of 1 ms inside one interval of 10 ms, far from the checked ones; its integral is known."""

        class Pulse(bench.Motion):
            def kinematics(self, t):
                push = 100 * np.exp(-0.5 * ((t - 50.005) / 1e-3) ** 2)
                acceleration = push[:, None] * [1.0, 0, 0]
                return bench.Kinematics(
                    [0, 0, 0], [0, 0, 0], acceleration, [1, 0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]
                )

        got = rig.increments(Pulse(), 100.0, 100.0)
        assert got.dvel[:, 0].sum() == pytest.approx(100 * np.sqrt(2 * np.pi) * 1e-3, abs=5e-12)  # 3 x 1e-12
        parts = rig.stream(Pulse(), 100.0, 100.0, chunk=7)
        np.testing.assert_array_equal(np.concatenate([part.dvel for part in parts]), got.dvel)

    def test_late_times_are_not_mistaken_for_roughness(self, rig):
        motion = Cone(np.deg2rad(5), 4 * np.pi)
        got = rig.increments(motion, 100.0, 1.0, t0=1e6)
        # t is known to 1.2e-10 s there, and a phase of 4 pi * 1e6 rad to 1.9e-9 rad.
        assert got.residual < 1e-10
        np.testing.assert_allclose(got.dtheta_b[:, 2], motion.dtheta(100.0, 100)[:, 2], rtol=0, atol=1e-15)

    def test_motion_may_spoil_its_argument(self, rig):
        class Careless(Tumble):
            def kinematics(self, t):
                truth = super().kinematics(t)
                t *= 0
                return truth

        t = np.linspace(0, 1, 50)
        got = rig.sample(Careless(), t)
        np.testing.assert_array_equal(t, np.linspace(0, 1, 50))
        np.testing.assert_array_equal(got.t, t)
        assert got.t is not t

    def test_rig_without_gyro(self):
        spec = random_array(1, 4)
        spec.delete(spec.sensor("gyro"))
        rig = bench.Rig.load(spec)
        assert rig.increments(Tumble(), 100.0, 0.1).dtheta_b is None
        assert rig.sample(Tumble(), np.arange(3.0)).gyro is None

    def test_gyro_alone(self):
        xml = '<mujoco><worldbody><body><site name="g"/><geom size="1"/></body></worldbody>'
        spec = mujoco.MjSpec.from_string(xml + '<sensor><gyro site="g"/></sensor></mujoco>')
        got = bench.Rig.load(spec).increments(Cone(0.1, 6.0), 100.0, 0.1)
        assert got.dvel.shape == (10, 0)
        np.testing.assert_allclose(got.dtheta_b, Cone(0.1, 6.0).dtheta(100.0, 10), rtol=0, atol=1e-15)


class TestBadInput:
    @pytest.mark.parametrize(
        ("t", "message"),
        [
            ([], "t must not be empty"),
            ([0.0, np.nan], r"t must be finite, got nan at \[1\]"),
            ([0.0, np.inf], "t must be finite"),
            ([[0.0]], r"t must have shape \(n,\), got \(1, 1\)"),
            ([0.0, 0.0], r"t must increase strictly, got t\[0\] = 0.0, t\[1\] = 0.0"),
            ([1.0, 0.5], "t must increase strictly"),
            ("soon", "t must be an array of real numbers"),
        ],
    )
    def test_times(self, rig, t, message):
        with pytest.raises(bench.InputError, match=message):
            rig.sample(Tumble(), t)

    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            ((-100.0, 1.0), "rate must be a positive number, got -100.0"),
            ((0.0, 1.0), "rate must be a positive number, got 0.0"),
            ((np.nan, 1.0), "rate must be finite"),
            ((100.0, -1.0), "duration must be a positive number, got -1.0"),
            ((100.0, np.inf), "duration must be finite"),
            (
                (100.0, 0.015),
                "duration must be a whole number of intervals, got duration 0.015 s at rate 100.0 Hz",
            ),
            ((100.0, 0.001), "duration must be a whole number"),
            ((100.0, 1.0, np.nan), "t0 must be finite"),
        ],
    )
    def test_increments(self, rig, arguments, message):
        with pytest.raises(bench.InputError, match=message):
            rig.increments(Tumble(), *arguments)
        with pytest.raises(bench.InputError, match=message):
            rig.stream(Tumble(), *arguments)  # at once, not at the first chunk

    def test_not_a_motion(self, rig):
        with pytest.raises(bench.InputError, match=r"motion must be a bench\.Motion, got 'coning'"):
            rig.sample("coning", np.arange(3.0))

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            ({"q_ib": [2, 0, 0, 0]}, r"q_ib must be unit quaternions \(wxyz\), got norm 2\.0"),
            ({"omega_ib_b": [np.nan, 0, 0]}, "omega_ib_b must be finite"),
            ({"omega_ib_b": [1e11, 0, 0]}, r"omega_ib_b must stay below 1e\+10 \(SI\), got 1e\+11"),
            ({"acceleration": [0, -1e12, 0]}, "acceleration - gravity must stay below"),
            ({"position": [[0, 0, 0]] * 2}, "kinematics must have 1 or 3 rows, got 2"),
        ],
    )
    def test_unusable_kinematics_raise_before_mujoco_resets_a_row(self, rig, change, message, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        names = ("position", "velocity", "acceleration", "omega_ib_b", "alpha_ib_b", "gravity")
        rest = {name: [0, 0, 0] for name in names}

        class Bad(bench.Motion):
            def kinematics(self, t):
                return bench.Kinematics(**{**rest, "q_ib": [1, 0, 0, 0], **change})

        with pytest.raises(bench.InputError, match=message):
            rig.sample(Bad(), np.arange(3.0))
        assert not (tmp_path / "MUJOCO_LOG.TXT").exists()

    def test_motion_returns_something_else(self, rig):
        class Wrong(bench.Motion):
            def kinematics(self, t):
                return t

        with pytest.raises(bench.InputError, match=r"must return bench.Kinematics, got ndarray"):
            rig.sample(Wrong(), np.arange(3.0))

    def test_error_in_one_thread_stops_the_others(self, rig):
        class Fragile(Tumble):
            calls = 0

            def kinematics(self, t):
                Fragile.calls += 1
                if Fragile.calls == 5:
                    raise RuntimeError("worn out")
                return super().kinematics(t)

        with pytest.raises(RuntimeError, match="worn out"):
            rig.sample(Fragile(), np.linspace(0, 1, 400_000))
        assert Fragile.calls < 20


class TestLoad:
    def test_unknown_name_lists_the_models(self):
        with pytest.raises(bench.UnknownNameError, match=r"unknown model 'nine_acelerometer' \(did you mean 'nine_a"):
            bench.Rig.load("nine_acelerometer")
        with pytest.raises(
            bench.UnknownNameError, match=r"imu, nine_accelerometer, six_accelerometer, .*, or a path to an MJCF file"
        ):
            bench.Rig.load("x")

    def test_missing_file(self):
        with pytest.raises(bench.InputError, match=r"model 'nowhere/rig.xml' is not a file"):
            bench.Rig.load("nowhere/rig.xml")

    def test_path(self, tmp_path):
        from bench.mjcf import models_dir

        path = tmp_path / "mine.xml"
        path.write_text((models_dir() / "imu.xml").read_text())
        assert len(bench.Rig.load(path).accelerometers) == 3
        assert bench.Rig.load(str(path)).accelerometers.names == RIGS["imu"].accelerometers.names

    @pytest.mark.parametrize(
        ("xml", "message"),
        [
            ("<mujoco><body></mujoco>", "is not valid MJCF"),
            ("not xml", "is not valid MJCF"),
            ("<mujoco/>", "model must have an <accelerometer> or a <gyro>, got 0 other sensors"),
            (
                "<mujoco><worldbody><site name='s'/></worldbody><sensor><accelerometer site='s'/></sensor></mujoco>",
                "must sit on a moving body, got the world",
            ),
            (
                "<mujoco><worldbody><body name='p'><geom size='1'/><site name='s'/></body><body name='q'>"
                "<geom size='1'/><site name='r'/></body></worldbody>"
                "<sensor><accelerometer site='s'/><gyro site='r'/></sensor></mujoco>",
                "must sit on one body, got p, q",
            ),
            (
                "<mujoco><worldbody><body><geom size='1'/><site name='s'/></body></worldbody>"
                "<sensor><accelerometer name='a' site='s' user='2'/></sensor></mujoco>",
                r"user of accelerometer 'a' must be 1 \(single axis\) or 0 \(triad\), got 2",
            ),
            (
                "<mujoco><worldbody><body><geom size='1'/><site name='s'/></body></worldbody>"
                "<sensor><gyro name='g' site='s'/><gyro name='h' site='s'/></sensor></mujoco>",
                "at most one <gyro>, got 2: g, h",
            ),
        ],
    )
    def test_unusable_mjcf(self, tmp_path, xml, message):
        path = tmp_path / "bad.xml"
        path.write_text(xml)
        with pytest.raises(bench.InputError, match=message):
            bench.Rig.load(path)

    def test_xml_text_and_impossible_names(self):
        with pytest.raises(bench.InputError, match=r"got XML text: use mujoco.MjSpec.from_string"):
            bench.Rig.load("<mujoco/>")
        with pytest.raises(bench.InputError, match=r"model 'xxxx.*is not a file: File name too long"):
            bench.Rig.load("x" * 5000)

    def test_unnamed_triads_have_different_names(self):
        xml = (
            "<mujoco><worldbody><body><geom size='1'/><site name='s'/></body></worldbody>"
            "<sensor><accelerometer site='s'/><accelerometer site='s'/></sensor></mujoco>"
        )
        names = bench.Rig.load(mujoco.MjSpec.from_string(xml)).accelerometers.names
        assert len(set(names)) == 6
        assert names[0] == "accelerometer 1_x"

    def test_neither_name_nor_spec(self):
        with pytest.raises(bench.InputError, match="model must be a name, a path to an MJCF file or an MjSpec, got 9"):
            bench.Rig.load(9)

    def test_threads(self):
        with pytest.raises(bench.InputError, match="threads must be an integer >= 1, got 0"):
            bench.Rig.load("imu", threads=0)

    def test_triad_channels_follow_the_site(self):
        """A triad turned by 90 degrees about z: its x axis is body y, its y axis is body -x."""
        xml = (
            "<mujoco><compiler angle='degree'/><worldbody><body><geom size='1'/>"
            "<site name='s' pos='1 2 3' euler='0 0 90'/></body></worldbody>"
            "<sensor><accelerometer name='T' site='s'/></sensor></mujoco>"
        )
        array = bench.Rig.load(mujoco.MjSpec.from_string(xml)).accelerometers
        assert array.names == ("T_x", "T_y", "T_z")
        np.testing.assert_allclose(array.direction, [[0, 1, 0], [-1, 0, 0], [0, 0, 1]], atol=1e-15)
        np.testing.assert_array_equal(array.position, [[1, 2, 3]] * 3)
