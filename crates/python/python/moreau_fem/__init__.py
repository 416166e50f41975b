"""Elastoplastic solids in unilateral contact with Coulomb friction.

A problem is a *deck*, given as a file, as text or as keys in Python; :func:`run` runs it to its end, and
:class:`Simulation` goes through it increment by increment. Results are arrays of numpy, and data frames where pandas
is installed, in the units of the deck.
"""

from importlib.metadata import version

from .check_law import LawCheck, check_law
from .deck import Deck
from .errors import Collapse, DeckError, DeckWarning, Finding, LawError, NotConverged, RunError
from .law import Law
from .mesh import Mesh, block
from .result import Picture, Result, run, table
from .simulation import Grid, Increment, Simulation

__version__ = version("moreau-fem")

__all__ = [
    "Collapse",
    "Deck",
    "DeckError",
    "DeckWarning",
    "Finding",
    "Grid",
    "Increment",
    "Law",
    "LawCheck",
    "LawError",
    "Mesh",
    "NotConverged",
    "Picture",
    "Result",
    "RunError",
    "Simulation",
    "block",
    "check_law",
    "run",
    "table",
]
