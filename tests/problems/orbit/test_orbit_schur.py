"""Eigenvalues of products that are never formed, against products known in closed form or in 200 digits."""

import mpmath
import numpy as np
import pytest

from contwalk.problems.orbit import periodic_schur
from contwalk.problems.orbit.periodic_schur import product_eigenvalues


def exactly(factors):
    """Eigenvalues of the formed product in 200 digits, by descending modulus."""
    with mpmath.workdps(200):
        whole = mpmath.eye(len(factors[0]))
        for factor in factors:
            whole = mpmath.matrix(factor.tolist()) * whole
        # mpmath 1.3 gives other things than eigenvalues for a single row.
        values = [whole[0, 0]] if len(whole) == 1 else mpmath.eig(whole, left=False, right=False)
        return sorted((complex(v) for v in values), key=lambda v: (-abs(v), -v.imag))


def ordered(values):
    return sorted((complex(v) for v in values), key=lambda v: (-abs(v), -v.imag))


@pytest.mark.parametrize("size", [1, 2, 3, 5, 8])
@pytest.mark.parametrize("number", [1, 2, 3, 7])
def test_random_products(size, number):
    random = np.random.default_rng(100 * size + number)
    factors = [random.standard_normal((size, size)) for _ in range(number)]
    found, wanted = ordered(product_eigenvalues(factors)), exactly(factors)
    # Backward stable: each factor is perturbed by some roundings; the product's condition is modest here.
    norm = float(np.prod([np.linalg.norm(f, 2) for f in factors]))
    for a, b in zip(sorted(found, key=abs), sorted(wanted, key=abs), strict=True):
        assert min(abs(a - b), abs(a - b.conjugate())) <= 1e-12 * norm


@pytest.mark.parametrize("number", [4, 12, 24])
def test_twelve_decades_up_and_down_each_with_its_own_accuracy(number):
    """Each factor is V_i+1 D V_i^-1 with 10^(+-12/number) in D: the product is similar to D^number."""
    random = np.random.default_rng(number)
    bases = [
        np.linalg.qr(random.standard_normal((3, 3)))[0] @ np.diag([1.0, 1.5, 0.7]) for _ in range(number)
    ]
    d = np.diag([10.0 ** (12.0 / number), 1.0, 10.0 ** (-12.0 / number)])
    factors = [bases[(i + 1) % number] @ d @ np.linalg.inv(bases[i]) for i in range(number)]
    found = ordered(product_eigenvalues(factors))
    # Rounding of each factor, 2e-16 of its norm, reaches its smallest share multiplied by the ratio in one
    # factor.
    tolerance = 1e-14 * number * 10.0 ** (24.0 / number)
    np.testing.assert_allclose(found, [1e12, 1.0, 1e-12], rtol=tolerance)
    if number >= 12:
        assert tolerance < 1e-10


def test_the_formed_product_would_have_lost_them():
    """What this is for: numpy's eigenvalues of the formed product have not one right digit of the
    smallest.
    """
    random = np.random.default_rng(24)
    bases = [np.linalg.qr(random.standard_normal((3, 3)))[0] for _ in range(12)]
    d = np.diag([10.0, 1.0, 0.1])
    factors = [bases[(i + 1) % 12] @ d @ bases[i].T for i in range(12)]
    whole = np.linalg.multi_dot(factors[::-1])
    smallest = min(abs(np.linalg.eigvals(whole)))
    assert abs(smallest - 1e-12) > 1e-12
    assert min(abs(product_eigenvalues(factors))) == pytest.approx(1e-12, rel=1e-12)


def test_complex_pairs_and_signs():
    turn = np.array([[0.0, -2.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, -3.0]])
    # Three quarter turns of growth 8, and (-3)^3.
    found = ordered(product_eigenvalues([turn, turn, turn]))
    np.testing.assert_allclose(found, [-27.0, 8.0j, -8.0j], rtol=0, atol=1e-13)


