"""Pages say what is so: pieces of Python, one after the other, and whole decks, as they stand."""

import re

import pytest

import moreau_fem as mc
from conftest import EXAMPLES

START = sorted((EXAMPLES.parent / "start").glob("*.md"))


def test_the_page_runs_as_it_stands(monkeypatch):
    pytest.importorskip("pandas")
    text = (EXAMPLES.parent / "python.md").read_text()
    pieces = re.findall(r"```python\n(.*?)```", text, flags=re.S)
    assert len(pieces) == 7
    monkeypatch.chdir(EXAMPLES)
    names: dict[str, object] = {}
    for piece in pieces:
        exec(piece, names)


@pytest.mark.parametrize("page", START, ids=lambda path: path.stem)
def test_decks_of_a_page_can_be_run(page):
    decks = re.findall(r"```toml\n(.*?)```", page.read_text(), flags=re.S)
    assert decks
    for text in decks:
        mc.Simulation(text)
