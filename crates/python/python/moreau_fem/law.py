"""Laws of materials as classes of Python, and how the core asks them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .errors import LawError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

# Fields that results have whatever the law.
_COMMON = {
    "stress",
    "von_mises",
    "equivalent_plastic_strain",
    "displacement",
    "out_of_balance",
    "cell",
    "point",
    "volume",
}


class Law(Protocol):
    """A law of a material under small strains, called for many points at once; any class with these two will do::

        class Elastic:
            state = 6                                   # the strain

            def respond(self, strain, state):
                strain = state + strain                 # the increments of the step, (n, 6)
                tangent = np.broadcast_to(C, (len(strain), 6, 6))
                return strain @ C, tangent, strain

        moreau_fem.run("block.toml", laws={"block": Elastic()})

    Symmetric tensors are ``[xx, yy, zz, √2·yz, √2·xz, √2·xy]``, so that products of vectors are those of tensors: the
    norm of a tensor is that of its six numbers, and a tangent of a material without axes is that of its moduli K and
    G, ``K d dᵀ + 2 G (1 − d dᵀ/3)`` with ``d = [1, 1, 1, 0, 0, 0]``. All six are there in plane strain and around
    an axis too. Stresses are in the unit of the deck.

    A law is pure: what it answers for a point depends on nothing but the numbers of that point. A step without strain
    changes nothing. What it answers to a point at rest is its elastic tangent; strain beyond what that explains is the
    plastic strain of the results, and the work of the stress on it what is dissipated.

    It may also have ``initial``, the numbers that every point starts from, (s,), zeros unless given; and ``symmetric``,
    ``False`` of a law whose tangents are not.
    """

    state: int | Mapping[str, int]
    """How many numbers a point remembers, s; or names of them and how many each has, in their order: these are fields
    of the results, 1 of a scalar, 3 of a vector, 6 of a symmetric tensor."""

    def respond(
        self, strain: NDArray[np.float64], state: NDArray[np.float64], /
    ) -> tuple[ArrayLike, ArrayLike, ArrayLike]:
        """Stresses (n, 6), tangents ∂stress/∂strain (n, 6, 6) and states (n, s) at the end of a step, from its strain
        increments (n, 6) and the states at its start (n, s), which are copies. All are in float64.

        An exception leaves the simulation at the last converged increment, and goes through it as it is. A stress that
        is no number says that the strain is too large: the step is shortened, or the increment cut.
        """
        ...


class Asked:
    """A law as the core asks it: numbers as bytes, answers as arrays that are looked at.

    Raises
    ------
    LawError
        For what is no law.
    """

    law: Law
    fields: list[tuple[str, int]]
    initial: list[float]
    symmetric: bool

    def __init__(self, law: Law) -> None:
        if isinstance(law, type):
            raise LawError(f"{law.__name__} is a class, expected a law of it: {law.__name__}(...)")
        self.law = law
        self.name = type(law).__name__
        if not callable(getattr(law, "respond", None)):
            raise LawError(f"{self.name} has no method respond(strain, state): it is no law")
        state: Any = getattr(law, "state", None)
        self.fields = []
        if isinstance(state, Mapping):
            self.fields = [(str(name), int(count)) for name, count in state.items()]
            state = sum(count for _, count in self.fields)
        for name, count in self.fields:
            if not name.isidentifier() or name in _COMMON or count not in (1, 3, 6):
                raise LawError(
                    f"{self.name}.state has {name!r} of {count} numbers, expected a word that no other field is called, "
                    "and 1, 3 or 6 numbers"
                )
        if not isinstance(state, (int, np.integer)) or state < 0:
            raise LawError(f"{self.name}.state is {state!r}, expected how many numbers a point remembers")
        initial: Any = getattr(law, "initial", None)
        numbers = np.zeros(int(state)) if initial is None else self._array("initial", initial, (int(state),))
        self.initial = numbers.tolist()
        self.symmetric = bool(getattr(law, "symmetric", True))

    def respond(
        self, strain: bytearray, state: bytearray
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """What the law answers to the points of a panel."""
        strains = np.frombuffer(strain, dtype=np.float64).reshape(-1, 6)
        count = len(strains)
        states = np.frombuffer(state, dtype=np.float64).reshape(count, len(self.initial))
        return self.answer(strains, states)

    def answer(
        self, strains: NDArray[np.float64], states: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """The same of arrays."""
        count = len(strains)
        answer: Any = self.law.respond(strains, states)
        if not isinstance(answer, tuple) or len(answer) != 3:
            raise LawError(f"{self.name}.respond returns {type(answer).__name__}, expected stress, tangent, state")
        stress, tangent, state = answer
        return (
            self._array("stress", stress, (count, 6)),
            self._array("tangent", tangent, (count, 6, 6)),
            self._array("state", state, (count, len(self.initial))),
        )

    def _array(self, what: str, given: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float64]:
        try:
            array = np.asarray(given)
            if array.dtype.kind not in "fc":
                array = array.astype(np.float64)
        except (TypeError, ValueError) as error:
            raise LawError(f"the {what} of {self.name} is no array of numbers: {error}") from error
        if array.dtype.kind == "c" or array.dtype.itemsize < 8:
            # With the digits of float32 no increment is balanced.
            raise LawError(f"the {what} of {self.name} is in {array.dtype}, expected float64")
        array = np.ascontiguousarray(array, dtype=np.float64)
        if array.shape != shape:
            raise LawError(f"the {what} of {self.name} has the shape {array.shape}, expected {shape}")
        return array


def asked(laws: Mapping[str, Law] | None) -> dict[str, Asked]:
    """Laws by the groups of cells that they are on, as the core asks them."""
    if laws is not None and not isinstance(laws, Mapping):
        raise TypeError(f"laws is {type(laws).__name__}, expected laws by the group that a material is on, as {{\"block\": law}}")
    return {on: Asked(law) for on, law in (laws or {}).items()}
