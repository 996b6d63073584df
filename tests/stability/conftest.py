"""What the stability tests found, kept as a table: `pytest tests/stability --write-table`."""

from pathlib import Path

import pytest

TABLE = Path(__file__).with_name("README.md")
HEAD = """# Where the methods fail, and how the add-on responds

Each row is a test in this folder, which reproduces the failure, its figure and the response of the
add-on. `pytest tests/stability --write-table` writes the table. ΔE is the mean CIEDE2000 over the
ColorChecker unless stated otherwise, and includes the error of the basis itself. The air of the
simulated skies is that of `atmosphere`, so these are the best cases for that basis.
"""

_rows = pytest.StashKey[dict]()


def pytest_addoption(parser):
    parser.addoption("--write-table", action="store_true", help="write tests/stability/README.md")


def pytest_configure(config):
    config.stash[_rows] = {}


@pytest.fixture
def keep(request):
    """Call with the failure, its figure and what the add-on does: a row of the table."""
    rows = request.config.stash.setdefault(_rows, {})
    title = request.module.__doc__.split("\n")[0].rstrip(".")

    def keep(failure, figure, does):
        rows.setdefault(title, []).append(f"| {failure} | {figure} | {does} |")

    return keep


def pytest_sessionfinish(session, exitstatus):
    config = session.config
    if config.getoption("--write-table", default=False) and exitstatus == 0:
        parts = [HEAD]
        for title, rows in config.stash[_rows].items():
            parts.append(
                f"\n## {title}\n\n| failure | figure | what the add-on does |\n|---|---|---|"
            )
            parts.append("\n".join(rows))
        TABLE.write_text("\n".join(parts) + "\n", encoding="utf-8")
