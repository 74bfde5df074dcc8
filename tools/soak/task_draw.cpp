#include "tools/soak/task_draw.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

#include "common/yaml_node.h"
#include "sim/effects/random_number.h"
#include "sim/model/drive_line.h"

namespace slewlab::tools {
namespace {

constexpr double kSecond = 1e9;  // [ns]

// Numbers one after the other. Counting (random_number.h) makes them the same with every library.
class Draw {
 public:
  Draw(std::uint64_t seed, std::int64_t number) : seed_(sim::mixed(seed, static_cast<std::uint64_t>(number))) {}

  double share() { return sim::uniform_number(seed_, counter_++); }
  bool chance(double probability) { return share() < probability; }
  double between(double lowest, double highest) { return lowest + (highest - lowest) * share(); }
  // Short ones as likely as long ones: evenly in the logarithm.
  double scattered(double lowest, double highest) { return lowest * std::pow(highest / lowest, share()); }
  std::int64_t below(std::int64_t count) {
    return std::min(count - 1, static_cast<std::int64_t>(share() * static_cast<double>(count)));
  }

 private:
  std::uint64_t seed_;
  std::uint64_t counter_ = 0;
};

std::int64_t on_grid(double seconds, std::int64_t grid) { return std::llround(seconds * kSecond / static_cast<double>(grid)) * grid; }

// What the hand does with the joystick: full deflection, anything between, inching, or letting go.
double draw_request(Draw& draw) {
  const double kind = draw.share();
  const double sign = draw.chance(0.5) ? 1.0 : -1.0;
  if (kind < 0.3) return sign;
  if (kind < 0.6) return sign * draw.share();
  if (kind < 0.75) return sign * draw.between(0.01, 0.2);
  return 0.0;
}

// What the operator sees of the load: a point mass on its rope, its top carried round by the ramp's speed,
//   beta'' = -2 zeta w beta' - w^2 beta - R speed' / L,   w^2 = g / L.
class Swing {
 public:
  Swing(const controller::RampSettings& ramp, double period, double radius, const sim::LoadParameters& load)
      : ramp_(ramp), period_(period) {
    length_ = load.rope_length + 0.5 * load.rod_length;
    radius_ = load.mass > 0.0 ? radius : 0.0;
    frequency_ = length_ > 0.0 ? std::sqrt(sim::kGravity / length_) : 0.0;
    damping_ = 2.0 * load.damping_ratio * frequency_;
  }

  void go_on(double time, const sim::OperatorMove& move) {
    for (const auto end = static_cast<std::int64_t>(time / period_); count_ < end; ++count_) {
      const double before = state_.speed;
      if (move.emergency_stop) {
        controller::step_emergency_stop(ramp_, state_, period_);
      } else {
        controller::step_ramp(ramp_, state_, period_, move.speed_request * ramp_.top_speed);
      }
      if (radius_ == 0.0) continue;
      rate_ += -period_ * (frequency_ * frequency_ * angle_ + damping_ * rate_) - radius_ * (state_.speed - before) / length_;
      angle_ += period_ * rate_;
      largest_ = std::max(largest_, std::hypot(angle_, rate_ / frequency_));
    }
  }

  // The largest swing there would be if this move were made and kept up until the ramp has ended.
  double foreseen(double time, const sim::OperatorMove& move) const {
    Swing ahead = *this;
    ahead.largest_ = 0.0;
    ahead.go_on(time + ramp_.acceleration_time + ramp_.deceleration_time, move);
    return ahead.largest_;
  }

 private:
  controller::RampSettings ramp_;
  double period_;  // [s]
  double length_ = 0.0, radius_ = 0.0, frequency_ = 0.0, damping_ = 0.0;
  controller::RampState state_;
  std::int64_t count_ = 0;  // periods so far
  double angle_ = 0.0, rate_ = 0.0, largest_ = 0.0;
};

class Hand {
 public:
  Hand(const TaskRanges& ranges, const Swing& swing, Draw& draw) : ranges_(ranges), swing_(swing), draw_(draw) {}

