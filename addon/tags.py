"""The keys of all custom properties that blend data of ours carries, but for those of node groups.

Files hold them: a key never changes, and neither does what its values mean. What a node group is
says `node_groups.tree`.
"""

# On materials
MATERIAL = "spectral_skylight"
"""What a material was given: `scene.materials.record.MaterialRecord`."""
MATERIAL_SETTINGS = "spectral_skylight_kept"
"""What settings it had before us."""
METAL = "spectral_skylight_metal"
"""n and k of its metal."""
VIEWPORT_COLOR = "spectral_skylight_colour"
"""Its viewport color before us, and ours."""
COMPARISON = "spectral_skylight_other"
"""Values that do not show now, see `scene.materials.rgb_comparison`."""
SHOWS_RGB = "spectral_skylight_before"
"""On a material that shows RGB × RGB now."""

# On nodes of materials
NODE = "spectral_skylight_node"
"""On nodes that we added: what they are."""
NODE_OUTPUT = "spectral_skylight_top"
"""On those of them that show: for which of the surface's outputs."""
OUTPUT = "spectral_skylight_output"
"""On a Material Output: the number under which …"""
OUTPUT_SOURCE = "spectral_skylight_source"
"""… the node that fed it before us remembers its socket."""

# On Worlds and their groups
SETTINGS = "spectral_skylight_settings"
"""On a World: `scene.world.settings.Settings`, as JSON."""
LEVEL_LUX = "spectral_skylight_level_lux"
"""On a World: the lux on the level in the open that it stands for, as a user has measured."""
LIGHT = "spectral_skylight_description"
"""On a World's group: what was found in its sky, as JSON."""
SUN_THRESHOLD = "spectral_skylight_sun_threshold"
"""On a World: its own Sun Threshold, which is ours meanwhile."""
SKY_MAP = "spectral_skylight_sky_map"
"""On a World: the columns of Cycles' map of its sky, which are ours while Cycles traces light."""

OWN_WORLD = "spectral_skylight_own"
"""On a World that we made …"""
WORLD_BEFORE = "spectral_skylight_before_world"
"""… and the user's World that it stands in for, if there was one."""

DAY = "spectral_skylight_day"
"""On a World whose sky moves: through what, as JSON …"""
SUN_ELEVATION = "spectral_skylight_sun_elevation"
"""… and where the sun stands [degrees], keyframed: all else follows that by drivers …"""
BAKED_KEY = "spectral_skylight_baked_key"
"""… but bakes: the number of the moment whose light they show, keyframed."""

# On images
SKY = "spectral_skylight_sky"
"""On an image that holds a sky as it was read: its file, and what was done to it."""

# On scenes
LEFT_ALONE = "spectral_skylight_left"
"""Names of materials that were left alone, and why, as JSON."""
UNBAKED = "spectral_skylight_unbaked"
"""Names of objects whose bake is missing or old, as JSON."""
PICTURE = "spectral_skylight_picture"
"""On a scene whose view shows colors as computed: what it had before."""
EXPOSURE = "spectral_skylight_exposure"
"""On a scene whose view's exposure is ours: what we have set it to."""
VIEW = "spectral_skylight_view"
"""On a scene whose white is ours: its view before, and as we set it."""

# On lamps, collections and objects
LAMP = "spectral_skylight_lamp"
"""On our lamps and what holds them: which part they play."""
LAMP_SPECTRUM = "spectral_skylight_spectrum"
"""On a user's lamp: what `transfer.lamps.lamp_spectrum` understands."""
RECEIVERS = "spectral_skylight_receivers"
"""On the collection of objects that our lamps shine on."""
LINKED = "spectral_skylight_linked"
"""On a collection of those of them that one lamp is linked to: that collection."""
PANES = "spectral_skylight_panes"
"""On the collection of objects that our lamps pass through."""
REST = "spectral_skylight_rest"
"""On a collection of ours: the full name of the one it stands for."""
SURROUNDINGS = "spectral_skylight_seen"
"""On a bake of an earlier version: what stood around when it was made, as JSON."""
SEEN = "spectral_skylight_record"
"""On a bake: the mesh of ours that keeps what stood around it, and all that were made with it."""
SEEN_NAMES, SEEN_ROWS = "spectral_skylight_names", "spectral_skylight_rows"
"""On that mesh: names of objects, as JSON, and 14 numbers for each, see `surroundings`."""
