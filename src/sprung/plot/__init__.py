"""The figures of the report with matplotlib, for notebooks and publications.

Every function draws into given axes, or into a new figure, and returns the axes.

Examples
--------
>>> import sprung
>>> car = sprung.Vehicle(m_s=1380, I_yy=2440, I_xx=380, m_uf=40.5, m_ur=45.4, k_sf=17000, k_sr=22000, k_tf=192000,
...                      k_tr=192000, c_sf=1500, c_sr=1500, a=1.25, b=1.51, t_f=0.74, t_r=0.74)
>>> result = sprung.identify(sprung.simulate(car, noise=0.02, seed=1, known={"total_mass": car.total_mass}))
>>> vertical, *others = sprung.plot.fit(result, "empty_bounce")
>>> vertical.get_ylabel(), len(others)
('vertical, m/s²', 5)
"""

try:
    import matplotlib as _mpl  # noqa: F401, ICN001 (its absence is reported here)
except ImportError as _error:
    raise ImportError('sprung.plot needs matplotlib, which is not installed: pip install "sprung[plot]"') from _error

from sprung.plot.drops import fit, recording
from sprung.plot.modal import mode, spectra, stabilisation
from sprung.plot.vehicle import amplitude, correlation, curve, parameters

__all__ = ["amplitude", "correlation", "curve", "fit", "mode", "parameters", "recording", "spectra", "stabilisation"]
