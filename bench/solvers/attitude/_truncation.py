"""How many terms a Taylor series of the attitude keeps, and the warning when the data need more.

Not the angle decides but sum |w_m|: the coefficient w_m enters with the power m + 1 only, and the noise of increments
makes the highest coefficients large. With 1 arcsec of quantisation the 10 terms of the paper do up to N = 4; N = 6
needs 30, N = 8 over 100.
"""

import math
import warnings

import numpy as np

from bench.errors import AccuracyError, Array, BenchWarning, InputError, require_integer

MOST_TERMS = 300
LOOKED_AT = 500  # terms, in the estimate of what is left out
TOLERANCE = 1e-10  # rad per update
GARBAGE = 1e-3  # rad per update


def require_terms(terms: int | None) -> None:
    """Check the option `terms`.

    Raises
    ------
    InputError
        If it is neither None nor an integer from 1 to 300.
    """
    if terms is not None and require_integer("terms", terms, minimum=1) > MOST_TERMS:
        raise InputError(f"terms must be an integer from 1 to {MOST_TERMS}, got {terms}")


def first_left_out(x: float, terms: int) -> float:
    """Return x^(terms + 1)/(terms + 1)!, the first term that is left out of exp(x)."""
    return math.exp((terms + 1) * math.log(x) - math.lgamma(terms + 2))


def warn_if_truncated(name: str, terms: int, squares: Array, share: float, angle: float) -> bool:
    """Warn if the terms left out may turn the attitude by more than 1e-10 rad in one update.

    Parameters
    ----------
    name : str
        Of the solver.
    terms : int
        Terms kept.
    squares : ndarray, shape (W,), rad^2
        Largest |w_m|^2 so far.
    share : float
        Of the rate in the equation of the series: 1/2 for a quaternion, 1 for a matrix.
    angle : float, rad
        Largest angle that a unit of what is left out stands for.

    Returns
    -------
    bool
        Whether it warned: of terms left out, or of rounding where an update turns too far for a power series.

    Raises
    ------
    AccuracyError
        If a square is not finite, or rounding may exceed 1e-3 rad in an update.
    """
    from bench.solvers.attitude._taylor_kernels import neglected

    if not np.isfinite(squares).all():
        raise AccuracyError(f"{name} overflows: the increments are too large for it")
    sizes = np.sqrt(squares)
    bound, needed = neglected(sizes, share, terms, TOLERANCE / angle, LOOKED_AT)
    if angle * bound <= TOLERANCE:
        return _warn_if_far(name, sizes[0], share, angle)
    reach = angle * bound if angle * bound < np.pi else np.pi  # also where the bound overflows
    enough = f"more than {LOOKED_AT}" if needed == LOOKED_AT else f"about {needed}"
    warnings.warn(
        f"{name}: terms = {terms} is too low for these increments: what is left out may reach "
        f"{reach:.1g} rad in an update; {enough} terms are needed for {TOLERANCE:g} rad "
        f"(sum |w_m| = {sizes.sum():.3g} rad)",
        BenchWarning,
        stacklevel=5,  # the caller of `solve` or `advance`
    )
    return True


def _warn_if_far(name: str, turn: float, share: float, angle: float) -> bool:
    """Warn of rounding: the terms of the series grow to exp(share |w_0|) before they cancel."""
    rounding = angle * np.finfo(float).eps * math.exp(min(share * turn, 700.0))
    if rounding > GARBAGE:
        raise AccuracyError(f"{name}: an update turns too far for a power series, |w_0| = {turn:.3g} rad")
    if rounding <= TOLERANCE:
        return False
    warnings.warn(
        f"{name}: an update turns by about {turn:.3g} rad, so far that rounding of the series may reach "
        f"{rounding:.1g} rad in an update: take fewer samples per update",
        BenchWarning,
        stacklevel=6,
    )
    return True
