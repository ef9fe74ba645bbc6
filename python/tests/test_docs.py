"""What README and guide show is run."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import pytest

import granflow

ROOT = Path(__file__).resolve().parents[2]


def blocks(page: str) -> list[str]:
    return re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(), re.MULTILINE | re.DOTALL)


def test_the_lines_of_the_readme_draw_an_avalanche(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (lines,) = (block for block in blocks("README.md") if "import granflow" in block)
    exec(compile(lines, "README.md", "exec"), {})
    assert (tmp_path / "avalanche.png").stat().st_size > 10_000


def test_the_first_lines_of_the_guide_run(monkeypatch):
    monkeypatch.chdir(ROOT)
    exec(compile(blocks("docs/python.md")[0], "docs/python.md", "exec"), {})


@pytest.mark.parametrize("name", granflow.__all__)
def test_every_public_name_says_what_it_is(name):
    found = getattr(granflow, name)
    assert name == "__version__" or (found.__doc__ and len(found.__doc__) > 20)


def test_a_note_is_no_warning(silo):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        granflow.run(silo, progress=False)
