// Vessel roll: the vessel rolls by phi(t) = A sin(2 pi t / period + phase), downhill for positive phi at
// the angle psi from the boom's first direction. At the height z above the roll axis everything feels,
// across the boom,
//   f(z) = (g phi - z phi'') sin(psi - theta_house)  [m/s^2],
// the boom at the height of its middle, the load at its own. Small phi. Accelerometers read a - f(z).
// Source: textbook; thesis 1.1 names the period, 6 to 15 s, and leaves the motion out.
#include "sim/effects/effect.h"

#include "sim/effects/accelerometers.h"
#include <cmath>
#include <numbers>

#include "sim/integrate/body_force.h"
#include "sim/integrate/plant.h"
#include "sim/model/boom.h"

namespace slewlab::sim {

namespace {

class VesselRoll : public Running<VesselRoll> {
 public:
  explicit VesselRoll(const EffectStart& start)
      : amplitude_(start.value("amplitude")),
        frequency_(2.0 * std::numbers::pi / start.value("period")),
        phase_(start.value("phase")),
        direction_(start.value("direction")),
        pivot_height_(start.value("height")),
        masses_(masses_of(start.model.parameters)) {
    const CraneParameters& crane = start.model.parameters;
    rise_ = boom_point(crane.boom, 1.0).height;
    load_height_ = pivot_height_ + rise_ - crane.load.rope_length;
  }

  void force(const EffectMoment& moment, PortForces& ports) override {
    const double across = std::sin(direction_ - moment.house_angle);
    const double boom = lateral(moment.time, pivot_height_ + 0.5 * rise_) * across;
    const double load = lateral(moment.time, load_height_) * across;
    ports.uniform_force += masses_.boom_per_length * boom;
    ports.load_force += masses_.load * load;
    ports.rod_moment += masses_.rod_moment * load;
  }

  void sensor(const SensorMoment& moment, PlantReadings& readings) override {
    const double across = std::sin(direction_ - moment.house_angle);
    add_to_accelerometers(readings, [&](std::string_view place) {
      return -lateral(moment.time, pivot_height_ + share_of_boom(place) * rise_) * across;
    });
  }

 private:
  double lateral(double time, double height) const {
    return (kGravity + height * frequency_ * frequency_) * amplitude_ * std::sin(frequency_ * time + phase_);
  }

  double amplitude_, frequency_, phase_, direction_, pivot_height_;
  double rise_ = 0.0;         // [m] of the tip above the pivot
  double load_height_ = 0.0;  // [m] above the roll axis
  BodyMasses masses_;
};

}  // namespace

const EffectDescription& vessel_roll() {
  static const EffectDescription description{
      .about = {.name = "vessel_roll",
                .subsystem = common::Subsystem::environment,
                .physics = "the vessel rolls under the crane",
                .parameters = {{.name = "amplitude",
                                .unit = common::Unit::radian,
                                .meaning = "of the roll",
                                .lower = 0.0,
                                .upper = 0.15,
                                .typical = 0.01,
                                .prior_scale = 0.005,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "period",
                                .unit = common::Unit::second,
                                .per = common::ScaleOf::swing_time,
                                .meaning = "of the roll",
                                .lower = 2.798,
                                .upper = 11.2,
                                .typical = 5.597,
                                .prior_scale = 0.3,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt,
                                .tries = {3.75, 4.198, 4.813, 6.716, 8.395}},  // a period between two of them is a quarter turn off after half a minute
                               common::angle_parameter("phase", "of the roll at the start"),
                               common::angle_parameter("direction",
                                                       "of the positive roll's downhill, from the boom's first direction", 0.5 * std::numbers::pi),
                               {.name = "height",
                                .unit = common::Unit::metre,
                                .per = common::ScaleOf::length,
                                .meaning = "of the boom's pivot above the roll axis",
                                .lower = 0.0,
                                .upper = 2.555,
                                .typical = 0.6386,
                                .prior_scale = 0.3193,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt}},
                .angles_multiply = true,
                .needs = {.boom = true},
                .family = common::Family::gravity},
      .ports = {EffectPort::force, EffectPort::sensor},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<VesselRoll>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