  std::vector<sim::OperatorMove> moves(bool acknowledges) {
    constexpr double kAcknowledges = 0.15;  // share of moves, where faults can trip the drive
    wait(draw_.between(0.5, 5.0));
    while (time_ < static_cast<double>(ranges_.duration) / kSecond) {
      const bool stop = draw_.chance(ranges_.emergency_stop);
      if (stop) {
        now_.emergency_stop = true;
        move();
        wait(draw_.between(0.2, 8.0));
      }
      if (stop || (acknowledges && draw_.chance(kAcknowledges))) {
        let_go_and_acknowledge();
      } else {
        sim::OperatorMove wish = now_;
        wish.speed_request = draw_request(draw_);
        if (swing_.foreseen(time_, wish) <= ranges_.watched_sidelead) {
          now_ = wish;
          move();
        }
      }
      wait(draw_.scattered(ranges_.hold.lowest, ranges_.hold.highest));
    }
    return std::move(moves_);
  }

 private:
  void let_go_and_acknowledge() {
    now_.emergency_stop = false;
    now_.speed_request = 0.0;
    move();
    wait(draw_.between(0.5, 4.0));
    now_.acknowledge = true;
    move();
    wait(draw_.between(0.1, 1.0));
    now_.acknowledge = false;
    move();
  }

  void wait(double seconds) {
    time_ += seconds;
    swing_.go_on(time_, now_);
  }

  void move() {
    now_.time = on_grid(time_, ranges_.plant_step);
    if (now_.time >= ranges_.duration) return;
    if (!moves_.empty() && moves_.back().time >= now_.time) now_.time = moves_.back().time + ranges_.plant_step;
    moves_.push_back(now_);
  }

