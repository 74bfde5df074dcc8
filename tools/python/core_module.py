"""slewlab._core, the C++ core in this process, of the build or the installation that the messages are of."""

from run_log import built_module

core = built_module("slewlab", "the package slewlab is", "slewlab._core")
