"""The literature of the methods that a result rests on: what was not used is not named."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from sprung.results import Result


@dataclass(frozen=True)
class Work:
    """Something to read.

    Attributes
    ----------
    text
        Authors, title, where and when.
    used
        What for.
    when
        Says of which results that is true.
    """

    text: str
    used: str
    when: Callable[[Result], bool] = lambda _: True


def _profiled(result: Result) -> bool:
    return any(found.interval_from == "profile" for found in (*result.parameters.values(), *result.derived.values()))


_WORKS = (
    Work(
        "A New Physical Parameter Identification Method for Two-Axis On-Road Vehicles: Simulation and Experiment. "
        "Shock and Vibration 2015, article 191050, doi:10.1155/2015/191050.",
        "the vehicle of seven degrees of freedom, drop tests with and without a known added mass, figures 7 to 9",
    ),
    Work(
        "Maine, R. E. and Iliff, K. W.: Application of Parameter Estimation to Aircraft Stability and Control: The "
        "Output-Error Approach. NASA RP-1168, 1986.",
        "maximum likelihood by output error",
    ),
    Work(
        "Golub, G. H. and Pereyra, V.: The Differentiation of Pseudo-Inverses and Nonlinear Least Squares Problems Whose "
        "Variables Separate. SIAM J. Numer. Anal. 10 (1973) 413.",
        "initial states and offsets of every drop, solved for in closed form",
    ),
    Work(
        "Shinbrot, M.: On the Analysis of Linear and Nonlinear Systems. Trans. ASME 79 (1957) 1319.",
        "the start of the fit without a guess, by modulating functions",
    ),
    Work(
        "Rao, C. R.: Large Sample Tests of Statistical Hypotheses Concerning Several Parameters with Applications to Problems "
        "of Estimation. Proc. Camb. Phil. Soc. 44 (1948) 50.",
        "score tests: whether a fault, or a further force, would explain what is left",
    ),
    Work(
        "Schwarz, G.: Estimating the Dimension of a Model. Ann. Stat. 6 (1978) 461.",
        "the choice of the model",
        lambda result: bool(result.fit.path) or "gains" in result.fit.why,
    ),
    Work(
        "Dahl, P. R.: Solid Friction Damping of Mechanical Vibrations. AIAA J. 14 (1976) 1675.",
        "dry friction that gives way before it slides",
        lambda result: "friction" in result.fit.model,
    ),
    Work(
        "Birge, R. T.: The Calculation of Errors by the Method of Least Squares. Phys. Rev. 40 (1932) 207.",
        "wider uncertainties, as the drops disagree by more than their noise",
        lambda result: result.fit.inflated_by == "drops that disagree",
    ),
    Work(
        "Flyvbjerg, H. and Petersen, H. G.: Error Estimates on Averages of Correlated Data. J. Chem. Phys. 91 (1989) 461.",
        "wider uncertainties, as what is left of the records is not white",
        lambda result: result.fit.inflated_by == "coloured residuals",
    ),
    Work(
        "Venzon, D. J. and Moolgavkar, S. H.: A Method for Computing Profile-Likelihood-Based Confidence Intervals. Applied "
        "Statistics 37 (1988) 87.",
        "intervals from profiles of the likelihood",
        _profiled,
    ),
    Work(
        "Ljung, G. M. and Box, G. E. P.: On a Measure of Lack of Fit in Time Series Models. Biometrika 65 (1978) 297.",
        "whether what is left is white",
        lambda result: any(drop.whiteness for drop in result.validation.values()),
    ),
    Work(
        "Juang, J.-N. and Pappa, R. S.: An Eigensystem Realization Algorithm for Modal Parameter Identification and Model "
        "Reduction. J. Guid. Control Dyn. 8 (1985) 620.",
        "the stabilisation diagram",
        lambda result: bool(result.series),
    ),
    Work(
        "Pappa, R. S., Elliott, K. B. and Schenk, A.: Consistent-Mode Indicator for the Eigensystem Realization Algorithm. "
        "J. Guid. Control Dyn. 16 (1993) 852.",
        "which poles of the stabilisation diagram are vibrations",
        lambda result: bool(result.series),
    ),
    Work(
        "ISO 8855: Road vehicles - Vehicle dynamics and road-holding ability - Vocabulary.",
        "axes and signs",
    ),
)


def literature_of(result: Result) -> Iterator[Work]:
    """Give the works of the methods that were used.

    Parameters
    ----------
    result
        What they led to.
    """
    return (work for work in _WORKS if work.when(result))
