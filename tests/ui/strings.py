"""Every string that the interface shows, read from the code; and what catalogues lack of them.

``python -m spectral_skylight.tests.ui.strings`` brings the catalogues up to date: it adds what is
new with an empty translation and takes out what is no more. No Blender is needed.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path

from spectral_skylight.addon.ui.catalogue import FOLDER, LANGUAGES, read

ADDON = Path(__file__).resolve().parents[2] / "addon"

OWN = (
    *(
        path
        for path in sorted((ADDON / "ui").glob("*.py"))
        if path.stem not in ("catalogue", "manual", "text_width")
    ),
    *(ADDON / name for name in ("choices.py", "grouping.py")),
)
"""Files that hold little but what the interface shows."""

SENTENCES = (
    "scene/bake/layout.py",
    "scene/bake/least_light.py",
    "scene/bake/patches.py",
    "scene/bake/scene_bake.py",
    "scene/bake/session.py",
    "scene/clear.py",
    "scene/day/animate.py",
    "scene/day/moments.py",
    "scene/explain.py",
    "scene/lights/lighting.py",
    "scene/lights/user_lamps.py",
    "scene/materials/eligibility.py",
    "scene/materials/glass_and_metal.py",
    "scene/materials/record.py",
    "scene/materials/shader_rewrite.py",
    "scene/materials/spectral_material.py",
    "scene/meter/calibration.py",
    "scene/meter/exposure.py",
    "scene/meter/light_meter.py",
    "scene/out_of_date.py",
    "scene/plan.py",
    "scene/use_cases/light.py",
    "scene/use_cases/materials.py",
    "scene/use_cases/meter.py",
    "scene/use_cases/sky.py",
    "scene/use_cases/world.py",
    "scene/world/hdri.py",
    "scene/world/panorama.py",
    "scene/world/simulated_sky.py",
    "scene/world/view_exposure.py",
    "scene/world/view_transform.py",
    "scene/write.py",
    "sky/direct_sun.py",
    "sky/hdri_checks.py",
    "sky/header_notes.py",
    "sky/light.py",
    "sky/panorama.py",
    "sky/sky_classification.py",
    "transfer/choice.py",
    "transfer/ground.py",
    "transfer/lamps.py",
    "transfer/prediction.py",
    "transfer/readings.py",
)
"""Files of other rooms whose sentences stand in the panel and in reports.

Other rooms' errors stay English: they quote files and settings, and are what one searches for. So
do the names and tooltips of our nodes' sockets, which lie in the blend file.
"""

COMPOSED = (
    *("{0} materials ({1})", "{0} objects ({1})", "{0} lamps ({1})"),
    *("{0}; {1}", "{0}: {1}"),
    *("estimated", "unknown", "none", "preparing {0}", "{0} left", "starting", "stopped"),
    *("Day, sun at {0}°", "is", "are", "Strength", "Rotation", "Strength and Rotation"),
    "no light comes from below: the HDRI is black there",
    *("Illuminance: {0}", "Melanopic EDI: {0}", "Luminance: {0}", "Color Temperature: {0}"),
    "Suspicious: {0}",
    *("open sky", "no light is baked yet"),
    "open sky: no shadows but the sun's yet",
)
"""Lines that no single text in the code holds, and parts of lines that are one word."""

NOT_SHOWN = {
    *("Base Color", "Blue", "Coat Weight", "Collection", "Cycles", "Diffuse Roughness"),
    *(
        "Edge Tint",
        "Eevee",
        "Emission Strength",
        "False Color",
        "Filmic Log",
        "Khronos PBR Neutral",
    ),
    *("Lamp 1", "Lamp 2", "Linear Rec.2020", "Linear Rec.709", "Sheen Weight", "Spectral Matrix"),
    *("Specular IOR Level", "Specular Tint", "Subsurface Weight"),
    *("Thin Film Thickness", "Transmission Weight", "Window"),
    "{0} or {1}",  # of an error's choices
    *("Many pictures", "Settings", "The fields of a file", "The library of reflectances"),
}
"""Names of Blender's and of our data, and headings of the manual, which is in English."""

LABELS = {"text", "name", "description", "placeholder", "message", "bl_label", "bl_description"}
"""Arguments and attributes that Blender itself looks up."""

Message = tuple[str, str]
"""Context and English text. Contexts: Blender's "*" and "Operator"; "Line" for what is composed."""


def messages() -> dict[Message, str]:
    """Every message of the interface, and where it stands."""
    found: dict[Message, str] = {}
    for path in (*OWN, *(path for name in SENTENCES for path in sorted(ADDON.glob(name)))):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for line, (context, text) in _Reader(tree).found:
            if text not in NOT_SHOWN and (path in OWN or is_sentence(text)):
                at = f"{path.relative_to(ADDON.parent).as_posix()}:{line}"
                found.setdefault((context, text), at)
    found |= {("Line", text): "composed" for text in COMPOSED}
    return {
        (context, text): at
        for (context, text), at in found.items()
        if context != "Line" or ("*", text) not in found or text in COMPOSED
    }


def template(node: ast.JoinedStr) -> str:
    """An f-string as catalogues have it: its values are {0}, {1} and so on."""
    values = iter(range(len(node.values)))
    parts = (
        part.value if isinstance(part, ast.Constant) else f"{{{next(values)}}}"
        for part in node.values
    )
    return "".join(map(str, parts))


