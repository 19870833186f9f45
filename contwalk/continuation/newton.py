"""The corrector: Newton's method on F(z) = 0 bordered by one linear condition."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.continuation.correction import CHORDS, Correction, Explanation
from contwalk.errors import PluginError
from contwalk.numerics.broyden import broyden_step
from contwalk.numerics.linear import norm, norm_in
from contwalk.problems.linearization import LARGEST_MAGNITUDE
from contwalk.problems.problem import Linearization, Problem, equations_at

# Residuals this many times above their rounding error still count as solved: the bound is of first order.
ROUNDED = 20.0
# Before corrections are this small, the residual is not asked whether it is rounding: that has a price.
NEARLY = 1e-4
# A correction this small in the metric is rounding, as of a velocity that is zero but for others' last
# digits.
NOTHING = 1e-14
# Unknowns this small against their typical magnitude may be zero.
DUST = 1e-18
# From which size on corrections are by the same Jacobian, and by how much each is smaller at least.
NEAR, CONTRACTS = 1e-2, 0.1
# Corrections by the derivatives at another solution, and by how much each is smaller at least.
APPROACHES, NEARS = 8, 0.5
# Iterations that may follow when corrections are small already.
SETTLING = 12
# A correction that takes more than so many iterations, as a real number: what is hard to guess is fitted.
LABORIOUS = 3.0
# Fitted unknowns take a solution out of its hyperplane: it is back in it to this part of the metric.
ON_PLANE = 1e-9


class _Equations:
    """A problem's equations at the points of one iteration, in the hyperplane normal . (z - guess) = 0;
    remeshed where its discretisation does not reach one of them.
    """

    def __init__(self, problem: Problem, guess: np.ndarray, normal: np.ndarray, weights: np.ndarray) -> None:
        self.problem, self.guess, self.normal, self.weights = problem, guess, normal, weights

    def begin(self) -> None:
        """An iteration begins: sizes of its corrections, and whether one Jacobian made the first two."""
        self.sizes = list[float]()
        self.chords = False

    def at(self, z: np.ndarray) -> Linearization:
        """Residual and Jacobian at z; not finite where no discretisation reaches it."""
        self.problem, lin = equations_at(self.problem, z)
        return lin

    def correction(
        self, lin: Linearization, z: np.ndarray, residual: np.ndarray | None = None
    ) -> np.ndarray | None:
        """What Newton's method subtracts from z, shape (N + 1,), for its residual, that of the Jacobian's
        place by default; None where the bordered Jacobian is singular.
        """
        left = lin.residual if residual is None else residual, [self.normal @ (z - self.guess)]
        try:
            step = lin.bordered(self.normal, self.weights).solve(np.concatenate(left))
        except np.linalg.LinAlgError:
            return None
        # Beyond 1e150 its length would overflow.
        return step if (np.abs(step) < 1e150).all() else None

    def size(self, step: np.ndarray | None) -> float:
        """Length of a correction in the metric."""
        return np.inf if step is None else norm_in(step, self.weights)

    def ended(
        self,
        z: np.ndarray,
        lin: Linearization | None,
        iterations: int,
        reason: str = "",
        explanation: Explanation = "",
    ) -> Correction:
        """What has become of the iteration."""
        sizes = tuple(self.sizes[:2])
        return Correction(self.problem, z, lin, iterations, reason, explanation, sizes, self.chords)

    def singular(self, z: np.ndarray, lin: Linearization, iterations: int, sentence: str) -> Correction:
        """A solution already, of equations too singular to improve on it; else why there is none."""
        solved = lin.excess <= ROUNDED
        return self.ended(z, lin, iterations, *(() if solved else ("no_convergence", sentence)))

    def undefined_at(self, z: np.ndarray, iterations: int) -> Correction:
        """That they have no finite value at z; where in the plugin that is, is looked for when it is told."""
        diagnosis = self.problem.diagnosis

        def explanation() -> str:
            return f"The equations have no finite value: {diagnosis.explain(z)}."

        return self.ended(z, None, iterations, "not_finite", explanation)


def correct(
    problem: Problem,
    guess: np.ndarray,
    normal: np.ndarray,
    weights: np.ndarray,
    iterations: int = 8,
    damped: bool = False,
    beside: np.ndarray | None = None,
) -> Correction:
    """The solution of F(z) = 0 in the hyperplane normal . (z - guess) = 0.

    Bordering keeps the system regular at folds, where F_u alone is singular. Iteration ends when every
    residual is at the level of its own rounding error, or when corrections have stopped shrinking there.

    Parameters
    ----------
    guess, normal, weights : ndarray, shape (N + 1,)
    damped : bool
        Shorten Newton steps that do not reduce the residual: for a start far from the solution.
    beside : ndarray, shape (N + 1,), optional
        A solution near the guess whose derivatives are known: where F is far cheaper than they are, they lead
        to where Newton's method has nothing left to do.
    """
    guess = _clean(problem, guess, weights)
    equations = _Equations(problem, guess, normal, weights)
    try:
        # What overflows or is not a number on the way is looked at where it matters.
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            found = None if beside is None else _from_beside(equations, beside, iterations)
            if found is None:
                found = _iterated(equations, guess, iterations, damped)
            if not damped and (not found.ok or found.effort > LABORIOUS):
                found = _with_fitted(equations, iterations, found)
            if found.ok:
                return _without_dust(found, weights)
            first = equations.at(guess)
            if first.finite and first.excess <= 2.0:  # a solution, at a point too singular for corrections
                return equations.ended(guess, first, 0)
            return found
    except PluginError as error:
        return equations.ended(guess, None, 0, "plugin_error", error.sentence)


def _with_fitted(equations: _Equations, iterations: int, found: Correction) -> Correction:
    """Newton's method on the other unknowns, those that are hard to guess solved for after each of its steps.

    What was found without stays where this takes no less effort, or where no unknowns are of that kind.
    """
    given = equations.normal, equations.weights
    fitted = (found.linearization or equations.at(equations.guess)).fitted
    if fitted is None:
        return found
    z, effort, previous = fitted(equations.guess, *given), 0, np.inf
    most = iterations + 1 if not found.ok else found.iterations
    equations.begin()
    while z is not None and effort <= most:
        lin = equations.at(z)
        if not lin.finite:
            return found
        step = equations.correction(lin, z)
        size = equations.size(step)
        equations.sizes.append(size)
        if size < ON_PLANE or (size < NEARLY and size > 0.25 * previous):
            other = equations.ended(z, lin, effort)
            return other if lin.excess <= ROUNDED and (not found.ok or other.effort < found.effort) else found
        if step is None or size > min(0.7 * previous, LARGEST_MAGNITUDE):
            return found
        z, previous = fitted(z - step, *given), size
        effort += int(size >= NEARLY)
    return found


def _clean(problem: Problem, z: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """z without its dust; a parameter may be that small, but of two that are free each is an unknown."""
    clean = np.where(np.abs(z) < DUST * weights, 0.0, z)
    if problem.line.second is None:
        clean[-1] = z[-1]
    return clean


def _without_dust(found: Correction, weights: np.ndarray) -> Correction:
    """A solution whose negligible unknowns are exactly zero, where that is as good a solution.

    On an invariant subspace the zero unknowns shrink from step to step, down to where floats end.
    """
    z, lin = found.z, found.linearization
    clean = _clean(found.problem, z, weights)
    if lin is None or np.array_equal(clean, z):
        return found
    there = found.problem.linearize(clean)
    if not there.finite or there.excess > max(lin.excess, 2.0):
        return found
    return replace(found, z=clean, linearization=there)


def _from_beside(equations: _Equations, beside: np.ndarray, iterations: int) -> Correction | None:
    """Newton's method from where the derivatives at another solution lead; None where that finds nothing.

    Some corrections without new derivatives count as one iteration, as after Newton's steps. Derivatives of
    equations that are exact, as of equilibria, cost no more than their residual.
    """
    if equations.problem.meshed is None:
        return None
    steps = list[np.ndarray]()
    try:
        z = _approached(equations, beside, steps)
    except PluginError:  # beside a singular point they lead anywhere, where the plugin may say nothing
        return None
    if z is None:
        return None
    found = _iterated(equations, z, iterations, damped=False)
    own = -(-len(steps) // (1 + CHORDS))
    sizes = tuple(float(norm(step)) for step in steps[:2])
    return replace(found, iterations=found.iterations + own, sizes=sizes, chords=True) if found.ok else None


def _approached(equations: _Equations, beside: np.ndarray, steps: list[np.ndarray]) -> np.ndarray | None:
    """Where the derivatives at another solution lead from the guess, by Broyden's method: a place whose
    residual is rounding. Its steps, in units of the weights, are added to `steps`.

    It takes several residuals where Newton's method takes one more linearization: None if these are not dear.
    """
    weights, known = equations.weights, equations.problem.linearize(beside)
    if known.nearby is None or not (known.dear and known.finite):
        return None
    residual, level = known.nearby(), known.levels[0]
    z, before = equations.guess, np.inf
    while len(steps) < APPROACHES:
        left = residual(z)
        chord = equations.correction(known, z, left)
        if chord is None or not np.any(chord):
            break
        steps.append(broyden_step(-chord / weights, steps))
        size = float(np.linalg.norm(steps[-1]))
        if not size < NEARS * before:
            return None
        z, before = z + weights * steps[-1], size
        if np.all(np.abs(left) <= level) or size < NOTHING:
            return _clean(equations.problem, z, weights)
    return None


def _iterated(equations: _Equations, begun: np.ndarray, iterations: int, damped: bool) -> Correction:
    """Newton's method itself, from a place of shape (N + 1,)."""
    z, weights, previous = begun.copy(), equations.weights, np.inf
    equations.begin()
    lin = equations.at(z)
    for iteration in range(iterations + 1):
        if not lin.finite:
            return equations.undefined_at(z, iteration)
        step = equations.correction(lin, z)
        if step is None:
            return equations.singular(z, lin, iteration, "The bordered Jacobian is singular.")
        size = norm_in(step, weights)
        equations.sizes.append(size)
        if (size < NEARLY or iteration >= 2) and not lin.exceeds(2.0, weights):
            return equations.ended(z, lin, iteration)
        if size < 1e-11 or (size > 0.25 * previous and size < 1e-7):
            return _settled(equations, z, lin, iteration)
        stalls = iteration > 1 and size > 0.7 * previous  # near a singular point corrections never get small
        if stalls and (lin.excess <= ROUNDED or not damped):
            return equations.singular(z, lin, iteration, "Newton's method does not contract.")
        # What is rounding farther off is none here, and to compute there may take as long as it likes.
        if not damped and norm_in(z - step - equations.guess, weights) > LARGEST_MAGNITUDE:
            return equations.ended(z, lin, iteration, "no_convergence", "Newton's method runs off.")
        previous = size
        if damped:
            z, lin = _damped(equations, z, step, lin)
        else:
            z = _followed(equations, z, step, lin)
            # If what is taken for dust is more than that, later iterations show it.
            z = _clean(equations.problem, z, weights) if iteration < 2 else z
            lin = equations.at(z)
    sentence = f"Newton's method did not converge in {iterations} iterations."
    return equations.singular(z, lin, iterations, sentence)


