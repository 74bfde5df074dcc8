#include "diagnosis/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "diagnosis/plausibility.h"
#include "diagnosis/torque_noise.h"
#include "sim/model/drive_line.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kNanosecond = 1e-9;  // [s]
constexpr int kTripped = 2, kBraked = 3;  // drive_state of PLANT_STATUS
constexpr int kLongestBridge = 3;     // missing messages in a row that are bridged
constexpr double kOnGrid = 0.01;         // [steps] by which a sensor's instant may miss the grid and still be on it
constexpr double kRounded = 1.5;          // times the rounding's deviation, from which on torques scatter by more than that
constexpr double kCommandScatter = 1e-5;  // of the rated torque, below which a command's own numbers and what is not linear in its controller are all that scatters
constexpr double kMeasuredNoise = 5e-4;   // of the rated torque; chosen: below what measures torques, above what is not linear in a controller
// At least, of rounded values; chosen: more levels than a test's torques have, while a coarse sensor reads few and seldom changes.
constexpr std::size_t kChanges = 100, kPositionLevels = 2, kTorqueLevels = 32, kAccelerationChanges = 10, kAccelerationLevels = 2;
constexpr double kMoving = 0.2;          // of the record's largest speed, above which a motor turns
constexpr double kPushing = 0.05;  // of the record's largest torque, above which the motors are on their way
// Speeds that a swinging load may make of a crane at rest: shares of the largest speed of the record, and of the machine's top speed; and
// the time over which the first speed is taken, as a share of the machine's.
constexpr double kStanding = 0.05, kCreeping = 2e-3, kFirstStretch = 0.2;

// The commonest distance between successive times [ns].
std::int64_t common_period(const std::vector<std::int64_t>& times) {
  std::map<std::int64_t, int> counts;
  for (std::size_t i = 1; i < times.size(); ++i) ++counts[times[i] - times[i - 1]];
  std::int64_t best = 0;
  int most = 0;
  for (const auto& [period, count] : counts) {
    if (count > most) {
      most = count;
      best = period;
    }
  }
  return best;
}

template <typename Message>
std::vector<std::int64_t> times_of(const std::vector<Message>& messages) {
  std::vector<std::int64_t> times;
  times.reserve(messages.size());
  for (const Message& message : messages) times.push_back(message.simulated_time);
  return times;
}

// Throws where the clock jumps back or a gap is longer than can be bridged; remarks on what is bridged.
void check_clock(const char* channel, const std::vector<std::int64_t>& times, std::int64_t period, Record& record) {
  int bridged = 0;
  for (std::size_t i = 1; i < times.size(); ++i) {
    const std::int64_t distance = times[i] - times[i - 1];
    const double at = static_cast<double>(times[i - 1]) * kNanosecond;
    if (distance <= 0) {
      throw NotAdmitted(fmt::format("{}: clock of {} jumps back by {:.4f} s at {:.3f} s; the log must rise in "
                                    "time: give the parts (slewlab cut) as separate logs",
                                    record.name, channel, -static_cast<double>(distance) * kNanosecond, at));
    }
    const auto missing = static_cast<int>((distance + period / 2) / period) - 1;
    if (missing > kLongestBridge) {
      throw NotAdmitted(fmt::format("{}: gap of {:.3f} s in {} at {:.3f} s ({} messages missing, at most {} can be "
                                    "bridged); give the parts (slewlab cut) as separate logs",
                                    record.name, static_cast<double>(distance) * kNanosecond, channel, at, missing,
                                    kLongestBridge));
    }
    if (missing > 0) bridged += missing;
    if (missing <= 0 && std::llabs(distance - period) > period / 5) {
      throw NotAdmitted(fmt::format("{}: clock of {} is uneven at {:.3f} s: {:.4f} ms between messages where {:.4f} ms "
                                    "is usual; give the times at which the values were measured, not received",
                                    record.name, channel, at, static_cast<double>(distance) * 1e-6,
                                    static_cast<double>(period) * 1e-6));
    }
  }
  if (bridged > 0) record.remarks.push_back(fmt::format("{}: {} missing messages of {} bridged", record.name, bridged, channel));
}

