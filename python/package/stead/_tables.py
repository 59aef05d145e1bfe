"""Tables and pictures: the CSV and SVG files of a result."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Collection, Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    import pandas

Column = npt.NDArray[Any]


class Table(Mapping[str, Column]):
    """A table of a result: numpy arrays by the names of the columns, which carry their units, as in the CSV file of the table.

    Empty cells are `nan` in columns of numbers and empty in columns of words.
    """

    def __init__(self, text: str, words: Collection[str] = ()) -> None:
        """From the text of a CSV file; the columns named hold words, whatever they look like."""
        names, *rows = csv.reader(io.StringIO(text))

        def column(name: str, cells: list[str]) -> Column:
            return np.asarray(cells, object) if name in words else _column(cells)

        self._columns = {name: column(name, [row[i] for row in rows]) for i, name in enumerate(names)}

    def __getitem__(self, name: str) -> Column:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def row_count(self) -> int:
        """Number of rows."""
        return len(next(iter(self._columns.values())))

    def to_pandas(self) -> pandas.DataFrame:
        """The table as a data frame, with `nan` for every empty cell. Needs pandas, which stead does not install."""
        import pandas

        def marked(column: Column) -> Column:
            return np.where(column == "", np.nan, column) if column.dtype == object else column

        frame: pandas.DataFrame = pandas.DataFrame({name: marked(column) for name, column in self.items()})
        return frame

    def __repr__(self) -> str:
        return f"<Table of {self.row_count} rows: {', '.join(self)}>"


def _column(cells: list[str]) -> Column:
    """The cells as whole numbers, numbers, truth values or words, whichever all of them are."""
    readers: tuple[tuple[Callable[[str], Any], Any], ...] = (
        (int, np.int64),
        (lambda cell: float(cell) if cell else float("nan"), np.float64),
        (lambda cell: {"false": False, "true": True}[cell], np.bool_),
    )
    for read, dtype in readers:
        try:
            return np.asarray([read(cell) for cell in cells], dtype)
        except (ValueError, KeyError, OverflowError):
            continue
    return np.asarray(cells, object)


class Picture:
    """A picture of a result, shown by notebooks.

    Attributes:
        svg: The content of its SVG file.
    """

    def __init__(self, svg: str) -> None:
        self.svg = svg

    def save(self, file: str | PathLike[str]) -> None:
        """Writes the picture to a file."""
        Path(file).write_bytes(self.svg.encode())

    def _repr_svg_(self) -> str:
        return self.svg
