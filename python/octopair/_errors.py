"""Exceptions. One table maps the codes of the C++ library to classes of Python."""

from __future__ import annotations

import re
from typing import Optional

__all__ = ["Error", "InputError", "InputTypeError", "UsageError", "FileError", "ResourceLimitError", "EngineError",
           "CancelledError"]

_POSITION = re.compile(r"\b(?:object|query|triangle|id) (\d+)\b")


class Error(Exception):
    """Base class of all errors of octopair.

    Attributes
    ----------
    code : str
        Kind of the failure: ``"usage"``, ``"bad_input"``, ``"io_failed"``, ``"resource_limit"``, ``"engine_failed"`` or
        ``"cancelled"``.
    index : int or None
        Index of the object or query that is invalid, if the message names one. In a call with two sets, the message also says which
        set.
    """

    code: str = "engine_failed"
    index: Optional[int] = None

    def __init__(self, message: str = "", index: Optional[int] = None) -> None:
        super().__init__(message)
        if index is None:
            found = _POSITION.search(message)
            index = int(found[1]) if found else None
        self.index = index


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


def make(code: int, message: str) -> Error:
    """Returns the exception for a code of the C++ library."""
    return _TABLE[code](message)