// Throws where a channel does not cover the time that ENCODER covers: values before its first and after its last would be invented.
void check_span(const char* channel, const std::vector<std::int64_t>& times, std::int64_t period, const std::vector<std::int64_t>& encoder_times,
                const Record& record) {
  const std::int64_t bridge = kLongestBridge * std::max(period, encoder_times[1] - encoder_times[0]);
  if (times.front() <= encoder_times.front() + bridge && times.back() >= encoder_times.back() - bridge) return;
  const auto seconds = [](std::int64_t time) { return static_cast<double>(time) * kNanosecond; };
  throw NotAdmitted(fmt::format("{}: {} goes from {:.3f} s to {:.3f} s, ENCODER from {:.3f} s to {:.3f} s; both must cover the same time: cut the "
                                "log to it (slewlab cut), or correct the clock that runs apart",
                                record.name, channel, seconds(times.front()), seconds(times.back()), seconds(encoder_times.front()),
                                seconds(encoder_times.back())));
}

// Positions between encoder messages follow the cubic through position and speed at both ends.
std::vector<double> resample_position(const std::vector<std::int64_t>& times, const std::vector<double>& position,
                                      const std::vector<double>& speed, const Record& record, std::size_t count) {
  std::vector<double> result(count);
  std::size_t i = 0;
  for (std::size_t n = 0; n < count; ++n) {
    const double t = record.time(n) / kNanosecond;
    while (i + 2 < times.size() && static_cast<double>(times[i + 1]) <= t) ++i;
    const double t0 = static_cast<double>(times[i]), t1 = static_cast<double>(times[i + 1]);
    const double h = (t1 - t0) * kNanosecond;
    const double s = std::clamp((t - t0) / (t1 - t0), 0.0, 1.0);
    const double s2 = s * s, s3 = s2 * s;
    result[n] = position[i] * (2 * s3 - 3 * s2 + 1) + h * speed[i] * (s3 - 2 * s2 + s) +
                position[i + 1] * (3 * s2 - 2 * s3) + h * speed[i + 1] * (s3 - s2);
  }
  return result;
}

void check_finite(const Record& record, const std::string& signal, const std::vector<std::int64_t>& times,
                  const std::vector<double>& values) {
  for (std::size_t n = 0; n < values.size(); ++n) {
    if (!std::isfinite(values[n])) {
      throw NotAdmitted(fmt::format("{}: {} is not a number at {:.3f} s", record.name, signal,
                                    static_cast<double>(times[n]) * kNanosecond));
    }
  }
}

// A signal that stands exactly still while the motors turn is frozen; one that touches its extreme again and
// again is clipped.
void check_alive(const Record& record, const std::string& signal, const std::vector<double>& values,
                 const std::vector<double>& motion, double motion_threshold, double longest) {
  const auto limit = static_cast<std::size_t>(longest / record.step);
  std::size_t still = 0;
  for (std::size_t n = 1; n < values.size(); ++n) {
    still = values[n] == values[n - 1] && std::fabs(motion[n]) > motion_threshold ? still + 1 : 0;
    if (still > limit) {
      throw NotAdmitted(fmt::format("{}: {} is frozen at {:.6g} from {:.3f} s while the motors turn; check its cable "
                                    "or leave the sensor out of the log",
                                    record.name, signal, values[n], record.time(n - still)));
    }
  }
}

// `step`: to which the values were rounded; 0: they were not. A crest stays on its last step for long, which it comes to by one.
void check_clipped(const Record& record, const std::string& signal, const std::vector<double>& values, double step) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  for (const double extreme : {*low, *high}) {
    if (extreme == 0.0) continue;
    std::size_t run = 0, longest = 0, runs = 0;
    bool is_crest = false;
    for (std::size_t n = 0; n < values.size(); ++n) {
      if (values[n] == extreme && run == 0) is_crest = n > 0 && std::fabs(values[n] - values[n - 1]) < 1.5 * step;
      run = values[n] == extreme && !is_crest ? run + 1 : 0;
      if (values[n] != extreme) is_crest = false;
      if (run == 5) ++runs;
      longest = std::max(longest, run);
    }
    // One long stand at an extreme to the record's end is a frozen sensor, which check_alive names.
    if (runs >= 2) {
      throw NotAdmitted(fmt::format("{}: {} is clipped at {:.6g}: it holds its extreme {} times in a row; raise the "
                                    "sensor's range and measure again",
                                    record.name, signal, extreme, longest));
    }
  }
}

