// What gears, rope, boom and house turn into heat, beside the plant and not by it.
#pragma once

#include <vector>

#include "sim/integrate/plant.h"

namespace slewlab::tools {

// [W] of all gears and the rope at this instant. A gear in contact: its damper's torque times its speed. Teeth that part while they are still
// wound up push no more (contact_torque() of sim/model/gear.h is 0 where stiffness and damper together would pull), and what is stored in them,
// k depth^2 / 2, goes into the damper as they unwind: at parting k depth = -c depth', so that the power goes on without a step.
double gear_and_rope_dissipation(const sim::PlantModel& model, const sim::PlantState& state);

// What the modes of boom and house turn into heat over one step, in closed form: x'' + d x' + w^2 x = f is solved for the force f = f_0 + f_1 s that
// leads from the state at the step's beginning to that at its end, and
//
//   heat = integral of d v^2 = integral of f v - (change of (v^2 + w^2 x^2) / 2),
//   integral of f v = f(h) x(h) - f(0) x(0) - f_1 integral of x.
//
// A fast mode dissipates most of its energy within a step, so that its power at the step's ends does not tell how much. Assumption: the force on a
// mode is linear within a step; where teeth meet or part within it, it is not.
class ModalDissipation {
 public:
  ModalDissipation(const sim::PlantModel& model, const sim::PlantState& state);

  // [J] since the state before, all modes together. Allocates nothing.
  double over_step(const sim::PlantState& state);

 private:
  // The state at the end is  x = qq x0 + qv v0 + f_0 q0 + f_1 q1,  v likewise; sum_* are the integral of x likewise.
  struct Mode {
    double square, damping_rate;
    double qq, qv, vq, vv, q0, q1, v0, v1;
    double sum_x, sum_v, sum_0, sum_1;
  };
  double step_ = 0.0;  // [s]
  std::vector<Mode> modes_;
  std::vector<double> q_, v_;  // at the end of the step before
};

}  // namespace slewlab::tools
