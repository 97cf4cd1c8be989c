"""Boolean operations on hit arrays."""

from __future__ import annotations

from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave import _core


class Operation(Enum):
    """A boolean operation on two solids.

    >>> import numpy as np
    >>> import rayweave as rw
    >>> a, b = np.array([[1.0], [4.0]]), np.array([[2.0], [3.0]])
    >>> rw.array_csg(a, b, rw.Operation.DIFFERENCE).ravel()
    array([1., 2., 3., 4.])
    """

    UNION = 1
    """Inside either."""
    INTERSECT = 2
    """Inside both."""
    DIFFERENCE = 3
    """Inside the first and not the second."""


def array_csg(
    array1: ArrayLike,
    array2: ArrayLike,
    operation: Operation,
    sort_output: bool = True,
    *,
    regularize: bool | float = False,
    out: NDArray[Any] | None = None,
    threads: int | None = None,
) -> NDArray[Any]:
    """The hits of ``array1 operation array2``, for one ray or for many.

    A hit array holds the times at which rays cross the boundary of a solid: column = ray, row = k-th hit, each column
    in non-decreasing order, an even number of rows, padded with +inf. An odd number of -inf entries means that the ray
    comes from infinity inside the solid.

    Parameters
    ----------
    array1, array2
        (H1, N) and (H2, N), or (H1,) and (H2,) for one ray. H1 and H2 are even; they and N may be 0. Lists and integers
        become float64; float32 is computed in float32 where both arrays are.
    operation
        `Operation.UNION`, `Operation.INTERSECT` or `Operation.DIFFERENCE`.
    sort_output
        If False, dropped entries remain as +inf at their positions among the merged ones. That is not a valid hit array
        until it is sorted along axis 0.
    regularize
        False: entries of both arrays with equal times toggle one after the other, those of `array1` first, so that
        pieces of length zero may occur and the order of the arrays matters. True: entries with equal times toggle
        together, which leaves no such pieces. A number: as True, and pieces shorter than this number are dropped.
    out
        An array of the result's shape and dtype, which is written and returned. If it is contiguous and shares no
        memory with the operands, nothing is allocated. After an error that names an entry, the array may be partly
        overwritten.
    threads
        The maximum number of threads; by default the environment variable RAYWEAVE_THREADS, or the number of cores.
        Small arrays are not split. The number changes no bit of the result.

    Returns
    -------
    (H1 + H2, N) or (H1 + H2,), padded with +inf.

    Raises
    ------
    RayweaveError
        For an odd number of rows, NaN, a column that is not sorted, different numbers of rays; the message names the
        array and the first bad column.
    TypeError
        For a dtype that is not real (bool, complex, object, text).

    Examples
    --------
    >>> array_csg([1, 4, 5, 10], [0, 2, 3, 5], Operation.INTERSECT)
    array([ 1.,  2.,  3.,  4.,  5.,  5., inf, inf])

    The algorithm is that of R. Frazier's PyRayT ("Efficient CSG", 2021), with a stable sort.
    """
    result: NDArray[Any] = _core.array_csg(
        array1, array2, _number(operation), bool(sort_output), regularize, out, threads
    )
    return result


def count_array(
    array1: ArrayLike, array2: ArrayLike, operation: Operation
) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """The merged entries of two hit arrays and, after each entry, the number of solids around the ray.

    For `Operation.DIFFERENCE` the second solid is replaced by its complement. Shapes and errors are those of
    `array_csg`; the counts are between 0 and 2.

    >>> import numpy as np
    >>> import rayweave as rw
    >>> a, b = np.array([[1.0], [4.0]]), np.array([[2.0], [3.0]])
    >>> times, counts = rw.count_array(a, b, rw.Operation.UNION)
    >>> times.ravel(), counts.ravel()
    (array([1., 2., 3., 4.]), array([1, 2, 1, 0]))
    """
    return _core.count_array(array1, array2, _number(operation))


def _number(operation: Operation) -> int:
    if isinstance(operation, Operation):
        return operation.value
    raise TypeError(
        f"operation is {operation!r}: it must be Operation.UNION, Operation.INTERSECT or Operation.DIFFERENCE."
    )
