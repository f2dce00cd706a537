"""The Python of the documentation runs as it stands."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / page for page in ["python/README.md", "docs/src/tutorials/from-python.md", "docs/src/reference/python.md"]]


def blocks(page):
    return re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_block_of_a_page_runs(page, tmp_path, monkeypatch):
    assert blocks(page), "there is none"
    monkeypatch.chdir(tmp_path)
    for block in blocks(page):
        # A figure needs matplotlib, which the tests do without.
        exec(block.replace('curve["steps"].plot()\n', ""), {})
