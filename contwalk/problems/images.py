"""Products of declared symmetries: which there are, how they are named, and what is stored of images."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import called
from contwalk.numerics.permutations import Permutation, as_cycles, generating
from contwalk.problems.problem import Problem, Test
from contwalk.system import Symmetry, System
from contwalk.system.declarations import ParameterValues

# More products than this are not looked at: exchanges of four masses make 24.
MOST_IMAGES = 24


def imaged(
    symmetry: Symmetry | None, x: np.ndarray, parameters: ParameterValues, power: int = 1
) -> np.ndarray:
    """Image of a state under a power of a symmetry, shape (n,)."""
    for _ in range(power if symmetry is not None else 0):
        out = np.zeros(len(x))
        called(f"symmetry '{symmetry.name}'", symmetry.map, 0.0, x.copy(), parameters, out)  # type: ignore[union-attr]
        x = out
    return x


@dataclass(frozen=True)
class Product:
    """Declared symmetries that are applied one after the other; the identity where there are none."""

    symmetries: tuple[Symmetry, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the symmetries in the order in which they are applied."""
        return tuple(symmetry.name for symmetry in self.symmetries)

    def then(self, symmetry: Symmetry) -> Product:
        """This product, and another symmetry after it."""
        return Product((*self.symmetries, symmetry))

    def state(self, x: np.ndarray, p: ParameterValues) -> np.ndarray:
        """Image of a state, shape (n,)."""
        for symmetry in self.symmetries:
            x = imaged(symmetry, x, p)
        return x

    def linear(self, sizes: np.ndarray, p: ParameterValues) -> np.ndarray:
        """The matrix of an affine map, shape (n, n), from its values at states of these sizes."""
        n = len(sizes)
        origin = self.state(np.zeros(n), p)
        moved = [(self.state(s * e, p) - origin) / s for s, e in zip(sizes, np.eye(n), strict=True)]
        return np.array(moved).T


def in_words(names: tuple[str, ...]) -> str:
    """`the symmetry 'mirror'`, or `the symmetries 'swap', 'mirror' in turn`."""
    quoted = ", ".join(f"'{name}'" for name in names)
    return f"the symmetry {quoted}" if len(names) == 1 else f"the symmetries {quoted} in turn"


def to_declare(permutations: Sequence[Permutation], names: tuple[str, ...], followed: str) -> str:
    """That a field is unchanged under permutations of its states, and what is followed once that is said."""
    cycles = " and ".join(as_cycles(p, names) for p in generating(permutations))
    return (
        f"the field is unchanged under {cycles}: declare it, symmetries=(Symmetry(...),), and {followed} "
        "are followed that close up to it"
    )


def products(system: System, x: np.ndarray, p: ParameterValues) -> Iterator[Product]:
    """The products of a system's symmetries that differ from each other and from the identity.

    They are told apart by what they do to a state beside x that no symmetry keeps.
    """
    generic = x + (1.0 + np.abs(x)) * np.cos(np.arange(1.0, len(x) + 1.0))
    found = [(Product(), generic)]
    for product, image in found:
        if product.symmetries:
            yield product
        for symmetry in system.symmetries:
            further = imaged(symmetry, image, p)
            new = all(not np.allclose(further, other, rtol=1e-10, atol=1e-12) for _, other in found)
            if new and len(found) < MOST_IMAGES:
                found.append((product.then(symmetry), further))


def refused_limit(problem: Problem, point: SpecialPoint) -> str:
    """Why the image of a special point is not one itself, as of limits: what is met there has a name."""
    limits = {kind.label for kind in problem.point_types if kind.test is Test.MARGIN}
    return f"a limit ({point.label}) has to be located" if point.label in limits else ""


def row_of_image(
    row: np.void, image: np.ndarray, tangent: np.ndarray, weights: np.ndarray, **told: object
) -> np.ndarray:
    """A stored row, shape (1,), with the image in its place; nothing was iterated for it.

    Parameters
    ----------
    row : void
        Of the solution whose image it is.
    image, tangent, weights : ndarray, shape (N + 1,)
    told
        Further columns, by name, that are not those of the row.
    """
    found, size = np.array([row]), len(image)
    found["s"], found["iterations"] = -row["s"], 0
    found["unknowns"][0, : size - 1] = image[:-1]
    found["tangent"][0, :size], found["weights"][0, :size] = tangent, weights
    for name, values in told.items():
        found[name] = values
    return found


def point_of_image(
    point: SpecialPoint, state: Mapping[str, float], image: np.ndarray, tangent: np.ndarray, **told: object
) -> SpecialPoint:
    """The image of a special point: what is counted before it there is counted after it."""
    return replace(
        point,
        s=-point.s,
        state=state,
        unstable_before=point.unstable_after,
        unstable_after=point.unstable_before,
        unknowns=tuple(image.tolist()),
        tangent=tuple(tangent.tolist()),
        **told,  # type: ignore[arg-type]
    )
