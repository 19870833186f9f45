"""Coefficients against the order conditions of all rooted trees, and against stability.

Source of the conditions: E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, II2
"""

from __future__ import annotations

import math
from functools import cache
from itertools import combinations_with_replacement

import numpy as np
import pytest

from contwalk.flow.explicit.stages import TABLEAUS

METHODS = [pytest.param(method, id=name) for name, method in TABLEAUS.items()]


@cache
def trees(order):
    """All rooted trees with so many vertices, each as the sorted tuple of its subtrees."""
    if order == 1:
        return [()]
    found = set()
    for sizes in partitions(order - 1, order - 1):
        groups = [(size, sizes.count(size)) for size in sorted({*sizes})]
        choices = [()]
        for size, count in groups:
            picked = list(combinations_with_replacement(trees(size), count))
            choices = [(*choice, *more) for choice in choices for more in picked]
        found.update(tuple(sorted(choice)) for choice in choices)
    return sorted(found)


def partitions(total, largest):
    if total == 0:
        yield ()
    for first in range(min(total, largest), 0, -1):
        for rest in partitions(total - first, first):
            yield (first, *rest)


def vertices(tree):
    return 1 + sum(vertices(child) for child in tree)


def density(tree):
    return vertices(tree) * math.prod(density(child) for child in tree)


def matrix(method):
    table = np.zeros((method.stages, method.stages))
    for i, row in enumerate(method.rows):
        for j, a in row.items():
            table[i, j] = a
    return table


def vector(method, combination):
    return np.array([combination.get(i, 0.0) for i in range(method.stages)])


def elementary(table, tree):
    """The elementary weights of a tree, one for each stage."""
    result = np.ones(len(table))
    for child in tree:
        result = result * (table @ elementary(table, child))
    return result


def test_numbers_of_trees():
    assert [len(trees(order)) for order in range(1, 10)] == [1, 1, 2, 4, 9, 20, 48, 115, 286]


@pytest.mark.parametrize("method", METHODS)
def test_order_conditions_of_the_step(method):
    """The coefficients are of size 60 at most, products of them cancel: a few hundred roundings."""
    table, weights = matrix(method), vector(method, method.weights)
    for order in range(1, method.order + 1):
        for tree in trees(order):
            assert abs(weights @ elementary(table, tree) - 1.0 / density(tree)) < 2e-14, tree
    worst = max(abs(weights @ elementary(table, t) - 1.0 / density(t)) for t in trees(method.order + 1))
    assert worst > 1e-9  # and of no higher order


@pytest.mark.parametrize("method", METHODS)
def test_order_conditions_of_the_error_estimates(method):
    """What an estimate compares the step with is of the order that the estimate is said to have, less one."""
    table = matrix(method)
    orders = {"dop853": (5, 3), "verner98": (8,)}[method.name]
    for combination, known in zip(method.errors, orders, strict=True):
        weights = vector(method, combination)
        for order in range(1, known + 1):
            for tree in trees(order):
                assert abs(weights @ elementary(table, tree)) < 2e-14, tree
        assert max(abs(weights @ elementary(table, tree)) for tree in trees(known + 1)) > 1e-9


@pytest.mark.parametrize("method", METHODS)
def test_nodes_are_sums_of_rows(method):
    np.testing.assert_allclose(matrix(method).sum(axis=1), method.nodes, rtol=0.0, atol=5e-15)
    for node, row in zip(method.dense_nodes, method.dense_rows, strict=True):
        assert abs(sum(row.values()) - node) < 5e-15


@pytest.mark.parametrize("method", METHODS)
def test_stability_on_the_negative_axis(method):
    table, weights = matrix(method), vector(method, method.weights)

    def amplification(z):
        inner = np.linalg.solve(np.eye(method.stages) + z * table, np.ones(method.stages))
        return abs(1.0 - z * (weights @ inner))

    assert all(amplification(z) < 1.0 for z in np.linspace(0.1, method.stable, 200))
    assert amplification(1.25 * method.stable) > 1.0
