"""A table of text cells, for terminals, notebooks and pages."""

from __future__ import annotations

import html
from dataclasses import dataclass

from sprung.tables.cells import with_minus_signs


def escaped(text: str) -> str:
    """Return text escaped for HTML, unprintable characters replaced.

    Parameters
    ----------
    text
        Any.

    Returns
    -------
    str
        HTML.
    """
    return html.escape("".join(c if c.isprintable() or c == "\n" else "\N{REPLACEMENT CHARACTER}" for c in text))


@dataclass(frozen=True)
class Table:
    """A table.

    Attributes
    ----------
    title
        Above it.
    headers, rows
        Of its columns; cells as text.
    numbers
        Headers of right-aligned columns.
    spare
        Headers of the columns that a narrow display moves below the others, in this order.
    heads
        Number of columns at the left that name the rows.
    """

    title: str
    headers: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numbers: frozenset[str] = frozenset()
    spare: tuple[str, ...] = ()
    heads: int = 1

    def html(self, caption: bool = True) -> str:
        """Return the table as HTML, the first cell of each row as its heading.

        Parameters
        ----------
        caption
            Whether the title is the caption.

        Returns
        -------
        str
            HTML.
        """
        kinds = [' class="number"' if header in self.numbers else "" for header in self.headers]
        head = "".join(
            f'<th scope="col"{kind}>{escaped(header.strip())}</th>'
            for header, kind in zip(self.headers, kinds, strict=True)
        )
        body = "\n".join(f"<tr>{_row(cells, kinds)}</tr>" for cells in self.rows)
        title = f"<caption>{escaped(self.title)}</caption>\n" if caption else ""
        return f"<table>\n{title}<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n</tbody>\n</table>\n"


def _row(cells: tuple[str, ...], kinds: list[str]) -> str:
    texts = (with_minus_signs(cell) if kind else cell for cell, kind in zip(cells, kinds, strict=True))
    first, *others = (f"{kind}>{escaped(text)}" for text, kind in zip(texts, kinds, strict=True))
    return f'<th scope="row"{first}</th>' + "".join(f"<td{other}</td>" for other in others)
