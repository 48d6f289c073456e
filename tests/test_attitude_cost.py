"""Operation counts against counts by hand, and table 1 of the paper against its own formulas.

Truth: hand counts written out in the tests, the printed table, and the compiled kernels for the values.
"""

import importlib
import math
import sys

import numpy as np
import pytest

import bench
from bench.errors import BenchError
from bench.experiments import _attitude_cost_counts as counts
from bench.experiments import _attitude_cost_verdicts as verdicts
from bench.experiments._attitude_limits_solvers import Variant, variants
from bench.operation_count import Number, Operations, counting

TOY = """
import math
import numpy as np
from bench.jit import njit

@njit
def square_sum(a):
    total = 0.0
    for i in range(a.shape[0]):
        total += a[i] * a[i]
    return total

@njit
def length_and_more(a, out):
    scratch = np.empty(2)
    scratch[0] = math.sqrt(square_sum(a))
    scratch[1] = math.sin(a[0]) / 2.0 - 1.0
    out[0] = -scratch[0]
    out[1] = scratch[1] ** 3

GAIN, GAINS, COUNT = np.float64(2.0), np.array([2.0, 4.0]), 3

@njit
def constants_on_the_left(a, out):
    out[0] = GAIN * a[0] + GAINS[1] / a[1]
    out[1] = COUNT - a[0]
    if GAIN < a[0]:
        out[1] = 0.0

@njit
def forbidden(a):
    return np.linalg.norm(a)
"""


@pytest.fixture
def toy(tmp_path, monkeypatch):
    """A module of kernels whose operations are counted by hand."""
    (tmp_path / "toy_kernels.py").write_text(TOY)
    monkeypatch.syspath_prepend(tmp_path)
    yield importlib.import_module("toy_kernels")
    del sys.modules["toy_kernels"]


def test_toy_kernel_by_hand(toy):
    a, out = np.array([0.3, 0.4, 1.2]), np.zeros(2)
    with counting() as tally:
        toy.length_and_more(a, out)
    # Three squares and three sums (the first to 0); root, sine, quotient, difference; a cube is two products.
    assert tally.operations == Operations(3 + 2, 1, 3, 1, 1, 1, trivial=1)
    assert tally.of("toy_kernels.square_sum") == Operations(3, 0, 3, 0, 0, 0, trivial=1)
    np.testing.assert_array_equal(out, [-math.sqrt(0.3**2 + 0.4**2 + 1.2**2), (math.sin(0.3) / 2 - 1) ** 3])
    np.testing.assert_array_equal(a, [0.3, 0.4, 1.2])
    assert toy.math is math  # restored
    assert toy.np is np


def test_what_cannot_be_counted_is_refused(toy):
    with counting(), pytest.raises(BenchError, match=r"numpy\.linalg cannot be counted"):
        toy.forbidden(np.ones(3))
    assert toy.np is np


def test_a_counting_number_does_not_leak():
    with pytest.raises(TypeError):
        float(Number(1.0))
    with pytest.raises(TypeError):
        np.zeros(1)[0] = Number(1.0)


def test_constants_on_the_left_are_counted(toy):
    out = np.zeros(2)
    with counting() as tally:
        toy.constants_on_the_left(np.array([1.5, 3.0]), out)
    assert tally.operations == Operations(1, 1, 1, 1)
    np.testing.assert_array_equal(out, [2.0 * 1.5 + 4.0 / 3.0, 3 - 1.5])


def test_one_sample_rotation_vector_by_hand():
    """The 1-sample update, term by term as its kernels are written.

    The increment times its coefficient 1: 3 products. The square of the angle: 3 products, 2 sums; two polynomials
    of degree 4 in it: 4 products and 4 sums each; 3 products for the vector part. The product of two quaternions:
    16 products, 6 sums, 6 differences. Keeping the norm, 1.5 - 0.5 |q|^2 times q: 4 + 1 + 4 products, 3 sums and
    1 difference.
    """
    tallies, difference = counts.count_solver(Variant("rotation-vector", 1).build())
    found = counts.per_update(tallies)
    assert difference == 0.0
    assert found.multiplications == 3 + (3 + 2 * 4 + 3) + 16 + (4 + 1 + 4)
    assert found.additions == (2 + 2 * 4) + 6 + 3
    assert found.subtractions == 6 + 1
    assert (found.divisions, found.roots, found.trigonometric) == (0, 0, 0)


