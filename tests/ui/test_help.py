"""Help: each panel, button and field has its place on the page that ships; the page as HTML."""

import html.parser
import urllib.parse
import webbrowser
from fnmatch import fnmatchcase
from pathlib import Path

import bpy
import pytest

from spectral_skylight.addon import registration
from spectral_skylight.addon.ui import help, manual, panels

pytestmark = pytest.mark.blender

TEXT = manual.PAGE.read_text(encoding="utf-8")


class Reader(html.parser.HTMLParser):
    """What a browser makes of a page: its places, its links, its text, and what is left open."""

    def __init__(self):
        super().__init__()
        self.places, self.links, self.text, self.open = [], [], [], []

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.places += [found["id"]] if "id" in found else []
        self.links += [found["href"]] if "href" in found else []
        if tag != "meta":
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


def read(text):
    reader = Reader()
    reader.feed(manual.page(text))
    assert reader.open == []
    return reader


def test_the_page_is_whole():
    found = read(TEXT)
    assert len({*found.places}) == len(found.places) > 50
    assert {link[1:] for link in found.links if link.startswith("#")} <= {*found.places}
    text = " ".join("".join(found.text).split())
    for part in ("bpy.ops.skylight.load_sky(filepath=", "The ? in a panel", "Object › Spectral"):
        assert part in text
    assert "](" not in text and "**" not in text and "```" not in text and "|---" not in text


@pytest.mark.parametrize(
    ("written", "shown"),
    [
        ("a *b* c", "<i>b</i>"),
        ("2 * 3 * 4", "2 * 3 * 4"),
        ("`a*b*c` <x>", "<code>a*b*c</code> &lt;x&gt;"),
        ("[a](#b) [c](d.md)", '<a href="#b">a</a> c'),
        ("    x < 1\n    # no heading", "<pre>x &lt; 1\n# no heading</pre>"),
        ("```python\n# no heading\n\ny = 1\n```", "<pre># no heading\n\ny = 1</pre>"),
        ("- one\n- two\n  goes on", "<ul><li>one</li><li>two goes on</li></ul>"),
        ("| a | b |\n|---|---|\n| `c` | d |", "<td><code>c</code></td><td>d</td>"),
        ("text\n## Next", '<h2 id="next">Next</h2>'),
        ("## skylight.load_sky", '<h2 id="skylightload_sky">skylight.load_sky</h2>'),
    ],
)
def test_markdown_as_html(written, shown):
    assert shown in manual.page(written)


def test_each_panel_has_its_section(addon):
    found = [c for c in registration.CLASSES if issubclass(c, panels.Sidebar)]
    found = [c for c in found if "HIDE_HEADER" not in getattr(c, "bl_options", ())]
    headings = manual.headings(TEXT)
    assert len(found) > 10
    assert [c.bl_label for c in found if c.bl_label not in headings] == ["Spectral Skylight"]


def test_f1_finds_every_button_and_field(addon):
    """As Blender does: the first pattern that the lowercase identifier matches."""
    found = [(prefix, *each) for prefix, places in bpy.utils.manual_map() for each in places]
    page = Path(urllib.parse.urlparse(help.address()).path)
    reader = Reader()
    reader.feed(page.read_text(encoding="utf-8"))
    wanted = {f"bpy.ops.skylight.{name}": f"skylight{name}" for name in dir(bpy.ops.skylight)}
    fields = {
        "SkylightNumbers.rotation": "settings",
        "SkylightReflectance.unit": "the-fields-of-a-file",
    }
    wanted |= {f"bpy.types.{name.lower()}": place for name, place in fields.items()}
    for name, place in wanted.items():
        first = next(prefix + at for prefix, pattern, at in found if fnmatchcase(name, pattern))
        assert first == help.address(place) and place in reader.places, name


def test_the_button_opens_the_section(addon, monkeypatch):
    opened = []
    monkeypatch.setattr(webbrowser, "open", lambda url, **_: opened.append(url))
    assert bpy.ops.skylight.help(section="Map of the Sky") == {"FINISHED"}
    (url,) = opened
    assert url.startswith("file:") and url.endswith(".html#map-of-the-sky")
    assert help.address() == url.partition("#")[0]
