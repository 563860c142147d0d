"""Inputs as NumPy arrays.

Arrays of the right dtype and order are read where they lie. Other arrays are refused with an error that says how to convert them;
``copy=True`` converts them.
"""

from __future__ import annotations

import math
import operator
from typing import Any, List, Optional, Sequence, Tuple

import numpy as np
import numpy.typing as npt

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

id_dtype = np.dtype([("index", np.uint32), ("generation", np.uint32)])
"""dtype of the ids of a scene's objects."""

_FLOATS = (np.dtype(np.float32), np.dtype(np.float64))
_TO_COPY = "or pass copy=True"


def array_of(value: Any, name: str, copy: bool = False) -> Array:
    """Returns an array that shares the memory of `value`, or a copy of a sequence if `copy` is true."""
    if type(value) is np.ndarray:
        return value
    if isinstance(value, np.ma.MaskedArray):
        raise InputTypeError(f"{name}: a masked array would lose its mask; pass {name}.compressed() or {name}.filled()")
    if isinstance(value, np.ndarray):
        return value.view(np.ndarray)
    if hasattr(value, "__array_interface__") or hasattr(value, "__array_struct__"):
        return np.asarray(value)
    if hasattr(value, "__dlpack__"):
        try:
            return np.from_dlpack(value)
        except Exception as error:
            raise InputTypeError(f"{name}: NumPy cannot read this {type(value).__name__}: {error}") from error
    if isinstance(value, (str, bytes, bytearray)):
        raise InputTypeError(f"{name}: a {type(value).__name__} is not an array; numpy.load() reads a file")
    try:
        return np.asarray(memoryview(value))
    except TypeError:
        pass
    if copy:
        try:
            return np.array(value)
        except ValueError as error:
            raise InputTypeError(f"{name}: {error}") from error
    raise InputTypeError(f"{name}: a {type(value).__name__} is not an array; pass numpy.array({name}), {_TO_COPY}")


def _shape_text(shape: Sequence[Optional[int]]) -> str:
    return "(" + ", ".join("n" if size is None else str(size) for size in shape) + ("," if len(shape) == 1 else "") + ")"


def _check_shape(array: Array, name: str, shape: Sequence[Optional[int]]) -> None:
    fits = array.ndim == len(shape) and all(want is None or want == size for want, size in zip(shape, array.shape))
    if not fits:
        raise InputError(f"{name}: the shape is {array.shape}; it must be {_shape_text(shape)}")


def _converted(array: Array, name: str, dtype: Any) -> Array:
    """Returns numbers as another dtype. Integers must keep their values."""
    if dtype.kind == "f":
        return np.ascontiguousarray(array, dtype=dtype)
    with np.errstate(invalid="ignore"):
        found = np.ascontiguousarray(array, dtype=dtype)
    wrong = np.flatnonzero((found != array).reshape(-1))
    if len(wrong):
        raise InputError(f"{name}: element {wrong[0]} is {array.reshape(-1)[wrong[0]]}, which {dtype.name} cannot hold")
    return found


def checked(value: Any, name: str, shape: Sequence[Optional[int]], dtypes: Sequence[Any], copy: bool = False) -> Array:
    """Returns an array of this shape (None: any size), C-contiguous, of one of the dtypes.

    With `copy`, converts to the first dtype if the array has none of them.
    """
    array = array_of(value, name, copy)
    wanted = [np.dtype(dtype) for dtype in dtypes]
    _check_shape(array, name, shape)
    if array.dtype not in wanted:
        if not copy:
            first = wanted[-1].name  # float64 loses less than float32
            raise InputTypeError(f"{name}: the dtype is {array.dtype}; it must be {' or '.join(d.name for d in wanted)}. "
                                 f"Pass {name}.astype(numpy.{first}), {_TO_COPY}")
        if array.dtype.kind not in "biuf":
            raise InputTypeError(f"{name}: numbers of the dtype {array.dtype} cannot become {wanted[0].name}")
        return _converted(array, name, wanted[0])
    if not array.flags.c_contiguous or not array.flags.aligned:
        if not copy and array.flags.aligned:
            raise InputError(f"{name}: the array is not C-contiguous; pass numpy.ascontiguousarray({name}), {_TO_COPY}")
        if not copy:
            raise InputError(f"{name}: the array is not aligned; pass {name}.copy(), {_TO_COPY}")
        return np.array(array, order="C")  # ascontiguousarray would return an array that is not aligned
    return array


