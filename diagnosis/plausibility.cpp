#include "diagnosis/plausibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "diagnosis/recorded_drive.h"
#include "sim/model/crane.h"
#include "sim/model/drive_line.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kGross = 3.0;        // factors within it may be a crane's own
constexpr double kAlmost = 0.9;       // of kGross, for what is known to be met
constexpr double kExchanged = 2.0;    // by how much less of the need's power another group's torque leaves than the own one: of groups that are not exchanged it leaves more; chosen
constexpr double kClose = 0.9;        // correlation from which a factor between torques, or the ways of two groups, means anything
constexpr double kManyPlays = 5.0;    // that a group has turned, from which it turns with the house
// By which a cycle's turn may differ from the one before, of the turn at top speed in the characteristic time, and so many times what the
// machine's acceleration makes of it in a cycle: a motor that crosses the play alone makes a tenth of that.
constexpr double kJump = 0.0036, kJumpOfAcceleration = 36.0;
constexpr double kAtLimit = 1.0 - 1e-9;  // share of the largest size, from which a value stands at it
constexpr double kLevelStands = 0.1;  // of the shortest stand that is looked at, from which another one at the same size is no chance; chosen
constexpr double kOneTurnsBy = 0.5;   // the same of one group alone
constexpr double kStands = 0.05;      // of top speed, below which a machine stands while its boom and load swing on; chosen, as a record begins in motion
constexpr double kTurnsBy = 0.15;     // share of the torques' range by which what is needed may change meanwhile
constexpr double kLeavesBy = 0.5;     // of that, within which a command leaves a limit that it meets once; chosen

// Least-squares slope of y on x, and the correlation.
struct Fit {
  double slope, correlation;
};
Fit fit_line(const std::vector<double>& x, const std::vector<double>& y) {
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t n = 0; n < x.size(); ++n) {
    xx += x[n] * x[n];
    xy += x[n] * y[n];
    yy += y[n] * y[n];
  }
  if (xx == 0.0 || yy == 0.0) return {0.0, 0.0};
  return {xy / xx, xy / std::sqrt(xx * yy)};
}

// Low-passed derivative of a series, for sign and unit checks: mean slope over `width` samples.
std::vector<double> smooth_slope(const std::vector<double>& values, std::size_t width, double step) {
  std::vector<double> slope(values.size(), 0.0);
  for (std::size_t n = width; n + width < values.size(); ++n) {
    slope[n] = (values[n + width] - values[n - width]) / (2.0 * static_cast<double>(width) * step);
  }
  return slope;
}

std::vector<double> smooth(const std::vector<double>& values, std::size_t width) {
  std::vector<double> result(values.size(), 0.0);
  double sum = 0.0;
  for (std::size_t n = 0; n < values.size(); ++n) {
    sum += values[n];
    if (n >= 2 * width + 1) sum -= values[n - 2 * width - 1];
    if (n >= width) result[n - width] = sum / static_cast<double>(2 * width + 1);
  }
  return result;
}

// Without its first and last `edge` values, which smoothing has spoilt, and without its mean: a sensor's offset.
std::vector<double> centred(const std::vector<double>& values, std::size_t edge) {
  if (values.size() <= 2 * edge) return {};
  std::vector<double> result(values.begin() + static_cast<std::ptrdiff_t>(edge), values.end() - static_cast<std::ptrdiff_t>(edge));
  const double mean = std::accumulate(result.begin(), result.end(), 0.0) / static_cast<double>(result.size());
  for (double& value : result) value -= mean;
  return result;
}

// What factor between two signals that should be equal would bring them together, in words.
struct Known {
  double factor;
  std::string words;
};
std::string explain_factor(double factor, const std::vector<Known>& known_factors) {
  const double size = std::fabs(factor);
  std::string words;
  for (const Known& known : known_factors) {
    const bool is_one = known.factor > 0.75 && known.factor < 1.33;  // of a machine with one motor, or without gears
    if (!is_one && size > 0.75 * known.factor && size < 1.33 * known.factor) words = known.words;
  }
  if (factor < 0) words += words.empty() ? "its sign is turned" : ", and its sign is turned";
  return words;
}

