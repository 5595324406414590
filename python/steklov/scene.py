"""Scenes from dictionaries, texts and files."""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Mapping
from typing import Any, Union

Scene = Union[Mapping[str, Any], str, "os.PathLike[str]"]

BARE = re.compile(r"[A-Za-z0-9_-]+")


def toml(value: Any, path: str) -> str:
    """A value of Python as TOML; `path` names it in errors."""
    if hasattr(value, "tolist"):  # numbers and arrays of numpy
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ValueError(f"{path} is {value}: numbers of a scene are finite")
        return repr(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, dict):
        entries = (f"{key(name)} = {toml(entry, f'{path}.{name}')}" for name, entry in value.items())
        return "{ " + ", ".join(entries) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml(entry, f"{path}[{k}]") for k, entry in enumerate(value)) + "]"
    if callable(value):
        raise TypeError(f"{path} is a function: write an expression of x, y and s in quotes, such as \"0.1*x^2\", or \"f(x)\" with the profile \"f\": steklov.profile(function, start, stop)")
    raise TypeError(f"{path} is {value!r}, a {type(value).__name__}: a scene takes numbers, texts, lists and dictionaries")


def key(name: object) -> str:
    """A key as TOML."""
    if not isinstance(name, str):
        name = str(name)
    return name if BARE.fullmatch(name) else json.dumps(name, ensure_ascii=False)


def text_of(scene: Scene) -> tuple[str, str]:
    """The text of a scene and its name: a dictionary, TOML text, or the path of a file."""
    if isinstance(scene, dict):
        lines = (f"{key(name)} = {toml(value, name)}\n" for name, value in scene.items())
        return "".join(lines), "scene"
    if isinstance(scene, os.PathLike) or isinstance(scene, str) and "\n" not in scene and ("=" not in scene or os.path.isfile(scene)):
        path = os.fspath(scene)
        with open(path, encoding="utf-8") as file:
            return file.read(), path
    if isinstance(scene, str):
        return scene, "scene"
    raise TypeError(f"a scene is a dictionary, TOML text or a path, not a {type(scene).__name__}")


def key_of(name: str) -> str:
    """A key of a scene; two underscores stand for a point where a name has none."""
    return name if "." in name else name.replace("__", ".")


def settings_of(overrides: Mapping[str, Any]) -> list[str]:
    """Settings KEY=VALUE of keyword arguments."""
    return [f"{key_of(name)}={toml(value, name)}" for name, value in overrides.items()]
