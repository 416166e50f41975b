"""The notebooks run as they stand, and end with what is known."""

import re
import runpy

import pytest

from conftest import EXAMPLES

GALLERY = sorted((EXAMPLES.parent / "gallery").glob("*.py"))


@pytest.mark.parametrize("notebook", GALLERY, ids=lambda path: path.stem)
def test_a_notebook_runs_as_it_stands(notebook, monkeypatch):
    text = notebook.read_text()
    # Tables are data frames where pandas is installed.
    frames = ["pandas"] if re.search(r"\.(iloc|query)\b", text) else []
    for name in re.findall(r"^(?:import|from) (\w+)", text, flags=re.M) + frames:
        pytest.importorskip(name, reason=f"{notebook.name} needs {name}")
    monkeypatch.chdir(notebook.parent)
    runpy.run_path(str(notebook))


def test_each_notebook_is_short_and_ends_with_what_is_known():
    assert GALLERY
    for notebook in GALLERY:
        text = notebook.read_text()
        assert len(text.splitlines()) <= 90, notebook
        assert "assert" in text.split("# %%")[-1], notebook
