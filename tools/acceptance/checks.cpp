#include "tools/acceptance/checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "common/xml_text.h"
#include "sim/drive/drive_fault.h"
#include "tools/acceptance/dead_time.h"

namespace slewlab::tools {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;
constexpr double kPercent = 100.0;
constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr auto kRunning = static_cast<std::int8_t>(sim::DriveState::running);
constexpr auto kTripped = static_cast<std::int8_t>(sim::DriveState::tripped);  // from here on: tripped, braked
constexpr double kForever = std::numeric_limits<double>::infinity();

double seconds(std::int64_t nanoseconds) { return static_cast<double>(nanoseconds) / kNanosecondsPerSecond; }

struct Sample {
  double time = 0.0;   // [s]
  double value = 0.0;
};

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

// The names of docs/wire.md, as words.
std::string in_words(std::int8_t cause) {
  std::string text = sim::name_of(static_cast<sim::DriveFault>(cause));
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

// What the operator asks for from `begin` until `end`.
struct Stretch {
  double begin = 0.0;   // [s]
  double end = 0.0;     // [s]
  double target = 0.0;  // [-] of top speed
  bool emergency = false;
};

// The run as the checks look at it.
struct View {
  std::vector<Sample> speed;   // [-] of top speed
  std::vector<Sample> angle;   // [rad] slewed, by the encoders
  std::vector<Stretch> stretches;
  double stop = kForever;      // [s] of the emergency stop
  double trip = kForever;      // [s] from which on the drive had tripped
  std::string trip_cause;      // in words
  double recovered = kForever;    // [s] when it ran again behind that, acknowledged
  double first_fault = kForever;  // [s] on purpose
};

double end_of(const View& view) { return std::min({view.trip, view.first_fault, view.speed.back().time}); }

View view_of(const msgs::RunLog& run, const AcceptanceLimits& limits, const AcceptedMachine& machine) {
  View view;
  view.first_fault = machine.first_fault.value_or(kForever);
  double last_not_running = kForever;
  for (const msgs::PlantStatus& status : run.plant_status) {
    const double time = seconds(status.simulated_time);
    const bool dated = status.trip_time >= 0 && status.trip_time <= status.simulated_time;
    // A drive that holds its brakes without a cause has not tripped. One that has recovered since shows its trip's time alone.
    const bool trips = status.drive_state >= kTripped && status.trip_cause != 0;
    if (std::isinf(view.trip) && (trips || dated)) {
      view.trip = dated ? seconds(status.trip_time) : time;
      view.trip_cause = trips ? in_words(status.trip_cause) : "unknown, it has recovered since";
      last_not_running = view.trip;
    }
    if (std::isinf(view.trip) || std::isfinite(view.recovered)) continue;
    if (status.drive_state == kRunning) {
      view.recovered = last_not_running;  // at the earliest
    } else {
      last_not_running = time;
    }
  }
  for (const msgs::Encoder& encoder : run.encoder) {
    view.speed.push_back({seconds(encoder.simulated_time), mean(encoder.shaft_speed) / machine.total_ratio / limits.top_speed});
    view.angle.push_back({seconds(encoder.simulated_time), mean(encoder.shaft_position) / machine.total_ratio});
  }
  if (view.speed.empty()) return view;
  Stretch now{view.speed.front().time, view.speed.back().time, 0.0, false};
  bool latched = false;  // only an acknowledgement at rest ends an emergency stop
  for (const msgs::Operator& move : run.operator_moves) {
    const double time = seconds(move.simulated_time);
    if (move.emergency_stop) {
      view.stop = std::min(view.stop, time);
      latched = true;
    } else if (move.acknowledge && move.speed_request == 0.0) {
      latched = false;
    }
    const double target = latched ? 0.0 : std::clamp(move.speed_request, -1.0, 1.0);
    if (target == now.target && latched == now.emergency) continue;
    if (time > now.begin) {
      view.stretches.push_back(now);
      view.stretches.back().end = time;
    }
    now.begin = time;
    now.target = target;
    now.emergency = latched;
  }
  view.stretches.push_back(now);
  for (Stretch& stretch : view.stretches) stretch.end = std::min(stretch.end, end_of(view));
  std::erase_if(view.stretches, [](const Stretch& stretch) { return stretch.end <= stretch.begin; });
  return view;
}

double value_at(const std::vector<Sample>& samples, double time) {
  const auto at = std::lower_bound(samples.begin(), samples.end(), time,
                                   [](const Sample& sample, double t) { return sample.time < t; });
  return at == samples.end() ? samples.back().value : at->value;
}

// The largest of `size(value)` from `begin` until `end`.
template <class Size>
Sample worst(const std::vector<Sample>& samples, double begin, double end, Size size) {
  Sample result{begin, -kForever};
  for (const Sample& sample : samples) {
    if (sample.time < begin || sample.time >= end) continue;
    const double value = size(sample.value);
    if (value > result.value || !std::isfinite(value)) result = {sample.time, std::isfinite(value) ? value : kForever};
  }
  return result;
}

// [s] from `begin` until the speed stays within the band around the target up to `end`; infinite if it never does.
double time_to_settle(const View& view, const Stretch& stretch, double band) {
  double left = stretch.begin;  // when it was last outside
  double last = stretch.begin;
  for (const Sample& sample : view.speed) {
    if (sample.time < stretch.begin || sample.time >= stretch.end) continue;
    last = sample.time;
    if (!(std::abs(sample.value - stretch.target) <= band)) left = sample.time;
  }
  return left >= last && last > stretch.begin ? kForever : left - stretch.begin;
}

CheckResult not_applicable(const char* name, const char* why) {
  CheckResult result;
  result.name = name;
  result.reason = why;
  return result;
}

// As a sentence has it: m/s² of m/s^2.
std::string printed(std::string unit) {
  for (std::size_t at = unit.find("^2"); at != std::string::npos; at = unit.find("^2")) unit.replace(at, 2, "²");
  return unit;
}

// `scale` from SI to the unit that people read.
CheckResult at_most(const char* name, Sample measured, double limit, double scale, const char* unit,
                    const std::string& what) {
  if (measured.value == -kForever) return not_applicable(name, "the log holds nothing of that time");
  CheckResult result;
  result.name = name;
  result.verdict = measured.value <= limit ? Verdict::pass : Verdict::fail;
  result.measured = measured.value * scale;
  result.limit = limit * scale;
  result.unit = unit;
  result.time = measured.time;
  result.reason = fmt::format("{}: {:.3g} {}, {} {:.3g} {}, at {:.2f} s", what, result.measured, printed(unit),
                              result.verdict == Verdict::pass ? "allowed" : "more than the allowed", result.limit, printed(unit),
                              measured.time);
  return result;
}

class Checks {
 public:
  Checks(const msgs::RunLog& run, const AcceptanceLimits& limits, const AcceptedMachine& machine)
      : run_(run), limits_(limits), machine_(machine), view_(view_of(run, limits, machine)) {}

  std::vector<CheckResult> all() {
    if (view_.speed.empty()) {
      CheckResult none;
      none.name = "log";
      none.verdict = Verdict::fail;
      none.reason = "there is no ENCODER in the log: nothing to judge";
      return {none};
    }
    direction();
    overshoot();
    settling();
    play_crossings();
    play_offset();
    sidelead();
    torque_share();
    emergency_stop();
    drive();
    dead_time();
    return std::move(results_);
  }

 private:
  bool stopped() const { return view_.stop <= end_of(view_); }
  double before_stop() const { return std::min(view_.stop, end_of(view_)); }
  void add(CheckResult result) { results_.push_back(std::move(result)); }
  double first_request() const {
    const auto asked = std::find_if(view_.stretches.begin(), view_.stretches.end(),
                                    [](const Stretch& each) { return each.target != 0.0; });
    return asked == view_.stretches.end() ? kForever : asked->begin;
  }
  double band() const { return limits_.settled_within; }

  void direction() {
    if (!limits_.wrong_way) return;
    Sample most{0.0, -kForever};
    for (const Stretch& stretch : view_.stretches) {
      if (stretch.target == 0.0) continue;
      const double sign = stretch.target > 0.0 ? 1.0 : -1.0;
      if (sign * value_at(view_.speed, stretch.begin) < -band()) continue;  // a reversal under way
      const Sample against = worst(view_.speed, stretch.begin, stretch.end, [&](double v) { return -sign * v; });
      if (against.value > most.value) most = against;
    }
    if (most.value == -kForever) return add(not_applicable("direction", "nothing was asked for"));
    most.value = std::max(0.0, most.value);
    add(at_most("direction", most, *limits_.wrong_way, kPercent, "% of top speed", "speed against the asked direction"));
  }

  Sample past_target(const Stretch& stretch) const {
    const double side = stretch.target - value_at(view_.speed, stretch.begin);
    if (side == 0.0) return {stretch.begin, 0.0};
    const double sign = side > 0.0 ? 1.0 : -1.0;
    return worst(view_.speed, stretch.begin, stretch.end, [&](double v) { return sign * (v - stretch.target); });
  }

  void overshoot() {
    if (!limits_.overshoot) return;
    Sample most{0.0, -kForever};
    for (const Stretch& stretch : view_.stretches) {
      if (stretch.emergency) continue;
      const Sample past = past_target(stretch);
      if (past.value > most.value) most = past;
    }
    if (most.value == -kForever) return add(not_applicable("overshoot", "nothing was asked for"));
    most.value = std::max(0.0, most.value);
    add(at_most("overshoot", most, *limits_.overshoot, kPercent, "% of top speed", "speed past the asked one"));
  }

  void settling() {
    if (!limits_.settling_time) return;
    Sample longest{0.0, -1.0};
    for (const Stretch& stretch : view_.stretches) {
      if (stretch.emergency || stretch.end - stretch.begin < *limits_.settling_time) continue;
      const double time = time_to_settle(view_, stretch, band());
      if (time > longest.value) longest = {stretch.begin, time};
    }
    if (longest.value < 0.0) return add(not_applicable("settling", "no request lasted as long as settling may take"));
    CheckResult result = at_most("settling", longest, *limits_.settling_time, 1.0, "s",
                                 fmt::format("time until the speed stays within {:.3g} % of top speed", kPercent * band()));
    if (std::isinf(longest.value)) {
      result.reason = fmt::format("the request at {:.2f} s is never settled within {:.3g} % of top speed", longest.time,
                                  kPercent * band());
    }
    add(result);
  }

  void play_crossings() {
    if (!limits_.play_crossings) return;
    if (run_.truth.empty()) return add(not_applicable("play crossings", "no TRUTH in the log"));
    Sample last{0.0, 0.0};
    for (const msgs::Truth& truth : run_.truth) {
      if (seconds(truth.simulated_time) > before_stop()) break;
      double sum = 0.0;
      for (const std::int64_t crossings : truth.play_crossings) sum += static_cast<double>(crossings);
      if (sum > last.value) last = {seconds(truth.simulated_time), sum};
    }
    add(at_most("play crossings", last, *limits_.play_crossings, 1.0, "crossings",
                "gearboxes passing their play before the emergency stop"));
  }

  void play_offset() {
    if (!limits_.play_offset) return;
    std::optional<Sample> least;
    for (const msgs::Torque& torque : run_.torque) {
      const double time = seconds(torque.simulated_time);
      const std::size_t half = torque.motor_torque.size() / 2;
      // Before the first request the motors are still on their way to their flanks.
      if (!torque.enable || half == 0 || time < first_request() || time >= before_stop()) continue;
      double first = 0.0;
      double second = 0.0;
      for (std::size_t i = 0; i < half; ++i) {
        first += torque.motor_torque[i];
        second += torque.motor_torque[torque.motor_torque.size() - 1 - i];
      }
      const double scale = static_cast<double>(half) * limits_.rated_torque;
      if (std::abs(first + second) / 2.0 / scale > limits_.play_offset_up_to) continue;
      const double offset = (first - second) / 2.0 / scale;
      if (!least || offset < least->value) least = {time, offset};
    }
    if (!least) return add(not_applicable("play offset", "no torque of two halves small enough in the log"));
    CheckResult result;
    result.name = "play offset";
    result.verdict = least->value >= *limits_.play_offset ? Verdict::pass : Verdict::fail;
    result.measured = kPercent * least->value;
    result.limit = kPercent * *limits_.play_offset;
    result.unit = "% of T100";
    result.time = least->time;
    result.reason = fmt::format("half the smallest torque difference between the two halves of the motor groups is {:.3g} % of T100 (rated motor torque), {} {:.3g} %, at {:.2f} s{}",
                                result.measured, result.verdict == Verdict::pass ? "wanted" : "less than the wanted",
                                result.limit, least->time, least->value < -*limits_.play_offset ? ": the halves are swapped" : "");
    add(result);
  }

  void sidelead() {
    if (!limits_.sidelead) return;
    if (run_.truth.empty()) return add(not_applicable("sidelead", "no TRUTH in the log"));
    std::vector<Sample> angles;
    for (const msgs::Truth& truth : run_.truth) angles.push_back({seconds(truth.simulated_time), truth.rope_angle});
    add(at_most("sidelead", worst(angles, 0.0, before_stop(), [](double v) { return std::abs(v); }), *limits_.sidelead,
                kDegrees, "deg", "sidelead before the emergency stop"));
  }

  void torque_share() {
    if (!limits_.torque_share) return;
    Sample most{0.0, -kForever};
    for (const msgs::Torque& torque : run_.torque) {
      if (seconds(torque.simulated_time) >= before_stop()) break;
      for (const double value : torque.motor_torque) {
        const double share = std::abs(value) / limits_.rated_torque;
        if (share > most.value || !std::isfinite(share)) {
          most = {seconds(torque.simulated_time), std::isfinite(share) ? share : kForever};
        }
      }
    }
    if (most.value == -kForever) return add(not_applicable("torque share", "no TORQUE in the log"));
    add(at_most("torque share", most, *limits_.torque_share, kPercent, "% of T100",
                "torque of a motor before the emergency stop"));
  }

  void emergency_stop() {
    constexpr const char* kNoStop = "no emergency stop in the run";
    const auto absent = [&](bool asked, const char* name) {
      if (asked && !stopped()) add(not_applicable(name, kNoStop));
      return !asked || !stopped();
    };
    const auto stretch = std::find_if(view_.stretches.begin(), view_.stretches.end(),
                                      [](const Stretch& each) { return each.emergency; });
    if (!absent(limits_.stop_distance.has_value(), "stop distance")) {
      const double from = value_at(view_.angle, view_.stop);
      add(at_most("stop distance", worst(view_.angle, view_.stop, stretch->end, [&](double v) { return std::abs(v - from); }),
                  *limits_.stop_distance, kDegrees, "deg", "slewed from the emergency stop on"));
    }
    if (!absent(limits_.stop_time.has_value(), "stop time")) {
      CheckResult result =
          at_most("stop time", {view_.stop, time_to_settle(view_, *stretch, band())}, *limits_.stop_time, 1.0, "s",
                  fmt::format("time until the crane stands, within {:.3g} % of top speed", kPercent * band()));
      if (std::isinf(result.measured)) result.reason = "the crane never stands still after the emergency stop";
      add(result);
    }
    if (!absent(limits_.stop_overshoot.has_value(), "stop overshoot")) {
      Sample past = past_target(*stretch);
      past.value = std::max(0.0, past.value);
      add(at_most("stop overshoot", past, *limits_.stop_overshoot, kPercent, "% of top speed",
                  "speed past zero after the emergency stop"));
    }
    if (!absent(limits_.tip_acceleration.has_value(), "tip acceleration")) {
      if (run_.sensors.empty()) return add(not_applicable("tip acceleration", "no SENSORS in the log"));
      std::vector<Sample> tip;
      for (const msgs::Sensors& sensors : run_.sensors) {
        tip.push_back({seconds(sensors.simulated_time), sensors.tip_acceleration});
      }
      if (std::all_of(tip.begin(), tip.end(), [](const Sample& sample) { return std::isnan(sample.value); })) {
        return add(not_applicable("tip acceleration", "no accelerometer at the tip: no value of it in SENSORS is a number"));
      }
      add(at_most("tip acceleration", worst(tip, view_.stop, end_of(view_), [](double v) { return std::abs(v); }),
                  *limits_.tip_acceleration, 1.0, "m/s^2", "tip after the emergency stop"));
    }
  }

  void drive() {
    const bool tripped = std::isfinite(view_.trip);
    if (limits_.trips && !machine_.first_fault) {
      if (run_.plant_status.empty()) {
        add(not_applicable("trips", "no PLANT_STATUS in the log"));
      } else {
        CheckResult result;
        result.name = "trips";
        result.verdict = !tripped || *limits_.trips > 0 ? Verdict::pass : Verdict::fail;
        result.measured = tripped ? 1 : 0;
        result.limit = *limits_.trips;
        result.unit = "trips";
        result.time = tripped ? view_.trip : -1.0;
        result.reason = tripped ? fmt::format("the drive tripped at {:.2f} s, cause: {}", view_.trip, view_.trip_cause)
                                : "the drive did not trip";
        add(result);
      }
    }
    if (!limits_.standstill_after_trip || !machine_.first_fault) return;
    if (!tripped) return add(not_applicable("reaction", "the drive did not trip"));
    const double end = std::min(view_.recovered, view_.speed.back().time);
    const Stretch after{view_.trip, end, 0.0, false};
    if (!(end > view_.trip)) return add(not_applicable("reaction", "the drive ran again, or the log ends, before the next PLANT_STATUS"));
    Sample stood{view_.trip, time_to_settle(view_, after, band())};
    CheckResult result =
        at_most("reaction", stood, *limits_.standstill_after_trip, 1.0, "s",
                fmt::format("the drive tripped at {:.2f} s, cause: {}; time until the crane stands for good", view_.trip,
                            view_.trip_cause));
    if (std::isinf(stood.value)) {
      result.reason = fmt::format("the drive tripped at {:.2f} s, cause: {}, but the crane does not stand still", view_.trip,
                                  view_.trip_cause);
    }
    add(result);
  }

  void dead_time() {
    if (!limits_.dead_time) return;
    if (!machine_.encoder_noise) return add(not_applicable("dead time", "the scenario puts no noise on the encoders"));
    const double from = machine_.encoder_noise->from;
    const AnswerToNoise found = answer_to_noise(run_, from, std::min(machine_.encoder_noise->until, view_.trip));
    if (found.lag < 0) return add(not_applicable("dead time", "the torque does not answer the encoders' noise"));
    constexpr double kMilliseconds = 1e3;
    add(at_most("dead time", {from, found.lag * machine_.controller_period}, *limits_.dead_time, kMilliseconds, "ms",
                "from a reading to the first torque that it moves, by the noise on the encoders"));
  }

  const msgs::RunLog& run_;
  const AcceptanceLimits& limits_;
  const AcceptedMachine& machine_;
  View view_;
  std::vector<CheckResult> results_;
};

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::pass: return "pass";
    case Verdict::fail: return "FAIL";
    case Verdict::not_applicable: return "-";
  }
  return "";
}

}  // namespace

