#include "sim/integrate/body_force.h"

namespace slewlab::sim {

BodyMasses masses_of(const CraneParameters& crane) {
  return {.boom_per_length = crane.boom.length > 0.0 ? crane.boom.mass / crane.boom.length : 0.0,
          .load = crane.load.mass,
          .rod_moment = 0.5 * crane.load.mass * crane.load.rod_length};
}

void add_body_force(const BodyMasses& masses, double lateral, PortForces& ports) {
  ports.uniform_force += masses.boom_per_length * lateral;
  ports.load_force += masses.load * lateral;
  ports.rod_moment += masses.rod_moment * lateral;
}

}  // namespace slewlab::sim
