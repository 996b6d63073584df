"""The page of a report: numbers, failures, colours and errors, and all pictures as a contact sheet.

It names pictures by relative paths and nothing from elsewhere: the folder can be sent as it is. A
copy of this file lies beside each plan, see `report`.
"""

from __future__ import annotations

from html import escape
from typing import Any
from urllib.parse import quote

if __package__:
    from .duration import duration
else:  # a copy beside a plan
    from duration import duration  # type: ignore[no-redef]

MOST = 5000
"""Pictures on the page; all are in `report.json`."""


def page(found: dict[str, Any]) -> str:
    """Return the HTML of what `report.write_report` found."""
    body = "\n".join([_summary(found), _failures(found), _colours(found), _sheet(found)])
    title = escape(found["study"].rsplit("/", 1)[-1])
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>\n'
        f'<meta name="viewport" content="width=device-width">\n<style>{_STYLE}</style></head>\n'
        f"<body><h1>{title}</h1>\n{body}\n<script>{_SCRIPT}</script></body></html>\n"
    )


def _summary(found: dict[str, Any]) -> str:
    counts = found["counts"]
    rendered = [p["seconds"] for p in found["pictures"] if p["seconds"] is not None]
    tiles = [(f"{counts.get('done', 0)}", f"of {found['tasks']} pictures")]
    for status, words in (("failed", "failed"), ("missing", "not rendered yet")):
        tiles += [(f"{counts[status]}", words)] if counts.get(status) else []
    if rendered:
        tiles.append((duration(found["seconds"]), "of rendering"))
        tiles.append((f"{sorted(rendered)[len(rendered) // 2]:.1f} s", "the median picture"))
    tiles += [(escape(", ".join(found["blender"])), "Blender")] if found["blender"] else []
    parts = "".join(f"<div><b>{value}</b>{name}</div>" for value, name in tiles)
    several = (
        "<p class=bad>Several builds of Blender rendered these pictures. They look alike, but "
        "their bytes differ.</p>"
        if len(found["blender"]) > 1
        else ""
    )
    notes = dict.fromkeys(note for p in found["prepared"].values() for note in p["notes"])
    said = "".join(f"<li>{escape(note)}</li>" for note in notes)
    return f"<div class=tiles>{parts}</div>{several}" + (f"<ul>{said}</ul>" if said else "")


def _failures(found: dict[str, Any]) -> str:
    failed = [p for p in found["pictures"] if p["status"] == "failed"]
    if not failed:
        return ""
    rows = "".join(
        f"<tr><td>{escape(p['exr'].rsplit('/', 1)[-1])}<td>{escape(p['error'])}"
        for p in failed[:MOST]
    )
    return f"<h2>Failed</h2><table class=failed><tr><th>Picture<th>Why{rows}</table>"


def _colours(found: dict[str, Any]) -> str:
    """Tables of materials by skies, one for each scene and variant."""
    parts: list[str] = []
    groups: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for prepared in found["prepared"].values():
        if prepared["materials"]:
            groups.setdefault((prepared["scene"], prepared["variant"]), []).append(prepared)
    for (scene, variant), group in groups.items():
        skies = "".join(f"<th>{escape(p['sky'])}{_sun(p)}" for p in group)
        rows: dict[str, str] = {}
        for material in (m for p in group for m in p["materials"]):
            label = (
                f"{escape(material['material'])}<small>{escape(material['reflectance'])}</small>"
            )
            rows.setdefault(label, "")
            rows[label] += _cell(material)
        lines = "".join(f"<tr><th>{label}{cells}" for label, cells in rows.items())
        head = f"{escape(scene)} · {escape(variant)}"
        parts.append(f"<h3>{head}</h3><div class=wide><table><tr><th>{skies}{lines}</table></div>")
    if not parts:
        return ""
    return (
        "<h2>Colors and errors</h2><p>Each material on level ground under each sky without its "
        "sun, with its expected error (CIEDE2000). In brackets: the error of RGB × RGB.</p>"
        + "".join(parts)
    )


def _sun(prepared: dict[str, Any]) -> str:
    sun = prepared.get("sun")
    return f"<small>sun {sun[0]:.1f}°</small>" if sun else "<small>no sun</small>"


def _cell(material: dict[str, Any]) -> str:
    ours, rgb = (_number(material[key]) for key in ("matrix_delta_E", "rgb_delta_E"))
    gamut = ' class=bad title="out of gamut"' if material["out_of_gamut"] else ""
    title = escape(material["line"], quote=True)
    swatch = f'<i style="background:{escape(material.get("swatch", "none"), quote=True)}"></i>'
    return f'<td title="{title}">{swatch}<span{gamut}>{ours}</span> <small>({rgb})</small>'


def _number(value: float | None) -> str:
    return "?" if value is None else f"{value:.1f}"


