"""Results: plain values, and tables of arrays."""

from __future__ import annotations

import dataclasses
import html
import operator
from typing import Any, Dict, Iterator, List, Optional, Tuple

import numpy as np

from ._arrays import Array

COLLISION_CLASSES = ("unknown", "clearance", "collision", "touching", "penetrating", "contained", "duplicate",
                     "undecided")
"""Names of the classes of collisions; a code in ``Collisions.class_codes`` is a position in this tuple."""
DEPTH_KINDS = ("unknown", "least", "at_least")
"""Names of the kinds of depths; a code in ``Collisions.depth_kind`` is a position in this tuple."""
THICKNESS_KINDS = ("unknown", "at_most", "at_least", "undecided")
"""Names of the kinds of thicknesses; a code in ``Collisions.thickness_kind`` is a position in this tuple."""


def html_table(title: str, rows: List[Tuple[str, str]]) -> str:
    """Returns a table of names and values for notebooks."""
    cells = "".join(f"<tr><th style='text-align:left'>{html.escape(name)}</th><td>{html.escape(value)}</td></tr>"
                    for name, value in rows)
    return f"<table><caption>{html.escape(title)}</caption>{cells}</table>"


@dataclasses.dataclass(frozen=True)
class StepSeconds:
    """Wall-clock seconds of each step of a call.

    Attributes
    ----------
    encode, count, scatter, scan : float
        See ``octopair/summary.hpp``.
    """

    encode: float
    count: float
    scatter: float
    scan: float


@dataclasses.dataclass(frozen=True)
class Summary:
    """Counts and times of a call.

    Attributes
    ----------
    pairs : int
        Number of pairs.
    truncated : bool
        True if the limit was reached and at least one more pair exists.
    seconds : float
        Wall-clock time of the call.
    entries : int
        Number of entries in the linear octree; at most 8 per object.
    steps : StepSeconds
        Seconds of each step.
    verified : bool
        True if the result was checked by a second algorithm (``verify=True``), and no difference was found.
    verification_seconds : float
        Wall-clock time of this check.
    not_checked : str
        Properties that were not checked; empty if all were.
    """

    pairs: int
    truncated: bool
    seconds: float
    entries: int
    steps: StepSeconds
    verified: bool = False
    verification_seconds: float = 0.0
    not_checked: str = ""

    @classmethod
    def _of(cls, row: Tuple[Any, ...]) -> "Summary":
        pairs, truncated, seconds, entries, steps, verified, verification_seconds, not_checked = row
        return cls(pairs, truncated, seconds, entries, StepSeconds(*steps), verified, verification_seconds, not_checked)

    def _repr_html_(self) -> str:
        return html_table("octopair", [
            ("pairs", f"{self.pairs:,}" + (" (limit reached, more exist)" if self.truncated else "")),
            ("time", f"{self.seconds * 1e3:.3f} ms"), ("entries", f"{self.entries:,}")])


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class JobResult:
    """Result of a job.

    Attributes
    ----------
    pairs : numpy.ndarray
        Shape (m, 2), uint32.
    summary : Summary
        Counts and times.
    """

    pairs: Array
    summary: Summary

    @property
    def truncated(self) -> bool:
        """True if the limit was reached and at least one more pair exists."""
        return self.summary.truncated

    def __repr__(self) -> str:
        return f"JobResult({len(self.pairs):,} pairs{', truncated' if self.truncated else ''})"

    def _repr_html_(self) -> str:
        return self.summary._repr_html_()


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class StepResult:
    """Result of a step of a scene.

    Attributes
    ----------
    began, ended : numpy.ndarray
        Pairs of indices that began and ended in this step, ascending; shape (m, 2), uint32. `ended` includes the pairs of removed
        objects. The arrays own their memory.
    persisting : int
        Number of pairs that existed before the step and still exist.
    full : bool
        True if all objects were searched, not only the changed ones.
    seconds : float
        Wall-clock time.
    """

    began: Array
    ended: Array
    persisting: int
    full: bool
    seconds: float

    @property
    def pairs(self) -> int:
        """Number of all pairs after the step."""
        return self.persisting + len(self.began)

    def __repr__(self) -> str:
        return f"StepResult({len(self.began):,} began, {len(self.ended):,} ended, {self.persisting:,} persisting)"

    def _repr_html_(self) -> str:
        return html_table("step", [("began", f"{len(self.began):,}"), ("ended", f"{len(self.ended):,}"),
                                   ("persisting", f"{self.persisting:,}"), ("time", f"{self.seconds * 1e3:.3f} ms")])


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class Answers:
    """Answers to many queries, flat.

    The answers to query `i` are at positions ``offsets[i]`` to ``offsets[i + 1]`` of the other arrays.

    Attributes
    ----------
    indices : numpy.ndarray
        Indices of objects, uint32.
    offsets : numpy.ndarray
        Shape (queries + 1,), int64.
    """

    indices: Array
    offsets: Array

    def __len__(self) -> int:
        """Returns the number of queries."""
        return len(self.offsets) - 1

    def __getitem__(self, query: int) -> Array:
        """Returns the indices that answer one query."""
        size, query = len(self), operator.index(query)
        if not -size <= query < size:
            raise IndexError(f"query {query} of {size}")
        query %= size
        return self.indices[self.offsets[query]:self.offsets[query + 1]]

    def __iter__(self) -> Iterator[Array]:
        return (self[query] for query in range(len(self)))

    @property
    def counts(self) -> Array:
        """Number of answers to each query."""
        return np.diff(self.offsets)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({len(self.indices):,} answers to {len(self):,} queries)"


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class Hits(Answers):
    """Boxes that rays hit.

    Attributes
    ----------
    along : numpy.ndarray
        Position on the ray where it enters the box, in lengths of its direction; 0 if it begins inside. float64.
    """

    along: Array


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class Neighbors(Answers):
    """Nearest objects.

    Attributes
    ----------
    distances : numpy.ndarray
        Euclidean distances between boxes, float64.
    """

    distances: Array