def boxes(value: Any, name: str = "boxes", copy: bool = False) -> Array:
    """Returns boxes of shape (n, 6), float32 or float64."""
    # The usual case, without the checks that only choose an error message.
    if type(value) is np.ndarray and value.ndim == 2 and value.shape[1] == 6 and value.dtype in _FLOATS:
        flags = value.flags
        if flags.c_contiguous and flags.aligned:
            return value
    if copy:
        array = array_of(value, name, True)
        return checked(array, name, (None, 6), _FLOATS if array.dtype in _FLOATS else (np.float64,), True)
    return checked(value, name, (None, 6), _FLOATS)


def numbers(value: Any, name: str, shape: Sequence[Optional[int]], copy: bool = False) -> Array:
    """Returns float64 numbers. Converts float32 without loss; other dtypes only with `copy`."""
    array = array_of(value, name, copy)
    _check_shape(array, name, shape)
    if array.dtype == np.float32 or copy:
        if array.dtype.kind not in "biuf":
            raise InputTypeError(f"{name}: numbers of the dtype {array.dtype} cannot become float64")
        return np.array(array, dtype=np.float64, order="C")
    return checked(array, name, shape, (np.float64,))


def column(value: Any, name: str, size: int, dtype: Any, copy: bool = False) -> Optional[Array]:
    """Returns a column with a value for each of `size` objects. A number stands for all of them; None stays None."""
    if value is None:
        return None
    kind = np.dtype(dtype)
    if isinstance(value, (bool, int, float, np.generic)):
        number = np.asarray(value)
        if not np.can_cast(number, kind, "safe") and not (kind.kind == "u" and number.dtype.kind in "iu" and number >= 0):
            raise InputTypeError(f"{name}: {value!r} is not a number of the dtype {kind.name}")
        if kind.kind == "u" and number > np.iinfo(kind).max:
            raise InputError(f"{name}: {value} is greater than {np.iinfo(kind).max}")
        return np.full(size, value, dtype=kind)
    array = checked(value, name, (None,), (kind,), copy)
    if len(array) != size:
        raise InputError(f"{name}: {len(array)} values for {size} objects")
    return array


def ids(value: Any, name: str = "ids") -> Array:
    """Returns a one-dimensional array of ids."""
    array = array_of(value, name)
    if array.dtype != id_dtype:
        raise InputTypeError(f"{name}: the dtype is {array.dtype}; pass ids that add() returned (octopair.id_dtype)")
    if array.ndim == 0:
        array = array.reshape(1)
    _check_shape(array, name, (None,))
    if not array.flags.c_contiguous:
        raise InputError(f"{name}: the array is not C-contiguous; pass numpy.ascontiguousarray({name})")
    return array


def join_input(value: Any, against: Any, paddings: Tuple[Any, Any], copy: bool) -> Tuple[Any, ...]:
    """Returns the arguments of _core.Input."""
    first = boxes(value, "boxes", copy)
    padding, against_padding = paddings
    if against is None:
        if against_padding is not None:
            raise InputError("against_padding: there is no second set; pass against")
        return (first,) if padding is None else (first, column(padding, "padding", len(first), np.float64, copy))
    second = boxes(against, "against", copy)
    return (first, column(padding, "padding", len(first), np.float64, copy), second,
            column(against_padding, "against_padding", len(second), np.float64, copy))

