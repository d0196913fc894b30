"""Two modes with the same pole: the records determine the sum of their amplitudes, and nothing else."""

from __future__ import annotations

import numpy as np

from sprung.estimation.projected_response import inverse_of


def test_each_of_two_equal_modes_gets_half_of_what_both_explain() -> None:
    """Minimum-norm solution of a singular least-squares problem (Golub and Van Loan, Matrix Computations, section 5.5)."""
    response = np.array([[2.0, 2.0, 1.0]] * 2 + [[1.0, 1.0, -3.0]] * 3, dtype=complex)
    record = response @ np.array([0.6, 0.4, 2.0])
    normal = response.conj().T @ response
    amplitudes = inverse_of(normal[None])[0] @ (response.conj().T @ record)
    np.testing.assert_allclose(amplitudes, [0.5, 0.5, 2.0], rtol=1e-9)


def test_without_equal_modes_it_is_the_inverse() -> None:
    normal = np.array([[[4.0, 1.0j], [-1.0j, 9e6]]])
    np.testing.assert_allclose(inverse_of(normal)[0] @ normal[0], np.eye(2), atol=1e-12)