const char* verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::pass: return "pass";
    case Verdict::fail: return "fail";
    case Verdict::not_applicable: return "not applicable";
  }
  return "";
}

std::vector<CheckResult> acceptance_checks(const msgs::RunLog& run, const AcceptanceLimits& limits,
                                           const AcceptedMachine& machine) {
  return Checks(run, limits, machine).all();
}

bool accepted(const std::vector<CheckResult>& results) {
  const auto any = [&](Verdict verdict) {
    return std::any_of(results.begin(), results.end(), [&](const CheckResult& result) { return result.verdict == verdict; });
  };
  return any(Verdict::pass) && !any(Verdict::fail);
}

std::string not_judged(const std::vector<CheckResult>& results) {
  std::string names;
  for (const CheckResult& result : results) {
    if (result.verdict == Verdict::not_applicable) names += (names.empty() ? "" : ", ") + result.name;
  }
  return names;
}

std::string why_no_verdict(const msgs::RunLogs& logs, const ExpectedRun& expected) {
  if (logs.runs.size() > 1) return fmt::format("the log holds {} runs: which of them is meant is not known", logs.runs.size());
  const msgs::RunLog& run = logs.runs.front();
  if (run.encoder.empty()) return "there is no ENCODER in the log: the run never started";
  if (run.torque.empty()) return "there is no TORQUE in the log: no controller ever answered";
  const auto too_short = [&](std::int64_t end) {
    return fmt::format("the log ends at {:.3f} s of {:.3f} s: the run did not come to its end, or the log is cut off",
                       seconds(end), seconds(expected.duration));
  };
  if (run.encoder.front().simulated_time > expected.longest_hole) {
    return fmt::format("the log begins at {:.3f} s: the run's beginning is missing", seconds(run.encoder.front().simulated_time));
  }
  if (run.encoder.back().simulated_time < expected.duration - expected.controller_period) {
    return too_short(run.encoder.back().simulated_time);
  }
  if (!run.sensors.empty() && run.sensors.back().simulated_time < expected.duration - expected.sensors_period) {
    return too_short(run.sensors.back().simulated_time);
  }
  for (std::size_t i = 1; i < run.encoder.size(); ++i) {
    const std::int64_t hole = run.encoder[i].simulated_time - run.encoder[i - 1].simulated_time;
    if (hole > expected.longest_hole) {
      return fmt::format("the log has a hole of {:.3f} s behind {:.3f} s", seconds(hole), seconds(run.encoder[i - 1].simulated_time));
    }
  }
  if (logs.lost_bytes > 0) return fmt::format("the log is damaged: {} bytes of it are no whole event", logs.lost_bytes);
  if (logs.lost_messages > 0) return fmt::format("the log is damaged: {} messages of the plant cannot be used", logs.lost_messages);
  return {};
}

