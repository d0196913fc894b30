"""Covariance of several estimates, by their names."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sprung.dataframes import require_pandas
from sprung.display import shown
from sprung.errors import UnknownNameError

if TYPE_CHECKING:
    import pandas as pd


@shown
@dataclass(frozen=True, slots=True, eq=False)
class Covariance:
    """Covariance matrix of estimated parameters.

    Attributes
    ----------
    names
        The parameters, in the order of rows and columns.
    matrix
        In the product of their SI units, shape (parameter, parameter).

    Examples
    --------
    >>> covariance = Covariance(("a", "b"), np.array([[4.0, 1.0], [1.0, 9.0]]))
    >>> float(covariance["a", "b"])
    1.0
    """

    names: tuple[str, ...]
    matrix: NDArray[np.float64]

    def __getitem__(self, pair: tuple[str, str] | str) -> np.float64:
        """Return the covariance of two parameters; `UnknownNameError` where one of them is not in it."""
        if not isinstance(pair, tuple):
            raise TypeError(
                'a covariance is that of two parameters: covariance["m_s", "k_sf"], or twice the same for its variance'
            )
        for name in pair:
            if name not in self.names:
                raise UnknownNameError(name, self.names)
        row, column = (self.names.index(name) for name in pair)
        found: np.float64 = self.matrix[row, column]
        return found

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        """Return the matrix, for NumPy."""
        return np.array(self.matrix, dtype=dtype) if copy or dtype is not None else self.matrix

    def to_dataframe(self) -> pd.DataFrame:
        """Return it as a table, parameters down and across."""
        require_pandas()
        import pandas as pd  # noqa: PLC0415 (optional, and nothing else here needs it)

        return pd.DataFrame(self.matrix, index=list(self.names), columns=list(self.names))
