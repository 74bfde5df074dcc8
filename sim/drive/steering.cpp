#include "sim/drive/steering.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "common/yaml_file.h"
#include "common/yaml_reader.h"
#include "sim/drive/fault_file.h"
#include "sim/machine/scales.h"

namespace slewlab::sim {
namespace {

constexpr std::int64_t kMostCycles = 1'000'000;

std::string in_seconds(std::int64_t time) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9f", static_cast<double>(time) * 1e-9);
  return text;
}

bool same_buttons(const OperatorMove& a, const OperatorMove& b) {
  return a.emergency_stop == b.emergency_stop && a.acknowledge == b.acknowledge;
}

constexpr double kAfterLoss = 30.0;  // [-] of the characteristic time

}  // namespace

std::int64_t after_loss_of(const CraneParameters& machine) { return std::llround(kAfterLoss * characteristic_time(machine) * 1e9); }

void Steering::take(const std::string& line) {
  std::istringstream words(line);
  std::string word;
  words >> word;
  std::string rest;
  std::getline(words >> std::ws, rest);
  if (word == "operator") {
    take_operator(rest);
  } else if (word == "fault") {
    take_fault(rest);
  } else if (word == "effect") {
    take_effect(rest);
  } else if (word == "play_compensation") {
    take_play_compensation(rest);
  } else if (word == "pause") {
    paused_ = true;
  } else if (word == "resume") {
    paused_ = false;
    cycles_ = 0;
  } else if (word == "cycle") {
    if (paused_) cycles_ = std::min(cycles_ + 1, kMostCycles);
  } else if (word == "speed") {
    double speed = -1.0;
    std::istringstream number(rest);
    if (number >> speed && std::isfinite(speed) && speed >= 0.0) {
      speed_ = speed;
    } else {
      refuse("speed '" + rest + "': 0 or a positive number is wanted");
    }
  } else if (word == "end") {
    ended_ = true;
  } else if (word == "lost") {
    lost_ = true;
    let_go();
  } else if (word == "silence") {
    let_go();
  } else if (word == "patience") {
    take_patience(rest);
  } else {
    refuse("'" + line + "': no such command");
  }
}

void Steering::let_go() {
  OperatorMove free = wishes_.empty() ? stands_ : wishes_.back();
  free.speed_request = 0.0;
  free.acknowledge = false;
  wishes_.push_back(free);
}

void Steering::take_patience(const std::string& rest) {
  double patience = 0.0;
  std::istringstream number(rest);
  if (number >> patience && std::isfinite(patience) && patience > 0.0) {
    patience_ = patience;
  } else {
    refuse("patience '" + rest + "': a positive number of seconds is wanted");
  }
}

void Steering::take_operator(const std::string& rest) {
  std::istringstream words(rest);
  OperatorMove move;
  int stop = -1, acknowledge = -1;
  const bool is_read = static_cast<bool>(words >> move.speed_request >> stop >> acknowledge);
  if (!is_read || !(std::fabs(move.speed_request) <= 1.0) || (stop & ~1) != 0 || (acknowledge & ~1) != 0) {
    refuse("operator '" + rest + "': a request from -1 to 1 and twice 0 or 1 are wanted");
    return;
  }
  move.emergency_stop = stop == 1;
  move.acknowledge = acknowledge == 1;
  if (!wishes_.empty() && same_buttons(wishes_.back(), move)) {
    wishes_.back() = move;
  } else {
    wishes_.push_back(move);
  }
}

void Steering::take_fault(const std::string& rest) {
  std::istringstream words(rest);
  std::string what, name, text;
  words >> what >> name;
  std::getline(words >> std::ws, text);
  if (what == "begin" && !name.empty() && !text.empty()) {
    fault_wishes_.push_back({true, name, text});
  } else if (what == "end" && !name.empty()) {
    fault_wishes_.push_back({false, name, ""});
  } else {
    refuse("fault '" + rest + "': begin NUMBER KEY: VALUE, ... or end NUMBER is wanted");
  }
}