// Of a speed over the rate of its position.
std::vector<Known> speed_factors(double total_ratio) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  return {{60.0 / kTurn, "the speed looks like revolutions per minute; rad/s is wanted"},
          {360.0 / kTurn, "the speed looks like degrees per second; rad/s is wanted"},
          {kTurn / 360.0, "the position looks like degrees; radians are wanted"},
          {1.0 / kTurn, "the speed looks like revolutions per second; rad/s is wanted"},
          {kTurn, "the position looks like revolutions; radians are wanted"},
          {total_ratio, "the position looks like the slew axis's; the motor shaft's is wanted"},
          {1.0 / total_ratio, "the speed looks like the slew axis's; the motor shaft's is wanted"}};
}

const std::vector<Known> kAccelerationFactors{{1.0 / 9.81, "it looks like multiples of g; m/s^2 are wanted"},
                                              {9.81, "it looks like m/s^2 that were multiplied by g"},
                                              {1000.0, "it looks like mm/s^2; m/s^2 are wanted"},
                                              {1000.0 / 9.81, "it looks like thousandths of g; m/s^2 are wanted"}};

// The largest size of a series where it is a limit; infinite where it is none. A limit that nobody knows is met again and again, of either sign, a
// frozen value stands once.
double limit_of(const std::vector<double>& values) {
  constexpr std::size_t kStand = 3;  // values in a row
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::fabs(value));
  int stands = 0;
  std::size_t length = 0;
  for (std::size_t n = 0; n < values.size(); ++n) {
    const bool is_at_limit = std::fabs(values[n]) >= kAtLimit * largest;
    length = !is_at_limit ? 0 : length > 0 && values[n] * values[n - 1] > 0.0 ? length + 1 : 1;
    if (length == kStand) ++stands;
  }
  return stands > 1 ? largest : std::numeric_limits<double>::infinity();
}

// Whether some series stands at this size, of either sign, for `least` values in a row outside [begin, end): a level to which the controller comes back, as that
// at which a group presses while another one drives.
bool stands_elsewhere(const std::vector<const std::vector<double>*>& commands, double size, std::size_t begin, std::size_t end, std::size_t least) {
  for (const std::vector<double>* values : commands) {
    std::size_t length = 0;
    for (std::size_t n = 0; n < values->size(); ++n) {
      const bool is_there = (n < begin || n >= end) && std::fabs(std::fabs((*values)[n]) - size) <= (1.0 - kAtLimit) * size;
      length = is_there ? length + 1 : 0;
      if (length >= least) return true;
    }
  }
  return false;
}

// A command that stands still while what is needed, slowly, changes by a share of its range; but where it stands at a limit, the rated torque among them, or at a
// level of its controller, which `commands` have. A limit that is met once is the largest of the record, and left without a jump: a frozen command jumps to what the controller asks for by then. What
// is needed is looked at inside the stand, where nothing of the time before and after is smoothed into it.
void check_not_frozen(const Record& record, const std::string& name, const std::vector<double>& recorded, const std::vector<const std::vector<double>*>& commands,
                      const std::vector<double>& needed, double share, const AdmissionSettings& settings) {
  const auto slow = static_cast<std::size_t>(std::lround(settings.slow / record.step));
  const auto limit = static_cast<std::size_t>(settings.frozen_time / record.step);
  if (recorded.size() <= 2 * slow) return;
  const double torque_limit = limit_of(recorded);
  const std::vector<double> smoothed = smooth(needed, slow);
  const auto at = [&](std::size_t n) { return smoothed.begin() + static_cast<std::ptrdiff_t>(n); };
  const auto [lowest, highest] = std::minmax_element(at(slow), at(recorded.size() - slow));
  const double turns_by = share * (*highest - *lowest);
  const double largest = std::transform_reduce(recorded.begin(), recorded.end(), 0.0, [](double a, double b) { return std::max(a, b); }, [](double torque) { return std::fabs(torque); });
  const auto is_met_once = [&](std::size_t begin, std::size_t end) {
    return end < recorded.size() && std::fabs(recorded[begin]) >= kAtLimit * largest && std::fabs(recorded[end] - recorded[begin]) <= kLeavesBy * turns_by;
  };
  for (std::size_t begin = 0, n = 1; n <= recorded.size(); ++n) {
    if (n < recorded.size() && recorded[n] == recorded[begin]) continue;
    const double torque = std::fabs(recorded[begin]);
    const bool is_limited = torque >= kAtLimit * torque_limit || std::fabs(torque - settings.rated_torque) <= (1.0 - kAtLimit) * settings.rated_torque;
    const auto is_level = [&] { return stands_elsewhere(commands, torque, begin, n, static_cast<std::size_t>(std::ceil(kLevelStands * static_cast<double>(limit)))); };
    if (n - begin > limit && recorded[begin] != 0.0 && !is_limited && !is_met_once(begin, n) && !is_level()) {
      const auto [low, high] = std::minmax_element(at(begin + slow), at(n - slow));
      if (*high - *low > turns_by) {
        throw NotAdmitted(fmt::format("{}: {} is frozen at {:.6g} Nm from {:.3f} s to {:.3f} s, where the nominal crane needs {:.3g} to {:.3g} Nm; cut the "
                                      "log there, or record the commands anew",
                                      record.name, name, recorded[begin], record.time(begin), record.time(n - 1), *low, *high));
      }
    }
    begin = n;
  }
}