// Throws where the motors turn and the commands are not what drives them: drives that are off or tripped, brakes that are on.
void check_driven(const msgs::RunLog& run, const Record& record, double moving) {
  const auto refuse_if = [&](std::int64_t time, bool is_undriven, const std::string& why) {
    if (!is_undriven) return;
    const double at = static_cast<double>(time) * kNanosecond;
    const double steps = (at - record.start_time) / record.step;
    if (steps < 0.0 || steps > static_cast<double>(record.size() - 1)) return;
    const auto n = static_cast<std::size_t>(steps);
    if (std::fabs(record.shaft_speed[0][n]) < moving) return;
    throw NotAdmitted(fmt::format("{}: {} at {:.3f} s while the motors turn; the commands there are not what drives the machine: give the part before it (slewlab cut)",
                                  record.name, why, at));
  };
  for (const msgs::Torque& message : run.torque) {
    refuse_if(message.simulated_time, !message.enable, "TORQUE does not enable the drives");
    refuse_if(message.simulated_time, message.brake, "TORQUE applies the brakes");
  }
  for (const msgs::PlantStatus& message : run.plant_status) {
    refuse_if(message.simulated_time, message.drive_state == kTripped, "PLANT_STATUS says that the drives are tripped");
    refuse_if(message.simulated_time, message.drive_state == kBraked, "PLANT_STATUS says that the brakes are on");
  }
}

}  // namespace

double mean_torque(const Record& record, std::size_t n) {
  double mean = 0.0;
  for (int g = 0; g < record.group_count; ++g) mean += record.motor_torque[static_cast<std::size_t>(g)][n] / record.group_count;
  return mean;
}

double creeping_speed(const AdmissionSettings& settings) { return kCreeping * settings.turn / settings.time; }

bool changes_with_every_message(const Record& record) {
  constexpr double kNearlyEvery = 0.6;  // chosen: a controller that stands holds its commands, one whose cycle has two rows or more changes half of them at most
  std::size_t changes = 0;
  for (std::size_t n = 1; n < record.torque.size(); ++n) {
    if (record.torque[n].motor_torque != record.torque[n - 1].motor_torque) ++changes;
  }
  return record.torque.size() > 1 && static_cast<double>(changes) > kNearlyEvery * static_cast<double>(record.torque.size() - 1);
}

std::size_t reading_stride(const Record& record) {
  return std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(record.encoder_period / record.step)));
}

const std::vector<double>& commands(const Record& record, std::size_t group) {
  return record.recorded_per_point > 1 ? record.recorded_torque[group] : record.motor_torque[group];
}

bool is_filtered(const Record& record) { return record.recorded_per_point > 1 && record.step > 1.5 * record.encoder_period; }

double command_step(const Record& record) { return record.step / static_cast<double>(record.recorded_per_point); }

void leave_out_beginning(Record& record, std::size_t points) {
  record.start_time = record.time(points);
  const auto cut_by = [](std::vector<double>& series, std::size_t count) {
    series.erase(series.begin(), series.begin() + static_cast<std::ptrdiff_t>(std::min(count, series.size())));
  };
  const auto cut = [&](std::vector<double>& series) { cut_by(series, points); };
  for (std::vector<double>& series : record.recorded_torque) cut_by(series, points * record.recorded_per_point);
  for (auto* groups : {&record.motor_torque, &record.shaft_speed, &record.shaft_position, &record.position_rate}) {
    for (std::vector<double>& series : *groups) cut(series);
  }
  for (std::vector<double>& series : record.acceleration) cut(series);
  cut(record.slew_angle);
}

int accelerometer_at(const sim::Sensor& sensor) {
  const auto& all = kAccelerometers<msgs::Sensors>;
  const auto at = std::find_if(all.begin(), all.end(), [&](const auto& field) { return sensor.channel == msgs::kSensorsChannel && field.field == sensor.field; });
  return at == all.end() ? -1 : static_cast<int>(at - all.begin());
}

