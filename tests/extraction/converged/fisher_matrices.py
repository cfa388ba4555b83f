"""Fisher matrices of several sources, as the package holds them and as dense matrices."""

import numpy as np
from scipy import sparse

from uvshear.extraction.converged.couplings import Couplings
from uvshear.shapes.normal_equations import NormalEquations

SIX = 6
SCALES = np.array([1e-6, 0.05, 0.05, 0.1, 1e-7, 1e-7])
"""Errors of parameters as they come: flux [Jy], shape, position [rad]."""


def fisher_matrix(sources, seed=1, coupled=0.8):
    """Fisher matrix of all parameters, positive, with blocks and far fluxes; in the units of ``SCALES``."""
    rng = np.random.default_rng(seed)
    size = sources * SIX
    half = rng.normal(size=(size, 3 * size)) / np.sqrt(3 * size)
    correlated = half @ half.T
    matrix = coupled * correlated + (1 - coupled) * np.kron(np.eye(sources), np.eye(SIX))
    scale = np.tile(SCALES, sources) * np.repeat(rng.uniform(0.3, 3, sources), SIX)
    return matrix / np.outer(scale, scale)


def parts_of(matrix, pairs, seed=2):
    """Return the matrix as the package holds it: own blocks, pairs, far fluxes; and the dense matrix of these alone."""
    sources = len(matrix) // SIX
    rng = np.random.default_rng(seed)
    blocks = matrix.reshape(sources, SIX, sources, SIX)
    equations = [
        NormalEquations(
            rng.normal(size=SIX) * np.sqrt(np.diag(blocks[k, :, k, :])), blocks[k, :, k, :]
        )
        for k in range(sources)
    ]
    dense = np.zeros_like(blocks)
    for k in range(sources):
        dense[k, :, k, :] = blocks[k, :, k, :]
    for i, j in pairs:
        dense[i, :, j, :], dense[j, :, i, :] = blocks[i, :, j, :], blocks[j, :, i, :]
    errors = np.sqrt([blocks[k, 0, k, 0] for k in range(sources)])
    far = 0.2 * rng.uniform(size=(sources, sources)) * np.outer(errors, errors)
    far = np.triu(far, 1) + np.triu(far, 1).T
    for i in range(sources):
        dense[i, 0, :, 0] += far[i]
    first, second = np.array(pairs).T
    held = np.array([blocks[i, :, j, :] for i, j in pairs])
    shared = np.array([0.9 * blocks[k, :, k, :] for k in range(sources)])
    couplings = Couplings(first, second, held, shared, sparse.csr_matrix(far), np.ones(sources))
    return equations, couplings, dense.reshape(matrix.shape)


PAIRS = [(0, 1), (0, 3), (1, 2), (2, 4), (3, 4)]
