"""Array types with named axes: ``row chan corr source cell sample`` are the only axis names.

``Real[Array, "row 3"]`` means real numbers with one line for each row and three columns. Tests check the types at run
time.
"""

from typing import TypeAlias

import numpy as np
from jaxtyping import Bool, Complex, Float, Int, Shaped

Array: TypeAlias = np.ndarray

__all__ = ["Array", "Bool", "Complex", "Float", "Int", "Shaped"]
