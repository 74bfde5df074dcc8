#include "sim/integrate/reference_newton.h"

#include <algorithm>

namespace slewlab::sim {
namespace {

using Coupling = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kReferenceChannels, kReferenceChannels>;
using Channels = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kReferenceChannels, 1>;

// (I - gamma J) is, without the forces that couple, a set of 2x2 blocks [1, -gamma; gamma w^2, 1 + gamma d].
// The couplings are few: each closed gear's torque, the rope's force, tip displacement and velocity on the load.
void prepare(const ReferenceEquations& r, double gamma, ReferenceNewton& newton) {
  newton.gamma = gamma;
  newton.inverse.resize(r.square.size());
  const FreeHouseModes& modes = r.machine.modes;
  double house_house = 0.0, house_tip = 0.0, tip_tip = 0.0;
  for (int k = 0; k < r.mode_count; ++k) {
    newton.inverse[k] = 1.0 / (1.0 + gamma * (modes.damping_rate[k] + gamma * r.square[k]));
    house_house += modes.house[k] * modes.house[k] * newton.inverse[k];
    house_tip += modes.house[k] * modes.tip[k] * newton.inverse[k];
    tip_tip += modes.tip[k] * modes.tip[k] * newton.inverse[k];
  }
  newton.closed_count = 0;
  for (int i = 0; i < r.group_count; ++i) {
    if (r.contact[i] != 0) newton.closed[newton.closed_count++] = i;
  }
  const int gears = newton.closed_count;
  const int channels = gears + (r.load_count > 0 ? 3 : 0);
  Coupling system = Coupling::Identity(channels, channels);
  for (int row = 0; row < gears; ++row) {
    const GearContact& gear = r.machine.gear[newton.closed[row]];
    const double factor = gamma * (gamma * gear.stiffness + gear.damping);
    for (int column = 0; column < gears; ++column) system(row, column) += factor * house_house;
    system(row, row) += factor / r.machine.group_inertia[newton.closed[row]];
    if (r.load_count > 0) system(row, gears) += factor * house_tip;
  }
  if (r.load_count > 0) {
    const double k = r.load.rope_stiffness, c = r.load.damping(0, 0), c_rod = r.load.damping(0, 1);
    for (int column = 0; column < gears; ++column) {
      system(gears, column) += gamma * (gamma * k + c) * house_tip;
      system(gears + 1, column) -= gamma * gamma * house_tip;
      system(gears + 2, column) -= gamma * house_tip;
    }
    system(gears, gears) += gamma * (gamma * k + c) * tip_tip;
    system(gears + 1, gears) -= gamma * gamma * tip_tip;
    system(gears + 2, gears) -= gamma * tip_tip;
    for (int j = 0; j < 2; ++j) {
      newton.load_inverse[j] = 1.0 / (1.0 + gamma * (r.load_damping[j] + gamma * r.load_square[j]));
      const double force_per_speed =
          r.load.modes(0, j) * (gamma * k + c) + r.load.modes(1, j) * c_rod;
      system(gears, gears + 1) -= force_per_speed * gamma * newton.load_inverse[j] * r.load_from_tip[j];
      system(gears, gears + 2) -= force_per_speed * gamma * newton.load_inverse[j] * r.load_from_tip_velocity[j];
    }
  }
  if (channels > 0) newton.coupling.compute(system);
}

}  // namespace

void solve(const ReferenceEquations& r, ReferenceNewton& newton, double gamma, const double* b, double* x) {
  if (gamma != newton.gamma) prepare(r, gamma, newton);
  const FreeHouseModes& modes = r.machine.modes;
  const int n = r.mode_count;
  for (int i = 0; i < r.group_count; ++i) x[r.speeds() + i] = b[r.speeds() + i];
  double house_speed = 0.0, tip_velocity = 0.0, house_angle = 0.0, tip_displacement = 0.0;
  const double* bq = b + r.q();
  const double* bv = b + r.v();
  double* xq = x + r.q();
  double* xv = x + r.v();
  for (int k = 0; k < n; ++k) {
    xv[k] = (bv[k] - gamma * r.square[k] * bq[k]) * newton.inverse[k];
    house_speed += modes.house[k] * xv[k];
    tip_velocity += modes.tip[k] * xv[k];
    house_angle += modes.house[k] * bq[k];
    tip_displacement += modes.tip[k] * bq[k];
  }
  house_angle += gamma * house_speed;
  tip_displacement += gamma * tip_velocity;

  const int gears = newton.closed_count;
  Channels force(gears + (r.load_count > 0 ? 3 : 0));
  for (int row = 0; row < gears; ++row) {
    const int i = newton.closed[row];
    const double angle = b[i] + gamma * x[r.speeds() + i];
    force(row) = r.machine.gear[i].stiffness * (angle - house_angle) +
                 r.machine.gear[i].damping * (x[r.speeds() + i] - house_speed);
  }
  if (r.load_count > 0) {
    double end = 0.0, end_velocity = 0.0, rod_rate = 0.0;
    for (int j = 0; j < 2; ++j) {
      const double position = b[r.load_q() + j];
      double& speed = x[r.load_v() + j];
      speed = (b[r.load_v() + j] - gamma * r.load_square[j] * position) * newton.load_inverse[j];
      end += r.load.modes(0, j) * (position + gamma * speed);
      end_velocity += r.load.modes(0, j) * speed;
      rod_rate += r.load.modes(1, j) * speed;
    }
    force(gears) = r.load.rope_stiffness * (end - tip_displacement) +
                   r.load.damping(0, 0) * (end_velocity - tip_velocity) + r.load.damping(0, 1) * rod_rate;
    force(gears + 1) = tip_displacement;
    force(gears + 2) = tip_velocity;
  }
  if (force.size() > 0) force = newton.coupling.solve(force).eval();

  double house_torque = 0.0, tip_force = 0.0;
  for (int row = 0; row < gears; ++row) {
    const int i = newton.closed[row];
    house_torque += force(row);
    x[r.speeds() + i] -= gamma * force(row) / r.machine.group_inertia[i];
  }
  if (r.load_count > 0) {
    tip_force = force(gears);
    for (int j = 0; j < 2; ++j) {
      x[r.load_v() + j] += gamma * newton.load_inverse[j] *
                           (r.load_from_tip[j] * force(gears + 1) + r.load_from_tip_velocity[j] * force(gears + 2));
    }
  }
  for (int k = 0; k < n; ++k) {
    xv[k] += gamma * newton.inverse[k] * (modes.house[k] * house_torque + modes.tip[k] * tip_force);
    xq[k] = bq[k] + gamma * xv[k];
  }
  for (int i = 0; i < r.group_count; ++i) x[i] = b[i] + gamma * x[r.speeds() + i];
  for (int j = 0; j < r.load_count; ++j) x[r.load_q() + j] = b[r.load_q() + j] + gamma * x[r.load_v() + j];
  // Extra states: their rates are left out of the Jacobian.
  std::copy(b + r.extra_start(), b + r.size, x + r.extra_start());
}

}  // namespace slewlab::sim
