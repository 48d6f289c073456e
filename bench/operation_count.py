"""Operation counts: kernels run uncompiled on numbers that count their own multiplications, additions and so on.

The very source of a kernel is executed, with every branch and loop it takes on the given data. While counting,
the kernels of all loaded modules are replaced by their Python functions, and `math` and `numpy` in those modules by
stand-ins whose arrays hold counting numbers; code outside of kernels is neither changed nor counted.
"""

import math
import operator
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import astuple, dataclass, field, fields
from types import ModuleType
from typing import Any

import numpy as np

from bench.errors import BenchError

TRIGONOMETRIC = ("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "exp", "log")
UNCOUNTED = ("fabs", "copysign", "floor", "ceil")  # sign bits and conversions: no arithmetic


@dataclass(frozen=True)
class Operations:
    """Floating-point operations; a mean over several updates may be a fraction.

    Attributes
    ----------
    multiplications, divisions, additions, subtractions, roots, trigonometric : float
        As executed. Changes of sign, comparisons, copies and integer arithmetic are not counted.
    trivial : float
        Those among the first four with an operand of exactly 0, or (products, quotients) 1 or -1: what a hand count
        or a compiler would leave out. 0 and 1 are structural if the data are generic.
    """

    multiplications: float = 0
    divisions: float = 0
    additions: float = 0
    subtractions: float = 0
    roots: float = 0
    trigonometric: float = 0
    trivial: float = 0

    @property
    def total(self) -> float:
        """All operations, the trivial ones included."""
        return sum(astuple(self)[:-1])

    def combine(self, other: "Operations", weight: float) -> "Operations":
        """Return self + weight * other."""
        return Operations(*(a + weight * b for a, b in zip(astuple(self), astuple(other), strict=True)))

    def scaled(self, factor: float) -> "Operations":
        """Return the counts times a factor."""
        return Operations(*(factor * a for a in astuple(self)))


MULTIPLY, DIVIDE, ADD, SUBTRACT, ROOT, TRIGONOMETRY, TRIVIAL = range(len(fields(Operations)))


@dataclass
class Tally:
    """What a block of code computed, by the kernel that computed it."""

    by_kernel: dict[str, list[int]] = field(default_factory=dict)
    running: list[str] = field(default_factory=list)

    def of(self, kernel: str) -> Operations:
        """Return the operations of one kernel ("module.function"), without those of the kernels that it calls."""
        return Operations(*self.by_kernel.get(kernel, ()))

    @property
    def operations(self) -> Operations:
        """The operations of all kernels."""
        return Operations(*map(sum, zip(*self.by_kernel.values(), strict=True)))


_counts = [0] * len(fields(Operations))  # of the kernel that runs now


def _binary(kind: int, apply: Callable[[Any, Any], Any], *, reflected: bool = False) -> Callable[[Any, Any], Any]:
    product, quotient = kind == MULTIPLY, kind == DIVIDE

    def method(self: "Number", other: Any) -> Any:
        if type(other) is Number:
            b = other.value
        elif isinstance(other, (int, float, np.number)):
            b = float(other)
        else:
            return NotImplemented
        a, b = (b, self.value) if reflected else (self.value, b)
        _counts[kind] += 1
        zero = a == 0.0 or (b == 0.0 and not quotient)
        one = (product and abs(a) == 1.0) or ((product or quotient) and abs(b) == 1.0)
        _counts[TRIVIAL] += zero or one
        return Number(apply(a, b))

    return method


def _comparison(apply: Callable[[Any, Any], bool]) -> Callable[[Any, Any], bool]:
    return lambda self, other: apply(self.value, other.value if type(other) is Number else other)


def _function(kind: int | None, apply: Callable[..., float]) -> Callable[..., Any]:
    def function(*values: Any) -> Any:
        if kind is not None:
            _counts[kind] += 1
        return Number(apply(*(v.value if type(v) is Number else v for v in values)))

    return function


def _divide(a: float, b: float) -> float:
    return float(np.divide(a, b))  # IEEE: kernels divide by zero without an exception


class Number:
    """A float that counts what is done to it. There is no way back to float, so nothing escapes the count."""

    __slots__ = ("value",)

    def __init__(self, value: float):
        self.value = value

    def __repr__(self) -> str:
        return f"Number({self.value!r})"

    __mul__, __rmul__ = _binary(MULTIPLY, operator.mul), _binary(MULTIPLY, operator.mul, reflected=True)
    __truediv__, __rtruediv__ = _binary(DIVIDE, _divide), _binary(DIVIDE, _divide, reflected=True)
    __add__, __radd__ = _binary(ADD, operator.add), _binary(ADD, operator.add, reflected=True)
    __sub__, __rsub__ = _binary(SUBTRACT, operator.sub), _binary(SUBTRACT, operator.sub, reflected=True)
    __lt__, __le__ = _comparison(operator.lt), _comparison(operator.le)
    __gt__, __ge__ = _comparison(operator.gt), _comparison(operator.ge)
    __eq__, __ne__ = _comparison(operator.eq), _comparison(operator.ne)
    __hash__ = None  # type: ignore[assignment]

    def __pow__(self, exponent: int) -> "Number":
        result = self  # as a compiler does it: repeated squares, and products of them
        for bit in f"{operator.index(exponent):b}"[1:]:
            result = result * result
            if bit == "1":
                result = result * self
        return result

    def __neg__(self) -> "Number":
        return Number(-self.value)

    def __pos__(self) -> "Number":
        return self

    def __abs__(self) -> "Number":
        return Number(abs(self.value))

    def __bool__(self) -> bool:
        return self.value != 0.0

    def __int__(self) -> int:
        return int(self.value)


class _Math:
    """Stands for the module `math` in a kernel."""

    pi, e, inf, nan = math.pi, math.e, math.inf, math.nan
    sqrt = staticmethod(_function(ROOT, math.sqrt))

    def __getattr__(self, name: str) -> Any:
        if name in TRIGONOMETRIC:
            return _function(TRIGONOMETRY, getattr(math, name))
        if name in UNCOUNTED:
            return _function(None, getattr(math, name))
        if name in ("isfinite", "isnan", "isinf"):
            return lambda x: getattr(math, name)(x.value if type(x) is Number else x)
        raise BenchError(f"math.{name} cannot be counted")


class _NumPy:
    """Stands for the module `numpy` in a kernel: its arrays hold counting numbers."""

    def __getattr__(self, name: str) -> Any:
        original = getattr(np, name)
        if name in ("empty", "zeros", "ones", "full", "eye", "empty_like", "zeros_like", "ones_like"):
            return lambda *args, **options: _counting(_made(name, original, args, options))
        if name in ("sqrt", "sin", "cos", "tan", "exp", "log", "floor", "isfinite", "isnan"):
            return getattr(_Math(), name)
        if name in ("abs", "fabs", "absolute"):
            return abs
        if isinstance(original, (type, float)):  # np.float64, np.pi
            return original
        raise BenchError(f"numpy.{name} cannot be counted")


def _made(name: str, original: Callable[..., Any], args: tuple[Any, ...], options: dict[str, Any]) -> Any:
    if name.endswith("_like") and args[0].dtype == object and "dtype" not in options:
        options = {**options, "dtype": np.float64}
    return original(*(a.value if type(a) is Number else a for a in args), **options)


def _counting(value: Any) -> Any:
    """Return a value with every float in it as a counting number."""
    if isinstance(value, np.ndarray) and value.dtype == np.float64:
        counted = np.empty(value.shape, dtype=object)
        counted.ravel()[:] = [Number(x) for x in value.ravel().tolist()]
        return counted
    if isinstance(value, (float, np.floating)):
        return Number(float(value))
    return tuple(map(_counting, value)) if isinstance(value, tuple) else value


def _plain(value: Any) -> Any:
    """Return a value with every counting number in it as a float."""
    if isinstance(value, np.ndarray) and value.dtype == object:
        return np.array([x.value if type(x) is Number else float(x) for x in value.ravel()]).reshape(value.shape)
    if type(value) is Number:
        return value.value
    return tuple(map(_plain, value)) if isinstance(value, tuple) else value


def _return_arrays(original: Any, counted: Any) -> None:
    """Write what a kernel left in its arguments back to the caller's arrays."""
    if isinstance(original, tuple):
        for one, other in zip(original, counted, strict=True):
            _return_arrays(one, other)
    elif isinstance(counted, np.ndarray) and counted.dtype == object and original.flags.writeable:
        original[...] = _plain(counted)


def _instrumented(kernel: Any, tally: Tally) -> Callable[..., Any]:
    function = getattr(kernel, "py_func", kernel)  # a plain function where compilation is switched off
    name = f"{function.__module__.rpartition('.')[2]}.{function.__name__}"
    counts = tally.by_kernel.setdefault(name, [0] * len(_counts))

    def run(*args: Any) -> Any:
        global _counts
        outer, _counts = _counts, counts
        tally.running.append(name)
        try:
            if len(tally.running) > 1:  # called by a kernel: the arguments count already
                return function(*args)
            counted = _counting(args)
            result = function(*counted)
            _return_arrays(args, counted)
            return _plain(result)
        finally:
            tally.running.pop()
            _counts = outer

    return run


def _is_kernel(value: Any) -> bool:
    from bench.jit import njit

    module = sys.modules.get(getattr(value, "__module__", None) or "")
    return callable(value) and value is not njit and module is not None and vars(module).get("njit") is njit


def _replacements(module: ModuleType, tally: Tally) -> dict[str, Any]:
    found: dict[str, Any] = {
        name: _instrumented(value, tally) for name, value in vars(module).items() if _is_kernel(value)
    }
    if found:
        stand_ins: dict[int, Any] = {id(math): _Math(), id(np): _NumPy()}
        found |= {name: stand_ins[id(value)] for name, value in vars(module).items() if id(value) in stand_ins}
    return found


@contextmanager
def counting() -> Iterator[Tally]:
    """Count the operations of all kernels that the block calls, in modules that are loaded already.

    The results are those of the compiled kernels, some thousand times slower. Not for several threads.

    Yields
    ------
    Tally
        Grows while the block runs.

    Raises
    ------
    BenchError
        If a kernel calls a function of `math` or `numpy` that cannot be counted.
    """
    tally = Tally()
    modules = [module for name, module in sorted(sys.modules.items()) if module and "njit" in vars(module)]
    patched = [(module, _replacements(module, tally)) for module in modules]
    originals = [(module, {name: vars(module)[name] for name in new}) for module, new in patched]
    try:
        for module, new in patched:
            vars(module).update(new)
        yield tally
    finally:
        for module, old in originals:
            vars(module).update(old)
