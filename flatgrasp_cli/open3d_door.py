"""The only door to Open3D.

Open3D's shared library links against libusb-1.0, which a fresh machine lacks. The wheel `libusb-package` carries it;
loaded first and globally, it satisfies the linker without a system package.
"""

from __future__ import annotations

import ctypes
from functools import cache
from types import ModuleType


@cache
def load_open3d() -> ModuleType:
    """Import Open3D (about a second) with its native dependency in place, and keep it from printing."""
    try:
        import libusb_package
    except ImportError:  # not on this platform, where the full Open3D wheel brings its own
        pass
    else:
        ctypes.CDLL(str(libusb_package.get_library_path()), mode=ctypes.RTLD_GLOBAL)
    import open3d

    open3d.utility.set_verbosity_level(open3d.utility.VerbosityLevel.Error)
    module: ModuleType = open3d
    return module
