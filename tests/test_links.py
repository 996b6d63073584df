"""Every page of the repository links to what is there."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
LINK = re.compile(r"\]\((?!https?:|#)([^)#\s]+)")


def pages():
    found = [p for p in ROOT.rglob("*.md") if not {".venv", ".venvs", "dist", "build"} & {*p.parts}]
    return sorted(path.relative_to(ROOT) for path in found if "out" not in path.parts)


@pytest.mark.parametrize("page", pages(), ids=str)
def test_links_lead_somewhere(page):
    text = re.sub(r"```.*?```", "", (ROOT / page).read_text(encoding="utf-8"), flags=re.DOTALL)
    targets = LINK.findall(text)
    assert [t for t in targets if not ((ROOT / page).parent / t).exists()] == []


def test_there_are_pages():
    assert {"README.md", "addon/README.md", "node_groups/README.md"} <= {str(p) for p in pages()}
