// Cost of the plant's step, alone and against SUNDIALS CVODE at equal accuracy on the same crane. tools/benchmark
// runs it and writes the tables of docs/benchmarks.md.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "tests/sim/integrate/driven_run.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

constexpr double kStep = 1e-3;  // [s]

// Slews to and fro, the play being crossed: a torque per step, then again from the start.
struct Manoeuvre {
  PlantModel model;
  PlantWorkspace workspace;
  PlantState start, state;
  std::vector<GroupArray> torque;
  PlantInput input;
  std::size_t next = 0;

  explicit Manoeuvre(const CraneParameters& crane)
      : model(make_plant_model(crane, kStep)),
        workspace(make_plant_workspace(model)),
        start(make_plant_state(model)),
        state(start) {
    const Drive drive = to_and_fro();
    for (std::int64_t n = 0; n < whole(drive.duration / kStep); ++n) {
      const double held = drive.period * std::floor(static_cast<double>(n) * kStep / drive.period + 1e-9);
      torque.push_back(to_and_fro_torque(held));
    }
  }

  void advance() {
    if (next == torque.size()) {
      next = 0;
      state = start;
    }
    input.motor_torque = torque[next++];
    step(model, workspace, input, state);
  }
};

// Mean over all steps of the manoeuvre, those with contact changes included.
void plant_step(benchmark::State& bench) {
  Manoeuvre manoeuvre(thesis_crane(static_cast<int>(bench.range(0))));
  for (auto _ : bench) {
    manoeuvre.advance();
    benchmark::ClobberMemory();
  }
  bench.SetComplexityN(bench.range(0));
}
BENCHMARK(plant_step)
    ->ArgName("elements")
    ->Arg(2)->Arg(4)->Arg(6)->Arg(8)->Arg(12)->Arg(16)->Arg(24)->Arg(32)->Arg(48)->Arg(64)
    ->Complexity(benchmark::oN);

double clock_cost() {
  using Clock = std::chrono::steady_clock;
  std::vector<double> costs;
  for (int k = 0; k < 10001; ++k) {
    const auto begin = Clock::now();
    costs.push_back(std::chrono::duration<double, std::nano>(Clock::now() - begin).count());
  }
  std::nth_element(costs.begin(), costs.begin() + 5000, costs.end());
  return costs[5000];
}

// Each step by the clock, less the clock's own median: median and tail [ns], and the median of the steps in which a
// contact changes.
void plant_step_distribution(benchmark::State& bench) {
  using Clock = std::chrono::steady_clock;
  Manoeuvre manoeuvre(thesis_crane(6));
  std::vector<double> all, with_change;
  all.reserve(1 << 22);
  for (auto _ : bench) {
    for (std::size_t n = 0; n < manoeuvre.torque.size(); ++n) {
      const std::int64_t before = manoeuvre.next == manoeuvre.torque.size() ? 0 : manoeuvre.state.contact_changes;
      const auto begin = Clock::now();
      manoeuvre.advance();
      const double cost = std::chrono::duration<double, std::nano>(Clock::now() - begin).count();
      all.push_back(cost);
      if (manoeuvre.state.contact_changes != before) with_change.push_back(cost);
    }
  }
  const double clock = clock_cost();
  std::sort(all.begin(), all.end());
  std::sort(with_change.begin(), with_change.end());
  bench.counters["median_ns"] = all[all.size() / 2] - clock;
  bench.counters["p99_ns"] = all[all.size() * 99 / 100] - clock;
  bench.counters["median_with_change_ns"] = with_change[with_change.size() / 2] - clock;
  bench.counters["share_with_change"] = static_cast<double>(with_change.size()) / static_cast<double>(all.size());
  bench.counters["clock_ns"] = clock;
}
BENCHMARK(plant_step_distribution)->Iterations(20)->Unit(benchmark::kMillisecond);

// The demo scenario without play compensation, controller in the loop, 60 s: the plant, and CVODE at tolerances among
// which the one of equal error is to be found. `error` is that of the tip acceleration against the judge.
struct Contest {
  Demo demo;
  Drive drive;
  Record truth;
};

const Contest& contest() {
  static const Contest* const kContest = [] {
    auto* made = new Contest;
    made->demo = load_demo(SLEWLAB_SOURCE_DIR "/config/scenarios/thesis_slew_without_play_compensation.yaml");
    made->drive = drive_of(made->demo);
    made->drive.sample = made->drive.period;  // CVODE need not stop more often than the controller asks
    made->truth = run_reference(made->demo.crane, made->drive, {ReferenceMethod::kBdf, 1e-12});
    return made;
  }();
  return *kContest;
}

void demo_plant(benchmark::State& bench) {
  const Contest& c = contest();
  Record record;
  for (auto _ : bench) record = run_plant(c.demo.crane, c.drive, kStep);
  bench.counters["error"] = tip_error(record, c.truth);
}
BENCHMARK(demo_plant)->Unit(benchmark::kMillisecond);

void demo_cvode(benchmark::State& bench) {
  const Contest& c = contest();
  const ReferenceOptions options{ReferenceMethod::kBdf, std::pow(10.0, -static_cast<double>(bench.range(0)))};
  Record record;
  for (auto _ : bench) record = run_reference(c.demo.crane, c.drive, options);
  bench.counters["error"] = tip_error(record, c.truth);
}
BENCHMARK(demo_cvode)->ArgName("digits")->DenseRange(4, 10)->Unit(benchmark::kMillisecond);

void demo_arkode(benchmark::State& bench) {
  const Contest& c = contest();
  const ReferenceOptions options{ReferenceMethod::kDirk, std::pow(10.0, -static_cast<double>(bench.range(0)))};
  Record record;
  for (auto _ : bench) record = run_reference(c.demo.crane, c.drive, options);
  bench.counters["error"] = tip_error(record, c.truth);
}
BENCHMARK(demo_arkode)->ArgName("digits")->DenseRange(6, 11)->Unit(benchmark::kMillisecond);

// What a withheld case costs: 60 s of the demo with 16 elements, read every millisecond.
void reference_16_elements(benchmark::State& bench) {
  Contest c = contest();
  c.demo.crane.boom.element_count = 16;
  c.drive.sample = 1e-3;
  const auto method = bench.range(0) == 0 ? ReferenceMethod::kBdf : ReferenceMethod::kDirk;
  for (auto _ : bench) {
    benchmark::DoNotOptimize(run_reference(c.demo.crane, c.drive, {method, 1e-8}));
  }
}
BENCHMARK(reference_16_elements)->ArgName("dirk")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace slewlab::sim

BENCHMARK_MAIN();
