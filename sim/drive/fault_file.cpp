#include "sim/drive/fault_file.h"

#include <cmath>
#include <utility>

#include "common/readable_number.h"
#include "sim/machine/scales.h"

namespace slewlab::sim {
namespace {

using common::any_number;
using common::between;
using common::not_negative;
using common::Unit;
using common::YamlReader;

constexpr double kLongest = 1e6;  // [s], as in scenario_file.cpp
constexpr int kMostCycles = 1'000'000;
constexpr double kBeyondAnyLimit = 4000.0;  // of the rated torque: chosen, no drive gives ten times

std::int64_t nanoseconds(double seconds) { return std::llround(seconds * 1e9); }

template <std::size_t N, std::size_t... I>
std::size_t choice(YamlReader& reader, std::string_view key, const std::array<const char*, N>& names,
                   std::index_sequence<I...>) {
  return reader.choice(key, {names[I]...});
}
template <std::size_t N>
std::size_t choice(YamlReader& reader, std::string_view key, const std::array<const char*, N>& names) {
  return choice(reader, key, names, std::make_index_sequence<N>());
}

std::int64_t read_time(YamlReader& reader, std::string_view key, std::int64_t period) {
  const std::int64_t time = nanoseconds(reader.number(key, Unit::second, between(0.0, kLongest)));
  if (period > 0 && time % period != 0) {
    reader.report(key, common::readable_time(time), "a whole multiple of the controller period, " + common::readable_time(period));
  }
  return time;
}

bool is_message_fault(FaultKind kind) {
  return kind >= FaultKind::message_lost && kind <= FaultKind::message_corrupted;
}

Fault read_fault(YamlReader& reader, std::int64_t period, const DriveParameters& drive, std::uint64_t seed) {
  Fault fault;
  fault.kind = static_cast<FaultKind>(choice(reader, "fault", kFaultKindNames));
  fault.from = read_time(reader, "from", period);
  if (reader.has("until")) {
    fault.until = read_time(reader, "until", period);
    if (fault.until < fault.from) reader.report("until", "a time before 'from'", "a time at or behind it");
  }
  fault.seed = seed;
  fault.torque = kBeyondAnyLimit * drive.rated_torque;
  if (is_message_fault(fault.kind)) {
    fault.channel = static_cast<FaultChannel>(choice(reader, "channel", kFaultChannelNames));
    fault.probability = reader.number("probability", Unit::none, between(0.0, 1.0));
    if (reader.has("seed")) {
      fault.seed = static_cast<std::uint64_t>(reader.integer("seed", 0, std::numeric_limits<int>::max()));
    }
  }
  switch (fault.kind) {
    case FaultKind::message_delayed:
      fault.cycles = reader.integer("cycles", 1, kMostCycles);
      break;
    case FaultKind::message_corrupted:
      fault.corruption = static_cast<Corruption>(choice(reader, "corruption", kCorruptionNames));
      if (fault.channel == FaultChannel::encoder && fault.corruption > Corruption::other_version) {
        reader.report("corruption", kCorruptionNames[static_cast<std::size_t>(fault.corruption)],
                      "bits, truncated, garbage or other_version on the channel ENCODER");
      }
      break;
    case FaultKind::encoder_noisy:
    case FaultKind::encoder_offset:
      fault.speed = reader.number("speed", Unit::radian_per_second, any_number());
      fault.position = reader.number("position", Unit::radian, any_number());
      [[fallthrough]];
    case FaultKind::encoder_frozen:
    case FaultKind::encoder_dropped:
    case FaultKind::motor_group_lost:
      if (reader.has("group")) fault.group = reader.integer("group", 0, drive.group_count - 1);
      break;
    default: break;
  }
  reader.finish();
  return fault;
}

CountRange read_range(YamlReader reader) {
  CountRange range;
  constexpr int kMost = std::numeric_limits<int>::max();
  if (reader.has("at_least")) range.at_least = reader.integer("at_least", 0, kMost);
  if (reader.has("at_most")) range.at_most = reader.integer("at_most", 0, kMost);
  reader.finish();
  return range;
}

}  // namespace

std::vector<Fault> read_faults(YamlReader& scenario, std::int64_t controller_period, const DriveParameters& drive,
                               std::uint64_t scenario_seed, std::size_t faults_before) {
  std::vector<Fault> faults;
  scenario.each("faults", [&](YamlReader& reader) {
    constexpr std::uint64_t kApart = 1'000'003;  // far enough that lists of neighbouring seeds share none
    faults.push_back(read_fault(reader, controller_period, drive, scenario_seed + kApart * (faults_before + faults.size() + 1)));
  });
  return faults;
}

double standing_angle_of(const CraneParameters& machine) {
  constexpr double kStandingShare = 0.1;
  const Scales scales = scales_of(machine);
  return kStandingShare * scales.top_speed * scales.acceleration_time;
}

FaultExpectation read_expectation(YamlReader reader) {
  FaultExpectation expected;
  if (reader.has("drive_state")) {
    expected.drive_state = static_cast<DriveState>(choice(reader, "drive_state", kDriveStateNames));
  }
  if (reader.has("trip_cause")) {
    expected.trip_cause = static_cast<DriveFault>(choice(reader, "trip_cause", kDriveFaultNames));
  }
  if (reader.has("faults")) {
    YamlReader faults = reader.map("faults");
    for (int i = 1; i < kDriveFaultCount; ++i) {
      const auto fault = static_cast<DriveFault>(i);
      if (faults.has(name_of(fault))) expected.faults.push_back({fault, read_range(faults.map(name_of(fault)))});
    }
    faults.finish();
  }
  if (reader.has("no_other_faults")) expected.no_other_faults = reader.flag("no_other_faults");
  if (reader.has("stale_commands")) expected.stale_commands = read_range(reader.map("stale_commands"));
  expected.tip_acceleration = reader.optional_number("tip_acceleration", Unit::metre_per_second_squared, not_negative());
  if (const auto time = reader.optional_number("standing_by", Unit::second, between(0.0, kLongest))) {
    expected.standing_by = nanoseconds(*time);
  }
  expected.slew_angle_at_least = reader.optional_number("slew_angle_at_least", Unit::radian, any_number());
  expected.slew_angle_at_most = reader.optional_number("slew_angle_at_most", Unit::radian, any_number());
  reader.finish();
  return expected;
}

}  // namespace slewlab::sim