def test_large_angles_take_the_other_branch():
    """Above 0.2 rad: one root, sine and cosine."""
    solver = bench.solver("attitude", "rotation-vector", samples=1)
    data = np.full((2, 3), [0.2, 0.1, -0.3])
    solver.solve(data, 0.01, counts.START)
    with counting() as tally:
        solver.solve(data, 0.01, counts.START)
    assert (tally.operations.roots, tally.operations.trigonometric) == (2, 4)


@pytest.mark.parametrize("label", [v.label for v in variants(3)])
def test_counted_and_compiled_runs_agree(label):
    """The counted source is the compiled source: the same attitude, to the few roundings of contracted functions."""
    variant = next(v for v in variants(3) if v.label == label)
    tallies, difference = counts.count_solver(variant.build())
    assert difference <= 4e-16
    assert counts.per_update(tallies).total > 40


def test_counts_are_deterministic():
    first, second = (counts.measure(counts.AS_PRINTED[1]) for _ in range(2))
    assert all(np.array_equal(first[name], second[name]) for name in first.columns)


class TestPrintedFormulas:
    """The paper's formulas, executed."""

    @pytest.mark.parametrize("name", counts.FORMULAS)
    def test_they_give_the_solver_s_attitude(self, name):
        # Series of ten terms: quaternion and matrix stop at different errors, 1e-13 rad here.
        _, difference = counts.count_formula(name)
        assert difference < 1e-12

    def test_rotation_vector_is_as_printed(self):
        found, _ = counts.count_formula("rotation vector")
        assert found == Operations(70, 4, 32, 18, 1, 2)

    @pytest.mark.parametrize(("name", "size", "fixed"), [("quaternion", 4, 16 + 30), ("DCM", 3, 27)])
    def test_transition_matrices_by_hand(self, name, size, fixed):
        found, _ = counts.count_formula(name)
        cells, products = size * size, 1 + 2 + 8 * 3
        # Dense products, binomials other than 1, weights 1/k!, the last product (and the matrix), the fit.
        assert found.multiplications == products * size**3 + 15 * cells + 9 * cells + fixed + 27
        assert found.divisions == found.roots == found.trigonometric == 0

    def test_matrix_of_a_quaternion(self):
        from bench.experiments import _attitude_cost_formulas as formulas

        with counting() as tally:
            formulas.matrix_of(*counts.START.tolist(), np.empty(9))
        assert tally.operations == verdicts.TO_MATRIX

    def test_account_of_the_printed_multiplications(self):
        assert verdicts.account_totals() == (2043, 920)


def test_run():
    outcome = bench.run("attitude-cost", max_samples=1, repeats=1, timed_updates=8)
    judged = {key: verdict.judgement for key, verdict in outcome.evaluation.verdicts.items()}
    assert judged == {
        "rotation vector operations": "holds",
        "quaternion operations": "does not hold",
        "DCM operations": "does not hold",
        "rotation vector cheapest": "holds",
        "DCM preferred": "does not hold",
    }
    assert (outcome.tables["times"]["kernel_ns"] > 0).all()
    assert not any(name.endswith("_ns") for name in outcome.rows.columns)  # rows do not depend on the machine


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"max_samples": 9}, "max_samples must be an integer from 1 to 8, got 9"),
        ({"max_samples": 0}, "max_samples must be an integer >= 1, got 0"),
        ({"repeats": -1}, "repeats must be an integer >= 0, got -1"),
        ({"timed_updates": 0}, "timed_updates must be an integer >= 1, got 0"),
    ],
)
def test_bad_options(options, message):
    with pytest.raises(bench.InputError, match=message):
        counts.Options(**options)
