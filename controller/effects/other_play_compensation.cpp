#include "controller/effects/other_play_compensation.h"

namespace slewlab::controller {

namespace {

void change(const std::vector<double>& values, ControllerSettings& settings) {
  PlayCompensationSettings& play = settings.play_compensation;
  for (int i = 0; i < play.point_count; ++i) {
    PlayMapPoint& point = play.points[static_cast<std::size_t>(i)];
    point.half_1 = point.average + values[0] * (point.half_1 - point.average);
    point.half_2 = point.average + values[0] * (point.half_2 - point.average);
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
