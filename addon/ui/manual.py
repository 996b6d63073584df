"""The pages of the manual, as a browser shows them: those that ship, so that they fit the version.

Of Markdown what our pages have: headings, paragraphs, lists, tables, code, links and emphasis.
"""

from __future__ import annotations

import html
import re
from pathlib import Path

PAGE = Path(__file__).with_name("README.md")
"""The panel's page."""

_HEAD = """<!DOCTYPE html><html lang="en"><meta charset="utf-8">
<meta name="viewport" content="width=device-width"><title>{title}</title><style>
body {{ font: 16px/1.5 sans-serif; max-width: 46em; margin: 2em auto; padding: 0 1em;
color: #222; background: #fff; }} code, pre {{ background: #f0f0f0; padding: 0 .2em; }}
pre {{ padding: .6em; overflow: auto; }} td, th {{ border: 1px solid #ccc; padding: .3em .5em;
vertical-align: top; text-align: left; }} table {{ border-collapse: collapse; }}
:target {{ background: #fff3b0; }}
@media (prefers-color-scheme: dark) {{ body {{ color: #ddd; background: #222; }}
code, pre {{ background: #333; }} a {{ color: #8cf; }} :target {{ background: #554; }} }}
</style><body>
"""


def anchor(heading: str) -> str:
    """Return the name by which a heading is linked to, as the hosts of code make it."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def headings(text: str) -> list[str]:
    """Return the headings of a page, in their order; a # in code is none."""
    return [line.lstrip("# ") for kind, line in _blocks(text) if kind == "heading"]


def page(text: str) -> str:
    """Return a page of Markdown as HTML, whole with its style."""
    blocks = [_RENDER[kind](block) for kind, block in _blocks(text)]
    title = next(iter(headings(text)), "")
    return _HEAD.format(title=html.escape(title)) + "\n".join(blocks) + "\n</body></html>\n"


def write(folder: Path) -> Path:
    """Write the panel's page into a folder, where it is not there yet; return the file."""
    path = folder / "spectral_skylight_manual.html"
    if not path.is_file():
        path.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    return path


def _blocks(text: str) -> list[tuple[str, str]]:
    """Return the kind of each block, and its lines."""
    found: list[tuple[str, str]] = []
    fenced = re.split(r"^```[^\n]*\n(.*?)^```[ ]*$", text, flags=re.MULTILINE | re.DOTALL)
    for number, part in enumerate(fenced):
        if number % 2:
            found.append(("code", part))
            continue
        for block in re.split(r"\n\s*\n|\n(?=#+ )", part.strip("\n")):
            if block.strip():
                found.append((_kind(block), block))
    return found


def _kind(block: str) -> str:
    start = next(kind for kind, sign in _KINDS if re.match(sign, block))
    return start


_KINDS = (
    ("heading", r"#+ "),
    ("code", r"    "),
    ("table", r"\|"),
    ("list", r"[-*] |\d+\. "),
    ("paragraph", r""),
)
"""Kinds of blocks and what they begin with."""


def _heading(block: str) -> str:
    line, _, rest = block.partition("\n")
    level, name = len(line) - len(line.lstrip("#")), line.lstrip("# ")
    after = f"\n{_paragraph(rest)}" if rest.strip() else ""
    return f'<h{level} id="{anchor(name)}">{_inline(name)}</h{level}>{after}'


def _code(block: str) -> str:
    lines = block.splitlines()
    cut = 4 if all(line.startswith("    ") for line in lines if line) else 0
    return f"<pre>{html.escape(chr(10).join(line[cut:] for line in lines))}</pre>"


def _table(block: str) -> str:
    rows = []
    for line in block.splitlines():
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip().strip("|"))]
        if not all(re.fullmatch(r":?-+:?|", cell) for cell in cells):
            rows.append("".join(f"<td>{_inline(cell)}</td>" for cell in cells))
    return f"<table>{''.join(f'<tr>{row}</tr>' for row in rows)}</table>"


def _list(block: str) -> str:
    items = re.split(r"^(?:[-*]|\d+\.) ", block, flags=re.MULTILINE)[1:]
    return f"<ul>{''.join(f'<li>{_inline(item)}</li>' for item in items)}</ul>"


def _paragraph(block: str) -> str:
    return f"<p>{_inline(block)}</p>"


def _inline(text: str) -> str:
    """Return a text with its code, links and emphasis; links to what does not ship are text."""
    parts = re.split(r"`([^`]+)`", " ".join(text.split()))
    for number, part in enumerate(parts):
        escaped = html.escape(part, quote=False)
        parts[number] = f"<code>{escaped}</code>" if number % 2 else _emphasis(escaped)
    return "".join(parts)


def _emphasis(text: str) -> str:
    text = re.sub(r"\[([^]]+)\]\(((?:#|https?://)[^)]+)\)", r'<a href="\2">\1</a>', text)
    text = re.sub(r"\[([^]]+)\]\([^)]+\)", r"\1", text)
    text = re.sub(r"\*\*(.+?)\*\*", r"<b>\1</b>", text)
    return re.sub(r"(?<![\w*])\*(?=\S)([^*]+?)(?<=\S)\*(?!\w)", r"<i>\1</i>", text)


_RENDER = {
    "heading": _heading,
    "code": _code,
    "table": _table,
    "list": _list,
    "paragraph": _paragraph,
}
