"""Exceptions. One table maps the codes of the C++ library to classes of Python.

Their ``__module__`` is that of their users, so tracebacks show ``octopair.InputError``.
"""

from __future__ import annotations

from typing import Optional

__all__ = ["Error", "InputError", "InputTypeError", "UsageError", "FileError", "ResourceLimitError", "EngineError",
           "CancelledError"]


class Error(Exception):
    """Base class of all errors of octopair.

    Attributes
    ----------
    code : str
        Kind of the failure: ``"usage"``, ``"bad_input"``, ``"io_failed"``, ``"resource_limit"``, ``"engine_failed"`` or
        ``"cancelled"``.
    index : int or None
        Index of the object, query, triangle or id that is invalid, if the error is about one.
    set : int or None
        Set of this object: 1 for the second set of a call with two sets, otherwise 0.
    """

    code: str = "engine_failed"
    index: Optional[int] = None
    set: Optional[int] = None

    def __init__(self, message: str = "", index: Optional[int] = None, of_set: Optional[int] = None) -> None:
        super().__init__(message)
        self.index = index
        self.set = 0 if of_set is None and index is not None else of_set


class UsageError(Error, ValueError):
    """Options contradict each other, or the call is not supported."""

    code = "usage"


class InputError(Error, ValueError):
    """A box, a number, a shape or a file is invalid."""

    code = "bad_input"


class InputTypeError(Error, TypeError):
    """An argument has a type, or an array a dtype, that octopair does not read."""

    code = "bad_input"


class FileError(Error, OSError):
    """The operating system failed to read or write."""

    code = "io_failed"


class ResourceLimitError(Error, MemoryError):
    """Memory or another bounded resource ran out."""

    code = "resource_limit"


class EngineError(Error, RuntimeError):
    """An engine or a server failed, or its result is wrong."""

    code = "engine_failed"


class CancelledError(Error):
    """The job was cancelled."""

    code = "cancelled"


# In the order of octopair::ErrorCode.
_TABLE = (UsageError, InputError, FileError, ResourceLimitError, EngineError, CancelledError)
for _kind in (Error, InputTypeError, *_TABLE):
    _kind.__module__ = "octopair"


def make(code: int, message: str, index: Optional[int] = None, of_set: Optional[int] = None) -> Error:
    """Returns the exception for an error of the C++ library."""
    return _TABLE[code](message, index, of_set)