def _followed(equations: _Equations, z: np.ndarray, step: np.ndarray, lin: Linearization) -> np.ndarray:
    """z - step, and corrections after it by the same Jacobian while each is far smaller than the last one.

    Only where a residual is far cheaper than its derivatives: then near a solution most of Newton's
    iterations need no new ones.
    """
    z, size = z - step, equations.size(step)
    if lin.nearby is None:
        return z
    residual = lin.nearby()
    for _ in range(CHORDS):
        if not NOTHING < size < NEAR:
            break
        following = equations.correction(lin, z, residual(z))
        before, size = size, equations.size(following)
        equations.chords |= len(equations.sizes) == 1
        equations.sizes.append(size)
        if following is None or not size < CONTRACTS * before:
            break
        z = z - following
    return z


def _settled(equations: _Equations, z: np.ndarray, lin: Linearization, iteration: int) -> Correction:
    """Iterate while residuals still fall: corrections are small in the metric, but so may an unknown be."""
    size = np.inf
    for _ in range(SETTLING):
        step = equations.correction(lin, z)
        if step is None:
            break
        before, size = size, equations.size(step)
        there = equations.at(z - step)
        gains = there.finite and (NOTHING < size < 0.1 * before or there.excess <= 0.5 * lin.excess)
        if not gains:
            break
        z, lin, iteration = z - step, there, iteration + 1
        if not lin.exceeds(2.0, equations.weights):
            break
    if size <= NOTHING:
        return equations.ended(z, lin, iteration)
    sentence = f"Residuals stay {lin.excess:.1e} times above their rounding error."
    return equations.singular(z, lin, iteration, sentence)


def _damped(
    equations: _Equations, z: np.ndarray, step: np.ndarray, lin: Linearization
) -> tuple[np.ndarray, Linearization]:
    """z - t step with the first t of 1, 1/2, 1/4 ... after which the next correction would be smaller.

    The next correction is measured with the present Jacobian, so that scaling of the equations plays no part
    (the natural monotonicity test, P. Deuflhard, Newton Methods for Nonlinear Problems, 2004, section 3.3).
    """
    size, fraction = equations.size(step), 1.0
    while True:
        moved = z - fraction * step
        there = equations.at(moved)
        if fraction < 1e-6:
            return moved, there
        if there.finite:
            following = equations.correction(lin, moved, there.residual)
            if equations.size(following) <= (1.0 - 0.25 * fraction) * size:
                return moved, there
        fraction /= 2.0
