"""The book: the pages of this folder, the notebooks of the gallery, executed, and the Python API."""

import re
from pathlib import Path

FOLDER = Path(__file__).parent

project = "moreau"
author = "the authors of moreau"
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
exclude_patterns = ["build", "_build"]
html_theme = "furo"
html_title = "moreau"
html_copy_source = False
html_show_copyright = False

myst_enable_extensions = ["dollarmath", "attrs_inline"]
myst_heading_anchors = 4

# Notebooks are executed anew each time, and an assertion that fails fails the book.
nb_custom_formats = {".py": ["jupytext.reads", {"fmt": "py:percent"}]}
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True

autodoc_member_order = "bysource"
autodoc_typehints = "description"
napoleon_numpy_docstring = True

# Python that is no notebook.
exclude_patterns += ["conf.py", "cluster/*.py", "examples/*.py"]


def of_github(app, name, source):
    """Pages are written for GitHub: anchors are HTML there, and folders can be shown."""
    page = FOLDER / f"{name}.md"
    if not page.exists():
        return
    text = source[0]
    # Before a heading an anchor is a target, in a table it is that of the key behind it.
    text = re.sub(r'^<a id="([^"]+)"></a>$', r"(\1)=", text, flags=re.M)
    text = re.sub(r'<a id="([^"]+)"></a>(`[^`]+`)', r"[\2]{#\1}", text)

    def if_shown(link):
        where = page.parent / link[2]
        program = where.suffix == ".py" and where.parent.name != "gallery"
        return link[1] if where.is_dir() or program else link[0]

    # Folders are no pages, and programs no notebooks.
    source[0] = re.sub(r"(?<!!)\[([^\[\]]+)\]\(([^()#:\s]+)\)", if_shown, text)


def setup(app):
    app.connect("source-read", of_github)
