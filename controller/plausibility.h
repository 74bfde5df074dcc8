// Refuses encoder readings that the machine cannot have made, as a PLC's input monitoring does: a flipped bit on the
// bus, a frozen counter, a reading out of its time. Each reading is judged against the last plausible one, dt earlier:
//
//   speed         |w| <= speed_limit, and w and the position p are finite
//   acceleration  |w - w0| <= acceleration_limit dt + tolerance
//   position      |(p - p0) / dt - (w + w0) / 2| <= acceleration_limit dt / 4 + tolerance
//   time          dt > 0 and within half a period of (sequence - sequence0) period
//
// dt / 4: with |w'| <= a the mean speed over dt differs from (w + w0) / 2 by at most a dt / 4 (full acceleration, then
// full braking). `tolerance` is what noise and the counting of an encoder add to a speed.
//
// A single reading that is refused does no harm: the speeds of the last plausible one are held, for `timeout`. Refused
// for longer, the readings are unusable, and stay so until they have been plausible for as long; what is done about
// that is controller.h's affair. A speed that is no finite number and a wrong number of groups are unusable at once:
// an encoder says so when it has no signal.
//
// Speeds and positions are those of the motor shafts. Allocates nothing, throws nothing.
#pragma once

#include <cstdint>
#include <limits>

#include "controller/groups.h"

namespace slewlab::controller {

// The defaults refuse nothing but what is no number.
struct PlausibilitySettings {
  double speed_limit = std::numeric_limits<double>::infinity();         // [rad/s]
  double acceleration_limit = std::numeric_limits<double>::infinity();  // [rad/s^2]
  double tolerance = std::numeric_limits<double>::infinity();           // [rad/s]
  double timeout = 0.0;                                                 // [s]
};

struct EncoderReading {
  std::int64_t sequence = 0;        // counts the controller's periods
  std::int64_t simulated_time = 0;  // [ns]
  int group_count = 0;
  PerGroup shaft_speed{};     // [rad/s]
  PerGroup shaft_position{};  // [rad]
};

struct PlausibilityState {
  bool known = false;  // there is a reading to judge by
  EncoderReading last;
  std::int64_t refused = 0;    // readings in a row
  bool distrusted = false;     // unusable until plausible for `timeout`
  std::int64_t plausible = 0;  // readings in a row, while distrusted
};

enum class Plausibility { plausible, held, unusable };

// Judges a reading of `group_count` groups, `period` [s] being the time between two. Where it is held, the reading gets
// the speeds to control by.
Plausibility judge(const PlausibilitySettings& settings, double period, int group_count, PlausibilityState& state,
                   EncoderReading& reading);

}  // namespace slewlab::controller
