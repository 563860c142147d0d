"""Inputs as NumPy arrays.

Arrays of the right dtype and order are read where they lie. Other arrays, and sequences of numbers, are converted if no value changes:
any numbers to floats, integers to integers, bools to bools. ``copy=True`` also rounds floats to the nearest that the dtype has.
"""

from __future__ import annotations

import collections.abc
import math
import operator
from typing import Any, List, Optional, Sequence, Tuple

import numpy as np
import numpy.typing as npt

from . import _core
from ._errors import InputError, InputTypeError


def whole(value: Any, name: str, most: int = 0xFFFFFFFF) -> int:
    """Returns an integer from 0 to `most`."""
    try:
        number = operator.index(value)
    except TypeError:
        raise InputTypeError(f"{name}: {value!r} is not an integer") from None
    if not 0 <= number <= most:
        raise InputError(f"{name}: {number} is not in the range 0 to {most}")
    return number


def real(value: Any, name: str) -> float:
    """Returns a float."""
    if isinstance(value, (str, bytes)):
        raise InputTypeError(f"{name}: {value!r} is not a number")
    try:
        return float(value)
    except OverflowError:
        raise InputError(f"{name}: {value} is beyond the range of float64") from None
    except (TypeError, ValueError):
        raise InputTypeError(f"{name}: {value!r} is not a number") from None


def length(value: Any, name: str) -> float:
    """Returns a finite number that is not below 0."""
    number = real(value, name)
    if not 0 <= number < math.inf:
        raise InputError(f"{name}: {number} is not a finite number >= 0")
    return number


def margin_of(value: Any) -> float:
    """Returns the margin of a call."""
    if isinstance(value, (list, tuple)) or getattr(value, "ndim", None):
        raise InputTypeError("margin: it is one number, not an array; pass padding= for a value for each object")
    return real(value, "margin")


def text(value: Any, name: str) -> str:
    """Returns a str that has a UTF-8 form."""
    if not isinstance(value, str):
        raise InputTypeError(f"{name}: {value!r} is not a str")
    try:
        value.encode()
    except UnicodeEncodeError:
        raise InputError(f"{name}: {value!r} has a surrogate, which no text may have") from None
    return value


def texts(values: Any, name: str) -> List[str]:
    """Returns a list of str."""
    if isinstance(values, (str, bytes)) or not hasattr(values, "__iter__"):
        raise InputTypeError(f"{name}: {values!r} is not a sequence of str")
    return [text(value, name) for value in values]


Array = npt.NDArray[Any]
ArrayLike = npt.ArrayLike

id_dtype = np.dtype([("index", np.uint32), ("generation", np.uint32)])
"""dtype of the ids of a scene's objects."""

_FLOAT32, _FLOAT64 = np.dtype(np.float32), np.dtype(np.float64)
_FLOATS = (_FLOAT32, _FLOAT64)
_SMALL_FLOATS = ("float16", "float32")


def array_of(value: Any, name: str) -> Array:
    """Returns an array that shares the memory of `value`, or that has the numbers of a sequence."""
    if type(value) is np.ndarray:
        return value
    if isinstance(value, np.ma.MaskedArray):
        raise InputTypeError(f"{name}: a masked array would lose its mask; pass {name}.compressed() or {name}.filled()")
    if isinstance(value, np.ndarray):
        return value.view(np.ndarray)
    if isinstance(value, (bool, int, float, complex, np.generic)) and not isinstance(value, np.void):
        raise InputTypeError(f"{name}: {value!r} is a number, not an array")
    if isinstance(value, (str, bytes, bytearray)):
        raise InputTypeError(f"{name}: a {type(value).__name__} is not an array; numpy.load() reads a file")
    try:
        if hasattr(value, "__array_interface__") or hasattr(value, "__array_struct__"):
            return np.asarray(value)
        if hasattr(value, "__dlpack__"):
            return np.from_dlpack(value)
        if hasattr(value, "__array__"):
            return np.asarray(value)
        if isinstance(value, collections.abc.Sequence):
            return _array_of_sequence(value, name)
    except (MemoryError, InputError):
        raise
    except Exception as error:
        raise InputTypeError(f"{name}: NumPy cannot read this {type(value).__name__}: {error}") from error
    buffer: Any = value
    try:
        return np.asarray(memoryview(buffer))
    except TypeError:
        raise InputTypeError(f"{name}: a {type(value).__name__} is not an array; pass an array or a list of rows") from None