  const TaskRanges& ranges_;
  Swing swing_;
  Draw& draw_;
  double time_ = 0.0;  // [s]
  sim::OperatorMove now_;
  std::vector<sim::OperatorMove> moves_;
};

sim::Fault draw_fault(const TaskRanges& ranges, const sim::DriveParameters& drive, Draw& draw) {
  constexpr std::int64_t kMostCyclesLate = 20;
  constexpr std::int64_t kSeeds = 1'000'000'000;
  constexpr double kSpeedError = 0.15;    // of the motor's speed at the machine's top speed
  constexpr double kPositionError = 1.0;  // [rad] of the encoder's shaft: a sixth of its turn
  constexpr double kCorrupted = 0.25;  // share of faults: there are more ways to corrupt than kinds of fault
  sim::Fault fault;
  fault.kind = static_cast<sim::FaultKind>(draw.below(static_cast<std::int64_t>(sim::kFaultKindNames.size())));
  if (draw.chance(kCorrupted)) fault.kind = sim::FaultKind::message_corrupted;
  fault.from = on_grid(draw.share() * static_cast<double>(ranges.duration) / kSecond, ranges.controller_period);
  const double shortest = static_cast<double>(ranges.controller_period) / kSecond;
  const double length = draw.scattered(shortest, std::max(shortest, ranges.longest_fault));
  fault.until = fault.from + on_grid(length, ranges.controller_period);
  fault.channel = draw.chance(0.5) ? sim::FaultChannel::encoder : sim::FaultChannel::torque;
  fault.probability = draw.chance(0.3) ? 1.0 : draw.scattered(0.01, 1.0);
  fault.seed = static_cast<std::uint64_t>(draw.below(kSeeds));
  fault.cycles = 1 + draw.below(kMostCyclesLate);
  const auto corruptions = fault.channel == sim::FaultChannel::encoder
                               ? static_cast<std::int64_t>(sim::Corruption::other_version) + 1
                               : static_cast<std::int64_t>(sim::kCorruptionNames.size());
  fault.corruption = static_cast<sim::Corruption>(draw.below(corruptions));
  fault.group = static_cast<int>(draw.below(drive.group_count + 1)) - 1;
  const double speed_error = kSpeedError * drive.top_speed * sim::total_ratio(drive);
  fault.speed = draw.between(-speed_error, speed_error);
  fault.position = draw.between(-kPositionError, kPositionError);
  return fault;
}

// Behind a fault the operator acknowledges, too early or in time, his other hand where it is or off the joystick.
void acknowledge(const std::vector<sim::Fault>& faults, const TaskRanges& ranges, Draw& draw,
                 std::vector<sim::OperatorMove>& moves) {
  constexpr double kSoonest = 0.05, kLatest = 10.0, kShortest = 0.02, kLongest = 1.0;  // [s] of a hand, whatever it moves
  for (const sim::Fault& fault : faults) {
    const std::int64_t press = fault.from + on_grid(draw.scattered(kSoonest, kLatest), ranges.plant_step);
    const std::int64_t release = press + on_grid(draw.scattered(kShortest, kLongest), ranges.plant_step);
    const bool lets_go = draw.chance(0.5);
    for (const std::int64_t time : {press, release}) {
      const auto later = std::find_if(moves.begin(), moves.end(), [&](const auto& move) { return move.time >= time; });
      if (time >= ranges.duration || (later != moves.end() && later->time == time)) continue;
      sim::OperatorMove move = later == moves.begin() ? sim::OperatorMove{} : *std::prev(later);
      move.time = time;
      move.acknowledge = time == press;
      if (lets_go) move.speed_request = 0.0;
      moves.insert(later, move);
    }
  }
}

std::string number_text(double value, const char* unit) {
  return fmt::format("{{value: {}, unit: {}, source: drawn}}", common::shortest(value), unit);
}
std::string name_text(const char* name) { return fmt::format("{{value: {}, source: drawn}}", name); }
std::string time_text(std::int64_t time) { return number_text(static_cast<double>(time) / kSecond, "s"); }
std::string count_text(std::int64_t count) { return fmt::format("{{value: {}, unit: \"-\", source: drawn}}", count); }

bool has_channel(sim::FaultKind kind) {
  return kind >= sim::FaultKind::message_lost && kind <= sim::FaultKind::message_corrupted;
}
bool has_group(sim::FaultKind kind) {
  return kind >= sim::FaultKind::encoder_frozen && kind <= sim::FaultKind::motor_group_lost;
}

std::string fault_text(const sim::Fault& fault) {
  std::string text = fmt::format("  - fault: {}\n", name_text(sim::kFaultKindNames[static_cast<std::size_t>(fault.kind)]));
  const auto line = [&](const char* key, const std::string& value) { text += fmt::format("    {}: {}\n", key, value); };
  line("from", time_text(fault.from));
  line("until", time_text(fault.until));
  if (has_channel(fault.kind)) {
    line("channel", name_text(sim::kFaultChannelNames[static_cast<std::size_t>(fault.channel)]));
    line("probability", number_text(fault.probability, "\"-\""));
    line("seed", count_text(static_cast<std::int64_t>(fault.seed)));
  }
  if (fault.kind == sim::FaultKind::message_delayed) line("cycles", count_text(fault.cycles));
  if (fault.kind == sim::FaultKind::message_corrupted) {
    line("corruption", name_text(sim::kCorruptionNames[static_cast<std::size_t>(fault.corruption)]));
  }
  if (fault.kind == sim::FaultKind::encoder_noisy || fault.kind == sim::FaultKind::encoder_offset) {
    line("speed", number_text(fault.speed, "rad/s"));
    line("position", number_text(fault.position, "rad"));
  }
  if (has_group(fault.kind) && fault.group >= 0) line("group", count_text(fault.group));
  return text;
}

}  // namespace

SoakTask draw_task(const TaskRanges& ranges, const sim::CraneParameters& crane, const controller::RampSettings& ramp,
                   bool with_faults, std::uint64_t seed, std::int64_t number) {
  constexpr double kFullLoad = 0.2;  // share of the loaded tasks with all that the crane may lift
  constexpr std::int64_t kSeeds = 1'000'000'000;
  Draw draw(seed, number);
  SoakTask task;
  task.seed = seed;
  task.number = number;
  const bool has_boom = crane.boom.length > 0.0;
  const bool has_load = crane.load.mass > 0.0;
  const double angle = draw.between(ranges.boom_angle.lowest, ranges.boom_angle.highest);
  task.boom_angle = has_boom ? angle : crane.boom.angle;
  const double radius = crane.boom.pivot_radius + crane.boom.length * std::cos(task.boom_angle);
  const double most = radius > 0.0 ? std::min(ranges.largest_mass, ranges.largest_moment / (sim::kGravity * radius))
                                   : ranges.largest_mass;
  const bool empty = draw.chance(ranges.no_load);
  const double part = draw.chance(kFullLoad) ? 1.0 : draw.share();
  task.load_mass = has_load && !empty ? part * most : 0.0;
  const double rope = draw.between(ranges.rope_length.lowest, ranges.rope_length.highest);
  task.rope_length = has_load ? rope : 0.0;
  task.scenario_seed = draw.below(kSeeds);
  sim::LoadParameters load = crane.load;
  load.mass = task.load_mass;
  load.rope_length = task.rope_length;
  const double period = static_cast<double>(ranges.controller_period) / kSecond;
  task.moves = Hand(ranges, Swing(ramp, period, radius, load), draw).moves(with_faults);
  if (with_faults) {
    const std::int64_t count = 1 + draw.below(ranges.most_faults);
    for (std::int64_t i = 0; i < count; ++i) task.faults.push_back(draw_fault(ranges, crane.drive, draw));
    acknowledge(task.faults, ranges, draw, task.moves);
  }
  return task;
}

std::string task_scenario(const SoakTask& task, const TaskRanges& ranges, const std::filesystem::path& crane,
                          const std::filesystem::path& controller) {
  std::string text = "kind: scenario\n";
  text += fmt::format("description: \"soak, seed {}, task {}\"\n", task.seed, task.number);
  text += fmt::format("crane: \"{}\"\n", std::filesystem::absolute(crane).string());
  text += fmt::format("controller: \"{}\"\n", std::filesystem::absolute(controller).string());
  text += "duration: " + time_text(ranges.duration) + "\n";
  text += "plant_step: " + time_text(ranges.plant_step) + "\n";
  text += "controller_period: " + time_text(ranges.controller_period) + "\n";
  text += "seed: " + count_text(task.scenario_seed) + "\n";
  text += "telemetry:\n";
  text += "  sensors_period: " + time_text(ranges.controller_period) + "\n";
  text += "  truth_period: " + time_text(ranges.controller_period) + "\n";
  text += "  status_period: " + time_text(10 * ranges.controller_period) + "\n";
  if (!task.moves.empty()) text += "operator:\n";
  for (const sim::OperatorMove& move : task.moves) {
    text += "  - time: " + time_text(move.time) + "\n";
    text += "    speed_request: " + number_text(move.speed_request, "\"-\"") + "\n";
    text += "    emergency_stop: " + name_text(move.emergency_stop ? "true" : "false") + "\n";
    text += "    acknowledge: " + name_text(move.acknowledge ? "true" : "false") + "\n";
  }
  if (!task.faults.empty()) text += "faults:\n";
  for (const sim::Fault& fault : task.faults) text += fault_text(fault);
  return text;
}

std::vector<common::Override> task_overrides(const SoakTask& task, const sim::CraneParameters& crane) {
  std::vector<common::Override> overrides;
  if (crane.boom.length > 0.0) overrides.push_back({"crane.boom.angle", number_text(task.boom_angle, "rad")});
  if (crane.load.mass > 0.0) {
    overrides.push_back({"crane.load.mass", number_text(task.load_mass, "kg")});
    overrides.push_back({"crane.load.rope_length", number_text(task.rope_length, "m")});
  }
  return overrides;
}

std::string describe(const SoakTask& task) {
  constexpr double kDegree = std::numbers::pi / 180.0;  // [rad]
  constexpr double kTonne = 1e3;                        // [kg]
  const auto pressed = std::count_if(task.moves.begin(), task.moves.end(), [](const auto& m) { return m.emergency_stop; });
  std::string text = fmt::format("boom {:.1f} deg, {:.1f} t on {:.1f} m, {} moves, {} emergency stops",
                                 task.boom_angle / kDegree, task.load_mass / kTonne, task.rope_length, task.moves.size(),
                                 pressed);
  for (std::size_t i = 0; i < task.faults.size(); ++i) {
    const sim::Fault& fault = task.faults[i];
    text += i == 0 ? ", faults: " : ", ";
    text += sim::kFaultKindNames[static_cast<std::size_t>(fault.kind)];
    if (has_channel(fault.kind)) text += std::string(" ") + sim::kFaultChannelNames[static_cast<std::size_t>(fault.channel)];
    if (fault.kind == sim::FaultKind::message_corrupted) {
      text += std::string(" ") + sim::kCorruptionNames[static_cast<std::size_t>(fault.corruption)];
    }
    text += fmt::format(" from {:.2f} to {:.2f} s", static_cast<double>(fault.from) / kSecond,
                        static_cast<double>(fault.until) / kSecond);
  }
  return text;
}

}  // namespace slewlab::tools
