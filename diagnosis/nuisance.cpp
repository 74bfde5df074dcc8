#include "diagnosis/nuisance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/yaml_node.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kSteepness = 30.0;  // [-] of the cost beyond the bound, in units of the normal prior's curvature

constexpr double kStudent = 3.0;  // one more than the degrees of freedom

}  // namespace

Nuisances nuisances_of(const sim::MachineDescription& machine, double latency_deviation) {
  Nuisances nuisances;
  nuisances.parameters = machine.parameters;
  nuisances.latency_deviation = latency_deviation;
  if (machine.machine.load.mass > 0.0) nuisances.rope_length = machine.machine.load.rope_length;
  // As far as the rated torque inclines the rope while it accelerates the machine.
  nuisances.swing_behind_moves =
      std::max(kSwingDeviation, machine.scales.reach * machine.scales.top_speed / machine.scales.acceleration_time / sim::kGravity);
  // As far as turning at top speed inclines it.
  nuisances.outward_swing = machine.scales.reach * machine.scales.top_speed * machine.scales.top_speed / sim::kGravity;
  return nuisances;
}

double encoder_latency(const Nuisances& nuisances, const std::vector<double>& amount) {
  return amount.size() < nuisances.common_count() ? 0.0 : nuisances.latency_deviation * amount[nuisances.parameters.size()];
}

double command_lead(const Nuisances& nuisances, const std::vector<double>& amount) {
  if (nuisances.lead_deviation == 0.0 || amount.size() < nuisances.common_count()) return 0.0;
  return nuisances.lead_deviation * amount[nuisances.parameters.size() + 1];
}

Beginning beginning_of(const Nuisances& nuisances, const std::vector<double>& amount, std::size_t record) {
  Beginning beginning;
  std::size_t k = nuisances.count(record);
  if (amount.size() < nuisances.count(record + 1)) return beginning;
  const RecordBegins begins = nuisances.begin_of(record);
  const bool has_load = nuisances.swing_amounts() > 0;
  const double natural = has_load ? std::sqrt(sim::kGravity / nuisances.rope_length) : 0.0;  // [rad/s]
  if (has_load) {
    const double deviation = begins == RecordBegins::unmoved ? kSwingDeviation : nuisances.swing_behind_moves;
    beginning.swing = deviation * amount[k++];
    beginning.swing_rate = deviation * natural * amount[k++];
  }
  for (std::size_t g = 0; g < nuisances.offset_groups; ++g) beginning.motor_offset[g] = nuisances.offset_deviation * amount[k++];
  if (begins == RecordBegins::unmoved) return beginning;
  if (has_load) {
    beginning.rod = kSwingDeviation * amount[k++];
    beginning.rod_rate = kSwingDeviation * natural * amount[k++];
  }
  for (std::size_t mode = 0; mode < kBeginningBends; ++mode) {
    beginning.bend[mode] = kBendDeviation * amount[k++];
    beginning.bend_rate[mode] = kBendDeviation * amount[k++];
  }
  if (nuisances.outward_amounts() > 0) {
    beginning.outwards = nuisances.outward_swing * amount[k++];
    beginning.outward_rate = nuisances.outward_swing * natural * amount[k++];
  }
  return beginning;
}

double swing_reach(const Nuisances& nuisances, const std::vector<double>& amount, std::size_t record) {
  if (nuisances.swing_amounts() == 0) return 0.0;
  const Beginning beginning = beginning_of(nuisances, amount, record);
  return std::hypot(beginning.swing, beginning.swing_rate / std::sqrt(sim::kGravity / nuisances.rope_length));
}

PriorTerm nuisance_prior(const Nuisances& nuisances, std::size_t k, double z) {
  PriorTerm term{z * z, z, 1.0};
  const double beyond = std::fabs(z) - kSpreadEnds;
  if (k < nuisances.parameters.size() && beyond > 0.0) {
    term.cost += kSteepness * beyond * beyond;
    term.slope += std::copysign(kSteepness * beyond, z);
    term.curvature += kSteepness;
  }
  return term;
}

bool is_said_by(const Nuisances& nuisances, const common::EffectAbout& effect, std::size_t k) {
  if (k >= nuisances.parameters.size()) return false;
  return std::find(effect.stands_for.begin(), effect.stands_for.end(), nuisances.parameters[k].name) != effect.stands_for.end();
}

bool says_what_is_beyond(const Nuisances& nuisances, const common::EffectAbout& effect, const std::vector<double>& amount) {
  for (std::size_t k = 0; k < std::min(nuisances.parameters.size(), amount.size()); ++k) {
    if (std::fabs(amount[k]) > kSpreadEnds && is_said_by(nuisances, effect, k)) return true;
  }
  return false;
}