def _array_of_sequence(value: Any, name: str) -> Array:
    """Returns the numbers of a sequence. NumPy rounds the integers of a sequence that also has floats."""
    array = np.asarray(value)
    if array.dtype.kind == "f" and array.size:
        large = np.flatnonzero(np.abs(array.reshape(-1)) >= 2.0 ** (np.finfo(array.dtype).nmant + 1))
        exact = np.asarray(value, dtype=object).reshape(-1) if len(large) else array
        for i in large:
            number = exact[i]
            if isinstance(number, (int, np.integer)) and int(array.reshape(-1)[i]) != int(number):
                _refuse_number(np.reshape(exact, array.shape), name, int(i), f"{array.dtype.name} does not have this number")
    return array


def _shape_text(shape: Sequence[Optional[int]]) -> str:
    return "(" + ", ".join("n" if size is None else str(size) for size in shape) + ("," if len(shape) == 1 else "") + ")"


def shaped(array: Array, name: str, shape: Sequence[Optional[int]]) -> Array:
    """Returns an array of this shape; None: any size. An empty sequence is an array without rows."""
    if array.ndim == len(shape) and all(want is None or want == size for want, size in zip(shape, array.shape)):
        return array
    if array.shape == (0,) and shape[0] in (None, 0):
        return array.reshape(0, *(0 if size is None else size for size in shape[1:]))
    raise InputError(f"{name}: the shape is {array.shape}; it must be {_shape_text(shape)}")


def contiguous(array: Array) -> Array:
    """Returns a C-contiguous, aligned array in the machine's byte order."""
    flags = array.flags
    if flags.c_contiguous and flags.aligned and array.dtype.isnative:
        return array
    return np.array(array, dtype=array.dtype.newbyteorder("="), order="C")


def _holds_all(dtype: np.dtype[Any], kept: np.dtype[Any]) -> bool:
    """Returns True if the floats of `dtype` have all values of the dtype `kept`."""
    if kept.kind == "f":
        return dtype.itemsize >= kept.itemsize
    return kept.kind == "b" or 8 * kept.itemsize <= np.finfo(dtype).nmant + 1


def _first_change(array: Array, found: Array) -> Optional[int]:
    """Returns the position of the first number that is another one in `found`, its conversion."""
    before, after = array.reshape(-1), found.reshape(-1)
    if array.dtype.kind == "f":
        wrong = np.flatnonzero((after.astype(array.dtype) != before) & ~np.isnan(before))
        return int(wrong[0]) if len(wrong) else None
    if found.dtype.kind == "f":
        limit = 2 ** (np.finfo(found.dtype).nmant + 1)
        large = np.flatnonzero((before > limit) | (before < -limit))
        return next((int(i) for i in large if int(before[i]) != int(after[i])), None)
    wrong = np.flatnonzero(before != after)
    return int(wrong[0]) if len(wrong) else None


def _refuse_number(array: Array, name: str, position: int, wanted: str) -> None:
    place = [int(i) for i in np.unravel_index(position, array.shape)]
    raise InputError(f"{name}{place} is {array.reshape(-1)[position]}; {wanted}", place[0])


def floats_of(array: Array, name: str, dtype: np.dtype[Any] = _FLOAT64, rounds: bool = False) -> Array:
    """Returns numbers as float32 or float64, C-contiguous. `rounds`: takes the nearest of a float that `dtype` has not."""
    if array.dtype == dtype:
        return contiguous(array)
    if array.size and array.dtype.kind not in "biuf":
        raise InputTypeError(f"{name}: the dtype is {array.dtype}; it must be numbers. For numbers in another form pass "
                             f"numpy.array({name}, dtype=float)")
    with np.errstate(over="ignore"):
        found = np.array(array, dtype=dtype, order="C")
    if not array.size or _holds_all(dtype, array.dtype) or (rounds and array.dtype.kind == "f"):
        return found
    wrong = _first_change(array, found)
    if wrong is not None:
        remedies = ["make the scene with dtype='float64'"] if dtype == _FLOAT32 else []
        remedies += [f"pass {name}.astype(numpy.{dtype.name}) to round it"] if array.dtype.kind == "f" else []
        _refuse_number(array, name, wrong, "; ".join([f"{dtype.name} does not have this number", ", or ".join(remedies)]).rstrip("; "))
    return found


def numbers(value: Any, name: str, shape: Sequence[Optional[int]]) -> Array:
    """Returns float64 numbers of this shape."""
    return floats_of(shaped(array_of(value, name), name, shape), name)


