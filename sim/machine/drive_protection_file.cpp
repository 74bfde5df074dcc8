#include "sim/machine/drive_protection_file.h"

#include <cmath>

namespace slewlab::sim {
namespace {

using common::between;
using common::not_negative;
using common::positive;
using common::Unit;
using common::YamlReader;

// Times of the drive are whole nanoseconds, as all times of the wire.
std::int64_t read_time(YamlReader& reader, std::string_view key) {
  constexpr double kLongest = 3600.0;  // [s]
  constexpr double kNanosecondsPerSecond = 1e9;
  return std::llround(reader.number(key, Unit::second, between(0.0, kLongest)) * kNanosecondsPerSecond);
}

BrakeSettings read_brake(YamlReader reader, const ShaftUnits& units) {
  BrakeSettings brake;
  brake.torque = reader.number("torque", units.torque, not_negative());
  brake.closing_delay = read_time(reader, "closing_delay");
  brake.closing_time_constant = reader.number("closing_time_constant", Unit::second, not_negative());
  brake.release_delay = read_time(reader, "release_delay");
  brake.release_time_constant = reader.number("release_time_constant", Unit::second, not_negative());
  reader.finish();
  return brake;
}

}  // namespace

DriveProtectionSettings read_drive_protection(YamlReader reader, const ShaftUnits& units) {
  constexpr int kOldestAnswer = 1000;  // [cycles]
  DriveProtectionSettings protection;
  protection.torque_limit = reader.number("torque_limit", units.torque, positive());
  protection.torque_rate_limit = reader.number("torque_rate_limit", units.torque_rate, positive());
  protection.alive_timeout = read_time(reader, "alive_timeout");
  protection.silence_timeout = read_time(reader, "silence_timeout");
  protection.answer_age_limit = reader.integer("answer_age_limit", 0, kOldestAnswer);
  protection.standstill_speed = reader.number("standstill_speed", units.speed, not_negative());
  protection.trip_on_group_lost = reader.flag("trip_on_group_lost");
  protection.brake = read_brake(reader.map("brake"), units);
  reader.finish();
  return protection;
}

}  // namespace slewlab::sim
