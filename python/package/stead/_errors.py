"""The exceptions of stead. Each one prints as the one line that the command prints."""

from __future__ import annotations

import json
from typing import Any


class Error(Exception):
    """A job gave no result, or a result could not be made. Base of the others.

    Attributes:
        is_bad_input: Whether a file, an argument or a folder is at fault, and not the job: the command ends with exit code 2 then, else with 1.
    """

    is_bad_input = False


class InputError(Error):
    """Something in a file is wrong.

    Attributes:
        file: The file as it was named.
        line: Line in the file, from 1, where it is known.
        field: Dotted key of a TOML file, or column of a CSV file, where it is known.
        problem: What is wrong.
        found: The value found, as written.
        allowed: What would have been accepted.
    """

    is_bad_input = True

    def __init__(
        self,
        message: str,
        *,
        file: str = "",
        line: int | None = None,
        field: str | None = None,
        problem: str = "",
        found: str | None = None,
        allowed: str | None = None,
    ) -> None:
        super().__init__(message)
        self.file = file
        self.line = line
        self.field = field
        self.problem = problem
        self.found = found
        self.allowed = allowed


class ArgumentError(Error, ValueError):
    """An argument of a call is out of range."""

    is_bad_input = True


class OutputError(Error):
    """A result could not be written, or another run writes to the folder. No file is left half written."""


class Locked(OutputError):
    """Another process works on the same folder, or on the same shard of a study."""


class _NoResult(Error):
    def __init__(self, message: str, *, document: str | None = None) -> None:
        super().__init__(message)
        self._document = document

    def to_dict(self) -> dict[str, Any]:
        """The JSON document that the command prints in place of a result."""
        document: dict[str, Any] = json.loads(self._document or "{}")
        return document


class Infeasible(_NoResult):
    """No placement, or not the given one, satisfies the constraints. `to_dict()["findings"]` says which fails at which points."""


class NotCompensated(_NoResult):
    """Points of a path cannot be compensated. `to_dict()` says which, and why."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C has stopped a job, which leaves what it has found so far.

    Attributes:
        result: What the job has found, as it would have been returned; `None` where there is nothing yet.
    """

    def __init__(self, result: Any = None) -> None:
        super().__init__("the job was stopped before its end")
        self.result = result
