// The thesis's crane and controller as the diagnosis's tests have them on the bench: what is nominal, how its logs are admitted, two
// manoeuvres.
#pragma once

#include <random>
#include <vector>

#include "controller/controller_file.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/nuisance.h"
#include "diagnosis/record.h"
#include "diagnosis/thresholds.h"
#include "sim/effects/catalogue.h"
#include "sim/machine/machine_file.h"
#include "tests/diagnosis/simulated_log.h"

namespace slewlab::diagnosis {

struct Bench {
  sim::CraneParameters crane;
  controller::ControllerSettings controller;
  sim::MachineDescription machine;
  Thresholds thresholds;
  AdmissionSettings admission;
};

inline const Bench& bench() {
  static const Bench kBench = [] {
    Bench b;
    b.crane = sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/thesis.yaml").parameters;
    b.controller = controller::load_controller_file(SLEWLAB_SOURCE_DIR "/config/controllers/thesis.yaml").settings;
    b.machine = sim::describe(b.crane);
    b.thresholds = thresholds_of(b.machine);
    b.admission = b.thresholds.admission;
    return b;
  }();
  return kBench;
}

// To one side and back without crossing the play, then inching.
inline const std::vector<Move> kThereAndBack{{2.0, 0.5}, {10.0, 0.0}, {14.0, -0.5}, {20.0, 0.0}};
inline const std::vector<Move> kInching{{2.0, 0.25}, {6.0, 0.0}, {10.0, -0.25}, {14.0, 0.0}, {18.0, 0.25}, {21.0, 0.0}};
// So fast to one side and back that the second group leaves its flank and comes back to it.
inline const std::vector<Move> kAcrossThePlay{{2.0, 1.0}, {9.0, -1.0}, {16.0, 0.0}};
inline constexpr double kDuration = 24.0;  // [s]

inline sim::CraneParameters spread_crane(unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-sim::kUnitSpread, sim::kUnitSpread);
  std::vector<double> amount;
  const Nuisances nuisances = nuisances_of(bench().machine, 0.0);
  for (const sim::Parameter& parameter : nuisances.parameters) amount.push_back(uniform(generator) / parameter.spread);
  sim::CraneParameters crane = with_nuisances(nuisances, bench().crane, amount);
  crane.boom.element_count = 20;
  return crane;
}

inline ShadowGains bench_gains() { return shadow_gains(bench().machine.scales, bench().thresholds.shadow); }

// What the bench's nominal crane is fitted to.
struct BenchProblem : Problem {
  BenchProblem() {
    nominal.crane = bench().crane;
    catalogue = sim::effects_for(nominal);
    nominal.crane.boom.highest_frequency = bench().thresholds.highest_mode;
    thresholds = bench().thresholds;
    nuisances = nuisances_of(bench().machine, thresholds.latency);
    gains = bench_gains();
  }
  void add(const Record& record) {
    const Shadow follower = shadow(nominal, record, gains);
    const WhiteningSettings& of_whitening = thresholds.whitening;
    const NoiseResponse response = noise_response(nominal, record, gains, transform_length(record.size()));
    whitening.push_back(make_whitening(record, trusted_stretches(record, follower, of_whitening), response, follower, of_whitening));
    records.push_back(record);
  }
};

}  // namespace slewlab::diagnosis