std::vector<double> cubic_slope(const std::vector<double>& values, std::size_t half_width, double step) {
  const std::size_t count = values.size();
  std::vector<double> slope(count, 0.0);
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t reach = std::min({half_width, n, count - 1 - n});
    if (reach < 2) {
      const std::size_t low = n > 0 ? n - 1 : 0, high = std::min(count - 1, n + 1);
      if (high > low) slope[n] = (values[high] - values[low]) / (static_cast<double>(high - low) * step);
      continue;
    }
    // Normal equations of odd powers: slope = (S6 A - S4 B) / (S2 S6 - S4^2), A = sum i x_i, B = sum i^3 x_i.
    double s2 = 0.0, s4 = 0.0, s6 = 0.0, a = 0.0, b = 0.0;
    for (std::size_t k = 1; k <= reach; ++k) {
      const double i = static_cast<double>(k), square = i * i;
      const double odd = values[n + k] - values[n - k];
      s2 += 2.0 * square;
      s4 += 2.0 * square * square;
      s6 += 2.0 * square * square * square;
      a += i * odd;
      b += i * square * odd;
    }
    slope[n] = (s6 * a - s4 * b) / (s2 * s6 - s4 * s4) / step;
  }
  return slope;
}

std::vector<double> resample(const std::vector<std::int64_t>& times, const std::vector<double>& values, const Record& record, std::size_t count) {
  std::vector<double> result(count);
  std::size_t i = 0;
  for (std::size_t n = 0; n < count; ++n) {
    const double t = record.time(n) / kNanosecond;
    while (i + 2 < times.size() && static_cast<double>(times[i + 1]) <= t) ++i;
    const double t0 = static_cast<double>(times[i]), t1 = static_cast<double>(times[i + 1]);
    const double share = std::clamp((t - t0) / (t1 - t0), 0.0, 1.0);
    result[n] = values[i] + share * (values[i + 1] - values[i]);
  }
  return result;
}

std::string accelerometer_name(int accelerometer) {
  return std::string(kAccelerometers<msgs::Sensors>.at(static_cast<std::size_t>(accelerometer)).place);
}