std::vector<FarParameter> far_parameters(const Nuisances& nuisances, const std::vector<double>& amount) {
  constexpr double kRangeEnds = 1.7320508075688772;  // [standard deviations] of an even distribution
  constexpr std::size_t kMostTold = 4;
  std::vector<std::size_t> far;
  for (std::size_t k = 0; k < std::min(amount.size(), nuisances.parameters.size()); ++k) {
    if (std::fabs(amount[k]) > kRangeEnds) far.push_back(k);
  }
  std::stable_sort(far.begin(), far.end(), [&](std::size_t a, std::size_t b) { return std::fabs(amount[a]) > std::fabs(amount[b]); });
  std::vector<FarParameter> told;
  for (const std::size_t k : far) {
    if (told.size() < kMostTold) told.push_back({std::string(nuisances.parameters[k].name), nuisances.parameters[k].spread * amount[k]});
  }
  return told;
}

std::string in_words(const std::vector<FarParameter>& far) {
  std::string words;
  for (const FarParameter& one : far) words += fmt::format("{}{} {:+.0f} %", words.empty() ? "" : ", ", one.name, 100.0 * one.change);
  return words;
}

std::vector<MovedParameter> moved_parameters(const Nuisances& nuisances, const std::vector<double>& amount, std::span<const AmountInterval> intervals) {
  constexpr double kWorthTelling = 0.02, kSurely = 2.0;  // chosen
  const auto reach = [&](std::size_t k) { return 0.5 * (intervals[k].high - intervals[k].low); };
  std::vector<std::size_t> moved;
  for (std::size_t k = 0; k < std::min({amount.size(), intervals.size(), nuisances.parameters.size()}); ++k) {
    const double change = nuisances.parameters[k].spread * std::fabs(amount[k]);
    if (change >= kWorthTelling && std::fabs(amount[k]) > kSurely * reach(k)) moved.push_back(k);
  }
  std::stable_sort(moved.begin(), moved.end(), [&](std::size_t a, std::size_t b) { return std::fabs(amount[a]) * reach(b) > std::fabs(amount[b]) * reach(a); });
  std::vector<MovedParameter> told;
  for (const std::size_t k : moved) {
    const double spread = nuisances.parameters[k].spread;
    told.push_back({std::string(nuisances.parameters[k].name), spread * amount[k], spread * intervals[k].low, spread * intervals[k].high});
  }
  return told;
}

PriorTerm effect_prior(double x) {
  const double weight = 1.0 / (1.0 + x * x / kStudent);
  return {kStudent * std::log1p(x * x / kStudent), weight * x, weight};
}

sim::CraneParameters with_nuisances(const Nuisances& nuisances, sim::CraneParameters machine, const std::vector<double>& amount) {
  for (std::size_t k = 0; k < nuisances.parameters.size() && k < amount.size(); ++k) {
    // A factor stays positive however far an optimiser reaches.
    const double factor = std::max(0.05, 1.0 + nuisances.parameters[k].spread * amount[k]);
    for (const sim::FileNumber& number : nuisances.parameters[k].numbers) number.of(machine) *= factor;
  }
  return machine;
}

std::string parameters_text(const Nuisances& nuisances, const sim::CraneParameters& nominal, const std::vector<double>& amount,
                            std::span<const AmountInterval> intervals, std::string_view source) {
  sim::CraneParameters machine = with_nuisances(nuisances, nominal, amount);
  const auto moved_to = [&](std::size_t k, double to) {
    std::vector<double> moved = amount;
    moved[k] = to;
    return with_nuisances(nuisances, nominal, moved);
  };
  std::map<std::string_view, std::string> sections;
  for (std::size_t k = 0; k < nuisances.parameters.size() && k < amount.size(); ++k) {
    if (amount[k] == 0.0) continue;
    const sim::Parameter& parameter = nuisances.parameters[k];
    for (const sim::FileNumber& number : parameter.numbers) {
      std::string origin = fmt::format("{}, {:+.1f} %", source, 100.0 * parameter.spread * amount[k]);
      if (k < intervals.size()) {
        sim::CraneParameters low = moved_to(k, intervals[k].low), high = moved_to(k, intervals[k].high);
        origin += fmt::format("; 90 %: {:.4g} to {:.4g}", number.of(low), number.of(high));
      }
      sections[number.section] +=
          fmt::format("  {}: {}\n", number.key, common::quantity_text(common::shortest(number.of(machine)), number.unit, origin));
    }
  }
  std::string text;
  for (const auto& [section, numbers] : sections) text += fmt::format("{}:\n{}", section, numbers);
  return text;
}

}  // namespace slewlab::diagnosis
