// The extension module slewlab._core: the C++ core as Python sees it. What a user calls stands in tools/python/package.

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "common/input_error.h"
#include "tools/python/core/bindings.h"

namespace nb = nanobind;

NB_MODULE(_core, m) {
  using namespace slewlab;
  m.doc() = "The C++ core of slewlab. Use the package `slewlab`, which is documented.";
  m.attr("__version__") = SLEWLAB_VERSION;
  const nb::exception<common::InputError> input_error(m, "InputError", PyExc_ValueError);
  input_error.attr("__doc__") = "A file, or a change of one, is wrong: a line per problem with file, line, key, value and what would be right.";
  tools::bind_machine(m);
  tools::bind_run(m);
  tools::bind_yaml(m);
  tools::bind_plc(m);
  tools::bind_campaign(m);
}