namespace {

void take_group_count(const msgs::RunLog& run, Record& record) {
  const std::string& name = record.name;
  if (run.encoder.size() < 3) {
    throw NotAdmitted(fmt::format("{}: no ENCODER messages; without the motors' speeds nothing can be compared", name));
  }
  if (run.torque.size() < 3) {
    throw NotAdmitted(fmt::format("{}: no TORQUE messages; without the torque commands the crane cannot be followed", name));
  }
  record.group_count = run.encoder.front().group_count;
  for (const msgs::Encoder& message : run.encoder) {
    if (message.group_count != record.group_count) throw NotAdmitted(fmt::format("{}: the number of motor groups changes", name));
  }
  if (record.group_count < 1 || record.group_count > sim::kMaximumGroupCount ||
      run.torque.front().group_count != record.group_count) {
    throw NotAdmitted(fmt::format("{}: ENCODER speaks of {} motor groups, TORQUE of {}", name, record.group_count,
                                  run.torque.front().group_count));
  }
  for (const msgs::Torque& message : run.torque) {
    if (message.group_count == record.group_count) continue;
    throw NotAdmitted(fmt::format("{}: TORQUE at {:.3f} s is for {} motor groups, the crane has {}; the drive did not take it: give the part before it (slewlab cut)",
                                  name, static_cast<double>(message.simulated_time) * kNanosecond, message.group_count, record.group_count));
  }
}

// When each channel speaks [ns].
struct ChannelTimes {
  std::vector<std::int64_t> encoder, torque, sensors;
  bool has_sensors() const { return sensors.size() > 2; }
};

// The common period of a channel whose clock is even.
std::int64_t checked_period(const char* channel, const std::vector<std::int64_t>& times, Record& record) {
  const std::int64_t period = common_period(times);
  if (period <= 0) throw NotAdmitted(fmt::format("{}: {} has no even clock", record.name, channel));
  check_clock(channel, times, period, record);
  return period;
}

// The even grid of time that all series lie on. Gives the number of its points.
std::size_t lay_grid(const ChannelTimes& times, const AdmissionSettings& settings, Record& record) {
  record.encoder_period = static_cast<double>(checked_period("ENCODER", times.encoder, record)) * kNanosecond;
  check_span("TORQUE", times.torque, checked_period("TORQUE", times.torque, record), times.encoder, record);
  record.step = record.encoder_period;
  if (times.has_sensors()) {
    const std::int64_t sensor_period = checked_period("SENSORS", times.sensors, record);
    check_span("SENSORS", times.sensors, sensor_period, times.encoder, record);
    record.sensor_period = static_cast<double>(sensor_period) * kNanosecond;
    // The controller's cycle is a whole number of steps, no sensor is slower than a step.
    record.step /= std::max(1.0, std::ceil(record.step / record.sensor_period - 1e-6));
  }
  record.start_time = static_cast<double>(times.encoder.front()) * kNanosecond;
  const double duration = static_cast<double>(times.encoder.back()) * kNanosecond - record.start_time;
  if (duration < settings.shortest_record) {
    throw NotAdmitted(fmt::format("{}: only {:.2f} s long; at least {:.3g} s are needed", record.name, duration, settings.shortest_record));
  }
  return static_cast<std::size_t>(std::floor(duration / record.step + 1e-6)) + 1;
}

void take_motors(const msgs::RunLog& run, const std::vector<std::int64_t>& encoder_times, const AdmissionSettings& settings, std::size_t count,
                 Record& record) {
  const double half_width = std::max(settings.rate_half_width, record.encoder_period) / record.step;
  for (int g = 0; g < record.group_count; ++g) {
    const auto i = static_cast<std::size_t>(g);
    std::vector<double> speed, position;
    for (const msgs::Encoder& message : run.encoder) {
      speed.push_back(message.shaft_speed[i]);
      position.push_back(message.shaft_position[i]);
    }
    check_finite(record, fmt::format("shaft speed of group {}", g + 1), encoder_times, speed);
    check_finite(record, fmt::format("shaft position of group {}", g + 1), encoder_times, position);
    for (const msgs::Torque& message : run.torque) {
      if (!std::isfinite(message.motor_torque[i])) {
        throw NotAdmitted(fmt::format("{}: torque command of group {} is not a number at {:.3f} s", record.name, g + 1,
                                      static_cast<double>(message.simulated_time) * kNanosecond));
      }
    }
    record.shaft_speed[i] = resample(encoder_times, speed, record, count);
    record.shaft_position[i] = resample_position(encoder_times, position, speed, record, count);
    record.position_rate[i] =
        cubic_slope(record.shaft_position[i], std::max<std::size_t>(2, static_cast<std::size_t>(std::lround(half_width))), record.step);
    // A command holds until the next one.
    record.motor_torque[i].assign(count, 0.0);
    std::size_t k = 0;
    for (std::size_t n = 0; n < count; ++n) {
      const auto t = static_cast<std::int64_t>(std::llround(record.time(n) / kNanosecond));
      while (k + 1 < run.torque.size() && run.torque[k + 1].simulated_time <= t) ++k;
      if (run.torque[k].simulated_time <= t) record.motor_torque[i][n] = run.torque[k].motor_torque[i];
    }
  }
}

void take_sensors(const msgs::RunLog& run, const std::vector<std::int64_t>& times, std::size_t count, Record& record) {
  // [steps] by which an instant lies beside the grid.
  const auto beside_grid = [&](std::int64_t time) {
    const double steps = (static_cast<double>(time) * kNanosecond - record.start_time) / record.step;
    return std::fabs(steps - std::round(steps));
  };
  const bool on_grid = record.sensor_period < 1.5 * record.step &&
                       std::all_of(times.begin(), times.end(), [&](std::int64_t time) { return beside_grid(time) < kOnGrid; });
  if (!on_grid) record.sampled_at = times;
  const auto take = [&](auto member, std::vector<double>& into, const std::string& signal, std::vector<double>* raw, Rounding* rounding) {
    std::vector<double> values;
    for (const msgs::Sensors& message : run.sensors) values.push_back(message.*member);
    // NaN all along is how an imported log says that the machine has no such sensor.
    const bool measured = std::any_of(values.begin(), values.end(), [](double v) { return v != 0.0 && !std::isnan(v); });
    if (!measured) {
      record.remarks.push_back(fmt::format("{}: {} is not in the log", record.name, signal));
      return;
    }
    check_finite(record, signal, times, values);
    into = resample(times, values, record, count);
    if (rounding != nullptr) {
      *rounding = find_rounding(values, kAccelerationChanges, kAccelerationLevels);
      if (rounding->is_slow) {
        record.remarks.push_back(fmt::format("{}: {} was read or written down in steps of {:.3g} m/s^2, as large as most of its changes: what is smaller cannot be told",
                                             record.name, signal, rounding->step));
      }
    }
    if (raw != nullptr && !on_grid) *raw = std::move(values);
  };
  std::size_t accelerometer = 0;
  for (const auto& field : msgs::kSensorFields<msgs::Sensors>) {
    std::string signal(field.field);
    std::replace(signal.begin(), signal.end(), '_', ' ');
    if (is_acceleration(field.unit)) {
      const std::size_t i = accelerometer++;
      take(field.value, record.acceleration[i], signal, &record.sampled_acceleration[i], &record.acceleration_rounding[i]);
    } else if (field.value == &msgs::Sensors::slew_angle) {
      take(field.value, record.slew_angle, signal, nullptr, nullptr);
    }
  }
}

// [rad/s] of all groups together, for play compensation turns them against each other first: over the first moments, and the largest of any group.
struct FirstSpeed {
  double mean = 0.0, largest = 0.0;
};
FirstSpeed first_speed(const Record& record, const AdmissionSettings& settings) {
  const auto stretch = std::min(record.size(), static_cast<std::size_t>(kFirstStretch * settings.time / record.step) + 1);
  FirstSpeed speed;
  for (int g = 0; g < record.group_count; ++g) {
    const std::vector<double>& rate = record.position_rate[static_cast<std::size_t>(g)];
    for (const double one : rate) speed.largest = std::max(speed.largest, std::fabs(one));
    for (std::size_t n = 0; n < stretch; ++n) speed.mean += rate[n] / static_cast<double>(stretch) / record.group_count;
  }
  return speed;
}

// The recorder was switched on while the motors pushed the axis on its way, however slow it still was: because the lever asked for a speed, or
// as it comes to rest after a move. A run that begins with a request pushes with nothing yet; a torque that holds an axis still moves nothing.
bool begins_in_motion(const msgs::RunLog& run, const Record& record, const AdmissionSettings& settings) {
  const FirstSpeed speed = first_speed(record, settings);
  const double creeping = creeping_speed(settings);
  if (std::fabs(speed.mean) > std::max(kStanding * speed.largest, creeping)) return true;
  double largest = 0.0;
  for (std::size_t n = 0; n < record.size(); ++n) largest = std::max(largest, std::fabs(mean_torque(record, n)));
  if (std::fabs(mean_torque(record, 0)) <= kPushing * largest) return false;
  const bool is_asked = !run.operator_moves.empty() && run.operator_moves.front().speed_request != 0.0 &&
                        1e-9 * static_cast<double>(run.operator_moves.front().simulated_time) <= record.start_time;
  return is_asked || std::fabs(speed.mean) > creeping;
}

// What the controller's replay needs, as it went over the wire.
void take_wire(const msgs::RunLog& run, Record& record) {
  for (const msgs::Operator& message : run.operator_moves) {
    record.operator_moves.push_back({message.simulated_time, message.speed_request, message.emergency_stop != 0,
                                     message.acknowledge != 0});
  }
  record.encoder = run.encoder;
  record.torque = run.torque;
  record.plant_status = run.plant_status;
  std::vector<double> position, torque;  // of the first group, as the messages have them
  for (const msgs::Encoder& message : run.encoder) position.push_back(message.shaft_position[0]);
  for (const msgs::Torque& message : run.torque) torque.push_back(message.motor_torque[0]);
  record.encoder_quantum = find_rounding(position, kChanges, kPositionLevels).step;
  record.torque_rounding = find_rounding(torque, kChanges, kTorqueLevels);
}

// By how much the torques are off, as they were written down or measured.
void take_torque_noise(const msgs::RunLog& run, const AdmissionSettings& settings, Record& record) {
  const double rounded = variance_of(record.torque_rounding), scatter = torque_noise(run.encoder, run.torque);
  record.has_measured_torque = settings.is_torque_measured;
  const bool is_of_numbers = scatter < std::pow(kCommandScatter * settings.rated_torque, 2);
  record.torque_noise = settings.is_torque_measured || is_of_numbers ? std::max(scatter, rounded) : rounded;
  if (!settings.is_torque_measured && scatter > std::max(std::pow(kMeasuredNoise * settings.rated_torque, 2), kRounded * kRounded * rounded)) {
    record.remarks.push_back(fmt::format("{}: the torques scatter by {:.2g} Nm that no encoder reading tells; taken for commands of a controller that hears of more. If they were measured, say so: --measured-torque",
                                         record.name, std::sqrt(scatter)));
  }
}

void check_motors_alive(const std::vector<std::int64_t>& encoder_times, const AdmissionSettings& settings, double moving, const Record& record) {
  for (int g = 0; g < record.group_count; ++g) {
    const auto i = static_cast<std::size_t>(g);
    // What a frozen speed differs from: its own position's rate and the other groups' speeds, for one encoder may freeze as a whole. A
    // drive that counts its speed coarsely stands at one value for long and differs from nothing.
    const std::vector<double>& other = record.shaft_speed[record.group_count > 1 ? (i == 0 ? 1 : 0) : i];
    std::vector<double> disagreement(record.size());
    for (std::size_t n = 0; n < record.size(); ++n) {
      const double speed = record.shaft_speed[i][n];
      disagreement[n] = std::max(std::fabs(record.position_rate[i][n] - speed), std::fabs(other[n] - speed));
    }
    // No check for clipping: a speed counted from a coarse encoder stands at its steps, its largest among them.
    check_alive(record, fmt::format("shaft speed of group {}", g + 1), record.shaft_speed[i], disagreement, moving, settings.frozen_time);
    std::vector<double> counted;  // as the messages have it: between them a position follows its speed
    for (const msgs::Encoder& message : record.encoder) counted.push_back(message.shaft_position[i]);
    check_alive(record, fmt::format("shaft position of group {}", g + 1), resample(encoder_times, counted, record, record.size()),
                record.shaft_speed[i], moving, settings.frozen_time);
  }
}

void check_accelerometers_alive(const AdmissionSettings& settings, double moving, const Record& record) {
  for (int a = 0; a < kAccelerometerCount; ++a) {
    const auto i = static_cast<std::size_t>(a);
    if (record.acceleration[i].empty()) continue;
    const std::string signal = fmt::format("acceleration at the {}", accelerometer_name(a));
    const double step = record.acceleration_rounding[i].is_slow ? record.acceleration_rounding[i].step : 0.0;
    // As it was sampled: lines between equal samples would hold their extreme for long.
    check_clipped(record, signal, record.sampled_at.empty() ? record.acceleration[i] : record.sampled_acceleration[i], step);
    // What is coarser than the acceleration stands as if it were frozen.
    if (step == 0.0) check_alive(record, signal, record.acceleration[i], record.shaft_speed[0], moving, settings.frozen_time);
  }
}

}  // namespace

