"""Decks that several tests run."""

from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[3] / "docs" / "examples"

# The load on the punch at the end [N], by an independent code to 1e-3.
LOAD = -10519.537829953842


@pytest.fixture
def block() -> Path:
    return EXAMPLES / "punched-block.toml"


@pytest.fixture
def collapsing() -> str:
    """A cylinder under more pressure than it carries, in a step that is not one to collapse."""
    text = (EXAMPLES / "cylinder-to-collapse.toml").read_text()
    return text.split("[expect]")[0].replace('until = "collapse"\n', "")
