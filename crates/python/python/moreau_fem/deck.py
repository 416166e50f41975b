"""Decks: a problem as a file, as text, or as keys in Python."""

from __future__ import annotations

import copy
import itertools
import tomllib
from collections.abc import Callable, Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from . import _core, _toml, errors
from ._core import Simulation as Core
from .errors import DeckError, Finding
from .law import Law, asked
from .mesh import Mesh
from .tables import frame

# Equivalent plastic strains at which a function of hardening is sampled.
_SAMPLES = np.concatenate([[0.0], np.geomspace(1e-6, 3.0, 500)])

# Pressures at which a function of friction is sampled: all that metals, soils and tissues know, in any unit.
_PRESSURES = np.concatenate([[0.0], np.geomspace(1e-6, 1e15, 1200)])

# Part of a shear that is rounding, of functions too that take the difference of large numbers.
_ROUNDING = 1e-6


class Deck:
    """A problem: the keys of a deck, which the documentation of decks explains.

    ``Deck("block.toml")`` is that of a file, ``Deck(text)`` that of a text with at least one line break,
    ``Deck(mapping)`` and ``Deck(units="mm-N-MPa", ...)`` that of keys, in which ``_`` stands for ``-``. Nothing is
    checked until :meth:`check`, :meth:`open` or a run does.

    In keys, ``mesh`` may also be a :class:`Mesh`, a mesh of meshio or of pyvista, or a list of these and of what
    :func:`moreau_fem.block` returns, which share no node and no name of a group; so may ``file`` of its parts;
    ``hardening`` of a material may be a function of the equivalent plastic strain:
    the stress that it adds to ``yield_stress``, sampled at 501 strains from 0 to 3; ``friction`` of a contact a function
    of the pressure: the bound of the shear, sampled at 1201 pressures from 0 to 1e15, each 4 % above the one before. Both
    may be objects of a class with ``__call__``, and are called for all points at once where they take arrays.

    Raises
    ------
    DeckError
        For a function of hardening that softens, or of friction that falls or is not concave.
    TypeError
        For what no deck can hold.
    OSError
        For a file that cannot be read.
    """

    text: str
    """The deck as TOML."""
    file: str
    """What it is called in messages."""
    folder: Path
    """The folder that paths in it are relative to."""
    meshes: dict[str, bytes]
    """Mesh files that are not on disk, by the paths that the deck gives."""

    def __init__(
        self,
        source: str | PathLike[str] | Mapping[str, Any] | Deck | None = None,
        *,
        folder: str | PathLike[str] | None = None,
        **keys: Any,
    ) -> None:
        self.meshes = {}
        self.file, self.folder = "deck.toml", Path(folder or ".").absolute()
        if isinstance(source, Deck):
            self.file, self.folder, self.meshes = source.file, source.folder, dict(source.meshes)
            source = source.text if not keys else source.keys
        if isinstance(source, str) and "\n" in source:
            self.text = source
        elif isinstance(source, (str, PathLike)):
            path = Path(source)
            self.text = path.read_text(encoding="utf-8")
            self.file, self.folder = str(source), Path(folder or path.parent).absolute()
        else:
            self.text = _toml.document(self._plain({**(source or {}), **keys}))
            return
        if keys:
            raise TypeError("keys can be added to keys, not to a file or a text: use with_")

    def _plain(self, keys: Mapping[str, Any]) -> dict[str, Any]:
        """Keys as TOML has them."""
        plain: dict[str, Any] = {}
        for name, value in _named(keys).items():
            if name == "mesh":
                plain[name] = self._mesh(value)
            elif name == "material":
                plain[name] = _dashed(_each(_sampled, value))
            elif name == "contact":
                plain[name] = _dashed(_each(_bounded, value))
            elif name in ("expect", "parameters"):
                # Their keys are names of columns, and of the user's own.
                plain[name] = value
            else:
                plain[name] = _dashed(value)
        if self.meshes:
            # Of a mesh that this one replaces, in a deck that was written.
            plain.pop("checksum", None)
        return plain

    def _mesh(self, given: Any) -> dict[str, Any]:
        """The keys of a mesh. What no file has gets a name that no file of them has."""
        keys = _joined(given)
        tables = [table for table in [keys, *_parts_of(keys)] if "file" in table]
        used = {Path(table["file"]).name for table in tables if isinstance(table["file"], (str, PathLike))}
        for table in tables:
            if not isinstance(table["file"], (str, PathLike)):
                content = Mesh.of(table["file"]).to_gmsh().encode()
                names = itertools.chain(["mesh.msh"], (f"mesh-{k}.msh" for k in itertools.count(2)))
                table["file"] = next(name for name in names if name not in used)
                used.add(table["file"])
                self.meshes[table["file"]] = content
        return keys

    @property
    def comments(self) -> str:
        """The lines of the text before the first that is no comment."""
        return "".join(itertools.takewhile(lambda line: line.startswith("#"), self.text.splitlines(keepends=True)))

    @property
    def keys(self) -> dict[str, Any]:
        """The keys of the deck, a copy.

        Raises
        ------
        DeckError
            If the text is no TOML.
        """
        try:
            return tomllib.loads(self.text)
        except tomllib.TOMLDecodeError:
            # With the place, as any other error.
            self.open()
            raise

    def __getitem__(self, path: str) -> Any:
        """The value at a path, as in ``deck["contact.0.friction"]``."""
        value: Any = self.keys
        for part in _split(path):
            value = value[part]
        return value

    def with_(self, changes: Mapping[str, Any]) -> Deck:
        """The deck with other values at some paths, as in ``deck.with_({"contact.0.friction": 0.2})``.

        Raises
        ------
        KeyError, IndexError
            For a path through what the deck does not have; its last part may be new.
        """
        keys = self.keys
        for path, value in changes.items():
            *parents, last = _split(path)
            at: Any = keys
            for part in parents:
                at = at[part]
            at[last] = copy.deepcopy(value)
        changed = Deck(keys, folder=self.folder)
        changed.file = self.file
        changed.meshes = {**self.meshes, **changed.meshes}
        return changed

    def to_toml(self, path: str | PathLike[str] | None = None, *, overwrite: bool = False) -> str:
        """The deck as TOML. With a path it is also written there, and beside it, under its name, the mesh that no file has:
        ``ring.toml`` with ``ring.msh``, whose ``checksum`` the deck then tells, so that it runs on no other.

        Raises
        ------
        FileExistsError
            If there is a file already with something else in it, unless ``overwrite``; nothing is written then.
        """
        if path is None:
            return self.text
        path = Path(path)
        text, meshes = self._on_disk(path)
        files = {path: text.encode()} | {path.parent / name: content for name, content in meshes.items()}
        for file, content in files.items():
            if not overwrite and file.is_file() and file.read_bytes() != content:
                raise FileExistsError(
                    f"{file} is there already, with something else in it: give another name, or overwrite=True"
                )
        for file, content in files.items():
            file.write_bytes(content)
        return text

    def _on_disk(self, path: Path) -> tuple[str, dict[str, bytes]]:
        """The text as a file of this path has it, and the meshes beside that by their names."""
        if not self.meshes:
            return self.text, {}
        keys, meshes = self.keys, {}
        stem = path.name.removesuffix(".toml")
        for entry, name in self._own(keys):
            # Several decks in one folder have their meshes there.
            entry["file"] = stem + name.removeprefix("mesh")
            meshes[entry["file"]] = self.meshes[name]
        # With files that are on disk as this deck finds them, wherever it is written.
        checksum = _core.checksum(_toml.document(keys), self.folder, meshes)
        if checksum is not None:
            keys["checksum"] = checksum
        return self.comments + _toml.document(keys), meshes

    def _own(self, keys: Mapping[str, Any]) -> list[tuple[dict[str, Any], str]]:
        """The tables of keys whose mesh file is not on disk, and the name of each in :attr:`meshes`."""
        mesh = keys.get("mesh")
        if not isinstance(mesh, dict):
            return []
        paths = {self.folder / name: name for name in self.meshes}
        tables = [table for table in [mesh, *_parts_of(mesh)] if isinstance(table.get("file"), str)]
        found = [(table, paths.get(self.folder / table["file"])) for table in tables]
        return [(table, name) for table, name in found if name is not None]

    def check(self) -> Any:
        """All that is wrong or doubtful, as a table with a row for each finding."""
        _, found, _ = self._open()
        return frame({name: [getattr(f, name) for f in found] for name in Finding._fields})

    def _open(self, laws: Mapping[str, Law] | None = None) -> tuple[Core | None, list[Finding], str]:
        core, found, shown = Core.open(self.text, self.folder, self.file, self.meshes, asked(laws))
        return core, [f._replace(message=self._of_arrays(f.message)) for f in errors.findings(found)], self._of_arrays(shown)

    def _of_arrays(self, told: str) -> str:
        """What is told of a mesh that no file has, with how its numbers are meant."""
        for name in self.meshes:
            told = told.replace(str(self.folder / name), f"{name} (arrays; its nodes and elements count from 1)")
        return told

    def open(self, laws: Mapping[str, Law] | None = None) -> Core:
        """The deck under way, as a simulation has it within, with laws in place of those of its materials. Doubts are
        warnings.

        Raises
        ------
        DeckError
            If anything is wrong.
        LawError
            For a law that is none. What a law raises itself goes through.
        """
        core, found, shown = self._open(laws)
        if core is None:
            raise DeckError(shown.rstrip(), found)
        errors.warn(found)
        return core

    def __repr__(self) -> str:
        return f"<deck {self.file}>"

    def __str__(self) -> str:
        return self.text


