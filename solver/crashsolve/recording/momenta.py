"""Momentum and angular momentum of the model, and their errors."""

import numpy as np

from crashsolve.foundation.record import Named

# columns that it is made of: of the clock of a sample, of nodes, and of elements
OF_CLOCK = ("impulse", "angular_impulse")
OF_NODES = ("r", "v", "L", "mass_inv")
OF_ELEMENTS = ("linear", "angular", "linear_size", "angular_size")


class Momenta:
    """Errors since the first sample: `start` (2, 3), and `largest` (2,) sums of sizes so far."""

    def __init__(self) -> None:
        self.start, self.largest = np.full((2, 3), np.nan), np.zeros(2)

    def of(
        self,
        clock: Named[np.ndarray],
        nodes: Named[np.ndarray],
        elements: Named[np.ndarray] | None = None,
    ) -> tuple[np.ndarray, ...]:
        """Both sums (k, 3) at k samples, and the errors (k,) of both.

        Columns of the clock and of elements are of k samples, those of nodes of all nodes at each.

        An error is the sum less that of the start and the external impulse, over the largest sum
        of |m v|, or of |r| |m v| + |L|, so far. Writes: start, largest.
        """
        sums = _moments(nodes)
        if elements is not None:
            sizes = np.column_stack([elements["linear_size"], elements["angular_size"]])
            own = (elements["linear"], elements["angular"], sizes)
            sums = [x + y for x, y in zip(sums, own, strict=True)]
        linear, angular, sizes = sums
        if np.isnan(self.start[0, 0]):
            self.start[:] = linear[0], angular[0]
        largest = np.maximum.accumulate(np.maximum(sizes, self.largest))
        self.largest[:] = largest[-1]
        pairs = (linear, "impulse"), (angular, "angular_impulse")
        lost = [now - self.start[i] - clock[name] for i, (now, name) in enumerate(pairs)]
        return linear, angular, *map(_share, lost, largest.T)


def _moments(nodes: Named[np.ndarray]) -> list[np.ndarray]:
    """Sums over nodes (k, n) of p, of r x p + L, and of the sizes of p and of |r| |p| + |L|."""
    # a component of all nodes side by side
    r, v, L = (np.ascontiguousarray(np.moveaxis(nodes[name], 2, 0)) for name in "rvL")
    p = v / nodes["mass_inv"]
    (x, y, z), (a, b, c) = r, p
    parts = (_dot(y, c) - _dot(z, b), _dot(z, a) - _dot(x, c), _dot(x, b) - _dot(y, a))
    rotated, size = np.column_stack(parts), _lengths(p)
    sizes = [size.sum(1), _dot(_lengths(r), size) + _lengths(L).sum(1)]
    return [p.sum(2).T, rotated + L.sum(2).T, np.column_stack(sizes)]


def _dot(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Products (k,) of rows."""
    products: np.ndarray = np.matmul(u[:, None, :], v[:, :, None])[:, 0, 0]
    return products


def _lengths(u: np.ndarray) -> np.ndarray:
    """Lengths of vectors whose components are the first axis."""
    return np.sqrt(np.einsum("ikj,ikj->kj", u, u))


def _share(error: np.ndarray, scale: np.ndarray) -> np.ndarray:
    shares = np.zeros(len(scale))
    return np.divide(np.sqrt(_dot(error, error)), scale, out=shares, where=scale > 0.0)