// Torques of two groups in each other's columns: what each of them needs, slowly, goes with the other one's command.
void check_not_exchanged(const Record& record, const std::array<std::vector<double>, sim::kMaximumGroupCount>& needed_of, std::size_t slow) {
  std::vector<std::vector<double>> needed, recorded;
  for (std::size_t i = 0; i < static_cast<std::size_t>(record.group_count); ++i) {
    needed.push_back(centred(smooth(needed_of[i], slow), slow));
    recorded.push_back(centred(smooth(record.motor_torque[i], slow), slow));
  }
  const auto left = [&](std::size_t need, std::size_t command) {
    double square = 0.0;
    for (std::size_t n = 0; n < needed[need].size(); ++n) square += (needed[need][n] - recorded[command][n]) * (needed[need][n] - recorded[command][n]);
    return square;
  };
  for (std::size_t i = 0; i < needed.size(); ++i) {
    for (std::size_t k = i + 1; k < needed.size(); ++k) {
      if (kExchanged * (left(i, k) + left(k, i)) > left(i, i) + left(k, k)) continue;
      throw NotAdmitted(fmt::format("{}: what the nominal crane needs of group {} for this motion goes with the torque commands of group {}, and the other way round: the two columns are exchanged; "
                                    "check which motors each column belongs to, of torques, positions and speeds",
                                    record.name, i + 1, k + 1));
    }
  }
}

// A counter that is set anew: the position's rate changes from one message to the next by more than any motor does. What a row has too much and the next one too little was read at another time
// than the row says.
void check_jumps(const Record& record, std::size_t group, const AdmissionSettings& settings) {
  const double cycle = record.encoder_period / settings.time;
  const double most = settings.turn * std::max(kJump, kJumpOfAcceleration * cycle * cycle) + 2.0 * record.encoder_quantum;
  const auto turned_until = [&](std::size_t n) {
    const auto cycles = static_cast<double>(record.encoder[n].simulated_time - record.encoder[n - 1].simulated_time) * 1e-9 / record.encoder_period;
    return (record.encoder[n].shaft_position[group] - record.encoder[n - 1].shaft_position[group]) / cycles;
  };
  double before = 0.0;
  for (std::size_t n = 1; n < record.encoder.size(); ++n) {
    const double turned = turned_until(n);
    if (n > 1 && std::fabs(turned - before) > most) {
      const double next = n + 1 < record.encoder.size() ? turned_until(n + 1) : turned;
      const bool is_given_back = std::fabs(next - before) > 0.5 * most && std::fabs(turned + next - 2.0 * before) < most;
      throw NotAdmitted(fmt::format("{}: shaft position of group {} jumps by {:.4g} at {:.3f} s, after {:.2g} in the cycle before; {}", record.name, group + 1, turned,
                                    static_cast<double>(record.encoder[n].simulated_time) * 1e-9, before,
                                    is_given_back ? fmt::format("the next cycle has {:.2g}, so this row was read later or earlier than its time says: record when each row was read", next)
                                                  : "a counter that was set anew? Cut the log there, or add what it lost"));
    }
    before = turned;
  }
}

double largest_speed(const Record& record) {
  double largest = 0.0;
  for (int g = 0; g < record.group_count; ++g) {
    for (const double speed : record.shaft_speed[static_cast<std::size_t>(g)]) largest = std::max(largest, std::fabs(speed));
  }
  return largest;
}

}  // namespace

