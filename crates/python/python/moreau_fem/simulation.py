"""A deck under way, stepped from outside."""

from __future__ import annotations

import json
import tomllib
import warnings
from collections.abc import Iterator, Mapping
from os import PathLike
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _toml, errors, tables
from .deck import Deck, _dashed
from .errors import DeckError, DeckWarning
from .law import Law
from .tables import numbers

if TYPE_CHECKING:
    from ._core import Field

Source = str | PathLike[str] | Mapping[str, Any] | Deck


class Increment(NamedTuple):
    """A converged increment; energies, forces and lengths in the units of the deck."""

    step: int
    """Number of the step, from 1."""
    increment: int
    """Number of the increment, from 1."""
    time: float
    """Steps done, with the part of the one under way."""
    newton_iterations: int
    contact_iterations: int
    cuts: int
    """Times that it was halved before it converged."""
    open: int
    """Contact points that are open."""
    stick: int
    slip: int
    plastic_fraction: float
    """Part of the volume in which plastic strain grew."""
    external_work: float
    elastic_energy: float
    plastic_dissipation: float
    friction_dissipation: float
    penalty_energy: float
    bipotential_gap: float
    """Sum of b(−u, t) + t·u over all contacts: zero is the solution."""
    penetration: float
    excess_force: float
    """Largest force outside of the cone of friction."""
    out_of_balance: float
    """Largest force that nothing balances."""
    factorisations: int


class Grid(NamedTuple):
    """A body, its contact surfaces or its quadrature points, with fields. All arrays are copies."""

    points: NDArray[np.float64]
    """Coordinates, (n, 3): under large strains where the points are, else where they were."""
    cells: NDArray[np.int64]
    """For each cell the number of its points and these, in the order of VTK."""
    types: NDArray[np.uint8]
    """Types of the cells in VTK, (m,)."""
    point_data: dict[str, NDArray[np.float64]]
    """Fields at points, (n,) or (n, components); tensors are xx, yy, zz, xy, yz, xz."""
    cell_data: dict[str, NDArray[np.float64]]
    """Fields of cells, (m,) or (m, components)."""
    units: dict[str, str]
    """Units of the fields that have one."""


def _fields(fields: list[Field]) -> dict[str, NDArray[np.float64]]:
    shapes = {1: (-1,)}
    return {name: numbers(data, *shapes.get(n, (-1, n))) for name, _, n, data in fields}


