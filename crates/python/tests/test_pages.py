"""The page for those who use Python says what is so: its pieces of code, one after the other, as they stand."""

import re

import pytest

from conftest import EXAMPLES


def test_the_page_runs_as_it_stands(monkeypatch):
    pytest.importorskip("pandas")
    text = (EXAMPLES.parent / "python.md").read_text()
    pieces = re.findall(r"```python\n(.*?)```", text, flags=re.S)
    assert len(pieces) == 5
    monkeypatch.chdir(EXAMPLES)
    names: dict[str, object] = {}
    for piece in pieces:
        exec(piece, names)
