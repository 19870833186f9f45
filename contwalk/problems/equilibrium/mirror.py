"""Equilibria whose branch leaves a symmetric one: each half is the image of the other under a symmetry.

At a branch point whose state a symmetry keeps, and whose critical direction it reverses, the solutions on
one side are the images of those on the other, at the same parameters. What is stored of an image follows from
what is stored of the solution: its place and tangent through the map, the metric with its unknowns exchanged,
the same spectrum. Whether it solves the equations is asked of the equations.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.numerics.linear import nearest_eigenpair, unit_in
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.normal_forms import critical_vectors
from contwalk.problems.images import Product, imaged, point_of_image, products, refused_limit, row_of_image
from contwalk.problems.problem import Sample
from contwalk.problems.sample import within
from contwalk.system.declarations import ParameterValues

# In the metric, a state that is kept comes back this exactly, and a tangent that is reversed.
KEPT, REVERSED = 1e-7, 1e-6
# Residuals this many times above their rounding error are those of solutions, as of the corrector's.
SOLVED = 20.0
# A critical vector whose image is a unit vector to this needs no other coefficients.
ISOMETRIC = 1e-12
# Of a state that is zero nothing is a part.
TINY = float(np.finfo(float).tiny)
# How often the critical vector stands in each coefficient more than its left one does.
DEGREES: Mapping[str, Mapping[str, int]] = {
    "LP": {"a": 1, "b": -1},
    "BP": {"c11": 1, "c22": -1, "c": 2, "c_error": 2},
    "HB": {"l1": 2, "l1_error": 2},
}


def mirror_of(problem: EquilibriumEquations, sample: Sample) -> Mirror | None:
    """What takes one half of a branch to the other, by the solution that it leaves and its tangent there.

    None where no declared symmetry, or product of some, does.
    """
    n, z = problem.states, sample.z
    parameters = ParameterValues(**problem.values_of(z))
    for product in products(problem.system, z[:n], parameters):
        mirror = Mirror(problem, product, sample, np.zeros(len(z)))
        image = mirror.image(z)
        turned = problem.nearest_turn(image, z)
        kept = float(np.max(np.abs(turned - z) / sample.weights)) < KEPT
        if not kept:
            continue
        moved = mirror.derivative(z) @ sample.tangent + sample.tangent
        if float(np.linalg.norm(moved / sample.weights)) < REVERSED:
            return Mirror(problem, product, sample, turned - image)
    return None


def asymmetries(problem: EquilibriumEquations, z: np.ndarray) -> dict[str, float]:
    """How far a solution, shape (N + 1,), is from its images under symmetries, in units of its size."""
    n, p = problem.states, ParameterValues(**problem.values_of(z))
    found = dict[str, float]()
    for symmetry in problem.system.symmetries:
        image = problem.nearest_turn(np.append(imaged(symmetry, z[:n], p), z[n:]), z)
        size = max(float(np.linalg.norm(z[:n])), TINY)
        found[symmetry.name] = float(np.linalg.norm((image - z)[:n])) / size
    return found


class Mirror:
    """The map from one half of a branch of equilibria to the other.

    Parameters
    ----------
    problem : EquilibriumEquations
    product : Product
        The symmetries that make it.
    born : Sample
        The solution that the branch leaves.
    turns : ndarray, shape (N + 1,)
        What is added to the image, so that angles are turned as on the branch.
    """

    def __init__(
        self, problem: EquilibriumEquations, product: Product, born: Sample, turns: np.ndarray
    ) -> None:
        self._problem, self._product, self._born, self._turns = problem, product, born, turns
        self._maps = [problem.kernels.of_symmetry(symmetry.map) for symmetry in product.symmetries]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the symmetries in the order in which they are applied."""
        return self._product.names

    def refuses(self, point: SpecialPoint) -> str:
        """Why the image of a special point has to be located itself: guards need not be images."""
        return refused_limit(self._problem, point)

    def image(self, z: np.ndarray) -> np.ndarray:
        """Image of a solution, shape (N + 1,)."""
        x = self._product.state(z[: self._problem.states], ParameterValues(**self._problem.values_of(z)))
        return np.concatenate([x, z[self._problem.states :]]) + self._turns

    def derivative(self, z: np.ndarray) -> np.ndarray:
        """Derivative of the image by z, shape (N + 1, N + 1)."""
        problem, total = self._problem, np.eye(len(z))
        for symmetry, kernel in zip(self._product.symmetries, self._maps, strict=True):
            own = np.eye(len(z))
            own[: problem.states] = kernel(*problem.inputs(z))
            total = own @ total
            z = problem.image(symmetry.name, z)
        return total

    def row(self, row: np.void, before: np.void, last: np.void) -> np.ndarray | None:
        """The stored image of a stored solution, shape (1,); None if it does not solve the equations."""
        problem, began, spent = self._problem, time.perf_counter(), self._problem.evaluations
        z = np.append(row["unknowns"], row["free"])
        there, derivative = self.image(z), self.derivative(z)
        weights = _metric(derivative, row["weights"])
        linearization = problem.linearize(there)
        if not np.isfinite(linearization.residual).all():
            return None
        residual = linearization.excess_in(weights)
        if not residual <= max(SOLVED, 2.0 * float(row["residual"])):
            return None
        tangent = -(derivative @ row["tangent"])
        return row_of_image(
            row,
            there,
            unit_in(tangent, weights),
            weights,
            state=there[: problem.states],
            observables=[*problem.measured(there), row["observables"][-1]],
            admissible=problem.limited is None or within(problem.limited.margins(there, weights)),
            residual=residual,
            rhs=problem.evaluations - spent,
            seconds=time.perf_counter() - began,
        )

    def sample(self, row: np.void) -> Sample:
        """Place and metric of a stored solution, as a sample that tells no more."""
        z = np.append(row["unknowns"], row["free"])
        return replace(self._born, z=z, weights=np.array(row["weights"]))

    def margin(self, row: np.void) -> Mapping[str, float]:
        """What must stay positive on an image, by name: nothing."""
        return {}

    def special_point(self, point: SpecialPoint, row: np.void, last: np.void) -> SpecialPoint:
        """The image of a special point: what is counted before it there is counted after it."""
        problem, z = self._problem, np.array(point.unknowns)
        there, derivative = self.image(z), self.derivative(z)
        values, names = problem.values_of(there), problem.system.state_names
        conserved = {name: values[name] for name in problem.system.conserved_names}
        return point_of_image(
            point,
            dict(zip(names, there[: problem.states].tolist(), strict=True)),
            there,
            -(derivative @ np.array(point.tangent)),
            parameters={**point.parameters, **conserved},
            coefficients=self._coefficients(point, z, there, derivative),
        )

    def _coefficients(
        self, point: SpecialPoint, z: np.ndarray, there: np.ndarray, derivative: np.ndarray
    ) -> Mapping[str, object]:
        """Coefficients of the normal form, for the critical vector that stands for the image's direction.

        Its length is one, and its sign by its own largest entry: the image of the other one has another.
        """
        degrees = DEGREES.get(point.label, {})
        if not degrees.keys() & point.coefficients.keys():
            return point.coefficients
        factor = self._factor(point, z, there, derivative)
        given: dict[str, object] = dict(point.coefficients)
        for name, degree in degrees.items():
            value = given.get(name)
            if isinstance(value, float):
                given[name] = value * factor**-degree + 0.0
        return given

    def _factor(self, point: SpecialPoint, z: np.ndarray, there: np.ndarray, derivative: np.ndarray) -> float:
        """How often the image of the critical vector is that of the image, 1 or -1 of an isometry."""
        problem, size = self._problem, self._problem.size
        if point.label == "HB":
            n = problem.states
            pair = nearest_eigenpair(problem.jacobian(z)[:n, :n], 1j * point.coefficients["omega"])
            ratio = float(np.linalg.norm(derivative[:n, :n] @ pair.right) / np.linalg.norm(pair.right))
        else:
            q = critical_vectors(problem, z)[0]
            own = critical_vectors(problem, there)[0]
            ratio = float(own @ derivative[:size, :size] @ q)
        sign = float(np.sign(ratio))
        return sign if abs(abs(ratio) - 1.0) < ISOMETRIC else ratio


def _metric(derivative: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Weights of the image: an unknown has the magnitudes of those that it is made of."""
    share = derivative.copy()
    share[:-1, -1] = 0.0  # a parameter's own magnitude is that of its whole range, not of a step
    return np.sqrt((share * share) @ (weights * weights))
