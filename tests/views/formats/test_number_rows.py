"""Arrays of numbers as text: what is read back is what was written, however often a number comes."""

import numpy as np
import pytest

from img2tri.views.formats.number_rows import real_rows


@pytest.mark.parametrize("different", [1, 2, 5, 400, 1000])
@pytest.mark.parametrize("before", ["", "50 %r "])
def test_numbers_that_repeat_are_written_as_all_others(different, before):
    rng = np.random.default_rng(different)
    values = rng.choice(np.append(rng.standard_normal(different) * 10.0 ** rng.integers(-20, 20, different), [0.0, -0.0]), (500, 3))
    values[:, 1] = 7.25
    expected = "".join(f"{before}{a!r},{b!r},{c!r}\n" for a, b, c in values.tolist())
    assert real_rows(values, ",", before=before) == expected
