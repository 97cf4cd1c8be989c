"""Results with rows: access by row and by column, data frames, and short texts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from html import escape
from typing import Any, ClassVar, overload

import numpy as np
from numpy.typing import NDArray

from rayweave._package import package
from rayweave._words import did_you_mean

_AXES = ("x", "y", "z", "w")
#: The number of rows that the text of a table shows, and that its HTML shows.
_TEXT_ROWS, _HTML_ROWS = 6, 12


class Tabular:
    """A result whose contents convert to tables: `_rows` returns them as rows."""

    def _rows(self) -> Rows:
        raise NotImplementedError

    def to_pandas(self) -> Any:
        """The contents as a pandas DataFrame."""
        return self._rows().to_pandas()

    def to_arrow(self) -> Any:
        """The contents as an Arrow table."""
        return self._rows().to_arrow()

    def to_xarray(self) -> Any:
        """The contents as an xarray Dataset with the dimension `row`."""
        return self._rows().to_xarray()

    def _repr_html_(self) -> str:
        return self._rows()._repr_html_()


class Table:
    """Rows with named columns.

    ``table["t"]`` is a column, ``table[3]`` a row as a dict with names instead of numbers, ``table[mask]`` and
    ``table[2:5]`` are the selected rows. A loop goes through the rows. `to_pandas`,
    `to_arrow` and `to_xarray` return data frames and datasets with their own copy of the numbers. Columns and the arrays
    of `to_dict` share the memory of the result: copy an array before you change it.

    >>> import rayweave as rw
    >>> found = rw.box(2).crossings([[-3, 0, 0], [-3, 0.5, 0], [-3, 9, 0]], [1, 0, 0])
    >>> len(found), found["t"]
    (4, array([2., 4., 2., 4.]))
    >>> found[1]["surface"]
    'box.x+'
    >>> found[found["enters"]]["ray"]
    array([0, 1])
    """

    #: The attributes that have an entry for each row, in order.
    _columns: ClassVar[tuple[str, ...]] = ()
    #: Columns of numbers, each with the attribute that has the names for its numbers; -1 has no name.
    _names: ClassVar[Mapping[str, str]] = {}

    def _heading(self) -> str:
        return f"{type(self).__name__}: {counted(len(self), 'row')}"

    def _column(self, name: str) -> NDArray[Any]:
        return np.asarray(getattr(self, name))

    def _names_of(self, column: str) -> list[str | None]:
        return [*getattr(self, self._names[column]), None]

    def __len__(self) -> int:
        """The number of rows."""
        return len(self._column(self._columns[0]))

    @overload
    def __getitem__(self, key: str) -> NDArray[Any]: ...
    @overload
    def __getitem__(self, key: int) -> dict[str, Any]: ...
    @overload
    def __getitem__(self, key: slice | NDArray[Any] | list[int] | list[bool]) -> Rows: ...
    def __getitem__(self, key: Any) -> Any:
        """A column by its name, a row by its number, or the rows of a slice, a mask or a list of numbers."""
        if isinstance(key, str):
            if key not in self._columns:
                hint = did_you_mean(key, list(self._columns), {})
                raise KeyError(f"there is no column '{key}': the columns are {', '.join(self._columns)}.{hint}")
            return self._column(key)
        if isinstance(key, (int, np.integer)):
            count = len(self)
            if not -count <= key < count:
                raise IndexError(f"there is no row {key}: there are {count} rows, numbered from 0.")
            return {name: self._entry(name, int(key)) for name in self._columns}
        columns = {name: self._column(name)[key] for name in self._columns}
        names = {name: self._names_of(name) for name in self._names}
        return Rows(columns, names)

    def _entry(self, name: str, row: int) -> Any:
        value = self._column(name)[row]
        if name in self._names:
            return self._names_of(name)[value]
        return value if np.ndim(value) else value.item() if isinstance(value, np.generic) else value

    def __iter__(self) -> Iterator[dict[str, Any]]:
        """The rows, each a dict."""
        columns = {name: self._column(name) for name in self._columns}
        names = {name: self._names_of(name) for name in self._names}
        for row in range(len(self)):
            entries = {name: column[row] for name, column in columns.items()}
            yield {
                name: names[name][entry] if name in names else entry.item() if np.ndim(entry) == 0 else entry
                for name, entry in entries.items()
            }

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """The columns by name: vectors as one column for each axis, such as ``point_x``; numbers of names as they are.
        The arrays share the memory of the result."""
        return dict(self._flat())

    def _flat(self) -> Iterator[tuple[str, NDArray[Any]]]:
        for name in self._columns:
            column = self._column(name)
            if column.ndim == 1:
                yield name, column
                continue
            for index in np.ndindex(column.shape[1:]):
                letters = [_AXES[k] if size <= 4 else str(k) for k, size in zip(index, column.shape[1:], strict=True)]
                yield f"{name}_{''.join(letters)}", column[(slice(None), *index)]

    def to_pandas(self) -> Any:
        """The rows as a pandas DataFrame: vectors as one column for each axis, names as categories. The frame has its own
        copy of the numbers: changes to it leave the result as it is."""
        pandas = package("pandas", "data frames")
        # each column is copied once, here, so that the frame needs no copy of its own
        table = {}
        for name, column in self._flat():
            if name not in self._names:
                table[name] = np.array(column, order="C")
                continue
            names = self._names_of(name)[:-1]
            # categories are unique, and two faces may have one name; the last code is that of -1
            codes = {text: code for code, text in enumerate(dict.fromkeys(names))}
            code = np.array([*(codes[text] for text in names), -1], dtype=np.int32)
            table[name] = pandas.Categorical.from_codes(code[column], list(codes))
        return pandas.DataFrame(table, copy=False)

    def to_arrow(self) -> Any:
        """The rows as an Arrow table: vectors as one column for each axis, names as dictionaries."""
        arrow = package("pyarrow", "Arrow tables")
        table = {}
        for name, column in self._flat():
            array = arrow.array(np.array(column, order="C"), mask=column < 0 if name in self._names else None)
            if name in self._names:
                names = arrow.array(self._names_of(name)[:-1], arrow.string())
                array = arrow.DictionaryArray.from_arrays(array, names)
            table[name] = array
        return arrow.table(table)

    def to_xarray(self) -> Any:
        """The rows as an xarray Dataset with the dimension `row`: vectors have the dimension `axis`, too, and names are texts."""
        columns = {}
        for name in self._columns:
            column = self._column(name)
            columns[name] = np.array(self._names_of(name), dtype=object)[column] if name in self._names else column
        return dataset(columns, {})

    def _texts(self, most: int) -> tuple[list[str], list[list[str]]]:
        """The names of the columns that have room, and the first rows as texts."""
        names = [name for name in self._columns if self._column(name).ndim <= 2]
        rows = []
        for row in range(min(most, len(self))):
            rows.append([short(self._entry(name, row)) for name in names])
        return names, rows

    def __repr__(self) -> str:
        names, rows = self._texts(_TEXT_ROWS)
        if not rows:
            return f"<{self._heading()}>"
        more = len(self) - len(rows)
        widths = _widths([names, *rows])
        # as many columns as fit into a line of 110 characters
        wide = int(np.searchsorted(np.cumsum([width + 2 for width in widths]), 110, side="right"))
        cut = "  ..." if wide < len(names) else ""
        lines = [line + cut for line in aligned([row[:wide] for row in [names, *rows]])]
        end = [f"... and {counted(more, 'more row')}"] if more else []
        return "\n".join([f"<{self._heading()}", *lines, *end]) + ">"

    def _repr_html_(self) -> str:
        names, rows = self._texts(_HTML_ROWS)
        more = len(self) - len(rows)
        head = "".join(f"<th>{escape(name)}</th>" for name in names)
        body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
        end = f"<p>... and {counted(more, 'more row')}</p>" if more else ""
        heading = f"<p>{escape(self._heading())}</p>"
        return f"{heading}<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{end}"


def dataset(columns: Mapping[str, NDArray[Any]], units: Mapping[str, str]) -> Any:
    """Copies of columns as an xarray Dataset. The dimensions of vectors and matrices of up to four components are axes."""
    xarray = package("xarray", "its datasets")
    variables, coordinates = {}, {}
    for name, column in columns.items():
        dimensions = ["row"]
        for k, size in enumerate(column.shape[1:]):
            dimension = f"axis{k + 1 if k else ''}" if size <= 4 else f"{name}_{k}"
            dimensions.append(dimension)
            if size <= 4:
                dimensions[-1] = dimension if size == 3 else f"{dimension}_{size}"
                coordinates[dimensions[-1]] = list(_AXES[:size])
        unit = units.get(name, "")
        variables[name] = (dimensions, np.array(column), {"units": unit} if unit else {})
    return xarray.Dataset(variables, coordinates)


class Rows(Table):
    """Selected rows of a table.

    >>> import rayweave as rw
    >>> found = rw.box(2).crossings([[-3, 0, 0], [-3, 0.5, 0]], [1, 0, 0])
    >>> first = found[found["enters"]]
    >>> type(first).__name__, first["t"].tolist()
    ('Rows', [2.0, 2.0])
    """

    def __init__(self, columns: Mapping[str, NDArray[Any]], names: Mapping[str, list[str | None]]) -> None:
        self._table = dict(columns)
        self._labels = dict(names)
        # those of the table from which the rows are taken, in place of those of the class
        self._columns = tuple(columns)  # type: ignore[misc]
        self._names = {name: name for name in names}  # type: ignore[misc]

    def _column(self, name: str) -> NDArray[Any]:
        return self._table[name]

    def _names_of(self, column: str) -> list[str | None]:
        return self._labels[column]


def table_of(heading: str, entries: Mapping[str, Any]) -> str:
    """The HTML of names and values."""
    rows = "".join(f"<tr><td>{escape(name)}</td><td>{escape(short(value))}</td></tr>" for name, value in entries.items())
    return f"<p>{escape(heading)}</p><table><tbody>{rows}</tbody></table>"


def _widths(rows: Sequence[Sequence[str]]) -> list[int]:
    return [max(len(cell) for cell in cells) for cells in zip(*rows, strict=True)]


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows of texts as lines, with every column aligned to the right."""
    widths = _widths(rows)
    return ["  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in rows]


def counted(number: int, noun: str) -> str:
    """A number with a noun, such as `1 more row` or `2 more rows`."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def short(entry: Any) -> str:
    """An entry in a few characters."""
    if entry is None:
        return "-"
    if isinstance(entry, np.ndarray):
        return "(" + ", ".join(short(part.item()) for part in entry.ravel()) + ")"
    if isinstance(entry, float):
        # plus zero: -0 is printed as 0
        return f"{entry + 0.0:.6g}"
    return str(entry)
