r"""The nodes of a cell: a few rows that stand for all of its samples.

A sum of visibilities over a cell loses what differs among its samples. Nodes keep more. Let w_j be the weights of the
samples, W their sum, and z a vector of linear functions of (u, v, w) whose weighted mean is zero and whose weighted
second moments are the unit matrix. Nodes z_k with shares s_k of the weight, of which there is one more than z has
components, satisfy

.. math:: \sum_k s_k = 1, \quad \sum_k s_k z_k = 0, \quad \sum_k s_k z_k z_k^T = 1,

as the samples do. The visibility of a node is a sum over the samples with the weights

.. math:: \mu_{kj} = \frac{w_j}{W} (1 + z_k \cdot z_j).

The matrix of sqrt(s_k) (1, z_k) is orthogonal, so that the noise of the nodes is independent, with the weights s_k W,
and the nodes keep all sums over the samples of their visibilities and of these times linear functions of (u, v, w).
A node is at the mean of its \mu_kj and has their second moments, which may be negative: some of the \mu_kj are.

What nodes do not keep of a source with the phase phi = s . (u, v, w) is, to fourth order, the part of phi^2/2 that is
not linear. The squared amplitude of the source is smaller on average by the variance of this part, a form of fourth
degree in s, which the rows have as ``fourth``. The form also makes up for the squares of the nodes' second moments,
which the Gaussian of these moments contains.

Along a line there are two nodes, those of Gaussian quadrature for the samples' weights. They are the corners of an
equilateral triangle in a plane, and of a regular tetrahedron in space. Directions along which the samples hardly
differ have no node.
"""
