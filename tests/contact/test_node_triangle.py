"""Benchmark C14: on which side of the edges of a triangle a node lies (Ambrosio (2003), Eq. 16)."""

import pytest

from crashsolve.contact.narrow.sphere_mesh import edge_products

CORNERS = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
N = (0.0, 0.0, 1.0)


def test_the_three_products_are_positive_inside() -> None:
    # the chapter prints -0.2, 0.4, 0 for this node, and calls it inside
    assert edge_products(*CORNERS, (0.2, 0.2, -0.01), N) == pytest.approx((0.2, 0.6, 0.2))


@pytest.mark.parametrize(
    ("node", "edge"), [((0.5, -0.1, 0.0), 0), ((0.6, 0.6, 0.0), 1), ((-0.1, 0.5, 0.0), 2)]
)
def test_only_the_edge_that_is_crossed_turns_negative(node: tuple[float, ...], edge: int) -> None:
    products = edge_products(*CORNERS, node, N)
    assert [k for k in range(3) if products[k] < 0.0] == [edge]
