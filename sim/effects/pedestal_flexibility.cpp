// Pedestal flexibility: the pedestal bends sideways, so that house and boom's pivot move laterally by y_p,
//   (M_top + M_boom) y_p'' + integral of m y'' dx + 2 zeta sqrt(k (M_top + M_boom)) y_p' + k y_p = F_rope,
// y being the boom's displacement against the house. In the house's frame everything feels the pseudo
// force of -y_p'' per mass: boom, load and rod. Accelerometers feel y_p'' besides; shaft encoders do not.
// Translation across the boom only; the frame is taken as not turning. Explicit, second order; the boom's
// reaction to y_p'' in the same step is solved for.
// Source: textbook; the thesis founds the crane rigidly.
#include "sim/effects/effect.h"

#include "sim/effects/accelerometers.h"
#include <cmath>
#include <limits>

#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class PedestalFlexibility : public Running<PedestalFlexibility> {
 public:
  explicit PedestalFlexibility(const EffectStart& start) : stiffness_(start.value("stiffness")) {
    const CraneParameters& crane = start.model.parameters;
    mass_ = start.value("top_mass") + crane.boom.mass;
    damping_ = 2.0 * start.value("damping_ratio") * std::sqrt(stiffness_ * mass_);
    boom_mass_per_length_ = crane.boom.length > 0.0 ? crane.boom.mass / crane.boom.length : 0.0;
    load_mass_ = crane.load.mass;
    rod_moment_per_acceleration_ = 0.5 * crane.load.mass * crane.load.rod_length;
    for (const double shape : start.model.uniform) boom_response_ += shape * shape;
  }

  void force(const EffectMoment& moment, PortForces& ports) override {
    const double h = moment.step;
    const double held = 1.5 * acceleration_ - 0.5 * acceleration_before_;
    // The boom's acceleration without the pseudo force that is in it.
    const double boom = moment.boom_acceleration + boom_mass_per_length_ * boom_response_ * held;
    const double displacement = displacement_ + 0.5 * h * speed_;
    const double speed = speed_ + 0.5 * h * held;
    const double acceleration =
        (moment.rope_force - stiffness_ * displacement - damping_ * speed - boom_mass_per_length_ * boom) /
        (mass_ - boom_mass_per_length_ * boom_mass_per_length_ * boom_response_);
    acceleration_before_ = acceleration_;
    acceleration_ = acceleration;
    displacement_ += h * (speed_ + 0.5 * h * acceleration);
    speed_ += h * acceleration;
    ports.uniform_force -= boom_mass_per_length_ * acceleration;
    ports.load_force -= load_mass_ * acceleration;
    ports.rod_moment -= rod_moment_per_acceleration_ * acceleration;
  }

  void sensor(const SensorMoment&, PlantReadings& readings) override {
    const double end = 1.5 * acceleration_ - 0.5 * acceleration_before_;
    add_to_accelerometers(readings, [&](std::string_view) { return end; });
  }

 private:
  double stiffness_;
  double mass_ = 0.0;                         // [kg] top and boom
  double damping_ = 0.0;                      // [N s/m]
  double boom_mass_per_length_ = 0.0;         // [kg/m]
  double load_mass_ = 0.0;                    // [kg]
  double rod_moment_per_acceleration_ = 0.0;  // [kg m]
  double boom_response_ = 0.0;                // [m^2/kg] boom_acceleration per uniform force
  double displacement_ = 0.0, speed_ = 0.0;
  double acceleration_ = 0.0, acceleration_before_ = 0.0;  // in the middle of the last two steps
};

}  // namespace

const EffectDescription& pedestal_flexibility() {
  static const EffectDescription description{
      .about = {.name = "pedestal_flexibility",
                .subsystem = common::Subsystem::house,
                .physics = "the pedestal bends sideways under the crane",
                .parameters = {{.name = "stiffness",
                                .unit = common::Unit::newton_per_metre,
                                .per = common::ScaleOf::lateral_stiffness,
                                .meaning = "lateral, at the height of the boom's pivot",
                                .lower = 240.8,
                                .upper = 1.204e+05,
                                .typical = 1204.0,
                                .prior_scale = 1.0,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::numeric_limits<double>::infinity(),
                                .tries = {361.2, 662.3, 2167.0, 3612.0, 1.204e+04}},  // each with a resonance of its own
                               {.name = "top_mass",
                                .unit = common::Unit::kilogram,
                                .per = common::ScaleOf::mass,
                                .meaning = "house and the pedestal's share that moves with it",
                                .lower = 0.5931,
                                .upper = 23.73,
                                .typical = 3.559,
                                .prior_scale = 0.3,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt},
                               {.name = "damping_ratio",
                                .unit = common::Unit::none,
                                .meaning = "share of critical damping",
                                .lower = 0.001,
                                .upper = 0.3,
                                .typical = 0.02,
                                .prior_scale = 0.5,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt,
                                .tries = {0.15}}},  // a wide resonance, which is seen from farther off
                .needs = {.boom = true},
                .family = common::Family::elasticity,
                .linear = true},
      .ports = {EffectPort::force, EffectPort::sensor},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<PedestalFlexibility>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