def test_singular_factors():
    """A direction that is lost entirely has the multiplier zero; the others do not feel it."""
    a = np.diag([2.0, 3.0, 0.0])
    b = np.diag([5.0, 0.5, 1.0])
    found = ordered(product_eigenvalues([a, b]))
    np.testing.assert_allclose(found, [10.0, 1.5, 0.0], rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("ranks", [(2,), (2, 3), (3, 2, 3), (2, 2, 1), (1, 3, 3, 2)])
def test_dense_factors_of_a_given_rank(ranks):
    """Dense factors of a given rank: as many zeros as the product has, and the others as in 200 digits."""
    random = np.random.default_rng(sum(ranks))
    factors = [random.standard_normal((3, rank)) @ random.standard_normal((rank, 3)) for rank in ranks]
    found = ordered(product_eigenvalues(factors))
    norm = float(np.prod([np.linalg.norm(f, 2) for f in factors]))
    least = min(ranks)
    # Zeros are known to rounding, where they are simple; the roundings of the factors make zeros of the exact
    # product as small.
    for a, b in zip(found[:least], exactly(factors)[:least], strict=True):
        assert min(abs(a - b), abs(a - b.conjugate())) <= 1e-13 * norm
    if least == 2:
        assert abs(found[2]) <= 1e-13 * norm


def test_where_the_product_begins_does_not_matter():
    """Cyclic permutations of the factors have the same eigenvalues, those of singular ones as well."""
    random = np.random.default_rng(8)
    factors = [random.standard_normal((4, 4)) for _ in range(5)]
    factors[2] = factors[2] @ np.diag([1.0, 1.0, 1.0, 0.0]) @ random.standard_normal((4, 4))
    norm = float(np.prod([np.linalg.norm(f, 2) for f in factors]))
    first = ordered(product_eigenvalues(factors))
    for shift in range(1, 5):
        again = ordered(product_eigenvalues([*factors[shift:], *factors[:shift]]))
        for a, b in zip(first, again, strict=True):
            assert min(abs(a - b), abs(a - b.conjugate())) <= 1e-13 * norm


def test_the_identity_and_defective_products():
    np.testing.assert_allclose(product_eigenvalues([np.eye(3)] * 4), np.ones(3), rtol=1e-15)
    jordan = np.array([[1.0, 1.0], [0.0, 1.0]])
    found = product_eigenvalues([jordan, jordan, jordan])
    # A double eigenvalue moves by the root of the rounding.
    np.testing.assert_allclose(found, [1.0, 1.0], rtol=0, atol=1e-7)


def test_factors_are_left_as_they_are():
    random = np.random.default_rng(5)
    factors = [random.standard_normal((3, 3)) for _ in range(4)]
    copies = [factor.copy() for factor in factors]
    product_eigenvalues(factors)
    for factor, copy in zip(factors, copies, strict=True):
        assert np.array_equal(factor, copy)


@pytest.mark.parametrize("first", range(3))
def test_singular_factors_that_are_not_triangular(first):
    """Integer factors of any rank, and cyclic permutations of one product."""
    random = np.random.default_rng(5)
    for _ in range(40):
        n = int(random.integers(1, 6))
        ranks = random.integers(0, n + 1, 3)
        factors = [random.integers(-2, 3, (n, r)) @ random.integers(-2, 3, (r, n)) * 1.0 for r in ranks]
        product = factors[2] @ factors[1] @ factors[0]
        found = np.poly(product_eigenvalues([*factors[first:], *factors[:first]]))
        size = max(float(np.prod([np.linalg.norm(f, 2) for f in factors])), 1.0)
        # The coefficients of the characteristic polynomial, by rounding of each factor: eigenvalues
        # themselves are not so well conditioned where they meet.
        off = np.abs(found - np.poly(product)) / size ** np.arange(n + 1.0)
        assert off.max() < 1e-12


def test_a_factor_that_is_zero():
    factors = [np.zeros((2, 2)), np.array([[-1.0, -1.0], [-2.0, 2.0]])]
    assert not np.any(product_eigenvalues(factors))
    assert not np.any(product_eigenvalues(factors[::-1]))


@pytest.mark.parametrize("size", [2, 3])
def test_a_product_graded_beyond_the_range_of_doubles(size, monkeypatch):
    """Hundreds of steps of a relaxation oscillation: it attracts by 1e-1200, and 1e3 grows."""
    sweeps, counted = [], periodic_schur.sweeps_of
    monkeypatch.setattr(
        periodic_schur, "sweeps_of", lambda *given: sweeps.append(counted(*given)) or sweeps[-1]
    )
    random, number = np.random.default_rng(size), 400
    bases = [np.linalg.qr(random.standard_normal((size, size)))[0] for _ in range(number)]
    growth = np.array([1e3 ** (1.0 / number), 1e-3, 3e-3])[:size]
    factors = []
    for i in range(number):
        inner = np.diag(growth) + 0.3 * np.triu(random.standard_normal((size, size)), 1)
        factors.append(bases[(i + 1) % number] @ inner @ bases[i].T)
    found = ordered(product_eigenvalues(factors))
    assert found[0] == pytest.approx(1e3, rel=1e-10)
    assert all(abs(value) < 1e-300 for value in found[1:])
    assert len(sweeps) == 1
    assert 0 <= sweeps[0] <= 4 * size


def test_what_is_not_a_number_has_no_eigenvalues():
    factors = [np.eye(3), np.array([[1.0, 2.0, 0.0], [0.0, np.nan, 1.0], [3.0, 0.0, 1.0]])]
    with pytest.raises(np.linalg.LinAlgError, match="does not converge"):
        product_eigenvalues(factors)


def test_hundreds_of_unknowns_by_the_same_loops():
    """A rotation of every plane by an angle of its own, in another basis: its powers are known."""
    random, size, number = np.random.default_rng(3), 60, 3
    basis = np.linalg.qr(random.standard_normal((size, size)))[0]
    angles = np.linspace(0.1, 1.0, size // 2)
    turn = np.zeros((size, size))
    for i, angle in enumerate(angles):
        turn[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = [
            [np.cos(angle), -np.sin(angle)],
            [np.sin(angle), np.cos(angle)],
        ]
    found = product_eigenvalues([basis @ turn @ basis.T] * number)
    wanted = np.exp(1j * number * np.concatenate([angles, -angles]))
    # Normal factors: each eigenvalue is as well known as the rounding of all of them together.
    apart = np.abs(found[:, None] - wanted).min(axis=0)
    assert apart.max() < 1e-13 * size


def test_powers_of_two_change_no_digit():
    """Partial products far beyond the range of doubles: the same bits as those within it."""
    random = np.random.default_rng(7)
    plain = random.normal(size=(9, 1, 1))
    shifted = plain.copy()
    shifted[0] *= 2.0**900
    shifted[1] *= 2.0**900
    shifted[2] *= 2.0**-900
    shifted[3] *= 2.0**-900
    assert product_eigenvalues(plain).tobytes() == product_eigenvalues(shifted).tobytes()
    assert product_eigenvalues(plain)[0] == pytest.approx(np.prod(plain), rel=1e-14)  # nine roundings
    far = np.array([2.0**700, 2.0**700, 2.0**-1000, 3.0]).reshape(4, 1, 1)
    assert product_eigenvalues(far)[0] == 3.0 * 2.0**400


def test_products_beyond_the_range_of_doubles():
    assert product_eigenvalues(np.full((3, 1, 1), 2.0**700))[0] == np.inf
    assert product_eigenvalues(np.full((3, 1, 1), -(2.0**700)))[0] == -np.inf
    assert product_eigenvalues(np.full((3, 1, 1), 2.0**-700))[0] == 0.0
