"""Whether a law is what it must be: its tangent by differences, and that it is pure."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .errors import LawError
from .law import Asked, Law

Array = NDArray[np.float64]

# What rounding may do, in parts of the size of the terms.
_ROUNDING = 1e-10


class LawCheck(NamedTuple):
    """What a check of a law has found."""

    points: int
    """Responses that were looked at."""
    inelastic: int
    """Those of them with another tangent than that at rest: at least some, if the law is to be more than elastic."""
    kinks: int
    """Those whose tangent jumps nearby, of which differences tell nothing."""
    tangent: float
    """Largest difference of a tangent from that by differences, in parts of the elastic one."""


def check_law(
    law: Law, *, strain: float = 5e-3, points: int = 64, steps: int = 4, tolerance: float = 1e-5, seed: int = 0
) -> LawCheck:
    """Asks a law along random paths of strain, and compares its tangents with central differences of its stresses.

    Parameters
    ----------
    law
        The law.
    strain
        Size of the largest steps; the smallest are a thousandth of it. Beyond where the law yields.
    points, steps
        Paths, and steps of each.
    tolerance
        Difference of a tangent that is accepted, in parts of the elastic one.
    seed
        Of the paths, which are always the same.

    Raises
    ------
    LawError
        For the first thing that is wrong, with the strain increment and the state at which it is:

        - numbers that are none, or arrays of another shape;
        - an elastic tangent, that of a point at rest, that is not symmetric and positive definite;
        - a step without strain that changes something, a second answer that differs from the first, inputs that are
          written to, points that depend on each other;
        - tangents that are not ∂stress/∂strain, or not symmetric where ``symmetric`` is not ``False``.
    """
    asked = Asked(law)
    rng = np.random.default_rng(seed)
    states = np.tile(asked.initial, (points, 1))
    at_rest, elastic, same = _numbers(asked, np.zeros((points, 6)), states)
    moduli = elastic[0]
    size = float(np.abs(moduli).max())
    if np.abs(moduli - moduli.T).max() > _ROUNDING * size or np.linalg.eigvalsh(moduli).min() <= 0.0:
        raise LawError(f"the tangent of {asked.name} at rest is not symmetric and positive definite:\n{moduli}")
    stress, worst, inelastic, kinks = at_rest, 0.0, 0, 0
    for _ in range(steps):
        _rests(asked, stress, states, size * strain)
        sizes = strain * 10.0 ** rng.uniform(-3.0, 0.0, (points, 1))
        step = sizes * rng.uniform(-1.0, 1.0, (points, 6))
        stress, tangent, after = _numbers(asked, step, states)
        _is_pure(asked, step, states, (stress, tangent, after))
        slope, kinked = _differences(asked, step, states, 1e-5 * strain, tolerance * size)
        error = np.abs(tangent - slope).max(axis=(1, 2))
        error[kinked] = 0.0
        if (error > tolerance * size).any():
            k = int(error.argmax())
            i, j = np.unravel_index(np.abs(tangent[k] - slope[k]).argmax(), (6, 6))
            raise LawError(
                f"the tangent of {asked.name} is not the derivative of its stress: entry [{i}, {j}] is "
                f"{tangent[k, i, j]:.6g} and differences of the stress give {slope[k, i, j]:.6g}, {_at(step, states, k)}"
            )
        asymmetry = np.abs(tangent - tangent.transpose(0, 2, 1)).max(axis=(1, 2))
        if asked.symmetric and (asymmetry > 1e-9 * size).any():
            k = int(asymmetry.argmax())
            raise LawError(
                f"a tangent of {asked.name} is off symmetry by {asymmetry[k]:.3g}, {_at(step, states, k)}: correct it, "
                "or let the law have symmetric = False"
            )
        worst = max(worst, float(error.max()) / size)
        inelastic += int((np.abs(tangent - moduli).max(axis=(1, 2)) > _ROUNDING * size).sum())
        kinks += int(kinked.sum())
        states = after
    return LawCheck(points * steps, inelastic, kinks, worst)


def _at(step: Array, states: Array, k: int) -> str:
    return f"at the strain increment {step[k].tolist()} from the state {states[k].tolist()}"


def _numbers(asked: Asked, step: Array, states: Array) -> tuple[Array, Array, Array]:
    """An answer, in which everything is a number."""
    stress, tangent, after = asked.answer(step.copy(), states.copy())
    answer = (stress.copy(), tangent.copy(), after.copy())
    for what, array in zip(("stress", "tangent", "state"), answer):
        bad = np.flatnonzero(~np.isfinite(array.reshape(len(step), -1)).all(axis=1))
        if bad.size:
            raise LawError(f"the {what} of {asked.name} is no number, {_at(step, states, int(bad[0]))}")
    return answer


def _rests(asked: Asked, stress: Array, states: Array, size: float) -> None:
    """A step without strain changes nothing."""
    rest = np.zeros((len(states), 6))
    again, _, after = _numbers(asked, rest, states)
    moved = np.abs(again - stress).max(axis=1)
    changed = np.abs(after - states).max(axis=1, initial=0.0)
    scale = np.abs(states).max(axis=1, initial=0.0)
    wrong = np.flatnonzero((moved > _ROUNDING * size) | (changed > _ROUNDING * scale))
    if wrong.size:
        raise LawError(
            f"a step without strain changes the stress or the state of {asked.name}, {_at(rest, states, int(wrong[0]))}"
        )


def _is_pure(asked: Asked, step: Array, states: Array, answer: tuple[Array, Array, Array]) -> None:
    """The same again, and point by point; and inputs are left alone."""
    given = (step.copy(), states.copy())
    again = [np.array(array) for array in asked.answer(*given)]
    if not (np.array_equal(given[0], step) and np.array_equal(given[1], states)):
        raise LawError(f"{asked.name} writes to the strains or states that it is given")
    if not all(np.array_equal(a, b) for a, b in zip(again, answer)):
        raise LawError(f"{asked.name} answers the same question twice and not the same: a law remembers nothing itself")
    for k in range(min(len(step), 4)):
        alone = asked.answer(step[k : k + 1].copy(), states[k : k + 1].copy())
        for one, all_ in zip(alone, answer):
            scale = np.abs(all_[k]).max(initial=0.0)
            if np.abs(one[0] - all_[k]).max(initial=0.0) > _ROUNDING * scale:
                raise LawError(f"{asked.name} answers otherwise for a point alone, {_at(step, states, k)}")


def _differences(
    asked: Asked, step: Array, states: Array, h: float, allowed: float
) -> tuple[Array, NDArray[np.bool_]]:
    """∂stress/∂strain by central differences over h, and where it jumps nearby: where one-sided differences differ by
    more than a curve does, or those over 2 h from those over h."""
    slope = np.empty((len(step), 6, 6))
    kinked = np.zeros(len(step), dtype=bool)
    for j in range(6):
        stress = []
        for by in (-2.0 * h, -h, 0.0, h, 2.0 * h):
            shifted = step.copy()
            shifted[:, j] += by
            stress.append(asked.answer(shifted, states.copy())[0].copy())
        slope[:, :, j] = (stress[3] - stress[1]) / (2.0 * h)
        wider = (stress[4] - stress[0]) / (4.0 * h)
        one_sided = (stress[3] - 2.0 * stress[2] + stress[1]) / h
        kinked |= np.abs(wider - slope[:, :, j]).max(axis=1) > 0.1 * allowed
        kinked |= np.abs(one_sided).max(axis=1) > 100.0 * allowed
    return slope, kinked