class Simulation:
    """A deck under way. Iterating over it goes through the increments, each converged::

        for increment in moreau_fem.Simulation("block.toml"):
            print(increment.time, increment.plastic_fraction)

    Ctrl-C leaves the last converged increment, also within the next one; going on ends with the same bits. All
    arrays are copies. A simulation belongs to one thread at a time, the interpreter is free for others meanwhile.
    :func:`copy.copy` and :mod:`pickle` make another by :meth:`save` and :meth:`restore`, which goes on by itself, with the
    same laws.

    ``laws`` are laws in Python, in place of those of materials of the deck, by the group that a material is ``on``: see
    :class:`Law`. They are for small strains. The elastic moduli and the yield stress of such a material are not used,
    but for the stiffness of a penalty that is given as a penetration.

    Raises
    ------
    DeckError
        If the deck cannot be run, or has no material on a group that a law is given on.
    LawError
        For a law that is none. What a law raises itself goes through.
    """

    deck: Deck
    """The deck. After :attr:`step` was set it is the one with that step, which :meth:`restore` needs, and no record of what
    was done: a step that gave way stands in it whole, with a comment that says where it was given up."""

    def __init__(self, deck: Source, *, laws: Mapping[str, Law] | None = None) -> None:
        self.deck = deck if isinstance(deck, Deck) else Deck(deck)
        self._core = self.deck.open(laws)
        self._laws = dict(laws or {})

    def __iter__(self) -> Iterator[Increment]:
        return self

    def __next__(self) -> Increment:
        """The next increment.

        Raises
        ------
        NotConverged, Collapse, RunError
            If there is none because the step does not go on; what converged before is kept.
        LawError
            If an answer of a law is none. After this, and after whatever a law raises itself, the last converged
            increment is kept, and going on begins the next one again.
        """
        if self._core.advance():
            return self.last
        from .result import Result

        error = errors.of_outcome(Result(self))
        if error is not None:
            raise error
        raise StopIteration

    @property
    def last(self) -> Increment:
        """The last increment that converged.

        Raises
        ------
        IndexError
            Before the first.
        """
        if not self.increments:
            raise IndexError("no increment has converged yet")
        row = tables.last(self._core.history())
        return Increment(**{name: row[name] for name in Increment._fields})

    def _set_step(self, keys: Mapping[str, Any]) -> None:
        if not isinstance(keys, Mapping):
            raise TypeError(f"step is {keys!r}, expected the keys of one, as dict(name=\"unload\", increments=2)")
        found, refused = self._core.replace_step(_toml.body(_dashed(keys)))
        if refused is not None:
            raise DeckError(refused, errors.findings(found))
        errors.warn(errors.findings(found))
        before = self.deck
        told = before.comments
        *steps, _ = tomllib.loads(self._core.resolved())["step"]
        part = self._time() - len(steps) + 1
        if steps and part < 1.0 - 1e-9:
            told += f"# Step \"{steps[-1]['name']}\" was given up at {part:.6g} of it: run anew, it is done whole.\n"
        self.deck = Deck(told + self._core.resolved(), folder=before.folder)
        self.deck.file, self.deck.meshes = before.file, before.meshes

    def _time(self) -> float:
        """Steps done, with the part of the one under way."""
        return float(tables.last(self._core.history())["time"]) if self.increments else 0.0

    step = property(
        None,
        _set_step,
        doc="""Set to the keys of a step, what is left of the step under way and the steps after it give way to it. A
        step that does not fit is a :class:`DeckError`, and changes nothing. What is done up to then is in no deck: the
        record of it is the code that sets the step, :attr:`history` and what :meth:`save` leaves.""",
    )

    @property
    def increments(self) -> int:
        """Increments that have converged."""
        return self._core.progress()[1]

    @property
    def done(self) -> float:
        """Part of all steps that has been done, in [0, 1]."""
        return self._core.progress()[2]

    @property
    def nodes(self) -> NDArray[np.float64]:
        """Coordinates of the nodes in the undeformed body, (n, 2) or (n, 3)."""
        return numbers(self._core.nodes()[0], -1, self._core.progress()[0])

    @property
    def displacement(self) -> NDArray[np.float64]:
        """Displacements of the nodes, (n, 2) or (n, 3), in the unit of length."""
        return numbers(self._core.nodes()[1], -1, self._core.progress()[0])

    @property
    def stress(self) -> NDArray[np.float64]:
        """Stresses at the quadrature points as they were computed, (m, 6): xx, yy, zz, xy, yz, xz. Where the points are,
        and what else is known there, is in ``arrays("points")``."""
        return self.arrays("points").point_data["stress"]

    @property
    def history(self) -> Any:
        """A row for each increment: a ``pandas.DataFrame`` with units in ``.attrs["units"]``, or without pandas a
        dictionary of arrays."""
        return tables.of_core(self._core.history())

    def contacts(self) -> Any:
        """A row for each contact point after the last increment, as :attr:`history` has one for each increment."""
        return tables.of_core(self._core.contacts())

    @property
    def outcome(self) -> dict[str, Any]:
        """How it stands, as ``run.json`` tells it: status, certificate, expectations, warnings, collapse."""
        outcome: dict[str, Any] = json.loads(self._core.outcome()[0])
        return outcome

    @property
    def summary(self) -> str:
        """The same for a person."""
        return self._core.outcome()[1]

    def arrays(self, which: str = "body") -> Grid:
        """A grid as arrays: ``"body"``, with fields recovered at points and means of cells; ``"contact"``;
        ``"points"``, the quadrature points with nothing recovered; or ``"failed"``, the last candidate of an increment
        that did not converge.

        Raises
        ------
        ValueError
            For another name, or if there is no such grid.
        """
        grid = self._core.grid(which)
        if grid is None:
            raise ValueError(f"there is no grid {which!r} of this simulation")
        points, cells, types, of_points, of_cells = grid
        units = {name: unit for name, unit, _, _ in [*of_points, *of_cells] if unit}
        return Grid(
            numbers(points, -1, 3),
            np.frombuffer(cells, dtype=np.int64),
            np.frombuffer(bytearray(types), dtype=np.uint8),
            _fields(of_points),
            _fields(of_cells),
            units,
        )

    def grid(self, which: str = "body") -> Any:
        """The same as a ``pyvista.UnstructuredGrid``, without a file. Under large strains its points are where the body is.

        Raises
        ------
        ImportError
            Without pyvista.
        """
        import pyvista

        arrays = self.arrays(which)
        grid = pyvista.UnstructuredGrid(arrays.cells, arrays.types, arrays.points)
        for name, values in arrays.point_data.items():
            grid.point_data[name] = values
        for name, values in arrays.cell_data.items():
            grid.cell_data[name] = values
        return grid

    def save(self) -> bytes:
        """The simulation as bytes, deck and history with it, but not the laws that it was given."""
        deck = self.deck
        head = {
            "text": deck.text,
            "file": deck.file,
            "folder": str(deck.folder),
            "meshes": {name: content.decode("latin-1") for name, content in deck.meshes.items()},
        }
        return json.dumps(head).encode() + b"\n" + self._core.save()

    @classmethod
    def restore(cls, state: bytes, *, laws: Mapping[str, Law] | None = None) -> Simulation:
        """A simulation that :meth:`save` has left, with the laws that it was given: it goes on as if nothing had
        happened, to the bit.

        Raises
        ------
        ValueError
            For bytes that are no such state, or not whole.
        """
        line, _, numbers = state.partition(b"\n")
        try:
            head = json.loads(line)
            deck = Deck(head["text"], folder=head["folder"])
            deck.file = head["file"]
            deck.meshes = {name: text.encode("latin-1") for name, text in head["meshes"].items()}
        except (ValueError, KeyError, TypeError) as error:
            raise ValueError("this is no state of a simulation") from error
        simulation = cls(deck, laws=laws)
        simulation._core.restore(numbers)
        return simulation

    def __reduce__(self) -> tuple[Any, ...]:
        # Copies and what is pickled have a course of their own.
        return _again, (type(self), self.save(), self._laws)

    def __repr__(self) -> str:
        return f"<simulation of {self.deck.file}: {self.increments} increments, {100 * self.done:.0f} %>"


def _again(kind: type[Simulation], state: bytes, laws: Mapping[str, Law]) -> Simulation:
    """A simulation that was saved, whose doubts have been told."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeckWarning)
        return kind.restore(state, laws=laws)
