// `slewlab diagnose` of a plain axis (diagnosis/balance/axis_diagnosis.h): writes diagnosis.json, summary.txt, the series of the
// page and axis_with_effect.yaml, and prints one page.
#pragma once

#include <iosfwd>

#include "sim/machine/machine_file.h"
#include "tools/commands/diagnose_command.h"

namespace slewlab::tools {

// Answers with the exit code. Throws diagnosis::NoBalance, common::InputError, and what reading and writing throws.
int diagnose_axis_logs(const sim::MachineFile& axis, const DiagnoseOptions& options, std::ostream& out);

}  // namespace slewlab::tools
