// slewlab-run: `slewlab run` alone, for tools/demo, which builds nothing that its picture does not need.

#include <CLI/CLI.hpp>

#include "tools/commands/command_line.h"

int main(int argc, char** argv) {
  const std::vector<std::string> command_line{argv, argv + argc};
  CLI::App app{"slewlab-run: a scenario with plant and controller as two processes over LCM", "slewlab-run"};
  slewlab::tools::Action action;
  slewlab::tools::add_run_options(app, command_line, action);
  return slewlab::tools::act(app, command_line, action);
}
