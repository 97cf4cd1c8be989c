"""Results as columns with units."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave._package import package
from rayweave._table import Rows


class Columns(Mapping[str, NDArray[Any]]):
    """Columns of equal length: a mapping from names to arrays. `units` has the unit of every column, "" for pure
    numbers."""

    def __init__(self, columns: Mapping[str, ArrayLike], units: Mapping[str, str] | None = None) -> None:
        self.columns = {name: np.asarray(column) for name, column in columns.items()}
        self.units = {name: (units or {}).get(name, "") for name in self.columns}

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self.columns:
            raise KeyError(f"there is no column {name!r}: the columns are {', '.join(self.columns)}.")
        return self.columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    @property
    def rows(self) -> int:
        """The length of the columns."""
        return len(next(iter(self.columns.values()), ()))

    def __repr__(self) -> str:
        units = (f"{name} [{unit}]" if unit else name for name, unit in self.units.items())
        return f"<{type(self).__name__} of {self.rows} rows: {', '.join(units)}>"

    def _repr_html_(self) -> str:
        names = {name: f"{name} [{unit}]" if unit else name for name, unit in self.units.items()}
        columns = {names[name]: column for name, column in self.columns.items() if column.ndim == 1}
        return Rows(columns, {})._repr_html_()

    def to_pandas(self) -> Any:
        """The columns as a pandas DataFrame; the units are in its `attrs`."""
        table = package("pandas", "data frames").DataFrame(self.columns, copy=False)
        table.attrs["units"] = dict(self.units)
        return table

    def to_arrow(self) -> Any:
        """The columns as an Arrow table, without copies; the units are in the metadata of its fields."""
        arrow = package("pyarrow", "Arrow tables")
        arrays = [arrow.array(column) for column in self.columns.values()]
        named = zip(self.columns, arrays, strict=True)
        fields = [arrow.field(name, array.type, metadata={"unit": self.units[name]}) for name, array in named]
        return arrow.table(arrays, schema=arrow.schema(fields))