def is_words(text: str) -> bool:
    """Whether a text is one for people: no identifier, file name, unit or number."""
    plain = re.sub(r"\{\d*\}| \.\w+", " ", text)
    if (
        text.startswith(".")
        or re.search(r"_|SKYLIGHT|skylight\.|import ", plain)
        or not re.search("[A-Za-z]{2}", plain)
    ):
        return False
    return " " in text.strip() or bool(re.fullmatch(r"[A-Z][a-z]+(-[A-Z][a-z]+)?", text))


def is_sentence(text: str) -> bool:
    """Whether words are more than the name of a thing, which is written in capitals."""
    return " " in text.strip() and not re.fullmatch(r"([A-Z]\S* ?|\{\d\} ?)+", text)


class _Reader(ast.NodeVisitor):
    """Collects (line, message) pairs."""

    def __init__(self, tree: ast.AST):
        self.found: list[tuple[int, Message]] = []
        self.context = "Line"
        self.visit(tree)

    def add(self, node: ast.AST, text: str) -> None:
        self.found.append((getattr(node, "lineno", 0), (self.context, " ".join(text.split(" ")))))

    def within(self, context: str, node: ast.AST) -> None:
        before, self.context = self.context, context
        self.visit(node)
        self.context = before

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        bases = {ast.unparse(base) for base in node.bases}
        operator = "bpy.types.Operator" in bases
        if operator and (told := ast.get_docstring(node, clean=False)):
            self.context = "*"
            self.add(node, told)
            self.context = "Line"
        for part in node.body:
            if isinstance(part, ast.Assign) and isinstance(part.targets[0], ast.Name):
                name = part.targets[0].id
                if name == "bl_label" and isinstance(part.value, ast.Constant):
                    label = ("Operator" if operator else "*", str(part.value.value))
                    self.found.append((part.lineno, label))
                    continue
                if name.startswith("bl_"):
                    continue
            if isinstance(part, ast.AnnAssign):
                self.within("*", part.annotation)  # a property
                continue
            self.visit(part)

    def visit_Call(self, node: ast.Call) -> None:
        called = ast.unparse(node.func).rpartition(".")[2]
        self.visit(node.func)
        if called in (
            "get",
            "getattr",
            "setattr",
            "property_unset",
            "endswith",
            "partition",
            "print",
        ):
            return
        for argument in node.args:
            self.within("*" if called == "Entry" else self.context, argument)
        for keyword in node.keywords:
            context = self.context
            if keyword.arg in LABELS:
                context = "Operator" if (called, keyword.arg) == ("operator", "text") else "*"
            elif keyword.arg == "items":
                context = "*"
            elif keyword.arg in ("icon", "default", "subtype", "options"):
                continue
            if context != self.context and isinstance(keyword.value, ast.Constant):
                text = keyword.value.value
                if isinstance(text, str) and re.search("[A-Za-z]{2}", text):
                    self.found.append((keyword.value.lineno, (context, text)))
                continue
            self.within(context, keyword.value)

    def visit_Tuple(self, node: ast.Tuple) -> None:
        """The items of an enum are (IDENTIFIER, label, description)."""
        texts = [part.value for part in node.elts if isinstance(part, ast.Constant)]
        item = len(texts) == len(node.elts) in (3, 4) and re.fullmatch("[A-Z]+", str(texts[0]))
        for part in node.elts[1:] if item else node.elts:
            self.within("*" if item else self.context, part)

    def visit_Dict(self, node: ast.Dict) -> None:
        for value in node.values:
            self.visit(value)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        for part in node.body:
            self.visit(part)

    def visit_Compare(self, node: ast.Compare) -> None:
        """What is compared is not shown."""

    def visit_Subscript(self, node: ast.Subscript) -> None:
        self.visit(node.value)

    def visit_Expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Constant):  # a docstring
            self.visit(node.value)

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        text = template(node)
        context = self.context
        if is_words(text):
            self.context = "Line"
            self.add(node, text)
            self.context = context
        for part in node.values:
            if isinstance(part, ast.FormattedValue):
                self.within("Line", part.value)

    def visit_Constant(self, node: ast.Constant) -> None:
        if isinstance(node.value, str) and is_words(node.value):
            self.add(node, node.value)


def write(language: str, wanted: dict[Message, str], known: dict[Message, str]) -> None:
    """Write a catalogue of the wanted messages, with what is known of their translations."""

    def quoted(text: str) -> str:
        return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'

    head = "Content-Type: text/plain; charset=UTF-8\\n"
    lines = ['msgid ""', 'msgstr ""', f'"Language: {language}\\n"', f'"{head}"']
    for context, text in sorted(wanted, key=lambda message: (message[1].lower(), message)):
        place = "#, python-brace-format" if "{0}" in text else ""
        lines += ["", *filter(None, [place]), f"msgctxt {quoted(context)}"]
        lines += [f"msgid {quoted(text)}", f"msgstr {quoted(known.get((context, text), ''))}"]
    (FOLDER / f"{language}.po").write_text("\n".join(lines) + "\n", encoding="utf-8")


def main() -> None:
    """Bring all catalogues up to date, and say what they lack."""
    wanted = messages()
    for language in LANGUAGES:
        known = read(language)
        write(language, wanted, known)
        lacking = [
            f"{context}: {text}" for context, text in wanted if not known.get((context, text))
        ]
        print(
            f"{language}: {len(wanted)} messages, {len(lacking)} to translate", *lacking, sep="\n  "
        )


if __name__ == "__main__":
    main()