void check_units(const Record& record, const AdmissionSettings& settings) {
  const auto width = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(settings.speed_window / record.step)));
  for (int g = 0; g < record.group_count; ++g) {
    const auto i = static_cast<std::size_t>(g);
    const std::vector<double> derived = smooth_slope(record.shaft_position[i], width, record.step);
    const std::vector<double> speed = smooth(record.shaft_speed[i], width);
    const Fit fit = fit_line(derived, speed);
    const std::string words = explain_factor(fit.slope, speed_factors(settings.total_ratio));
    // A position in another unit goes farther than any motor does in a cycle, and its counter has not been set anew.
    if (words.empty() || std::fabs(fit.correlation) < kClose) check_jumps(record, i, settings);
    if (fit.correlation != 0.0 && (std::fabs(fit.correlation) < 0.8 || fit.slope < 0.8 || fit.slope > 1.25)) {
      throw NotAdmitted(fmt::format("{}: shaft speed of group {} is {:.4g} times the rate of its position (correlation "
                                    "{:.2f}){}{}; check sign, unit and gear ratio of both columns",
                                    record.name, g + 1, fit.slope, fit.correlation, words.empty() ? "" : ": ", words));
    }
  }
  // Level accelerations of the house follow the motors' at low frequency: a = r_sensor * theta'' / ratio.
  const auto slow = static_cast<std::size_t>(std::lround(settings.slow / record.step));
  std::vector<double> mean_speed(record.size(), 0.0);
  for (int g = 0; g < record.group_count; ++g) {
    for (std::size_t n = 0; n < record.size(); ++n) {
      mean_speed[n] += record.shaft_speed[static_cast<std::size_t>(g)][n] / (record.group_count * settings.total_ratio);
    }
  }
  const std::vector<double> angular = smooth(smooth_slope(mean_speed, slow, record.step), slow);
  for (int a = 0; a < kAccelerometerCount; ++a) {
    const auto i = static_cast<std::size_t>(a);
    if (record.acceleration[i].empty() || settings.radius[i] <= 0.0) continue;
    const std::vector<double> level = smooth(smooth(record.acceleration[i], slow), slow);
    const Fit fit = fit_line(centred(angular, 2 * slow), centred(level, 2 * slow));
    const double factor = fit.slope / settings.radius[i];
    // A flexible boom swings about the level value, so only gross factors and signs are told from it. What stands on the stiff house
    // must follow closely before it is refused: near the axis a rolling vessel's gravity is larger than any slewing.
    const double close = a == accelerometer_at("house") || a == accelerometer_at("pivot") ? 0.97 : 0.7;
    if (std::fabs(fit.correlation) > close && (factor < 1.0 / kGross || factor > kGross)) {
      const double largest = largest_speed(record), top = settings.turn / settings.time;
      if (largest < kStands * top) {
        throw NotAdmitted(fmt::format("{}: the crane stands, and boom and load swing on: its motors turn with {:.3g} rad/s at most, of {:.3g} at top speed, and the acceleration at "
                                      "the {} is {:.3g} times what that gives; record a move",
                                      record.name, largest, top, accelerometer_name(a), factor));
      }
      const std::string words = explain_factor(factor, kAccelerationFactors);
      throw NotAdmitted(fmt::format("{}: acceleration at the {} is {:.3g} times what the motors' speed and its radius "
                                    "of {:.1f} m give{}{}; check sign, unit and place of the sensor",
                                    record.name, accelerometer_name(a), factor, settings.radius[i],
                                    words.empty() ? "" : ": ", words));
    }
  }
  double largest = 0.0;
  for (int g = 0; g < record.group_count; ++g) {
    for (const double torque : record.motor_torque[static_cast<std::size_t>(g)]) largest = std::max(largest, std::fabs(torque));
  }
  if (largest > 5.0 * settings.rated_torque) {
    throw NotAdmitted(fmt::format("{}: torque commands reach {:.4g} where one motor's rated torque is {:.4g} Nm; Nm per "
                                  "motor on the fast axis are wanted, not {}",
                                  record.name, largest, settings.rated_torque,
                                  largest > 50.0 * settings.rated_torque ? "torques on the slew axis" : "sums over a group"));
  }
}

void check_groups(const Record& record, const sim::CraneParameters& nominal) {
  // All turn one house: what they differ by is play and windup, and a crane that turns goes many times as far.
  const double play = 2.0 * sim::gear_contact(nominal).half_play * sim::total_ratio(nominal.drive);
  const auto turned = [&](std::size_t group) {
    std::vector<double> way = record.shaft_position[group];
    for (double& one : way) one -= record.shaft_position[group][0];
    return way;
  };
  const auto reach = [](const std::vector<double>& way) {
    const auto [low, high] = std::minmax_element(way.begin(), way.end());
    return *high - *low;
  };
  const std::vector<double> first = turned(0);
  for (int g = 1; g < record.group_count; ++g) {
    const std::vector<double> other = turned(static_cast<std::size_t>(g));
    if (std::min(reach(first), reach(other)) < kManyPlays * play) continue;
    const Fit fit = fit_line(first, other);
    if (fit.correlation > -kClose) continue;
    throw NotAdmitted(fmt::format("{}: group {} turns against group 1 ({:.3g} times its way, correlation {:.2f}), though both turn one house; check the "
                                  "signs of its positions, speeds and torques",
                                  record.name, g + 1, fit.slope, fit.correlation));
  }
}

