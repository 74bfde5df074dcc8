"""slewlab._core, the C++ core in this process."""

from extension_module import loaded

loaded("_log")  # knows the LogError that the core's functions raise
core = loaded("_core")
