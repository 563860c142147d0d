"""The octants of the octree that a search uses."""

from __future__ import annotations

import dataclasses
import operator
from typing import List, Optional

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _core
from ._arrays import Array
from ._options import MOST_THREADS


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class Octants:
    """The octants of a search in pre-order: the root first, and an octant directly before all octants below it.

    An octant stores an entry for each of its objects; an object has one to eight entries. The octants with an entry of an object tile
    its box. They are leaves or, for a large box, octants above leaves. The home of an object is that one of these octants in which
    its box begins. ``octopair/octants.hpp`` says more about bounds and borders.

    Attributes
    ----------
    codes : list of OctalCode
        Code of each octant.
    bounds : numpy.ndarray
        Bounds of each octant, in the unit of the boxes; shape (octants, 6), float64. Bounds of neighbours meet exactly.
    leaf : numpy.ndarray
        True for each octant that has no octants below it.
    entries : numpy.ndarray
        Number of entries in each octant, without those in octants below it; uint64.
    homes : numpy.ndarray
        Number of these entries whose objects have their home there; uint64.
    objects : numpy.ndarray
        Objects of all octants, uint32. Those of octant `i` are at ``offsets[i]`` to ``offsets[i + 1]``: first those that have their home
        there, then the others. Both parts ascend.
    offsets : numpy.ndarray
        Shape (octants + 1,), int64.
    home_octants : numpy.ndarray
        Position of the home of each object; uint32. 0xFFFFFFFF for an index of a scene without an object.
    space : numpy.ndarray
        Part of the root in which objects are looked up; shape (6,), float64. Octants at its faces also store boxes beyond them.
    """

    codes: List[_core.OctalCode]
    bounds: Array
    leaf: Array
    entries: Array
    homes: Array
    objects: Array
    offsets: Array
    home_octants: Array
    space: Array

    @property
    def levels(self) -> Array:
        """Level of the home of each object, uint8. 255 for an index of a scene without an object."""
        levels = np.array([*(code.level for code in self.codes), 255], dtype=np.uint8)
        return levels[np.minimum(self.home_octants, len(self.codes))]

    def objects_in(self, octant: int) -> Array:
        """Returns the objects with an entry in an octant."""
        size, octant = len(self), operator.index(octant)
        if not -size <= octant < size:
            raise IndexError(f"octant {octant} of {size}")
        octant %= size
        return self.objects[self.offsets[octant]:self.offsets[octant + 1]]

    def __len__(self) -> int:
        """Returns the number of octants."""
        return len(self.codes)

    def __repr__(self) -> str:
        return f"Octants({len(self):,} octants, {len(self.objects):,} entries)"


def list_octants(boxes: ArrayLike, *, margin: float = 0, threads: int = 0, padding: Optional[ArrayLike] = None,
                 copy: bool = False) -> Octants:
    """Lists the octants that :func:`octopair.find_pairs` uses for these boxes.

    Parameters are those of :func:`octopair.find_pairs`. The result does not depend on `threads`.

    Examples
    --------
    >>> import numpy as np, octopair as op
    >>> low = np.random.default_rng(1).random((10_000, 3), dtype=np.float32)
    >>> octants = op.list_octants(np.hstack([low, low + np.float32(0.01)]))
    >>> str(octants.codes[0]), octants.leaf[0], int(octants.homes.sum())
    ('{}', False, 10000)
    >>> bool((octants.entries == np.diff(octants.offsets)).all())
    True
    """
    data = _core.Input(*_arrays.join_input(boxes, None, (padding, None), copy))
    return Octants(*_core.list_octants(data, _arrays.margin_of(margin), _arrays.whole(threads, "threads", MOST_THREADS)))
