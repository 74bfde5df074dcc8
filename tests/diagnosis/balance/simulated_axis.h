// An axis J q'' = F - friction(q', q, t), integrated here with a step a hundred times finer than the record's, so that nothing of
// the balance's own arithmetic is in it.
#pragma once

#include <cmath>
#include <functional>
#include <random>

#include "diagnosis/balance/balance_record.h"

namespace slewlab::diagnosis {

struct SimulatedAxis {
  double inertia = 2.0;
  std::function<double(double time, double position, double speed)> resistance = [](double, double, double) { return 0.0; };
  std::function<double(double time)> effort = {};
  double duration = 20.0;   // [s]
  double step = 0.01;       // [s] of the record
  double noise = 0.0;       // standard deviation of the positions
  unsigned seed = 1;
};

inline AxisRecord record_of(const SimulatedAxis& axis) {
  constexpr int kFiner = 100;
  std::mt19937_64 generator(axis.seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  AxisRecord record;
  record.name = "simulated";
  record.step = axis.step;
  double position = 0.0, speed = 0.0;
  const double h = axis.step / kFiner;
  for (int n = 0; n * axis.step < axis.duration; ++n) {
    const double time = n * axis.step, effort = axis.effort(time);
    record.position.push_back(position + axis.noise * noise(generator));
    record.effort.push_back(effort);
    for (int i = 0; i < kFiner; ++i) {
      const double middle_speed = speed + 0.5 * h * (effort - axis.resistance(time + i * h, position, speed)) / axis.inertia;
      const double middle_position = position + 0.5 * h * speed;
      speed += h * (effort - axis.resistance(time + (i + 0.5) * h, middle_position, middle_speed)) / axis.inertia;
      position += h * middle_speed;
    }
  }
  return record;
}

}  // namespace slewlab::diagnosis
