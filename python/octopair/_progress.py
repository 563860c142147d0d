"""Progress of calls: a callable, or a bar."""

from __future__ import annotations

import contextlib
import sys
from typing import Any, Callable, Iterator, Optional, Union

from ._errors import InputTypeError

Progress = Union[None, bool, Callable[[float], Any]]


@contextlib.contextmanager
def reporter(progress: Progress) -> Iterator[Optional[Callable[[float], Any]]]:
    """Yields a function that receives the fraction that is done, or None.

    True stands for a bar of tqdm, or for percentages on standard error if tqdm is not installed.
    """
    if progress is None or progress is False:
        yield None
    elif progress is not True:
        if not callable(progress):
            raise InputTypeError(f"progress: a {type(progress).__name__} is neither callable nor a bool")
        yield progress
    else:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            yield lambda done: print(f"\roctopair {done:4.0%}", end="\n" if done == 1 else "", file=sys.stderr, flush=True)
            return
        with tqdm(total=1.0, desc="octopair", bar_format="{desc}: {percentage:3.0f}%|{bar}| {elapsed}") as bar:
            yield lambda done: bar.update(done - bar.n)
