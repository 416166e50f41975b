"""Keys of a deck as TOML: tables and lists of tables under headers, all else on one line."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from os import PathLike, fspath
from typing import Any

_BARE = frozenset("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_")


def key(name: str) -> str:
    """A key, in quotes where it has to be."""
    return name if name and _BARE.issuperset(name) else _text(name)


def _text(text: str) -> str:
    plain = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r"}
    shown = (plain.get(c) or (c if c.isprintable() else f"\\U{ord(c):08X}") for c in text)
    return '"' + "".join(shown) + '"'


def value(given: Any) -> str:
    """A value on one line. Arrays and scalars of numpy are lists and numbers."""
    if hasattr(given, "tolist"):
        given = given.tolist()
    if isinstance(given, bool):
        return "true" if given else "false"
    if isinstance(given, (int, float)):
        return repr(given)
    if isinstance(given, str):
        return _text(given)
    if isinstance(given, PathLike):
        return _text(str(fspath(given)))
    if isinstance(given, Mapping):
        return "{ " + ", ".join(f"{key(k)} = {value(v)}" for k, v in given.items()) + " }"
    if isinstance(given, Iterable):
        return "[" + ", ".join(value(v) for v in given) + "]"
    raise TypeError(f"a deck cannot hold {given!r}, expected numbers, texts, lists and dicts")


def _is_tables(given: Any) -> bool:
    return isinstance(given, list) and given != [] and all(isinstance(v, Mapping) for v in given)


def body(keys: Mapping[str, Any]) -> str:
    """The keys of one table, a line each."""
    return "".join(f"{key(k)} = {value(v)}\n" for k, v in keys.items())


def document(keys: Mapping[str, Any], above: str = "") -> str:
    """A whole document: plain keys first, since what follows a header belongs to it."""
    plain = {k: v for k, v in keys.items() if not isinstance(v, Mapping) and not _is_tables(v)}
    text = body(plain)
    for k, v in keys.items():
        if k in plain:
            continue
        name = above + key(k)
        if isinstance(v, Mapping):
            inner = document(v, name + ".")
            header = "" if inner.startswith("\n[") else f"\n[{name}]\n"
            text += header + inner
        else:
            text += "".join(f"\n[[{name}]]\n{body(table)}" for table in v)
    return text
