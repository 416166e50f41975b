"""Runs to the end, and what they have found."""

from __future__ import annotations

import difflib
import html
import math
import sys
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from .deck import Deck
from .law import Law
from .simulation import Simulation, Source
from .tables import frame

# Suffixes of the components of vectors and of tensors.
_SUFFIXES = {3: ["x", "y", "z"], 6: ["xx", "yy", "zz", "xy", "yz", "xz"]}


class Picture:
    """A picture, which notebooks show."""

    svg: str
    """The picture as SVG."""

    def __init__(self, svg: str) -> None:
        self.svg = svg

    def _repr_svg_(self) -> str:
        return self.svg


class Result:
    """What a run has found. Notebooks show its summary and its pictures."""

    simulation: Simulation
    """The simulation at its end, with arrays and grids."""

    def __init__(self, simulation: Simulation) -> None:
        self.simulation = simulation

    @property
    def deck(self) -> Deck:
        """The deck."""
        return self.simulation.deck

    @property
    def history(self) -> Any:
        """See :attr:`Simulation.history`."""
        return self.simulation.history

    @property
    def contacts(self) -> Any:
        """See :meth:`Simulation.contacts`."""
        return self.simulation.contacts()

    @property
    def outcome(self) -> dict[str, Any]:
        """See :attr:`Simulation.outcome`."""
        return self.simulation.outcome

    def grid(self, which: str = "body") -> Any:
        """See :meth:`Simulation.grid`."""
        return self.simulation.grid(which)

    def plot(self, field: str | None = None, magnification: float | None = None) -> Picture:
        """The deformed body, in space seen from one side, with a field of ``arrays("body")`` or a component of one, as in
        ``"displacement.x"`` and ``"stress.xx"``, and displacements drawn so many times as large. Tensors are drawn by their
        components.

        Raises
        ------
        ValueError
            For a field that there is not, for a magnification that is no number, and before the first increment.
        """
        if magnification is not None and not math.isfinite(magnification):
            raise ValueError(f"the magnification is {magnification}, expected a finite number")
        pictures = dict(self.simulation._core.pictures(field, magnification))
        if "deformed" not in pictures:
            raise ValueError(self._nothing_of(field))
        return Picture(pictures["deformed"])

    def _nothing_of(self, field: str | None) -> str:
        """Why there is nothing to draw of a field."""
        if not self.simulation.increments:
            return "there is nothing to draw: no increment has converged yet"
        fields = self.simulation.arrays().point_data
        components = {
            name: [f"{name}.{suffix}" for suffix in _SUFFIXES.get(values.shape[-1] if values.ndim > 1 else 1, [])]
            for name, values in fields.items()
        }
        # Of a vector its length is drawn, of a tensor its components alone.
        if field in components:
            return f"{field!r} is drawn by its components, expected one of {', '.join(components[field])}"
        names = [name for name, own in components.items() if len(own) < 6] + sum(components.values(), [])
        near = difflib.get_close_matches(str(field), names, 1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        return f"there is no field {field!r}, expected one of {', '.join(names)}{hint}"

    def __str__(self) -> str:
        return self.simulation.summary.rstrip()

    def __repr__(self) -> str:
        return f"<result of {self.deck.file}: {self.outcome['status']}>"

    def _repr_html_(self) -> str:
        pictures = [svg for _, svg in self.simulation._core.pictures()]
        return f"<pre>{html.escape(str(self))}</pre>\n" + "\n".join(pictures)


def run(deck: Source, *, quiet: bool = False, laws: Mapping[str, Law] | None = None) -> Result:
    """Runs a deck to its end, in memory: nothing is written. On a terminal, progress is shown unless ``quiet``.
    ``laws`` are those of :class:`Simulation`.

    Raises
    ------
    DeckError
        If the deck cannot be run.
    NotConverged, Collapse, RunError
        If it does not come to its end; ``.result`` has what converged before.
    LawError
        For a law that is none. What a law raises itself goes through.
    """
    simulation = Simulation(deck, laws=laws)
    shown = not quiet and sys.stderr.isatty()
    try:
        for increment in simulation:
            if shown:
                part = 100 * simulation.done
                text = f"\rincrement {increment.increment}, {part:.0f} %, {increment.newton_iterations} Newton"
                print(f"{text:<60}", end="", file=sys.stderr, flush=True)
    finally:
        if shown:
            print(file=sys.stderr)
    return Result(simulation)


def table(runs: Iterable[Result], **columns: Callable[[Result], Any]) -> Any:
    """A table with a row for each run and a column for each function of it: a ``pandas.DataFrame``, or without
    pandas a dictionary of arrays."""
    every = list(runs)
    return frame({name: [of(result) for result in every] for name, of in columns.items()})
