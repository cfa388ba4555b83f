import pytest

from uvshear.numerics.fft_sizes import fast_size


def _largest_factor(size):
    return max(k for k in range(1, size + 1) if size % k == 0 and all(k % d for d in range(2, k)))


@pytest.mark.parametrize(("real", "largest"), [(True, 5), (False, 11)])
@pytest.mark.parametrize("multiple", [2, 4])
@pytest.mark.parametrize("least", [31.2, 32, 33, 97, 500.5, 1025])
def test_sizes_are_the_smallest_multiples_with_small_factors(least, multiple, real, largest):
    size = fast_size(least, multiple=multiple, real=real)
    allowed = [
        n for n in range(multiple, 1400, multiple) if n >= least and _largest_factor(n) <= largest
    ]
    assert size == min(allowed)
