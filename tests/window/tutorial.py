"""The tutorial as steps: what a person presses, types and sees, and the same as a script.

In a step's prose **bold** is pressed, <kbd>keys</kbd> are pressed over the 3D view, choose `name`
picks a file in the browser, type `text` is typed, and *italics* are then to be read in the sidebar.
A picture's name is that of the screenshot after the step.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

FILE = Path(__file__).parents[2] / "examples" / "tutorial.md"
ACTIONS = re.compile(
    r"\*\*(?P<press>.+?)\*\*|<kbd>(?P<key>.+?)</kbd>|choose `(?P<choose>.+?)`|type `(?P<type>.+?)`"
    r"|(?<!\*)\*(?P<see>[^*]+?)\*(?!\*)",
    re.DOTALL,
)


@dataclass(frozen=True)
class Step:
    """Its title, (kind, text) of what is done and seen in order, its script and its picture."""

    title: str
    actions: list[tuple[str, str]]
    script: str
    picture: str


def steps() -> list[Step]:
    """The steps of the tutorial in their order."""
    text = FILE.read_text(encoding="utf-8")
    found = []
    for part in re.split(r"^## ", text, flags=re.MULTILINE)[1:]:
        title, _, body = part.partition("\n")
        prose, *_ = body.partition("```")
        script = "".join(re.findall(r"```python\n(.*?)```", body, re.DOTALL))
        picture = re.search(r"!\[[^]]*\]\((.+?)\)", body)
        actions = [
            (match.lastgroup or "", " ".join(match[match.lastgroup or 0].split()))
            for match in ACTIONS.finditer(re.sub(r"!\[[^]]*\]\(.+?\)", "", prose))
        ]
        found.append(Step(title, actions, script, picture[1] if picture else ""))
    return found


def files() -> dict[str, str]:
    """The text files that the tutorial tells the reader to save: name and content."""
    text = FILE.read_text(encoding="utf-8")
    return {
        name: content
        for name, content in re.findall(r"as `(\S+?)`:\n+```\w*\n(.*?)```", text, re.DOTALL)
    }
