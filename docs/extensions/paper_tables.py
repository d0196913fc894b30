"""The paper's tables with computed values, made when the documentation is built."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache

from sprung.paper import ModalValues, PaperReproduction, reproduce
from sprung.paper.printed import TABLE_3


@cache
def _reproduced() -> PaperReproduction:
    return reproduce(noise_levels=(0.0, 1e-3, 2e-2), seeds=1)


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---", *("---:" for _ in head[1:])], *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def table_2() -> str:
    """Return Table 2: the simulated car."""
    rows = [
        [
            f"`{row.name}`",
            f"{row.known:g}",
            f"{row.paper:g}",
            f"{100 * (row.paper / row.known - 1):+.3f}",
            f"{row.identified:.8g}",
            f"{row.error_percent:+.0e}",
        ]
        for row in _reproduced().table2
    ]
    return _table(("parameter", "true value", "paper", "error of the paper, %", "computed", "error, %"), rows)


def table_3() -> str:
    """Return Table 3: modes of the school bus."""

    def three(values: ModalValues) -> list[str]:
        return [f"{value:.4f}" for value in (values.damped_frequency, values.natural_frequency, values.damping_ratio)]

    rows = [
        [row.mode, row.paper_name, f"{TABLE_3[row.paper_name].fft or '-'}", *three(row.paper), *three(row.computed)]
        for row in _reproduced().table3
    ]
    head = ("mode", "in the paper", "paper: FFT", "$f_d$", "$f_n$", "$\\zeta$", "computed: $f_d$", "$f_n$", "$\\zeta$")
    return _table(head, rows)


def table_5() -> str:
    """Return Table 5: parameters of the school bus, recovered from simulated recordings."""
    rows = [
        (f"`{row.name}`", f"{row.known:g}", "given" if row.given else f"{row.error_percent:+.0e}")
        for row in _reproduced().bus
    ]
    return _table(("parameter", "Tables 4 and 5", "error of recovery, %"), rows)


def noise() -> str:
    """Return a table of the errors of the paper's method over the noise level."""
    rows = [
        (f"{point.noise:g}", f"{point.paper_method:.2g}", "-" if point.joint_fit is None else f"{point.joint_fit:.2g}")
        for point in _reproduced().noise
    ]
    return _table(("noise, m/s² rms", "paper's method, worst error, %", "maximum likelihood, worst error, %"), rows)


def misprints() -> str:
    """Return the list of misprints, each with its reason."""

    def text(words: str) -> str:
        return words.replace("*", "\\*").replace("|", "\\|").replace("_", "\\_")

    return "\n\n".join(
        f"{text(one.where)}\n: *printed* {text(one.printed)}; *should be* {text(one.should_be)}. {text(one.reason)}"
        for one in _reproduced().misprints
    )


WRITTEN = {
    "<!-- table 2 -->": table_2,
    "<!-- table 3 -->": table_3,
    "<!-- table 5 -->": table_5,
    "<!-- noise -->": noise,
    "<!-- misprints -->": misprints,
}
