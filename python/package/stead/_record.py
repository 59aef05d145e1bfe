"""Parts of JSON documents with attributes named as their keys.

The meaning of each key is that of the documents which the commands print with `--json`; units are in the names.
"""

from __future__ import annotations

import inspect
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar


class Record:
    """A part of a JSON document. Its keys are attributes; a key that this document leaves out is `None`."""

    _declared: ClassVar[frozenset[str]] = frozenset()
    _made: ClassVar[Mapping[str, Callable[[Any], Any]]] = {}
    _entries: Mapping[str, Any]

    def __init__(self, entries: Mapping[str, Any]) -> None:
        self._entries = entries

    def __init_subclass__(cls) -> None:
        own = frozenset(name for name in inspect.get_annotations(cls) if not name.startswith("_"))
        cls._declared = own.union(*(base._declared for base in cls.__bases__ if issubclass(base, Record)))

    def to_dict(self) -> dict[str, Any]:
        """A copy as plain Python objects, with the keys of the JSON document."""
        copy: dict[str, Any] = json.loads(json.dumps(self._entries))
        return copy

    # Not for type checkers: they know the declared keys, and find slips.
    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            if name.startswith("_"):
                raise AttributeError(name)
            if name not in self._entries:
                if name in self._declared:
                    return None
                known = ", ".join(self._entries)
                raise AttributeError(f"{type(self).__name__} has no {name!r}; there are: {known}")
            value = self._entries[name]
            make = self._made.get(name, Record)
            if isinstance(value, list):
                return [make(item) if isinstance(item, dict) else item for item in value]
            return make(value) if isinstance(value, dict) else value

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._entries})

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Record) and self._entries == other._entries

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{key}={_short(value)}' for key, value in self._entries.items())})"


def _short(value: Any) -> str:
    if isinstance(value, (list, dict)):
        return f"<{len(value)} {'items' if isinstance(value, list) else 'keys'}>"
    return repr(value)


@dataclass(frozen=True)
class Placement:
    """Where the workpiece stands: its origin in the robot base frame (mm) and its yaw about the vertical (deg)."""

    x_mm: float
    y_mm: float
    z_mm: float
    yaw_deg: float

    @classmethod
    def from_q4(cls, x_mm: float, y_mm: float, z_mm: float, q4: float) -> Placement:
        """From the quaternion component Q4 = sin(yaw / 2), from -1 to 1, by which the papers state the yaw."""
        return cls(x_mm, y_mm, z_mm, math.degrees(2.0 * math.asin(q4)))

    @property
    def q4(self) -> float:
        """Q4 = sin(yaw / 2)."""
        return math.sin(math.radians(self.yaw_deg) / 2.0)

    @classmethod
    def _of(cls, entries: Mapping[str, float]) -> Placement:
        return cls(entries["x_mm"], entries["y_mm"], entries["z_mm"], entries["yaw_deg"])
