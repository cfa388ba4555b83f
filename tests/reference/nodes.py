"""The nodes of a cell, from its samples one by one."""

import numpy as np

TRIANGLE = np.sqrt(2) * np.array([[np.cos(a), np.sin(a)] for a in np.radians([0, 120, 240])])
TETRAHEDRON = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])


def whitened(place, share, smallest):
    """Return linear functions z of the places [sample, function]: mean 0, second moments 1, decorrelated one by one."""
    moved = place - share @ place
    rest, functions = moved.copy(), []
    for _ in range(3):
        variance = share @ rest**2
        axis = int(np.argmax(variance))
        if not variance[axis] > smallest:
            break
        z = rest[:, axis] / np.sqrt(variance[axis])
        functions.append(z)
        rest = rest - np.outer(z, (share * z) @ rest)
        rest[:, axis] = 0.0
    return np.array(functions).T.reshape(len(place), -1)


def nodes_of_samples(place, weight, values, smallest, turned=False):
    """Return the nodes' shares of the weight, places, means of each column of values, and second moments."""
    share = weight / weight.sum()
    z = whitened(place, share, smallest)
    rank = z.shape[1]
    if rank == 0:
        at, shares = np.zeros((1, 0)), np.ones(1)
    elif rank == 1:
        # The 2-point Gaussian quadrature of the samples' shares.
        skew = float(share @ z[:, 0] ** 3)
        at = np.sort(np.roots([1.0, -skew, -1.0]))[::-1, None]
        shares = 1 / (1 + at[:, 0] ** 2)
    else:
        at = (TRIANGLE, TETRAHEDRON)[rank - 2] * (-1 if turned else 1)
        shares = np.full(rank + 1, 1 / (rank + 1))
    weights = share * (1 + at @ z.T)
    mean = weights @ place
    moments = [(mu * (place - m).T) @ (place - m) for mu, m in zip(weights, mean, strict=True)]
    return shares, mean, weights @ values, np.array(moments)


def squared_loss(place, weight, smallest, direction, turned=False):
    """Return the loss of squared amplitude, to fourth order, beyond what the second moments of the nodes tell."""
    share = weight / weight.sum()
    phase = (place - share @ place) @ direction
    z = whitened(place, share, smallest)
    design = np.sqrt(share)[:, None] * np.column_stack([np.ones(len(place)), z])
    target = np.sqrt(share) * phase**2 / 2
    rest = target - design @ np.linalg.lstsq(design, target, rcond=None)[0]
    shares, _, _, moments = nodes_of_samples(
        place, weight, np.zeros((len(place), 0)), smallest, turned
    )
    second = np.einsum("kab,a,b->k", moments, direction, direction)
    return rest @ rest + shares @ second**2 / 2
