"""Runs to the end, and what they have found."""

from __future__ import annotations

import html
import sys
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from .deck import Deck
from .law import Law
from .simulation import Simulation, Source
from .tables import frame


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
        """The deformed body of a plane problem, with a field of ``arrays("body")`` or a component of one, as in
        ``"displacement.x"``, and displacements drawn so many times as large.

        Raises
        ------
        ValueError
            For a field that there is not, and for bodies in space: see :meth:`grid`.
        """
        pictures = dict(self.simulation._core.pictures(field, magnification))
        if "deformed" not in pictures:
            fields = ", ".join(self.simulation.arrays().point_data)
            raise ValueError(f"nothing to draw of {field!r}; in the plane there are {fields}")
        return Picture(pictures["deformed"])

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