@dataclasses.dataclass(frozen=True)
class FilterCounts:
    """Counts of a filter.

    Attributes
    ----------
    name : str
        Name of the filter.
    pairs_in, pairs_out : int
        Number of pairs before and after the filter.
    seconds : float
        Sum over all threads.
    undecided : int
        Pairs that the filter could not decide. "exact object" drops them: an object lies in the bounds of a mesh that is not closed, so it has
        no inside. "exact feature" keeps them as penetrating: it could not compare the thickness of their overlap with the tolerance.
    """

    name: str
    pairs_in: int
    pairs_out: int
    seconds: float
    undecided: int


@dataclasses.dataclass(frozen=True)
class PipelineSummary:
    """Counts and times of a pipeline.

    Attributes
    ----------
    collisions : int
        Number of pairs that passed all filters.
    of_class : dict
        Collisions by class, for those that a filter has classified.
    truncated : bool
        True if the limit was reached and at least one more collision exists.
    seconds : float
        Wall-clock time.
    search : Summary
        Summary of the all-pairs stage.
    filters : list of FilterCounts
        One element per filter.
    """

    collisions: int
    of_class: Dict[str, int]
    truncated: bool
    seconds: float
    search: Summary
    filters: List[FilterCounts]

    @classmethod
    def _of(cls, row: Tuple[Any, ...]) -> "PipelineSummary":
        classes = {name: count for name, count in zip(COLLISION_CLASSES, row[1]) if count}
        return cls(row[0], classes, row[2], row[3], Summary._of(row[4]), [FilterCounts(*counts) for counts in row[5]])

    def _repr_html_(self) -> str:
        rows = [("collisions", f"{self.collisions:,}"), ("time", f"{self.seconds * 1e3:.3f} ms"),
                ("pairs of boxes", f"{self.search.pairs:,}")]
        rows += [(name, f"{count:,}") for name, count in self.of_class.items()]
        rows += [(f"after {counts.name}", f"{counts.pairs_out:,}") for counts in self.filters]
        return html_table("collisions", rows)
