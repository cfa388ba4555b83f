"""Memory that this process has freed, and that the C library keeps for later arrays."""

import ctypes


def give_back_free_memory() -> None:
    """Give it back to the system; does nothing where the C library has no function for that.

    The library of GNU keeps pages of arrays of up to 32 MB in the pool of each thread. The pages would stay occupied
    while larger arrays, which are never put there, take other memory. Copies of the process would keep them too.
    """
    if (trim := getattr(ctypes.CDLL(None), "malloc_trim", None)) is not None:
        trim(0)