def integers(value: Any, name: str, shape: Sequence[Optional[int]], dtype: Any = np.uint32, copy: bool = False) -> Array:
    """Returns integers of this shape and unsigned dtype. `copy`: also converts floats that are whole numbers."""
    array = shaped(array_of(value, name), name, shape)
    kind = np.dtype(dtype)
    if array.dtype == kind or not array.size:
        return contiguous(array.astype(kind, copy=False))
    if array.dtype.kind == "f":
        inside = (array >= 0) & (array < 2.0 ** (8 * kind.itemsize))  # False for a NaN
        found = np.where(inside, array, 0).astype(kind)
        wrong = _first_change(array, found) if inside.all() else int(np.flatnonzero(~inside.reshape(-1))[0])
        if wrong is not None:
            _refuse_number(array, name, wrong, f"it must be an integer from 0 to {np.iinfo(kind).max}")
        if copy:
            return found
    if array.dtype.kind not in "iu":
        raise InputTypeError(f"{name}: the dtype is {array.dtype}; it must be integers: pass {name}.astype(numpy.{kind.name})")
    outside = np.flatnonzero(((array < 0) | (array > np.iinfo(kind).max)).reshape(-1))
    if len(outside):
        _refuse_number(array, name, int(outside[0]), f"it must be an integer from 0 to {np.iinfo(kind).max}")
    return contiguous(array.astype(kind))


def boxes(value: Any, name: str = "boxes", copy: bool = False, dtype: Optional[np.dtype[Any]] = None) -> Array:
    """Returns boxes of shape (n, 6), float32 or float64; of the scene's `dtype`, if given. Makes boxes of spheres, shape (n, 4)."""
    # The usual case, without the checks that only choose an error message.
    if type(value) is np.ndarray and value.ndim == 2 and value.shape[1] == 6 and value.dtype in _FLOATS:
        flags = value.flags
        if flags.c_contiguous and flags.aligned and (dtype is None or value.dtype == dtype):
            return value
    array = array_of(value, name)
    if array.shape == (0,):
        array = array.reshape(0, 6)
    if array.ndim != 2 or array.shape[1] not in (4, 6):
        raise InputError(f"{name}: the shape is {array.shape}; boxes have the shape (n, 6), and spheres (n, 4)")
    wanted = dtype or (_FLOAT32 if array.dtype.name in _SMALL_FLOATS else _FLOAT64)
    found = floats_of(array, name, wanted, copy or isinstance(value, (list, tuple)))  # floats of a list have no dtype of their own
    return found if array.shape[1] == 6 else _core.sphere_boxes(found, int(name == "against"))


def column(value: Any, name: str, size: int, dtype: Any, copy: bool = False) -> Optional[Array]:
    """Returns a column with a value for each of `size` objects. A number stands for all of them; None stays None."""
    if value is None:
        return None
    kind = np.dtype(dtype)
    if isinstance(value, (bool, int, float, np.generic)):
        number = np.asarray(value)
        if kind.kind == "f" and number.dtype.kind in "iuf":
            return np.full(size, floats_of(number.reshape(1), name, kind, copy))
        if not np.can_cast(number, kind, "safe") and not (kind.kind == "u" and number.dtype.kind in "iu" and number >= 0):
            raise InputTypeError(f"{name}: {value!r} is not a number of the dtype {kind.name}")
        if kind.kind == "u" and number > np.iinfo(kind).max:
            raise InputError(f"{name}: {value} is greater than {np.iinfo(kind).max}")
        return np.full(size, value, dtype=kind)
    array = shaped(array_of(value, name), name, (None,))
    if len(array) != size:
        raise InputError(f"{name}: {len(array)} values for {size} objects")
    if kind.kind == "f":
        return floats_of(array, name, kind, copy)
    if kind.kind == "u":
        return integers(array, name, (None,), kind, copy)
    return _flags(array, name, copy)


def _flags(array: Array, name: str, copy: bool) -> Array:
    """Returns bools. `copy`: also converts the numbers 0 and 1."""
    if array.dtype == np.bool_ or not array.size or (copy and array.dtype.kind in "iuf" and np.isin(array, (0, 1)).all()):
        return contiguous(array.astype(np.bool_, copy=False))
    raise InputTypeError(f"{name}: the dtype is {array.dtype}; it must be bool: True or False for each object")


def join_input(value: Any, against: Any, paddings: Tuple[Any, Any], copy: bool) -> Tuple[Any, ...]:
    """Returns the arguments of _core.Input."""
    first = boxes(value, "boxes", copy)
    padding, against_padding = paddings
    if against is None:
        if against_padding is not None:
            raise InputError("against_padding: there is no second set; pass against")
        return (first,) if padding is None else (first, column(padding, "padding", len(first), np.float64, copy))
    if isinstance(against, (int, float, np.number)):
        raise InputTypeError(f"against: {against!r} is a number, not boxes of a second set; for a margin pass margin={against!r}")
    second = boxes(against, "against", copy)
    return (first, column(padding, "padding", len(first), np.float64, copy), second,
            column(against_padding, "against_padding", len(second), np.float64, copy))
