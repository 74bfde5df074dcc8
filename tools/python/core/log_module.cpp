// The extension module slewlab._log: the log reader alone, so that a picture of a log needs nothing else of slewlab built. What a user calls
// stands in tools/python/package. Its LogError is what functions of slewlab._core raise, too: nanobind's modules share their exceptions.

#include <nanobind/nanobind.h>

#include "msgs/log_writer.h"
#include "tools/python/core/bindings.h"

namespace nb = nanobind;

NB_MODULE(_log, m) {
  using namespace slewlab;
  m.doc() = "The log reader of slewlab. Use the package `slewlab`, which is documented.";
  const nb::exception<msgs::LogError> log_error(m, "LogError", PyExc_RuntimeError);
  log_error.attr("__doc__") = "A log cannot be read or written, or holds no run; the text says which file and why.";
  tools::bind_log(m);
}
