"""What can go wrong with a deck and with a run, as exceptions with numbers."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from pathlib import Path

    from ._core import Found
    from .result import Result


class Finding(NamedTuple):
    """What is wrong or doubtful in a deck, and where."""

    severity: str
    """``"error"`` or ``"warning"``."""
    subject: str
    """The section of ``docs/errors.md`` with cause and remedy."""
    message: str
    """What was found and what was expected."""
    label: str
    """What stands at the place."""
    help: str | None
    """What to do, if there is more to say."""
    line: int
    """Line of the deck's text, from 1."""
    column: int
    """Column in that line, from 1."""
    file: Path | None = None
    """The file that the line is of, if the deck includes it; else it is of the deck itself."""


def findings(found: list[Found]) -> list[Finding]:
    """The findings as they come from the core."""
    return [Finding(*one) for one in found]


class DeckWarning(UserWarning):
    """A doubt about a deck that can be run."""


class DeckError(ValueError):
    """A deck that cannot be run. Its text shows each error with its line and a mark at the place."""

    findings: list[Finding]
    """All that was found, warnings too."""

    def __init__(self, text: str, found: list[Finding]) -> None:
        super().__init__(text)
        self.findings = found

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (*self.args, self.findings), self.__dict__

    def __str__(self) -> str:
        # On a line of its own, so that marks stand below what they point at.
        return "\n" + str(self.args[0])


class LawError(ValueError):
    """A law of a material in Python that is none: what it answers, and where if that is known."""

    cell: int | None
    """The cell of the mesh."""
    point: int | None
    """The quadrature point of the cell, from 0."""
    position: tuple[float, ...] | None
    """Where that is in the undeformed body."""

    def __init__(
        self,
        message: str,
        cell: int | None = None,
        point: int | None = None,
        position: tuple[float, ...] | None = None,
    ) -> None:
        super().__init__(message)
        self.cell, self.point, self.position = cell, point, position


class RunError(RuntimeError):
    """A run that did not come to its end. What converged before is in ``result``."""

    result: Result | None
    """What converged before; ``None`` of an exception that was pickled, as by another process."""
    outcome: dict[str, Any]
    """How the run stood, as ``run.json`` tells it."""

    def __init__(self, message: str, result: Result | None = None) -> None:
        super().__init__(message)
        self.result = result
        self.outcome = {} if result is None else result.outcome

    def __reduce__(self) -> tuple[Any, ...]:
        # A result opens its deck again: that could fail where nobody catches it, as in the thread of a pool.
        return type(self), self.args, {**self.__dict__, "result": None}


class NotConverged(RunError):
    """A step that stopped, however short its increments were made."""

    @property
    def _diagnosis(self) -> dict[str, Any]:
        return self.outcome["diagnosis"] or {}

    @property
    def worst(self) -> list[dict[str, Any]]:
        """The nodes farthest out of balance: ``node``, ``position``, ``force``."""
        return list(self._diagnosis.get("worst", []))

    @property
    def plastic_fraction(self) -> float:
        """Part of the volume that flows plastically."""
        return float(self._diagnosis.get("plastic_fraction", 0.0))

    @property
    def load_factor(self) -> float | None:
        """Estimate of the load factor at collapse, in parts of the loads of the step."""
        factor = self._diagnosis.get("load_factor")
        return None if factor is None else float(factor)

    @property
    def suggestion(self) -> str:
        """What to change first."""
        return str(self._diagnosis.get("suggestion", ""))


class Collapse(RunError):
    """Loads that the structure does not carry; those of a step with ``until="collapse"`` are no error."""

    @property
    def load_factor(self) -> float:
        """Load factor at collapse, of the way from the forces at the start of the step to its loads."""
        return float(self.outcome["collapse"]["load_factor"])

    @property
    def lower(self) -> float:
        """Load factor that the structure was found to carry: that at collapse."""
        return self.load_factor

    @property
    def upper(self) -> float | None:
        """Kinematic bound of the load factor, if there is one."""
        bound = self.outcome["collapse"]["upper_bound"]
        return None if bound is None else float(bound)


def warn(found: list[Finding]) -> None:
    """Passes doubts on to whoever filters warnings."""
    for finding in found:
        if finding.severity == "warning":
            where = f" (line {finding.line})" if finding.line else ""
            warnings.warn(finding.message + where, DeckWarning, stacklevel=4)


def of_outcome(result: Result) -> RunError | None:
    """The exception of a run that did not come to its end; ``None`` of one that did, or is under way."""
    outcome = result.outcome
    kinds = {"not converged": NotConverged, "collapsed": Collapse, "refused": RunError}
    kind = kinds.get(outcome["status"])
    return None if kind is None else kind(outcome["error"], result)
