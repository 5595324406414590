"""What may go wrong, as exceptions."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Any


def near(name: str, names: Iterable[str]) -> str:
    """A hint at the name that may be meant."""
    found = difflib.get_close_matches(name, list(names), n=1)
    return f": did you mean {found[0]!r}?" if found else ""


class SteklovError(Exception):
    """Any error of this package."""


class SceneError(SteklovError):
    """A scene that is wrong or cannot be solved.

    `str(error)` shows the place and the remedy; `message`, `help`, `file` and `line` are its parts, `line` None where the scene was no
    text.
    """

    def __init__(self, text: str, message: str, help: str, file: str, line: int | None) -> None:
        super().__init__(text)
        self.message, self.help, self.file, self.line = message, help, file, line

    def __reduce__(self) -> tuple[Any, ...]:
        return SceneError, (str(self), self.message, self.help, self.file, self.line)


class SolveError(SteklovError):
    """A solution that failed through no fault of the scene."""


class BlockError(SteklovError, ValueError):
    """Data of which a building block cannot be made; `str(error)` names the place and the remedy."""