void check_torques(const Record& record, const Shadow& follower, const sim::MachineSettings& nominal, const AdmissionSettings& settings) {
  // Of one motor, the mean of all groups: the gears carry torque from one to the other.
  std::vector<double> recorded(record.size(), 0.0), needed(record.size(), 0.0);
  std::array<std::vector<double>, sim::kMaximumGroupCount> needed_of;  // each group
  for (std::vector<double>& one : needed_of) one.resize(record.size());
  RecordedDrive drive(record, nominal.drive_protection);
  for (std::size_t n = 0; n < record.size(); ++n) {
    const sim::DriveCommand delivered = drive.next();
    for (int g = 0; g < record.group_count; ++g) {
      const auto i = static_cast<std::size_t>(g);
      needed_of[i][n] = delivered.motor_torque[i] + follower.missing_torque[i][n];
      recorded[n] += delivered.motor_torque[i] / record.group_count;
      needed[n] += needed_of[i][n] / record.group_count;
    }
  }
  const auto slow = static_cast<std::size_t>(std::lround(settings.slow / record.step));
  const std::vector<double> slow_recorded = smooth(recorded, slow), slow_needed = smooth(needed, slow);
  const Fit fit = fit_line(slow_needed, slow_recorded);
  // A factor of a known slip is one a little below as well: of three motors in a group.
  if (std::fabs(fit.correlation) > kClose && (fit.slope < 1.0 / kGross || fit.slope > kAlmost * kGross)) {
    const int motors = nominal.crane.drive.motors_per_group, all_motors = motors * nominal.crane.drive.group_count;
    const double ratio = sim::total_ratio(nominal.crane.drive);
    const std::string words = explain_factor(fit.slope, {{static_cast<double>(motors), fmt::format("it looks like the sum over a group's {} motors", motors)},
                                                         {static_cast<double>(all_motors), fmt::format("it looks like the sum over all {} motors", all_motors)},
                                                         {ratio, "it looks like the torque on the slew axis"},
                                                         {all_motors * ratio, "it looks like the sum over all motors on the slew axis"},
                                                         {0.001, "it looks like kN m"},
                                                         {0.01, "it looks like a share of the rated torque"}});
    const bool is_gross = fit.slope < 1.0 / kGross || fit.slope > kGross;
    if (is_gross || !words.empty()) throw NotAdmitted(fmt::format("{}: torque commands are {:.3g} times what the nominal crane needs for this motion (correlation {:.2f}){}{}; Nm per "
                                  "motor on the fast axis are wanted: check sign and unit, or whether this is another crane than the nominal one",
                                  record.name, fit.slope, fit.correlation, words.empty() ? "" : ": ", words));
  }
  for (int g = 0; g < record.group_count && record.group_count > 1; ++g) {
    const auto i = static_cast<std::size_t>(g);
    const Fit of_group = fit_line(smooth(needed_of[i], slow), smooth(record.motor_torque[i], slow));
    if (of_group.correlation > -kClose) continue;
    throw NotAdmitted(fmt::format("{}: torque commands of group {} are {:.3g} times what the nominal crane needs of it for this motion (correlation {:.2f}): "
                                  "its sign is turned; check the sign of that column",
                                  record.name, g + 1, of_group.slope, of_group.correlation));
  }
  check_not_exchanged(record, needed_of, slow);
  // All groups together, and each alone, where two cranes may share the torque otherwise.
  check_not_frozen(record, "the torque command, mean of the groups,", recorded, {&recorded}, needed, kTurnsBy, settings);
  std::vector<const std::vector<double>*> commands;
  for (int g = 0; g < record.group_count; ++g) commands.push_back(&record.motor_torque[static_cast<std::size_t>(g)]);
  for (int g = 0; g < record.group_count && record.group_count > 1; ++g) {
    const auto i = static_cast<std::size_t>(g);
    check_not_frozen(record, fmt::format("the torque command of group {}", g + 1), record.motor_torque[i], commands, needed_of[i], kOneTurnsBy, settings);
  }
}

}  // namespace slewlab::diagnosis
