"""The command `stead`, which comes with the package: from a terminal, and from Python."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import sysconfig
from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

from . import _stead
from ._errors import Error


def main() -> NoReturn:
    """Runs the command line and leaves with its exit code."""
    # Ctrl-C is handled by the command itself.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    # What came with the package, where `stead` looks for files that are not there.
    os.environ.setdefault("STEAD_SHIPPED", str(Path(__file__).with_name("shipped")))
    sys.exit(_stead.run_command(sys.argv))


class CommandError(Error):
    """A command ended without its result.

    Attributes:
        exit_code: 1: the job failed; 2: wrong usage or bad input; 130: Ctrl-C ended it.
        output: What it printed all the same, as the reasons why nothing is feasible.
        messages: What it said besides, line by line.
    """

    def __init__(self, message: str, exit_code: int, output: str, messages: list[str]) -> None:
        super().__init__(message)
        self.exit_code, self.output, self.messages = exit_code, output, messages
        self.is_bad_input = exit_code == 2

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.exit_code, self.output, self.messages)


class Completed(NamedTuple):
    """What a command has printed."""

    output: str
    """Its result: a text, or with `json=True` a document."""
    messages: list[str]
    """Notes, warnings and progress, line by line."""

    def document(self) -> dict[str, Any]:
        """The JSON document of a command that was called with `json=True`."""
        document: dict[str, Any] = json.loads(self.output)
        return document


Value = str | float | PathLike[str] | bool | None


def command(
    name: str, *arguments: str | PathLike[str], **options: Value | Sequence[Value] | Mapping[str, Value]
) -> Completed:
    """Runs any command of `stead`, in a process of its own, and returns what it printed.

        stead.command("export", "my/run.toml", "results/run/best.csv", format="krl", out="my/program/PART", force=True)
        stead.command("import robot", "arm.urdf", out="my/arm.toml", chain=["base_link", "tool0"])
        stead.command("check", "my/run.toml", json=True).document()

    Args:
        name: The command, as `pose` or `study slurm`.
        arguments: Its files and names, in their order.
        options: Its options, with `_` for `-`: `True` for one without a value; several values, or a mapping for `KEY=VALUE`, for one that may be
            there several times. `None` and `False` leave it out.

    Raises:
        CommandError: The command ended with another exit code than 0; the line of its error says why.
    """
    program = shutil.which("stead", path=sysconfig.get_path("scripts"))
    if program is None:
        raise Error("the command stead is not installed beside this Python: install the package by pip")
    call = [program, *name.split()]
    for key, value in options.items():
        if isinstance(value, Mapping):
            value = [f"{field}={entry}" for field, entry in value.items()]
        for entry in value if isinstance(value, Sequence) and not isinstance(value, str) else [value]:
            call += _option("--" + key.strip("_").replace("_", "-"), entry)
    # What follows is no option, whatever it begins with.
    call += ["--", *(fspath(argument) for argument in arguments)] if arguments else []
    done = subprocess.run(call, capture_output=True, text=True, encoding="utf-8", check=False)
    messages = done.stderr.splitlines()
    if done.returncode:
        last = messages[-1] if messages else f"exit code {done.returncode}"
        # Wrong usage is followed by how it is right.
        problem = next((line for line in messages if line.startswith("error: ")), last)
        raise CommandError(problem.removeprefix("error: "), done.returncode, done.stdout, messages)
    return Completed(done.stdout, messages)


def _option(key: str, value: Value) -> list[str]:
    if value is None or value is False:
        return []
    return [key] if value is True else [f"{key}={fspath(value) if isinstance(value, PathLike) else value}"]