def _sheet(found: dict[str, Any]) -> str:
    pictures = found["pictures"][:MOST]
    described = {blend: p for blend, p in found["prepared"].items()}
    choices = {
        "scene": dict.fromkeys(p["scene"] for p in described.values()),
        "variant": dict.fromkeys(p["variant"] for p in described.values()),
        "sky": dict.fromkeys(p["sky"] for p in described.values()),
        "camera": dict.fromkeys(p["camera"] for p in pictures),
        "status": dict.fromkeys(p["status"] for p in pictures),
    }
    filters = "".join(_filter(name, values) for name, values in choices.items() if len(values) > 1)
    animated = len({p["frame"] for p in pictures}) > 1
    figures = "".join(_figure(p, described[p["prepared"]], animated) for p in pictures)
    more = len(found["pictures"]) - len(pictures)
    rest = f"<p>{more} more are in report.json.</p>" if more else ""
    return f"<h2>Pictures</h2><nav>{filters}</nav><main>{figures}</main>{rest}"


def _filter(name: str, values: dict[str, None]) -> str:
    options = "".join(f"<option>{escape(value)}" for value in values)
    return f'<label>{name} <select data-key={name}><option value="">all{options}</select></label>'


def _figure(picture: dict[str, Any], prepared: dict[str, Any], animated: bool) -> str:
    data = {**{key: prepared[key] for key in ("scene", "variant", "sky")}, **picture}
    keys = ("scene", "variant", "sky", "camera", "status")
    tags = " ".join(f'data-{key}="{escape(str(data[key]), quote=True)}"' for key in keys)
    link = quote(picture["png"])
    shown = (
        f'<a href="{link}"><img loading=lazy decoding=async src="{link}" alt=""></a>'
        if picture["status"] == "done"
        else f"<div class=none>{picture['status']}</div>"
    )
    took = "" if picture["seconds"] is None else f" · {picture['seconds']:.1f} s"
    frame = f" · frame {picture['frame']}" if animated else ""
    where = "<br>".join(escape(data[key]) for key in ("variant", "sky", "scene") if data[key])
    exr = f'<a class=exr href="{quote(picture["exr"])}">EXR</a>'
    linear = exr if picture["status"] == "done" else ""
    return (
        f"<figure {tags}>{shown}<figcaption>{linear}<b>{escape(picture['camera'])}</b>{frame}"
        f"<small>{where}{took}</small></figcaption></figure>"
    )


_STYLE = """
:root{color-scheme:light dark;--b:#f2f2f2;--c:#fff;--f:#1b1b1b;--s:#6b6b6b;--l:#d9d9d9}
@media(prefers-color-scheme:dark){:root{--b:#1d1d1d;--c:#2a2a2a;--f:#e8e8e8;--s:#a0a0a0;--l:#3c3c3c}}
body{font:14px/1.45 system-ui,sans-serif;margin:2rem;background:var(--b);color:var(--f)}
h1{font-size:1.5rem;margin:0 0 1rem}h2{font-size:1.15rem;margin:2.2rem 0 .4rem}
h3{font-size:1rem;margin:1.2rem 0 .4rem}small{color:var(--s);font-weight:400}
.tiles{display:flex;flex-wrap:wrap;gap:.6rem}.bad{color:#d33}
.tiles div{background:var(--c);border:1px solid var(--l);border-radius:6px;padding:.5rem .9rem}
.tiles b{display:block;font-size:1.35rem;font-weight:600}.wide{overflow-x:auto}
table{border-collapse:collapse;background:var(--c);border:1px solid var(--l)}
th,td{padding:.35rem .7rem;text-align:left;border-bottom:1px solid var(--l);white-space:nowrap}
th{font-weight:600}th small{display:block}.failed td{white-space:normal;vertical-align:top}
td i{display:inline-block;width:2.6rem;height:1.3rem;border-radius:3px;vertical-align:middle;
margin-right:.5rem}
nav{display:flex;flex-wrap:wrap;gap:1rem;margin:.6rem 0}select{font:inherit}
main{display:grid;grid-template-columns:repeat(auto-fill,minmax(240px,1fr));gap:.8rem}
figure{margin:0;background:var(--c);border:1px solid var(--l);border-radius:6px;overflow:hidden}
figure[hidden]{display:none}img{width:100%;display:block;aspect-ratio:3/2;object-fit:contain;
background:#777}
.none{aspect-ratio:3/2;display:grid;place-items:center;color:var(--s)}
figure[data-status=failed] .none{color:#d33}
figcaption{padding:.45rem .7rem .55rem}figcaption small{display:block}a{color:inherit}
figcaption .exr{float:right;font-size:.8em}
"""

_SCRIPT = """
const choices = [...document.querySelectorAll("select")];
for (const choice of choices) choice.onchange = () => {
  for (const figure of document.querySelectorAll("figure"))
    figure.hidden = choices.some(c => c.value && figure.dataset[c.dataset.key] !== c.value);
};
"""
