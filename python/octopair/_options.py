"""Values of arguments that engines, scenes and pipelines share: options of calls, element types, paths."""

from __future__ import annotations

import os
from typing import Any, Literal, Optional, Union

import numpy as np

from . import _arrays, _core
from ._errors import InputError, InputTypeError

Order = Literal["ascending", "octal"]
PathLike = Union[str, "os.PathLike[str]"]
MOST_PAIRS = (1 << 64) - 1
MOST_THREADS = 4096
_DEFAULT_OPTIONS = _core.Options()


def call_options(margin: float = 0, order: str = "ascending", limit: Optional[int] = None, verify: bool = False,
                 buffer_bytes: Optional[int] = None) -> _core.Options:
    """Returns the options of a call."""
    if type(margin) is not float:
        margin = 0.0 if type(margin) is int and margin == 0 else _arrays.margin_of(margin)  # the usual case first
    if margin == 0 and isinstance(order, str) and order == "ascending" and limit is None and not verify and buffer_bytes is None:
        return _DEFAULT_OPTIONS
    options = _core.Options()
    options.margin = margin
    if _arrays.text(order, "order") not in ("ascending", "octal"):
        raise InputError(f"order: {order!r} is neither 'ascending' nor 'octal'")
    options.octal = order == "octal"
    if limit is not None:
        options.limit = _arrays.whole(limit, "limit", MOST_PAIRS)
    if buffer_bytes is not None:
        options.buffer_bytes = max(_arrays.whole(buffer_bytes, "buffer_bytes", MOST_PAIRS), 1 << 20)
    options.verify = bool(verify)
    return options


def path_text(path: Any, name: str) -> str:
    """Returns a path as text that the system can use."""
    try:
        text = os.fspath(path)
    except TypeError:
        raise InputTypeError(f"{name}: {path!r} is not a path") from None
    if isinstance(text, bytes):
        text = os.fsdecode(text)
    if "\0" in text:
        raise InputError(f"{name}: {path!r} has a character that no path may have")
    return str(text)


def float_dtype(dtype: Any) -> np.dtype[Any]:
    """Returns float32 or float64."""
    try:
        found = np.dtype(dtype)
    except TypeError:
        raise InputTypeError(f"dtype: {dtype!r} is no dtype of NumPy") from None
    if found not in (np.float32, np.float64):
        raise InputError(f"dtype: {found} is neither float32 nor float64")
    return found