def _joined(given: Any) -> dict[str, Any]:
    """The keys of a mesh that is given as keys, as what is a mesh itself, or as a list of these."""
    if isinstance(given, Mapping):
        keys: dict[str, Any] = _dashed(given)
        return keys
    if not isinstance(given, (list, tuple)):
        return {"file": given}
    whole: dict[str, Any] = {}
    files = []
    for keys in map(_joined, given):
        if "file" in keys:
            files.append(keys.pop("file"))
        for name, value in keys.items():
            whole.setdefault(name, [])
            if not isinstance(value, list):
                raise TypeError(f"mesh.{name} is {value!r}, expected a list")
            whole[name] += value
    if len(files) == 1:
        whole["file"] = files[0]
    elif files:
        whole["part"] = [{"file": file} for file in files] + whole.get("part", [])
    return whole


def _parts_of(mesh: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The tables of ``[[mesh.part]]``."""
    parts = mesh.get("part", [])
    return [part for part in parts if isinstance(part, dict)] if isinstance(parts, list) else []


def _split(path: str) -> list[Any]:
    parts = path.split(".")
    # What users name is what they name it.
    if parts[0] == "parameters":
        return parts
    return [int(part) if part.isdigit() else part.replace("_", "-") for part in parts]


def _named(keys: Mapping[str, Any]) -> dict[str, Any]:
    """Keys with ``-`` in place of ``_``."""
    named: dict[str, Any] = {}
    for name, value in keys.items():
        if not isinstance(name, str):
            raise TypeError(f"a deck has the key {name!r}, expected a text")
        dashed = name.replace("_", "-")
        if dashed in named:
            raise TypeError(f"a deck has the key {name!r} twice, once with '-' and once with '_'")
        named[dashed] = value
    return named


def _each(change: Callable[[Mapping[str, Any]], Any], tables: Any) -> Any:
    """Tables with a change to each; what is none is left to whoever reads the deck."""
    if isinstance(tables, Mapping):
        return change(tables)
    if isinstance(tables, str) or not isinstance(tables, Iterable):
        return tables
    return [change(table) if isinstance(table, Mapping) else table for table in tables]


def _dashed(value: Any) -> Any:
    """The same of what is in them too."""
    if isinstance(value, Mapping):
        return {name: _dashed(v) for name, v in _named(value).items()}
    if isinstance(value, (list, tuple)):
        return [_dashed(v) for v in value]
    return value


def _sampled(material: Mapping[str, Any]) -> dict[str, Any]:
    """A material with a function of hardening as a table."""
    given = _named(material)
    hardening: Callable[[Any], Any] | Any = given.get("hardening")
    if not callable(hardening):
        return given
    start = float(given.get("yield-stress", 0.0))
    stress = (start + _values(hardening, _SAMPLES)).tolist()
    on = given.get("on")
    if not np.isfinite(stress).all() or abs(stress[0] - start) > 1e-9 * abs(start):
        message = f"hardening of {on!r} adds {stress[0] - start} at the strain 0, expected 0 there and finite numbers"
        raise DeckError(message, [_softening(message)])
    softer = np.flatnonzero(np.diff(stress) < 0.0)
    if softer.size:
        at = int(softer[0])
        message = (
            f"hardening of {on!r} softens at the equivalent plastic strain {_SAMPLES[at + 1]:.4g}: "
            f"from {stress[at]:.6g} to {stress[at + 1]:.6g}, expected a stress that does not fall"
        )
        raise DeckError(message, [_softening(message)])
    given["hardening"] = {"table": [[p, s] for p, s in zip(_SAMPLES.tolist(), stress)]}
    return given


def _values(function: Callable[[Any], Any], at: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Its values at an array of arguments, by one call where it takes arrays."""
    try:
        # What changes its argument in place must not change the points.
        values = np.asarray(function(at.copy()), dtype=float)
    except (TypeError, ValueError):
        # As of an `if` on the argument, or of the functions of math.
        values = np.empty(0)
    if values.shape == at.shape:
        return values
    return np.array([float(function(argument)) for argument in at.tolist()])


def _softening(message: str) -> Finding:
    return Finding("error", "values", message, "hardening", None, 0, 0)


def _above(x: np.ndarray[Any, Any], y: np.ndarray[Any, Any]) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """The corners of the least concave line above points: all that bend it, none that lie on it or below."""
    kept: list[int] = []
    for k in range(len(x)):
        while len(kept) > 1:
            a, b = kept[-2:]
            if (y[b] - y[a]) * (x[k] - x[a]) > (y[k] - y[a]) * (x[b] - x[a]):
                break
            kept.pop()
        kept.append(k)
    return x[kept], np.maximum.accumulate(y[kept])


def _bounded(contact: Mapping[str, Any]) -> dict[str, Any]:
    """A contact with a function of friction as a table, up to a pressure that no contact reaches."""
    given = _named(contact)
    friction: Callable[[Any], Any] | Any = given.get("friction")
    if not callable(friction):
        return given
    pressures = _PRESSURES
    shear = _values(friction, pressures)
    on = given.get("surface")
    corners = _above(pressures, shear)
    bent = np.interp(pressures, *corners) - shear > _ROUNDING * shear
    parts = (pressures[1:-1] - pressures[:-2]) / (pressures[2:] - pressures[:-2])
    rises = shear[:-2] + parts * (shear[2:] - shear[:-2]) - shear[1:-1] > _ROUNDING * shear[1:-1]
    falls = np.diff(shear) < -_ROUNDING * shear[:-1]
    if not np.isfinite(shear).all() or shear[0] < 0.0:
        message = f"friction of {on!r} is {shear[0]} at no pressure, expected a shear >= 0 and finite numbers"
    elif falls.any():
        at = pressures[1 + int(np.flatnonzero(falls)[0])]
        message = f"friction of {on!r} falls at the pressure {at:.4g}, expected a shear that does not fall"
    elif bent.any():
        at = pressures[1 + int(np.flatnonzero(rises)[0])] if rises.any() else pressures[int(np.flatnonzero(bent)[0])]
        message = f"friction of {on!r} rises faster from the pressure {at:.4g} on, expected a concave function"
    else:
        given["friction"] = {"table": [list(row) for row in zip(*(c.tolist() for c in corners))]}
        return given
    raise DeckError(message, [Finding("error", "values", message, "friction", None, 0, 0)])
