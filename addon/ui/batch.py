"""Many pictures: setting up a study, starting it in the background, and how far it is."""

# No postponed annotations here: Blender reads properties from them.
# mypy: disable-error-code="valid-type"

from pathlib import Path

import bpy

from ..choices import ENGINES, items
from ..errors import InputError
from . import operator, panels, where
from .translation import translated

RELATIVE = {"PATH_SUPPORTS_BLEND_RELATIVE"}
"""Options of paths that may start with ``//``."""

PACE = 0.5
"""[s] between two looks at a run, only while there is one."""

ENGINE_ITEMS = (("SCENE", "Scene", "The render engine of the scene"), *items(ENGINES))
CAMERAS = (
    ("ALL", "All", "All cameras of the scene"),
    ("ACTIVE", "Active", "Only the active camera of the scene"),
    ("NAMED", "Named", "Cameras from a list of names"),
)
SKIES = (
    ("FILES", "HDRIs", "A sky HDRI, or a folder of them"),
    ("PLACE", "Date & Place", "Simulated clear skies at times of a day"),
)


class SkylightBatch(where.Where, bpy.types.PropertyGroup):
    """What a study of this scene is made of, as `scene.skylight_batch`."""

    out: bpy.props.StringProperty(
        name="Output",
        description="Folder for the pictures and the report",
        subtype="DIR_PATH",
        options=RELATIVE,
        default="//batch",
    )
    cameras: bpy.props.EnumProperty(name="Cameras", description="Cameras to render", items=CAMERAS)
    names: bpy.props.StringProperty(
        name="Names", description="Names of cameras, separated by commas"
    )
    source: bpy.props.EnumProperty(name="Skies", description="Source of the skies", items=SKIES)
    files: bpy.props.StringProperty(
        name="HDRIs",
        description="An .exr or .hdr file, or a folder of them",
        subtype="FILE_PATH",
        options=RELATIVE,
    )
    date: bpy.props.StringProperty(
        name="Date", description="Date as YYYY-MM-DD", default="2025-06-21"
    )
    times: bpy.props.StringProperty(
        name="Times", description="Local times, separated by commas", default="09:00, 12:00, 15:00"
    )
    variants: bpy.props.StringProperty(
        name="Variants",
        description="A CSV with the columns material and reflectance (FILE.csv:COLUMN), or a "
        "folder of them. Leave empty to keep the materials",
        subtype="FILE_PATH",
        options=RELATIVE,
    )
    engine: bpy.props.EnumProperty(name="Engine", description="Render engine", items=ENGINE_ITEMS)
    samples: bpy.props.IntProperty(
        name="Samples", description="Samples per pixel. 0: as the scene has", min=0, soft_max=4096
    )
    workers: bpy.props.IntProperty(
        name="Processes",
        description="Number of Blender processes. 0: chosen automatically",
        min=0,
        max=64,
    )


class SkylightBatchRun(bpy.types.PropertyGroup):
    """How far the run of this session is, as `window_manager.skylight_batch`: no undo turns it."""

    state: bpy.props.StringProperty(description="State of the run. Empty before the first run")
    line: bpy.props.StringProperty(description="Progress of the run, in words")
    factor: bpy.props.FloatProperty(description="Completed fraction of the run", min=0, max=1)
    report: bpy.props.StringProperty(description="Path of the report, once it exists")


_run = None  # the one `batch.background.Background` of this session


def study_values(scene) -> dict:
    """The study that a scene's properties describe; InputError for what cannot be one."""
    chosen = scene.skylight_batch
    absolute = lambda path: Path(bpy.path.abspath(path))  # noqa: E731
    cameras: str | list[str] = "all"
    if chosen.cameras == "ACTIVE":
        if scene.camera is None:
            raise InputError(f'scene "{scene.name}"', "has no camera", "add one")
        cameras = [scene.camera.name]
    elif chosen.cameras == "NAMED":
        cameras = [name.strip() for name in chosen.names.split(",") if name.strip()]
    if chosen.source == "FILES":
        skies: list = _files(
            "Skies", absolute(chosen.files), (".exr", ".hdr", ".hsr"), chosen.files
        )
    else:
        times = [time.strip() for time in chosen.times.split(",") if time.strip()]
        place = {key: getattr(chosen, key) for key in ("date", "latitude", "longitude", "timezone")}
        place |= {key: round(place[key], 6) for key in ("latitude", "longitude")}
        skies = [{**place, "times": times, "north": round(chosen.north, 4)}]
    variants = None
    if chosen.variants:
        files = _files("Variants", absolute(chosen.variants), (".csv",), chosen.variants)
        variants = [{"name": path.stem, "assign": path} for path in files]
    return {
        "out": absolute(chosen.out),
        "scenes": [Path(bpy.data.filepath)],
        "cameras": cameras,
        "skies": skies,
        "variants": variants,
        "engine": None if chosen.engine == "SCENE" else chosen.engine,
        "samples": chosen.samples or None,
    }


def _files(what: str, path: Path, suffixes: tuple[str, ...], given: str) -> list[Path]:
    """The files that a path means: itself, or those of a folder."""
    if given and path.is_file():
        return [path]
    found = sorted(p for p in path.glob("*") if p.suffix.lower() in suffixes) if given else []
    if not found:
        cure = f"choose an {' or '.join(suffixes)} file, or a folder of them"
        raise InputError(what, f'"{given}" has no such file', cure)
    return found


