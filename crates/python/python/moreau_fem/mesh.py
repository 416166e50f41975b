"""Meshes as arrays, from other libraries, or of structured blocks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

# Of every kind of cell its names elsewhere, its type in VTK, its type in Gmsh, its nodes and its dimension.
_KINDS = [
    ("vertex", ["vertex"], 1, 15, 1, 0),
    ("line2", ["line"], 3, 1, 2, 1),
    ("line3", ["line3"], 21, 8, 3, 1),
    ("tri3", ["triangle"], 5, 2, 3, 2),
    ("tri6", ["triangle6"], 22, 9, 6, 2),
    ("quad4", ["quad"], 9, 3, 4, 2),
    ("quad8", ["quad8"], 23, 16, 8, 2),
    ("quad9", ["quad9"], 28, 10, 9, 2),
    ("tet4", ["tetra"], 10, 4, 4, 3),
    ("tet10", ["tetra10"], 24, 11, 10, 3),
    ("hex8", ["hexahedron"], 12, 5, 8, 3),
    ("hex20", ["hexahedron20"], 25, 17, 20, 3),
    ("hex27", ["hexahedron27"], 29, 12, 27, 3),
]
_NAMES = {name: kind[0] for kind in _KINDS for name in [kind[0], *kind[1]]}
_VTK = {kind[2]: kind[0] for kind in _KINDS}
_GMSH = {kind[0]: kind[3] for kind in _KINDS}
_NODES = {kind[0]: kind[4] for kind in _KINDS}
_DIMENSION = {kind[0]: kind[5] for kind in _KINDS}

# Which node of Gmsh stands at each place of VTK, where that is not the same.
_HEXAHEDRON = [0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15]
_ORDER = {
    "tet10": [0, 1, 2, 3, 4, 5, 6, 7, 9, 8],
    "hex20": _HEXAHEDRON,
    "hex27": [*_HEXAHEDRON, 22, 23, 21, 24, 20, 25, 26],
}

Cells = Mapping[str, ArrayLike]


def block(name: str, element: str, **grid: Any) -> dict[str, Any]:
    """A structured block with the groups ``name``, ``name.left``, ``name.right``, ``name.bottom`` and ``name.top``,
    in space also ``name.back`` and ``name.front``: the keys of ``[[mesh.block]]`` of a deck.

    ``x``, ``y`` and in space ``z`` are ``[from, to]`` with the numbers of ``cells`` along each, or
    ``{"lines": [...]}``.
    """
    return {"block": [{"name": name, "element": element, **grid}]}


class Mesh:
    """A mesh of arrays.

    Parameters
    ----------
    points
        Coordinates, (n, 2) or (n, 3), in the unit of length of the deck.
    cells
        Nodes of the cells by kind, as in ``{"quad8": (m, 8)}``, counted from 0 and in the order of VTK, which is that
        of meshio and pyvista. Their dimension is that of the analysis.
    groups
        By name, the nodes of the members by kind: cells, sides of cells (``{"line3": (k, 3)}``) or single nodes
        (``{"vertex": (k, 1)}``). Cells in no group are left out, unless none is in any: they are the group ``"mesh"``.

    Raises
    ------
    ValueError
        For coordinates that are no numbers, for a kind of cell that is not known, for arrays of another shape, for nodes that do not exist or are no whole numbers, and for names of groups
        with quotes or line breaks.
    TypeError
        For cells, or a group, that are not given by kind.
    """

    def __init__(
        self, points: ArrayLike, cells: Cells, groups: Mapping[str, Cells] | None = None
    ) -> None:
        self.points = np.asarray(points, dtype=float)
        if self.points.ndim != 2 or self.points.shape[1] not in (2, 3):
            raise ValueError(f"points have the shape {self.points.shape}, expected (n, 2) or (n, 3)")
        unknown = np.flatnonzero(~np.isfinite(self.points).all(axis=1))
        if unknown.size:
            at = int(unknown[0])
            raise ValueError(f"points[{at}] is {self.points[at].tolist()}, expected finite coordinates")
        self.cells = self._checked("cells", cells)
        self.groups = {name: self._checked(f"the group {name!r}", members) for name, members in (groups or {}).items()}
        unfit = [name for name in self.groups if not name.isprintable() or '"' in name]
        if unfit:
            raise ValueError(f"groups are called {unfit}, expected names without quotes and line breaks")

    def _checked(self, what: str, cells: Cells) -> dict[str, NDArray[np.int64]]:
        if not isinstance(cells, Mapping):
            raise TypeError(
                f"{what} is given as {type(cells).__name__}, expected nodes by kind of cell, as "
                '{"quad8": (m, 8)}, of sides {"line3": (k, 3)}, of nodes {"vertex": (k, 1)}'
            )
        checked = {}
        for name, given in cells.items():
            kind = _NAMES.get(name)
            if kind is None:
                raise ValueError(f"no cells are called {name!r}, expected one of {', '.join(_NODES)}")
            nodes = np.asarray(given)
            if nodes.dtype.kind not in "iuf":
                raise ValueError(f"{kind} has values of the type {nodes.dtype}, expected numbers of nodes")
            if (nodes % 1 != 0).any():
                raise ValueError(f"{kind} has the node {nodes[nodes % 1 != 0][0]}, expected whole numbers from 0")
            nodes = nodes.astype(np.int64)
            if nodes.ndim != 2 or nodes.shape[1] != _NODES[kind]:
                raise ValueError(f"{kind} has the shape {nodes.shape}, expected (m, {_NODES[kind]})")
            if nodes.size and not (0 <= nodes.min() and nodes.max() < len(self.points)):
                raise ValueError(f"{kind} has nodes beyond 0 to {len(self.points) - 1}")
            checked[kind] = nodes
        return checked

    @classmethod
    def of(cls, given: Any) -> Mesh:
        """A mesh of meshio (``points``, ``cells`` as blocks, ``cell_sets``, ``point_sets``, physical groups of Gmsh) or
        of pyvista (``points``, ``cells_dict``; arrays of 0 and 1 on cells and points are groups)."""
        if isinstance(given, cls):
            return given
        if hasattr(given, "cells_dict") and hasattr(given, "celltypes"):
            return cls(*_of_pyvista(given))
        if hasattr(given, "cell_sets") and hasattr(given, "points"):
            return cls(*_of_meshio(given))
        raise TypeError(f"{type(given).__name__} is no mesh, expected keys, a Mesh, or one of meshio or pyvista")

    def to_gmsh(self) -> str:
        """The mesh as the text of a file of Gmsh, version 2.2."""
        return "\n".join(self._lines()) + "\n"

    def _lines(self) -> Iterator[str]:
        top = max((_DIMENSION[kind] for kind in self.cells), default=0)
        body = {kind: nodes for kind, nodes in self.cells.items() if _DIMENSION[kind] == top}
        groups = dict(self.groups)
        if not any(_DIMENSION[kind] == top for members in groups.values() for kind in members):
            groups = {"mesh": body, **groups}
        yield from ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(groups))]
        for tag, (name, members) in enumerate(groups.items(), 1):
            dimension = max((_DIMENSION[kind] for kind in members), default=0)
            yield f'{dimension} {tag} "{name}"'
        yield from ["$EndPhysicalNames", "$Nodes", str(len(self.points))]
        for number, point in enumerate(self.points.tolist(), 1):
            x, y, z = [*point, 0.0][:3]
            yield f"{number} {x!r} {y!r} {z!r}"
        # Cells that no group has are left out by whoever reads them, unless none has any.
        listed = list(enumerate(groups.values(), 1))
        count = sum(len(nodes) for _, members in listed for nodes in members.values())
        yield from ["$EndNodes", "$Elements", str(count)]
        number = 0
        for tag, members in listed:
            for kind, nodes in members.items():
                for row in _of_gmsh(kind, nodes).tolist():
                    number += 1
                    yield f"{number} {_GMSH[kind]} 2 {tag} {tag} " + " ".join(map(str, row))
        yield "$EndElements"


def _of_gmsh(kind: str, nodes: NDArray[np.int64]) -> NDArray[np.int64]:
    """Nodes in the order of Gmsh, from 1."""
    ordered = nodes
    if kind in _ORDER:
        ordered = np.empty_like(nodes)
        ordered[:, _ORDER[kind]] = nodes
    return ordered + 1


def _flat(points: Any) -> NDArray[np.float64]:
    return np.asarray(points, dtype=float)


def _gathered(blocks: list[tuple[str, Any]]) -> dict[str, Any]:
    """Blocks of cells by kind, several of a kind in one array."""
    kinds: dict[str, list[Any]] = {}
    for kind, nodes in blocks:
        kinds.setdefault(kind, []).append(np.asarray(nodes))
    return {kind: np.concatenate(nodes) for kind, nodes in kinds.items()}


def _marked(values: Any) -> NDArray[np.intp] | None:
    """Members of a group that an array of 0 and 1 stands for; ``None`` of another array."""
    array = np.asarray(values)
    if array.ndim != 1 or not np.isin(array, (0, 1)).all() or not array.any():
        return None
    return np.flatnonzero(array)


def _of_pyvista(given: Any) -> tuple[Any, Any, dict[str, Any]]:
    groups: dict[str, Any] = {}
    types = np.asarray(given.celltypes)
    unknown = sorted(set(types.tolist()) - set(_VTK))
    if unknown:
        raise ValueError(f"cells of the types {unknown} of VTK are not known")
    cells = {_VTK[int(kind)]: np.asarray(nodes) for kind, nodes in given.cells_dict.items()}
    for name in given.cell_data.keys():
        members = _marked(given.cell_data[name])
        if members is not None:
            marked = np.zeros(len(types), dtype=bool)
            marked[members] = True
            own = {_VTK[int(kind)]: marked[types == kind] for kind in set(types[members].tolist())}
            groups[name] = {kind: cells[kind][mask] for kind, mask in own.items()}
    for name in given.point_data.keys():
        members = _marked(given.point_data[name])
        if members is not None:
            groups[name] = {"vertex": members[:, None]}
    return _flat(given.points), cells, groups


def _of_meshio(given: Any) -> tuple[Any, Any, dict[str, Any]]:
    blocks = [(_NAMES.get(block.type, block.type), np.asarray(block.data)) for block in given.cells]
    groups: dict[str, Any] = {}
    for name, members in (given.cell_sets or {}).items():
        own = [(kind, nodes[np.asarray(index)])
               for (kind, nodes), index in zip(blocks, members) if index is not None and len(index)]
        if own and not name.startswith("gmsh:"):
            groups[name] = _gathered(own)
    tags = (given.cell_data or {}).get("gmsh:physical")
    if tags is not None:
        for name, (tag, dimension) in given.field_data.items():
            own = [(kind, nodes[np.asarray(tagged) == tag])
                   for (kind, nodes), tagged in zip(blocks, tags) if _DIMENSION.get(kind) == dimension]
            own = [(kind, nodes) for kind, nodes in own if len(nodes)]
            if own:
                groups.setdefault(name, _gathered(own))
    for name, nodes in (given.point_sets or {}).items():
        groups.setdefault(name, {"vertex": np.asarray(nodes)[:, None]})
    return _flat(given.points), _gathered(blocks), groups
