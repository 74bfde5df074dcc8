// Machines side by side against the same machines one after the other: CPU time per machine and step, in turns in one run.
//
//   batch_benchmark [SECONDS]     of simulated time of every machine in every turn; 6 unless given
//
// The machines differ by a hundredth in their parameters and slew to and fro, the play being crossed; `in contact` the torque keeps its
// sign, and hardly a machine leaves the lanes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <vector>

#include "sim/integrate/batch.h"
#include "tests/common/number_argument.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

constexpr double kStep = 1e-3;  // [s]
constexpr int kTurns = 5;

double processor_time() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Fleet {
  std::vector<PlantModel> models;
  std::vector<const PlantModel*> pointers;
  std::vector<PlantWorkspace> workspaces;

  Fleet(int count, int elements) {
    for (int m = 0; m < count; ++m) {
      CraneParameters crane = thesis_crane(elements);
      const double share = 1.0 + 0.01 * std::sin(m);
      crane.house.inertia *= share;
      crane.load.mass /= share;
      crane.drive.gearbox_stiffness *= share;
      models.push_back(make_plant_model(crane, kStep));
    }
    for (const PlantModel& model : models) {
      pointers.push_back(&model);
      workspaces.push_back(make_plant_workspace(model));
    }
  }
};

void drive(std::vector<PlantInput>& inputs, int n, bool crosses) {
  if (n % 10 != 0) return;  // the controller's period
  const double torque = crosses && n / 1500 % 2 != 0 ? -60.0 : 60.0;  // [Nm] per motor
  for (PlantInput& input : inputs) input.motor_torque = {torque + 10.0, torque - 10.0};
}

double alone(Fleet& fleet, int steps, bool crosses, bool reads) {
  std::vector<PlantState> states;
  for (const PlantModel& model : fleet.models) states.push_back(make_plant_state(model));
  std::vector<PlantInput> inputs(fleet.models.size());
  std::vector<PlantReadings> readings(fleet.models.size());
  const double begin = processor_time();
  for (std::size_t m = 0; m < fleet.models.size(); ++m) {
    for (int n = 0; n < steps; ++n) {
      if (m == 0 || n % 10 == 0) drive(inputs, n, crosses);
      step(fleet.models[m], fleet.workspaces[m], inputs[m], states[m]);
      if (reads) readings[m] = read(fleet.models[m], states[m]);
    }
  }
  return processor_time() - begin;
}

double together(Fleet& fleet, BatchWidth width, int steps, bool crosses, bool reads, double& out_of_line) {
  const PlantBatchHandle batch = make_plant_batch(fleet.pointers, width);
  std::vector<PlantInput> inputs(fleet.models.size());
  std::vector<PlantReadings> readings(fleet.models.size());
  const double begin = processor_time();
  for (int n = 0; n < steps; ++n) {
    drive(inputs, n, crosses);
    step_batch(*batch, inputs.data());
    if (reads) read_batch(*batch, readings.data());
  }
  const double used = processor_time() - begin;
  out_of_line = static_cast<double>(steps_out_of_line(*batch)) / static_cast<double>(steps) / static_cast<double>(fleet.models.size());
  return used;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + kTurns / 2, values.end());
  return values[kTurns / 2];
}

void compare(int machines, int elements, double seconds, bool crosses, bool reads) {
  Fleet fleet(machines, elements);
  const int steps = static_cast<int>(std::lround(seconds / kStep));
  const double per_step = 1e9 / (static_cast<double>(steps) * machines);
  const BatchWidth widths[] = {BatchWidth::portable, BatchWidth::four, BatchWidth::eight};
  std::vector<double> one, batch[3];
  double out_of_line = 0.0;
  for (int turn = 0; turn < kTurns; ++turn) {
    one.push_back(alone(fleet, steps, crosses, reads) * per_step);
    for (int w = 0; w < 3; ++w) {
      if (is_supported(widths[w])) batch[w].push_back(together(fleet, widths[w], steps, crosses, reads, out_of_line) * per_step);
    }
  }
  fmt::print("| {} | {} | {} | {:.1f} % | {:.0f} |", crosses ? "crossing" : "in contact", machines, elements, 100.0 * out_of_line, median(one));
  for (int w = 0; w < 3; ++w) {
    if (batch[w].empty()) {
      fmt::print(" |");
    } else {
      fmt::print(" {:.0f}, {:.2f} times |", median(batch[w]), median(one) / median(batch[w]));
    }
  }
  fmt::print("\n");
  std::fflush(stdout);
}

}  // namespace
}  // namespace slewlab::sim

int main(int argc, char** argv) {
  using slewlab::sim::compare;
  const double seconds = slewlab::number_argument(argc, argv, 1, 6.0);
  for (const bool reads : {false, true}) {
    fmt::print("{}, ns per machine and step:\n\n", reads ? "Step and sensors read" : "Step");
    fmt::print("| play | machines | elements | out of line | one at a time | 4 lanes, portable | 4 lanes, AVX2 | 8 lanes, AVX-512 |\n");
    fmt::print("|---|---|---|---|---|---|---|---|\n");
    for (const bool crosses : {false, true}) {
      for (const int machines : {1, 4, 8, 16, 64}) compare(machines, 6, seconds, crosses, reads);
      for (const int elements : {2, 16, 64}) compare(8, elements, seconds, crosses, reads);
    }
    fmt::print("\n");
  }
}
