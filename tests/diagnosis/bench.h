// The thesis's crane and controller as the diagnosis's tests have them on the bench: what is nominal, how its logs are admitted, two
// manoeuvres.
#pragma once

#include <vector>

#include "controller/controller_file.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/nuisance.h"
#include "diagnosis/record.h"
#include "sim/effects/catalogue.h"
#include "sim/machine/machine_file.h"
#include "tests/diagnosis/simulated_log.h"

namespace slewlab::diagnosis {

struct Bench {
  sim::CraneParameters crane;
  controller::ControllerSettings controller;
  AdmissionSettings admission;
};

inline const Bench& bench() {
  static const Bench kBench = [] {
    Bench b;
    b.crane = sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/thesis.yaml").parameters;
    b.controller = controller::load_controller_file(SLEWLAB_SOURCE_DIR "/config/controllers/thesis.yaml").settings;
    b.admission = {.rated_torque = b.controller.rated_torque,
                   .total_ratio = b.controller.total_ratio,
                   .radius = {b.crane.house.sensor_radius, b.crane.boom.pivot_radius, 17.5, 31.3}};
    return b;
  }();
  return kBench;
}

// To one side and back without crossing the play, then inching.
inline const std::vector<Move> kThereAndBack{{2.0, 0.5}, {10.0, 0.0}, {14.0, -0.5}, {20.0, 0.0}};
inline const std::vector<Move> kInching{{2.0, 0.25}, {6.0, 0.0}, {10.0, -0.25}, {14.0, 0.0}, {18.0, 0.25}, {21.0, 0.0}};
inline constexpr double kDuration = 24.0;  // [s]

// What the bench's nominal crane is fitted to.
struct BenchProblem : Problem {
  BenchProblem() {
    nominal.crane = bench().crane;
    catalogue = sim::effects_for(nominal);
    gains = shadow_gains(bench().crane);
    latency_deviation = kLatencyDeviation;
  }
  void add(const Record& record) {
    const Shadow follower = shadow(nominal, record, gains);
    whitening.push_back(make_whitening(record, trusted_stretches(record, follower), gains, follower, {}));
    records.push_back(record);
  }
};

}  // namespace slewlab::diagnosis
