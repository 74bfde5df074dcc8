#include "sim/effects/wind_force.h"

namespace slewlab::sim {

common::EffectParameter boom_drag_area_parameter() {
  return {.name = "boom_drag_area",
          .unit = common::Unit::square_metre,
          .per = common::ScaleOf::drag_area,
          .meaning = "drag coefficient times side area of the boom",
          .lower = 0.001436,
          .upper = 0.7182,
          .typical = 0.1149,
          .prior_scale = 0.3,
          .scale = common::ParameterScale::logarithmic,
          .absent = std::nullopt,
          .detail = true};
}

common::EffectParameter load_drag_area_parameter() {
  common::EffectParameter parameter = boom_drag_area_parameter();
  parameter.name = "load_drag_area";
  parameter.meaning = "drag coefficient times area of the load";
  parameter.lower = 1.435e-4;
  parameter.typical = 0.02873;
  parameter.prior_scale = 0.5;
  return parameter;
}

DragAreas drag_areas(const CraneParameters& crane, double boom, double load) {
  return {.boom_per_length = crane.boom.length > 0.0 ? boom / crane.boom.length : 0.0,
          .load = crane.load.mass > 0.0 ? load : 0.0};
}

void add_wind(const DragAreas& areas, double on_boom, double on_load, PortForces& ports) {
  ports.uniform_force += areas.boom_per_length * on_boom;
  ports.load_force += areas.load * on_load;
}

}  // namespace slewlab::sim