def study_path() -> Path:
    """Where the open file's study lies."""
    path = Path(bpy.data.filepath)
    return path.with_name(f"{path.stem}.study.toml")


def _unsaved() -> str:
    return "" if bpy.data.filepath else "Save the file first: the study is written next to it"


def _changed() -> str:
    return "Save the file first: the saved file is rendered" if bpy.data.is_dirty else ""


class SKYLIGHT_OT_batch_write(operator.Thin, bpy.types.Operator):
    """Write the study next to the blend file, for the command line or a render farm"""

    bl_idname = "skylight.batch_write"
    bl_label = "Write Study"
    bl_options = {"REGISTER"}

    @classmethod
    def disabled_reason(cls, context):
        return _unsaved()

    def run(self, context):
        from ..batch.write_study import write_study

        write_study(study_path(), study_values(context.scene))
        return [("INFO", f"Wrote {study_path()}")]


class SKYLIGHT_OT_batch_start(operator.Thin, bpy.types.Operator):
    """Write the study and render it in background processes"""

    bl_idname = "skylight.batch_start"
    bl_label = "Render Study"
    bl_options = {"REGISTER"}

    @classmethod
    def disabled_reason(cls, context):
        if _run is not None and _run.running:
            return "A study is rendering"
        return _unsaved() or _changed()

    def run(self, context):
        global _run
        from ..batch.background import Background
        from ..batch.write_study import write_study

        values = study_values(context.scene)
        write_study(study_path(), values)
        workers = context.scene.skylight_batch.workers
        _run = Background(study_path(), values["out"], bpy.app.binary_path, workers)
        watch()
        if not bpy.app.timers.is_registered(watch):
            bpy.app.timers.register(watch, first_interval=PACE, persistent=True)
        return [("INFO", f"Rendering {study_path().name} in the background")]


class SKYLIGHT_OT_batch_cancel(operator.Thin, bpy.types.Operator):
    """Stop the background run. Finished pictures are kept"""

    bl_idname = "skylight.batch_cancel"
    bl_label = "Cancel"
    bl_options = {"REGISTER"}

    @classmethod
    def disabled_reason(cls, context):
        return "" if _run is not None and _run.running else "No study is rendering"

    def run(self, context):
        assert _run is not None
        _run.cancel()
        watch()
        return [("INFO", "Run stopped. Finished pictures are kept")]


def watch() -> float | None:
    """Look how far the run is, for panels to show; return the pause [s] to the next look."""
    if _run is None:
        return None
    running = _run.running  # before the look: what came last is seen
    found, shown = _run.status(), bpy.context.window_manager.skylight_batch
    shown.state, shown.line = found["state"], found["line"]
    shown.factor = found.get("done", 0) / max(1, found.get("total") or 1)
    report = _run.out / "report.html"
    shown.report = str(report) if not running and report.is_file() else ""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()
    return PACE if running else None


class SKYLIGHT_PT_batch(panels.Child, bpy.types.Panel):
    """The study of this scene, and its run."""

    bl_label = "Batch"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 90

    def draw(self, context):
        layout, chosen = self.layout, context.scene.skylight_batch
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(chosen, "cameras")
        if chosen.cameras == "NAMED":
            layout.prop(chosen, "names")
        layout.prop(chosen, "source")
        column = layout.column(align=True)
        if chosen.source == "FILES":
            column.prop(chosen, "files")
        else:
            column.prop(chosen, "date")
            column.prop(chosen, "times")
            where.draw(column, chosen)
            column.prop(chosen, "north")
        layout.prop(chosen, "variants")
        column = layout.column(align=True)
        for name in ("engine", "samples", "workers"):
            column.prop(chosen, name)
        layout.prop(chosen, "out")
        _progress(layout, context.window_manager.skylight_batch)


def _progress(layout, shown) -> None:
    """Draw the buttons, and how far the run is."""
    running = shown.state in ("starting", "preparing", "rendering")
    row = layout.row(align=True)
    if running:
        row.progress(factor=shown.factor, text=translated(shown.line))
        row.operator("skylight.batch_cancel", text="", icon="X")
        return
    row.operator("skylight.batch_start", icon="RENDER_ANIMATION")
    row.operator("skylight.batch_write", text="", icon="TEXT")
    if shown.state:
        icon = "CHECKMARK" if shown.state == "done" else "ERROR"
        layout.label(text=translated(shown.line), icon=icon)
    if shown.report:
        layout.operator("wm.path_open", text="Open Report", icon="URL").filepath = shown.report


CLASSES = (
    SkylightBatch,
    SkylightBatchRun,
    SKYLIGHT_OT_batch_write,
    SKYLIGHT_OT_batch_start,
    SKYLIGHT_OT_batch_cancel,
    SKYLIGHT_PT_batch,
)


def attach() -> None:
    """Give scenes their study, and the session its run."""
    bpy.types.Scene.skylight_batch = bpy.props.PointerProperty(type=SkylightBatch)
    bpy.types.WindowManager.skylight_batch = bpy.props.PointerProperty(type=SkylightBatchRun)


def detach() -> None:
    """Take that off again; a run in the background goes on."""
    if bpy.app.timers.is_registered(watch):
        bpy.app.timers.unregister(watch)
    del bpy.types.Scene.skylight_batch
    del bpy.types.WindowManager.skylight_batch