Record unchecked_record(const msgs::RunLog& run, const std::string& name, const AdmissionSettings& settings) {
  Record record;
  record.name = name;
  take_group_count(run, record);
  const ChannelTimes times{times_of(run.encoder), times_of(run.torque), times_of(run.sensors)};
  const std::size_t count = lay_grid(times, settings, record);
  take_motors(run, times.encoder, settings, count, record);
  record.begins_in_motion = record.begins_bent = begins_in_motion(run, record, settings);
  if (times.has_sensors()) {
    take_sensors(run, times.sensors, count, record);
  } else {
    record.remarks.push_back(fmt::format("{}: no SENSORS messages; with encoders and torques alone what is said of house, boom and load is a hint", name));
  }
  take_wire(run, record);
  return record;
}

Record make_record(const msgs::RunLog& run, const std::string& name, const AdmissionSettings& settings) {
  Record record = unchecked_record(run, name, settings);
  take_torque_noise(run, settings, record);
  double largest_speed = 0.0;
  for (const double speed : record.shaft_speed[0]) largest_speed = std::max(largest_speed, std::fabs(speed));
  if (largest_speed == 0.0) throw NotAdmitted(fmt::format("{}: the motors never turn", name));
  const double moving = kMoving * largest_speed;
  check_motors_alive(times_of(run.encoder), settings, moving, record);
  check_accelerometers_alive(settings, moving, record);
  check_driven(run, record, moving);
  check_units(record, settings);
  return record;
}

double effects_from(std::span<const Record> records, const Record& record) {
  constexpr double kOfAnotherClock = 10.0;  // times the longest record's length; chosen
  double first = std::numeric_limits<double>::infinity(), longest = 0.0;
  for (const Record& one : records) {
    first = std::min(first, one.start_time);
    longest = std::max(longest, one.step * static_cast<double>(one.size()));
  }
  if (std::fabs(record.start_time - first) > kOfAnotherClock * longest) return record.start_time;
  return first > longest ? first : 0.0;
}

}  // namespace slewlab::diagnosis
