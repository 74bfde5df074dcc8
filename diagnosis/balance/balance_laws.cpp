#include "diagnosis/balance/balance_laws.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slewlab::diagnosis {

namespace {

// Shares of the top speed at which friction changes its character, chosen evenly in the logarithm over what bearings and
// seals show (Stribeck speeds of a hundredth to a third of the working speed).
constexpr double kSpeedShares[] = {0.01, 0.015, 0.022, 0.033, 0.05, 0.075, 0.11, 0.16, 0.24, 0.36};
// Shares of the record's duration within which a machine warms.
constexpr double kWarmingShares[] = {0.1, 0.2, 0.4, 1.0};
// What a lag withholds is no more than there is; between two of the lags that are tried it seems so.
constexpr double kMostWithheld = 1.3;
// A rotary axis that turns less than this says nothing of how its load depends on the angle by sine and cosine.
constexpr double kLeastTurn = 0.25;  // [rad] half range

}  // namespace

std::string words_of(LawFamily family) {
  switch (family) {
    case LawFamily::friction: return "friction";
    case LawFamily::load: return "a load";
    case LawFamily::drive: return "a drive that acts late";
  }
  return "";
}

std::vector<BalanceLaw> balance_laws(const BalanceScales& scales) {
  const double resolved = scales.resolved_speed, top = scales.top_speed;
  const auto direction = [resolved](const LawMoment& m) {
    return m.is_exact ? static_cast<double>((m.speed > 0.0) - (m.speed < 0.0)) : std::tanh(m.speed / resolved);
  };
  std::vector<BalanceLaw> laws;
  const auto along_speed = [](const LawMoment& m) { return m.speed; };
  const auto constant = [](const LawMoment&) { return 1.0; };
  if (scales.direction == 0) {
    laws.push_back({"dry", LawFamily::friction, "dry friction", {{0.0, {direction}}}, true, "", true});
    // No two directions are quite alike: half their difference goes with |v|.
    laws.push_back({"viscous", LawFamily::friction, "viscous friction", {{.columns = {along_speed, [](const LawMoment& m) { return std::fabs(m.speed); }}, .is_leaning = true}}, true, "", true});
    // With dry friction this is dry friction with a value of its own in each direction: the same motion.
    laws.push_back({"offset", LawFamily::load, "constant torque", {{0.0, {constant}}}, false, "", true});
  } else {
    laws.push_back({"dry", LawFamily::friction, "dry friction or a constant torque against the motion", {{0.0, {direction}}}, true, "", true, "offset"});
    laws.push_back({"viscous", LawFamily::friction, "viscous friction", {{0.0, {along_speed}}}, true, "", true});
    LawShape helping{.columns = {constant}};
    (scales.direction > 0 ? helping.largest : helping.least) = 0.0;
    laws.push_back({"offset", LawFamily::load, "constant torque along the motion", {helping}, false, "", true, "dry"});
  }
  BalanceLaw stribeck{"stribeck", LawFamily::friction, "friction that falls from its breakaway value", {}, true, "", false};
  BalanceLaw rising{"rising", LawFamily::friction, "friction that rises from low speed and flattens", {}, true, "", false};
  for (const double share : kSpeedShares) {
    const double speed = share * top;
    if (speed < 2.0 * resolved) continue;  // cannot be told from dry friction
    stribeck.shapes.push_back({speed, {[direction, speed](const LawMoment& m) {
                                 return direction(m) * std::exp(-(m.speed / speed) * (m.speed / speed));
                               }}});
    rising.shapes.push_back({speed, {[direction, speed](const LawMoment& m) {
                               return direction(m) * (1.0 - std::exp(-std::fabs(m.speed) / speed));
                             }}});
  }
  if (!stribeck.shapes.empty()) laws.push_back(std::move(stribeck));
  if (!rising.shapes.empty()) laws.push_back(std::move(rising));
  laws.push_back({"quadratic", LawFamily::friction, "drag with the square of the speed",
                  {{0.0, {[top](const LawMoment& m) { return m.speed * std::fabs(m.speed) / top; }}}}, true, "", false});
  const double middle = scales.middle_position, half = scales.half_range;
  if (half > 0.0) {
    const auto along = [middle, half](const LawMoment& m) { return (m.position - middle) / half; };
    laws.push_back({"position_friction", LawFamily::friction, "friction that depends on the position",
                    {{0.0, {[=](const LawMoment& m) { return direction(m) * along(m); },
                            [=](const LawMoment& m) { return direction(m) * along(m) * along(m); }}}}, false, "", false});
    if (scales.is_rotary && half > kLeastTurn) {
      laws.push_back({"gravity", LawFamily::load, "gravity on a tilted axis",
                      {{0.0, {[](const LawMoment& m) { return std::sin(m.position); }, [](const LawMoment& m) { return std::cos(m.position); }}}},
                      false, "", false});
    }
    laws.push_back({"spring", LawFamily::load, "load that changes with the position", {{0.0, {[=](const LawMoment& m) { return along(m); }}}}, false, "", false});
  }
  BalanceLaw warming{"warming", LawFamily::friction, "friction that falls as the machine warms", {}, true, "", false};
  for (const double share : kWarmingShares) {
    const double time = share * scales.duration;
    warming.shapes.push_back({time, {[direction, time](const LawMoment& m) { return direction(m) * std::exp(-m.time / time); }}});
  }
  laws.push_back(std::move(warming));
  // What comes late withholds; the size is the lag, or the delay, where the shape's time is. Of slow efforts both are the same.
  BalanceLaw lag{"lag", LawFamily::drive, "torque that comes late", {}, true, "", false, "delay"};
  BalanceLaw delay{"delay", LawFamily::drive, "torque that comes a fixed time late", {}, true, "", false, "lag"};
  for (std::size_t k = 0; k < scales.lateness.size(); ++k) {
    const auto [time, is_delay] = scales.lateness[k];
    (is_delay ? delay : lag).shapes.push_back({time, {[k](const LawMoment& m) { return m.late == nullptr ? 0.0 : m.late[k]; }}, kMostWithheld * time, false, static_cast<int>(k)});
  }
  for (BalanceLaw* law : {&lag, &delay}) {
    if (!law->shapes.empty()) laws.push_back(std::move(*law));
  }
  return laws;
}

std::vector<std::string> balance_law_names() {
  // Fast enough, far enough and known well enough for every law.
  const BalanceScales all{.top_speed = 1.0, .resolved_speed = 0.0, .duration = 1.0, .middle_position = 0.0, .half_range = 1.0, .lateness = {{1.0, false}, {1.0, true}}};
  std::vector<std::string> names;
  for (const bool is_rotary : {true, false}) {
    BalanceScales scales = all;
    scales.is_rotary = is_rotary;
    for (const BalanceLaw& law : balance_laws(scales)) {
      if (std::find(names.begin(), names.end(), law.name) == names.end()) names.push_back(law.name);
    }
  }
  return names;
}

std::vector<double> law_column(const BalanceRecord& record, const std::function<double(const LawMoment&)>& value) {
  std::vector<double> along(record.motion.time.size());
  for (std::size_t n = 0; n < along.size(); ++n) {
    const double* late = record.motion.late_count > 0 ? &record.motion.late[n * record.motion.late_count] : nullptr;
    along[n] = value({record.motion.time[n], record.motion.position[n], record.motion.speed[n], record.motion.effort_rate[n], late});
  }
  return balance_smoothed(along, record.half_window);
}

}  // namespace slewlab::diagnosis
