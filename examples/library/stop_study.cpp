// How hard the tip swings after an emergency stop, for several times in which the controller brings the crane to rest.
//
//   stop_study SCENARIO.yaml

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>

#include "controller/controller_file.h"
#include "diagnosis/loop/closed_loop.h"
#include "sim/analysis/eigen.h"
#include "sim/drive/scenario_run.h"

int main(int count, char** words) {
  if (count != 2) {
    std::fprintf(stderr, "usage: stop_study SCENARIO.yaml\n");
    return 2;
  }
  try {
    using namespace slewlab;
    const sim::Scenario scenario = sim::load_scenario_file(words[1]);
    const std::vector<sim::Mode> modes = sim::crane_modes(scenario.crane.parameters);
    std::printf("boom's first bending mode: %.2f Hz\n", sim::frequency_of(modes, sim::ModeKind::kBending, 1));

    diagnosis::LoopSettings settings;
    settings.machine = sim::machine_settings(scenario);
    settings.controller = controller::load_controller_file(scenario.controller_file).settings;
    settings.controller.period = static_cast<double>(scenario.controller_period) * 1e-9;
    settings.operator_moves = scenario.moves;
    settings.duration = static_cast<double>(scenario.duration) * 1e-9;
    const double as_configured = settings.controller.ramp.emergency_stop_time;
    for (const double factor : {1.0, 2.0, 4.0}) {
      settings.controller.ramp.emergency_stop_time = factor * as_configured;
      const diagnosis::ClosedLoopSeries run = diagnosis::run_closed_loop(settings);
      double peak = 0.0;  // [m/s^2]
      for (const double acceleration : run.tip_acceleration) peak = std::max(peak, std::fabs(acceleration));
      std::printf("stop in %.1f s: tip acceleration up to %.2f m/s^2\n", settings.controller.ramp.emergency_stop_time, peak);
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
