"""Scenes and sessions as text."""
import json
import math
import os

import numpy


def _value(value):
    if isinstance(value, numpy.generic):
        value = value.item()
    if isinstance(value, numpy.ndarray):
        value = value.tolist()
    if isinstance(value, (bool, str)):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, os.PathLike):
        return json.dumps(os.fspath(value), ensure_ascii=False)
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else str(value)
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(name)} = {_value(part)}" for name, part in value.items()) + " }"
    raise TypeError(f"{value!r} has no place in TOML: numbers, texts, lists, arrays and dicts have")


def _key(name):
    return json.dumps(str(name), ensure_ascii=False)


def _table(head, values):
    lines = [head] + [f"{_key(name)} = {_value(value)}" for name, value in values.items() if value is not None]
    return "\n".join(lines) + "\n"


def toml(document):
    """A dict of dicts (tables) and lists of dicts (arrays of tables) as TOML text; None is left out."""
    text = []
    for name, value in document.items():
        if isinstance(value, dict):
            text.append(_table(f"[{_key(name)}]", value))
        elif isinstance(value, (list, tuple)) and all(isinstance(part, dict) for part in value):
            text += [_table(f"[[{_key(name)}]]", part) for part in value]
        elif value is not None:
            raise TypeError(f"{name} is {value!r}, must be a dict or a list of dicts")
    return "\n".join(text)
