"""What is tested in one of the Blenders alone."""

import bpy
import pytest

newest = pytest.mark.skipif(bpy.app.version < (5, 3, 0), reason="once is enough: in the newest")