const std::vector<std::string>& acceptance_check_names() {
  static const std::vector<std::string> kNames{"direction", "overshoot", "settling", "play crossings", "play offset", "sidelead",
                                               "torque share", "stop distance", "stop time", "stop overshoot", "tip acceleration",
                                               "trips", "reaction", "dead time", "expectation", "run", "log"};
  return kNames;
}

std::string junit_xml(const std::string& suite, const std::vector<CheckResult>& results) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + junit_suite(suite, results, {});
}

std::string junit_suite(const std::string& suite, const std::vector<CheckResult>& results,
                        const std::vector<std::pair<std::string, std::string>>& properties) {
  const auto count = [&](Verdict verdict) {
    return std::count_if(results.begin(), results.end(), [&](const CheckResult& r) { return r.verdict == verdict; });
  };
  std::string text = fmt::format("<testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"{}\">\n", common::xml_text(suite),
                      results.size(), count(Verdict::fail), count(Verdict::not_applicable));
  if (!properties.empty()) {
    text += "  <properties>";
    for (const auto& [name, value] : properties) text += fmt::format("<property name=\"{}\" value=\"{}\"/>", common::xml_text(name), common::xml_text(value));
    text += "</properties>\n";
  }
  for (const CheckResult& result : results) {
    text += fmt::format("  <testcase classname=\"{}\" name=\"{}\">", common::xml_text(suite), common::xml_text(result.name));
    if (result.verdict == Verdict::fail) text += fmt::format("<failure message=\"{}\"/>", common::xml_text(result.reason));
    if (result.verdict == Verdict::not_applicable) text += fmt::format("<skipped message=\"{}\"/>", common::xml_text(result.reason));
    if (result.verdict == Verdict::pass) text += fmt::format("<system-out>{}</system-out>", common::xml_text(result.reason));
    text += "</testcase>\n";
  }
  return text + "</testsuite>\n";
}

std::string check_table(const std::vector<CheckResult>& results) {
  std::string text;
  for (const CheckResult& result : results) {
    text += fmt::format("{:<4} {:<17} {}\n", to_string(result.verdict), result.name, result.reason);
  }
  return text;
}

std::string checks_json(const std::vector<CheckResult>& results, const AcceptanceLimits& limits,
                        const AcceptedMachine& machine, const std::string& log_digest) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const CheckResult& result : results) {
    list.push_back({{"name", result.name},
                    {"verdict", verdict_name(result.verdict)},
                    {"measured", std::isfinite(result.measured) ? nlohmann::ordered_json(result.measured)
                                                                : nlohmann::ordered_json(nullptr)},
                    {"limit", result.limit},
                    {"unit", result.unit},
                    {"time", result.time},
                    {"reason", result.reason}});
  }
  const nlohmann::ordered_json all{{"accepted", accepted(results)},
                                   {"log_digest", log_digest},
                                   {"top_speed", limits.top_speed},
                                   {"total_ratio", machine.total_ratio},
                                   {"rated_torque", limits.rated_torque},
                                   {"settled_within", limits.settled_within},
                                   {"checks", list}};
  return all.dump(2) + "\n";
}

}  // namespace slewlab::tools
