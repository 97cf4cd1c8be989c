"""Results as columns with units."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave._package import package
from rayweave._table import Rows, aligned, counted, dataset, short

#: The number of rows that `print` shows.
_PRINTED_ROWS = 40


class Columns(Mapping[str, NDArray[Any]]):
    """Columns of equal length: a mapping from names to arrays. `units` has the unit of every column, "" for pure
    numbers. A number selects a row; a slice, a mask or a list selects rows. Columns are attributes, too.

    >>> import rayweave.optics as ro
    >>> energy = ro.Columns({"radius": [1, 2], "fraction": [0.5, 1.0]}, {"radius": "mm"})
    >>> energy
    <Columns of 2 rows: radius [mm], fraction>
    >>> print(energy)
    radius [mm]  fraction
              1       0.5
              2         1
    >>> energy["fraction"], energy.radius
    (array([0.5, 1. ]), array([1, 2]))
    >>> energy[energy.fraction < 1]
    <Columns of 1 rows: radius [mm], fraction>
    >>> energy.rows, energy.units["radius"]
    (2, 'mm')
    """

    def __init__(self, columns: Mapping[str, ArrayLike], units: Mapping[str, str] | None = None) -> None:
        self.columns = {name: np.asarray(column) for name, column in columns.items()}
        self.units = {name: (units or {}).get(name, "") for name in self.columns}

    @overload
    def __getitem__(self, key: str) -> NDArray[Any]: ...
    @overload
    def __getitem__(self, key: int) -> dict[str, Any]: ...
    @overload
    def __getitem__(self, key: slice | NDArray[Any] | list[int] | list[bool]) -> Columns: ...
    def __getitem__(self, key: Any) -> Any:
        """A column by its name, a row by its number, or the rows of a slice, a mask or a list of numbers."""
        if isinstance(key, str):
            if key not in self.columns:
                raise KeyError(f"there is no column {key!r}: the columns are {', '.join(self.columns)}.")
            return self.columns[key]
        if isinstance(key, (int, np.integer)):
            if not -self.rows <= key < self.rows:
                raise IndexError(f"there is no row {key}: there are {self.rows} rows, numbered from 0.")
            return {name: column[key].item() if column.ndim == 1 else column[key] for name, column in self.columns.items()}
        if not isinstance(key, (slice, list, np.ndarray)):
            raise KeyError(f"there is no column {key!r}: the columns are {', '.join(self.columns)}.")
        return Columns({name: column[key] for name, column in self.columns.items()}, self.units)

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Columns are attributes, too, except those with the name of a method."""
            columns = self.__dict__.get("columns", {})
            if name not in columns:
                known = f": the columns are {', '.join(columns)}." if not name.startswith("_") else ""
                raise AttributeError(f"{type(self).__name__} has no attribute {name!r}{known}")
            return columns[name]

        def __dir__(self) -> list[str]:
            return sorted({*super().__dir__(), *self.__dict__.get("columns", {})})

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    @property
    def rows(self) -> int:
        """The length of the columns."""
        return len(next(iter(self.columns.values()), ()))

    def __eq__(self, other: object) -> bool:
        """The same kind of result with the same units and values; NaN equals NaN."""
        if not isinstance(other, Columns):
            return NotImplemented
        if type(self) is not type(other) or self.units != other.units:
            return False
        return all(_equal(column, other.columns[name]) for name, column in self.columns.items())

    # columns are arrays, which can change
    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        units = (f"{name} [{unit}]" if unit else name for name, unit in self.units.items())
        return f"<{type(self).__name__} of {self.rows} rows: {', '.join(units)}>"

    def __str__(self) -> str:
        """A table of the rows, with the units of the columns; of long tables the first rows."""
        return self._text({})

    def _text(self, last: Mapping[str, Any]) -> str:
        """The table, with the entries of one more row at the end, if there are any."""
        names = [name for name, column in self.columns.items() if column.ndim == 1]
        shown = range(min(self.rows, _PRINTED_ROWS))
        cells = [[f"{name} [{self.units[name]}]" if self.units[name] else name for name in names]]
        cells += [[short(self.columns[name][row].item()) for name in names] for row in shown]
        cells += [[short(last.get(name, "")) for name in names]] if last else []
        more = self.rows - len(shown)
        return "\n".join(aligned(cells) + ([f"... and {counted(more, 'more row')}"] if more else []))

    def _repr_html_(self) -> str:
        names = {name: f"{name} [{unit}]" if unit else name for name, unit in self.units.items()}
        columns = {names[name]: column for name, column in self.columns.items() if column.ndim == 1}
        return Rows(columns, {})._repr_html_()

    def to_pandas(self) -> Any:
        """Copies of the columns as a pandas DataFrame; the units are in its `attrs`."""
        columns = {name: np.array(column) for name, column in self.columns.items()}
        table = package("pandas", "data frames").DataFrame(columns, copy=False)
        table.attrs["units"] = dict(self.units)
        return table

    def to_arrow(self) -> Any:
        """The columns as an Arrow table, without copies; the units are in the metadata of its fields."""
        arrow = package("pyarrow", "Arrow tables")
        arrays = [arrow.array(column) for column in self.columns.values()]
        named = zip(self.columns, arrays, strict=True)
        fields = [arrow.field(name, array.type, metadata={"unit": self.units[name]}) for name, array in named]
        return arrow.table(arrays, schema=arrow.schema(fields))

    def to_xarray(self) -> Any:
        """The columns as an xarray Dataset with the dimension `row`; the units are in the attribute `units` of each variable."""
        return dataset(self.columns, self.units)


def _equal(one: NDArray[Any], other: NDArray[Any]) -> bool:
    has_nan = one.dtype.kind in "fc" and other.dtype.kind in "fc"
    return bool(np.array_equal(one, other, equal_nan=has_nan))
