// Other play-compensation map: the two halves differ from the average torque by a factor times what the
// map says,
//   T_i = average + factor (T_i,map - average).
// A map that is switched off stays off; factor 0 takes the offset away.
// Source: thesis 3.5, Table 3.4.
#include "controller/effects/effect.h"

namespace slewlab::controller {

namespace {

void change(const common::EffectValues& values, ControllerSettings& settings) {
  PlayCompensationSettings& play = settings.play_compensation;
  for (int i = 0; i < play.point_count; ++i) {
    PlayMapPoint& point = play.points[static_cast<std::size_t>(i)];
    point.half_1 = point.average + values["offset_factor"] * (point.half_1 - point.average);
    point.half_2 = point.average + values["offset_factor"] * (point.half_2 - point.average);
  }
}

}  // namespace

const ControllerEffect& other_play_compensation() {
  static const ControllerEffect effect{
      .about = {.name = "other_play_compensation",
                .subsystem = common::Subsystem::controller,
                .physics = "the play compensation uses another offset",
                .parameters = {{.name = "offset_factor",
                                .unit = common::Unit::none,
                                .meaning = "offset from the average over the one of the map",
                                .lower = 0.0,
                                .upper = 3.0,
                                .typical = 0.5,
                                .prior_scale = 0.3,
                                .scale = common::ParameterScale::linear,
                                .absent = 1.0}}},
      .change = change};
  return effect;
}

}  // namespace slewlab::controller
