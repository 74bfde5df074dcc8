// Where slewlab's own files lie that are no programs: config/, tools/python/, tools/in-private-network. No folder is built
// into the programs, so that a build or an installation may be moved. Looked for in this order:
//
//   $SLEWLAB_HOME                        where it is set
//   PROGRAM/../../share/slewlab          of an installation: PREFIX/bin, PREFIX/share/slewlab
//   the folder named in PROGRAM/../../slewlab_home, relative to it: of a build, which CMake leaves there
//
// PROGRAM is the running program's own file.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace slewlab::tools {

// Throws std::runtime_error, saying where was looked, where there is none.
std::filesystem::path home();

// The interpreter for tools/python: $SLEWLAB_PYTHON, which a wheel sets to the one it was installed for; .venv of the home folder; or the
// system's python3 of an installation without one.
std::filesystem::path python_interpreter();

// The folder with what an FMU carries, a folder each for plant and controller: unit.so, license.txt and sources/.
std::filesystem::path fmu_parts();

// The folder with the messages as Python classes (lcm-gen).
std::filesystem::path python_messages();

// What a program of tools/python has in its environment beside ours: SLEWLAB_PYTHON_MESSAGES, and in a build under a sanitizer its runtime,
// which has to be there before our extension. What the interpreter keeps for ever is no leak of ours.
std::vector<std::pair<std::string, std::string>> python_environment();

}  // namespace slewlab::tools
