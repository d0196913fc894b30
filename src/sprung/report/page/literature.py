"""References of the methods that were used for a result."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from sprung.results import Result


@dataclass(frozen=True)
class Reference:
    """A reference.

    Attributes
    ----------
    text
        Authors, title, journal or publisher, year.
    purpose
        What it was used for.
    is_used
        Whether it was used for a result.
    """

    text: str
    purpose: str
    is_used: Callable[[Result], bool] = lambda _: True


def _profiled(result: Result) -> bool:
    return any(
        estimate.interval_from == "profile" for estimate in (*result.parameters.values(), *result.derived.values())
    )


def _has_free_decays(result: Result) -> bool:
    return any(drop.name in result.series and not drop.is_driven for drop in result.drops)


_REFERENCES = (
    Reference(
        "A New Physical Parameter Identification Method for Two-Axis On-Road Vehicles: Simulation and Experiment. "
        "Shock and Vibration 2015, article 191050, doi:10.1155/2015/191050.",
        "the vehicle of seven degrees of freedom, tests with and without a known added mass, motion of the body compared",
    ),
    Reference(
        "Maine, R. E. and Iliff, K. W.: Application of Parameter Estimation to Aircraft Stability and Control: The "
        "Output-Error Approach. NASA RP-1168, 1986.",
        "maximum likelihood by output error",
    ),
    Reference(
        "Golub, G. H. and Pereyra, V.: The Differentiation of Pseudo-Inverses and Nonlinear Least Squares Problems Whose "
        "Variables Separate. SIAM J. Numer. Anal. 10 (1973) 413.",
        "variable projection: initial states and offsets of every drop in closed form",
    ),
    Reference(
        "Shinbrot, M.: On the Analysis of Linear and Nonlinear Systems. Trans. ASME 79 (1957) 1319.",
        "start values by modulating functions",
    ),
    Reference(
        "Rao, C. R.: Large Sample Tests of Statistical Hypotheses Concerning Several Parameters with Applications to Problems "
        "of Estimation. Proc. Camb. Phil. Soc. 44 (1948) 50.",
        "score tests of faults and model terms",
    ),
    Reference(
        "Schwarz, G.: Estimating the Dimension of a Model. Ann. Stat. 6 (1978) 461.",
        "selection of model terms",
        lambda result: bool(result.fit.path) or "gains" in result.fit.why,
    ),
    Reference(
        "Dahl, P. R.: Solid Friction Damping of Mechanical Vibrations. AIAA J. 14 (1976) 1675.",
        "dry friction with presliding",
        lambda result: "friction" in result.fit.model,
    ),
    Reference(
        "Birge, R. T.: The Calculation of Errors by the Method of Least Squares. Phys. Rev. 40 (1932) 207.",
        "Birge ratio: larger uncertainties, because parts of the recordings disagree by more than their noise",
        lambda result: "disagree" in result.fit.inflated_by,
    ),
    Reference(
        "Flyvbjerg, H. and Petersen, H. G.: Error Estimates on Averages of Correlated Data. J. Chem. Phys. 91 (1989) 461.",
        "larger uncertainties, because the residuals are autocorrelated",
        lambda result: result.fit.inflated_by == "coloured residuals",
    ),
    Reference(
        "Venzon, D. J. and Moolgavkar, S. H.: A Method for Computing Profile-Likelihood-Based Confidence Intervals. Applied "
        "Statistics 37 (1988) 87.",
        "intervals from likelihood profiles",
        _profiled,
    ),
    Reference(
        "Ljung, G. M. and Box, G. E. P.: On a Measure of Lack of Fit in Time Series Models. Biometrika 65 (1978) 297.",
        "whiteness test of the residuals",
        lambda result: any(drop.whiteness for drop in result.validation.values()),
    ),
    Reference(
        "Juang, J.-N. and Pappa, R. S.: An Eigensystem Realization Algorithm for Modal Parameter Identification and Model "
        "Reduction. J. Guid. Control Dyn. 8 (1985) 620.",
        "the stabilisation diagram",
        _has_free_decays,
    ),
    Reference(
        "Pappa, R. S., Elliott, K. B. and Schenk, A.: Consistent-Mode Indicator for the Eigensystem Realization Algorithm. "
        "J. Guid. Control Dyn. 16 (1993) 852.",
        "selection of the poles of the stabilisation diagram",
        _has_free_decays,
    ),
    Reference(
        "ISO 8855: Road vehicles - Vehicle dynamics and road-holding ability - Vocabulary.",
        "axes and signs",
    ),
)


def references_of(result: Result) -> Iterator[Reference]:
    """Yield the references of the methods that were used.

    Parameters
    ----------
    result
        Of an identification.
    """
    return (reference for reference in _REFERENCES if reference.is_used(result))