void Steering::take_effect(const std::string& rest) {
  std::istringstream words(rest);
  std::string name, what;
  words >> name >> what;
  const bool is_known = std::find(settings_.effects.begin(), settings_.effects.end(), name) != settings_.effects.end();
  if (!is_known || (what != "on" && what != "off")) {
    refuse("effect '" + rest + "': an effect that the machine has and that changes no parameter, and on or off, are wanted");
    return;
  }
  effect_wishes_.push_back({0, name, what == "on"});
}

void Steering::take_play_compensation(const std::string& rest) {
  if (rest != "on" && rest != "off") {
    refuse("play_compensation '" + rest + "': on or off is wanted");
    return;
  }
  play_compensation_wish_ = rest == "on";
}

void Steering::begin_fault(std::int64_t time, const std::string& name, const std::string& text, SteeredPeriod& period) {
  common::InputProblems problems;
  const std::string file = "faults: [{from: {value: " + in_seconds(time) + ", unit: s, source: \"the desk\"}, " + text + "}]\n";
  const common::YamlNode root = common::parse_yaml_text(file, "the desk", problems);
  std::vector<Fault> faults;
  if (problems.empty()) {
    common::YamlReader reader(root, "", problems);
    faults = read_faults(reader, settings_.controller_period, settings_.drive, settings_.seed,
                         settings_.scenario_faults + fault_count_);
  }
  if (!problems.empty() || faults.size() != 1) {
    refuse("fault " + name + ": " + (problems.empty() ? "'" + text + "' is no fault" : common::InputError(problems).what()));
    return;
  }
  faults_.emplace_back(name, settings_.scenario_faults + fault_count_++);
  period.faults.push_back({faults.front(), 0});
  news_.push_back("fault " + name + " from " + in_seconds(time));
}

SteeredPeriod Steering::begin_period(std::int64_t time) {
  SteeredPeriod period;
  if (paused_ && cycles_ > 0) --cycles_;
  if (!wishes_.empty()) {
    OperatorMove& wish = wishes_.front();
    const bool changes = wish.speed_request != stands_.speed_request || !same_buttons(wish, stands_);
    if (changes) {
      stands_ = wish;
      stands_.time = time;
      period.move = stands_;
    }
    wishes_.pop_front();
  }
  for (const FaultWish& wish : std::exchange(fault_wishes_, {})) {
    const auto under_way = std::find_if(faults_.begin(), faults_.end(), [&](const auto& each) { return each.first == wish.name; });
    if (wish.begins && under_way != faults_.end()) {
      refuse("fault " + wish.name + ": it is under way");
    } else if (wish.begins) {
      begin_fault(time, wish.name, wish.text, period);
    } else if (under_way == faults_.end()) {
      refuse("fault " + wish.name + ": it is not under way");
    } else {
      period.faults.push_back({std::nullopt, under_way->second});
      news_.push_back("fault " + wish.name + " until " + in_seconds(time));
      faults_.erase(under_way);
    }
  }
  for (EffectSwitch& change : effect_wishes_) {
    change.time = time;
    news_.push_back("effect " + change.effect + (change.on ? " on " : " off ") + in_seconds(time));
  }
  period.effects = std::exchange(effect_wishes_, {});
  period.play_compensation = std::exchange(play_compensation_wish_, std::nullopt);
  if (period.play_compensation) news_.push_back(std::string("play_compensation ") + (*period.play_compensation ? "on " : "off ") + in_seconds(time));
  if (lost_ && !lost_at_) lost_at_ = time;
  period.ends_run = ended_ || (lost_at_ && time - *lost_at_ >= settings_.after_loss);
  return period;
}

std::vector<std::string> Steering::take_news() { return std::exchange(news_, {}); }

}  // namespace slewlab::sim
