"""The documentation builds without a warning, and whoever reads it fetches nothing from anywhere."""

from __future__ import annotations

import html
import re
import subprocess
import sys
from pathlib import Path

import pytest

import sprung
from sprung.campaign.key_examples import KEYS
from sprung.campaign.schema import KNOWABLE
from sprung.vehicle import PARAMETERS

# Sphinx takes half a minute: `.ci/run` and `nox -s long` build the pages.
pytestmark = pytest.mark.long

DOCS = Path(__file__).resolve().parents[2] / "docs"


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("docs")
    options = ("-W", "--keep-going", "-q", "-b", "html", "-d", str(folder / "doctrees"))
    command = [sys.executable, "-m", "sphinx", *options, str(DOCS), str(folder / "html")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)  # noqa: S603 (our own text)
    assert done.returncode == 0, done.stderr
    return folder / "html"


def page(built: Path, name: str) -> str:
    return (built / f"{name}.html").read_text(encoding="utf-8")


def words(built: Path, name: str) -> str:
    """Return the visible text of a page."""
    return " ".join(html.unescape(re.sub(r"<[^>]+>", "", page(built, name))).replace("’", "'").split())


def test_nothing_is_fetched(built: Path) -> None:
    pages = list(built.rglob("*.html"))
    assert len(pages) > 15
    for path in pages:
        text = path.read_text(encoding="utf-8")
        fetched = re.findall(r"<(?:script|img|iframe|source)[^>]+src=\"([^\"]+)\"", text)
        fetched += [
            href
            for rel, href in re.findall(r"<link[^>]+rel=\"([^\"]+)\"[^>]+href=\"([^\"]+)\"", text)
            if rel not in ("index", "search", "next", "prev", "canonical")
        ]
        assert fetched
        assert not [address for address in fetched if re.match(r"(https?:)?//", address)], path.name
    for style in built.rglob("*.css"):
        assert not re.search(r"(@import|url\()\s*[\"']?(https?:)?//", style.read_text(encoding="utf-8")), style.name


def test_equations_are_set_by_the_browser(built: Path) -> None:
    theory = page(built, "theory")
    assert theory.count("<math") > 20
    assert "$" not in re.sub(r"<(pre|code|script|style).*?</\1>", "", theory, flags=re.DOTALL)


def test_the_commands_are_described(built: Path) -> None:
    text = page(built, "commands")
    for command in ("identify", "compare", "check", "modal", "plan", "simulate", "new", "validate", "demo", "paper"):
        assert f'id="sprung-{command}"' in text
    seen = words(built, "commands")
    assert "--fall, --no-fall" in seen
    assert "Example: sprung compare before/results after/results" in seen


def test_every_key_of_the_campaign_file_is_described(built: Path) -> None:
    seen = words(built, "campaign")
    for model, own in KEYS.items():
        for key, note in own.items():
            assert f" {key} = " in seen, (model, key)  # its example
            assert note.unit in seen
    assert [name for name in KNOWABLE if f" {name} " not in seen] == []
    assert [name for name in PARAMETERS if f" {name} " not in seen] == []
    assert page(built, "campaign").count('<svg class="sketch"') == 2  # from above and from the side
    assert "<!-- " not in seen


def test_the_public_names_are_described(built: Path) -> None:
    text = page(built, "api") + page(built, "rooms")
    for name in sprung.__all__:
        assert f'id="sprung.{name}"' in text
    for name in (
        "vehicle.PARAMETERS",
        "estimation.FitResult",
        "modal.ModeSet",
        "study.Comparison",
        "errors.InputError",
    ):
        assert f'id="sprung.{name}"' in text or f'id="sprung.{name.split(".")[1]}"' in text


def test_every_parameter_is_in_the_conventions(built: Path) -> None:
    text = words(built, "conventions")
    assert [name for name, one in PARAMETERS.items() if f"{name} {one.unit} {one.meaning}" not in text] == []


def test_the_readme_leads_there() -> None:
    text = (DOCS.parent / "README.md").read_text(encoding="utf-8")
    linked = [name for name in re.findall(r"\]\(([^)#:]+)\)", text) if not name.startswith("http")]
    assert {"docs/index.md", "docs/tutorial.md", "docs/drop-test.md"} <= set(linked)
    # A study's page is there from when its script was first run through.
    written = {f"docs/studies/{path.stem.replace('_', '-')}.md" for path in (DOCS / "studies").glob("*.py")}
    assert [name for name in linked if not (DOCS.parent / name).exists() and name not in written] == []
