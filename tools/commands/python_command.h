// Runs a program of tools/python with the project's own interpreter (.venv) and the messages of this build. In its environment
// SLEWLAB_PYTHON_MESSAGES names what the build made for Python, SLEWLAB_PROGRAM this program, for whoever starts it again.
#pragma once

#include <string>
#include <vector>

namespace slewlab::tools {

// This process becomes the Python program. Returns, with exit code 1 and a word on standard error, only where there
// is no interpreter.
int run_python(const std::string& script, const std::vector<std::string>& arguments);

// The same in a process of its own, waited for; its exit code.
int call_python(const std::string& script, const std::vector<std::string>& arguments);

}  // namespace slewlab::tools
