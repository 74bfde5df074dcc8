// Manoeuvres of the nominal machine with a torque at the motors that no record has.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/parameters_alone.h"
#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {

// The second one farther and faster to the other side, so that speed, angle and time are not one and the same.
inline const std::vector<Move> kFarToTheOther{{2.0, 0.5}, {7.0, 0.0}, {10.0, -1.0}, {17.0, 0.0}};

struct MotorState {
  double time, angle, speed, torque;  // [s], [rad] and [rad/s] of the axis, [Nm per motor] mean amount
  double own_torque;                  // [Nm] of the motor from which it is missing
  std::size_t group;                  // and which one it is
};
using TorqueLaw = std::function<double(const MotorState&)>;

inline double no_torque(const MotorState&) { return 0.0; }

// Makes a record of a machine on which that torque acts: it is in no command.
inline void take_off(const TorqueLaw& missing, msgs::RunLog& log) {
  const double ratio = bench().machine.scales.ratio;
  for (msgs::Torque& torque : log.torque) {
    const auto after = [&](const msgs::Encoder& encoder) { return encoder.simulated_time > torque.simulated_time; };
    const auto next = std::find_if(log.encoder.begin(), log.encoder.end(), after);
    const msgs::Encoder& now = next == log.encoder.begin() ? *next : *(next - 1);
    MotorState state{1e-9 * static_cast<double>(torque.simulated_time), now.shaft_position[0] / ratio, now.shaft_speed[0] / ratio, 0.0, 0.0, 0};
    for (const double t : torque.motor_torque) state.torque += std::fabs(t) / static_cast<double>(torque.motor_torque.size());
    for (state.group = 0; state.group < torque.motor_torque.size(); ++state.group) {
      double& t = torque.motor_torque[state.group];
      state.own_torque = t;
      t -= missing(state);
    }
  }
}

// The residual of parameters alone on two manoeuvres of the nominal machine with some effects and such a torque.
struct MissingTorque {
  MissingTorque(const std::vector<common::EffectInstance>& effects, const TorqueLaw& missing) {
    problem.threads = 2;
    sim::MachineSettings truth;
    truth.crane = bench().crane;
    truth.effects = effects;
    for (const auto* moves : {&kThereAndBack, &kFarToTheOther}) {
      msgs::RunLog log = simulated_log(truth, bench().controller, *moves, kDuration, 41 + static_cast<unsigned>(problem.records.size()));
      take_off(missing, log);
      problem.add(make_record(log, moves == &kThereAndBack ? "a" : "b", bench().admission));
    }
    fit = fit_parameters_alone(problem, nominal_fit(problem));
  }

  BenchProblem problem;
  FitResult fit;
};

}  // namespace slewlab::diagnosis
