#include "tools/commands/diagnose_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "common/unit.h"
#include "diagnosis/balance/axis_diagnosis.h"
#include "diagnosis/decimation.h"
#include "diagnosis/stretch.h"
#include "sim/drive/scenario_run.h"
#include "sim/effects/catalogue.h"
#include "sim/machine/scales.h"
#include "tools/commands/findings.h"
#include "tools/commands/long_logs.h"
#include "tools/commands/measured_runs.h"
#include "tools/commands/python_command.h"

namespace slewlab::tools {

namespace {

constexpr std::size_t kMostDrawn = 4000;  // points of a series on the page
constexpr double kWorthNaming = 0.005;    // probability
constexpr double kMostSamples = 3e5;      // that are fitted, of all logs together; chosen: a balance of so many takes a gigabyte
constexpr double kShortestStretch = 20.0;  // characteristic times, below which nothing of a log is fitted; as Thresholds::shortest_stretch
constexpr double kLeastUnbraked = 0.3;     // of a stretch; as kLeastTrusted of a crane's
constexpr double kNinetyPercent = 1.645;  // standard deviations of a normal 90 % interval

using diagnosis::AxisDiagnosis;
using diagnosis::AxisError;
using diagnosis::AxisOutcome;
using diagnosis::AxisSeries;
using diagnosis::BalanceModel;
using diagnosis::BalanceTerm;

// Units of what is told.
struct Words {
  const char *effort, *speed, *position, *inertia, *inertia_name, *damping;
};

Words words_of(const sim::MachineFile& axis) {
  return axis.axis.is_linear ? Words{"N", "m/s", "m", "kg", "mass", "N s/m"} : Words{"Nm", "rad/s", "rad", "kg m^2", "inertia", "Nm s/rad"};
}

struct Interval {
  double low = 0.0, high = 0.0;
};

// 90 % of a normal size; of one that cannot be negative, what of it is above zero.
Interval interval_of(double value, double deviation, bool is_positive) {
  const double low = value - kNinetyPercent * deviation;
  return {is_positive ? std::max(0.0, low) : low, value + kNinetyPercent * deviation};
}

// Of a law's first size; shapes are in the unit of what they are about.
std::string unit_of(const BalanceTerm& term, const Words& words) {
  if (term.law == "viscous") return words.damping;
  if (term.family == diagnosis::LawFamily::drive) return "s";
  return words.effort;
}

nlohmann::json to_json(const AxisError& error) { return {{"balance_rms", error.balance}, {"forward_speed_rms", error.forward}, {"forward_speed_rms_in_tenths", error.tenths}}; }

// The inertia and the sizes of these laws.
nlohmann::json sizes_of(const BalanceModel& model, const std::vector<BalanceTerm>& terms, const Words& words) {
  nlohmann::json sizes = nlohmann::json::array();
  const auto add_size = [&](const std::string& name, double value, double deviation, const std::string& unit, bool is_positive) {
    const Interval interval = interval_of(value, deviation, is_positive);
    sizes.push_back({{"parameter", name}, {"value", value}, {"unit", unit}, {"low_90", interval.low}, {"high_90", interval.high}});
  };
  add_size(words.inertia_name, model.inertia, model.inertia_deviation, words.inertia, true);
  for (const BalanceTerm& term : terms) {
    for (std::size_t k = 0; k < term.size.size(); ++k) {
      add_size(term.size.size() == 1 ? term.law : fmt::format("{}.{}", term.law, k + 1), term.size[k], term.deviation[k], unit_of(term, words), k == 0 && term.is_dissipative);
    }
    if (term.shape != 0.0) add_size(term.law + ".shape", term.shape, 0.0, term.law == "warming" || term.family == diagnosis::LawFamily::drive ? "s" : words.speed, true);
  }
  return sizes;
}

// Either set of sizes belongs together: those of the laws alone, and those of the laws beside what is carried along (`predicts`).
nlohmann::json to_json(const BalanceModel& model, double probability, const BalanceModel& predicts, const Words& words) {
  nlohmann::json json{{"laws", nlohmann::json::array()}, {"words", model.words()}, {"probability", probability},
                      {"sizes", sizes_of(model, model.terms, words)}, {"details", nlohmann::json::array()}};
  for (const BalanceTerm& term : model.named()) {
    json["laws"].push_back(term.law);
    json["law_probabilities"].push_back(term.probability);
  }
  for (const BalanceTerm& term : predicts.details) json["details"].push_back(term.law);
  if (!predicts.details.empty()) json["sizes_with_details"] = sizes_of(predicts, predicts.acting(), words);
  json["torque_recorded_ahead_s"] = predicts.skew;
  return json;
}

// What doubts of laws take away of the models' probabilities, and in words what that is instead; no words: nothing.
struct InTheirPlace {
  double probability = 0.0;
  std::string words;
};
InTheirPlace in_their_place(const diagnosis::BalanceAnswer& answer) {
  InTheirPlace found;
  for (const BalanceModel& model : answer.models) found.probability += model.probability - diagnosis::believed_probability(answer, model);
  for (const diagnosis::LawProbability& law : answer.laws) {
    if (law.belief < 1.0) found.words += (found.words.empty() ? "these with something unknown in the place of " : " and of ") + law.words;
  }
  return found;
}

// The laws of a family that were tried; a constant torque that says where a load over the position rests is none of its own.
std::vector<diagnosis::LawProbability> members_of(const AxisDiagnosis& found, diagnosis::LawFamily family) {
  std::vector<diagnosis::LawProbability> members = diagnosis::law_probabilities(found.answer);
  const bool has_rest = found.answer.best.named().size() < found.answer.best.terms.size();
  std::erase_if(members, [&](const diagnosis::LawProbability& law) { return law.family != family || (has_rest && law.law == "offset"); });
  return members;
}

nlohmann::json to_json(const AxisDiagnosis& found, const sim::MachineFile& axis, const Words& words) {
  const auto& validation = found.validation;
  const InTheirPlace instead = in_their_place(found.answer);
  nlohmann::json json{{"kind", "axis"},
                      {"gap", found.outcome != AxisOutcome::nothing_missing},
                      {"is_stated", found.outcome == AxisOutcome::nothing_missing || found.outcome == AxisOutcome::stated},
                      {"cannot_tell", found.outcome == AxisOutcome::not_identifiable},
                      {"verdict", found.verdict},
                      {"action", found.action},
                      {"unit", words.effort},
                      {"coordinate", axis.axis.is_linear ? "linear" : "rotary"},
                      {"position_unit", words.position},
                      {"speed_unit", words.speed},
                      {"nominal_inertia", found.nominal_inertia},
                      {"probability_unknown", found.answer.probability_unknown},
                      {"probability_unknown_instead", instead.probability},
                      {"unknown_instead", instead.words},
                      {"explained_share", found.answer.explained},
                      {"unexplained_share", found.unexplained},
                      {"has_unknown_remainder", found.has_remainder},
                      {"judged_share", found.answer.judged_share},
                      {"remainder", {{"follows", found.answer.remainder.variable}, {"words", found.answer.remainder.words}, {"share", found.answer.remainder.share}}},
                      {"validation",
                       {{"on", validation.place}, {"holds", validation.holds}, {"noise_rms", validation.noise}, {"floor_rms", validation.floor}, {"correlated_rms", validation.cause_together},
                        {"effort_rms", validation.effort}, {"speed_rms", validation.speed},
                        {"nominal", to_json(validation.nominal)}, {"inertia_alone", to_json(validation.inertia)},
                        {"cause", to_json(validation.cause)}}},
                      {"remarks", found.remarks},
                      {"causes", nlohmann::json::array()}};
  for (const diagnosis::AxisValidation& one : found.unseen) {
    json["unseen"].push_back({{"log", one.place}, {"holds", one.holds}, {"nominal", to_json(one.nominal)}, {"inertia_alone", to_json(one.inertia)}, {"cause", to_json(one.cause)}});
  }
  for (const BalanceModel& model : found.answer.models) {
    json["causes"].push_back(to_json(model, diagnosis::believed_probability(found.answer, model), &model == &found.answer.models.front() ? found.answer.best : model, words));
  }
  for (const diagnosis::FamilyProbability& one : diagnosis::family_probabilities(found.answer)) {
    nlohmann::json members = nlohmann::json::array();
    for (const diagnosis::LawProbability& law : members_of(found, one.family)) {
      members.push_back({{"law", law.law}, {"words", law.words}, {"probability", law.probability}});
    }
    json["families"].push_back({{"family", diagnosis::words_of(one.family)}, {"probability", one.probability}, {"members", members}});
  }
  return json;
}

// Of logs that had no part in the answer.
std::string unseen_text(const AxisDiagnosis& found, const Words& words) {
  const bool has_cause = found.outcome == AxisOutcome::stated;
  std::string text;
  for (const diagnosis::AxisValidation& one : found.unseen) {
    const auto line = [&](const char* what, double nominal, double inertia, double cause, const char* unit) {
      std::string told = fmt::format("  {:24} nominal {:.4g}, {} alone {:.4g}", what, nominal, words.inertia_name, inertia);
      if (has_cause) told += fmt::format(", with {} {:.4g}", found.answer.best.words(), cause);
      return told + " " + unit + "\n";
    };
    text += fmt::format("\nValidation on {} (had no part in the answer)\n", one.place);
    text += line("torque balance, RMS", one.nominal.balance, one.inertia.balance, one.cause.balance, words.effort);
    text += line("speed, simulated forward", one.nominal.forward, one.inertia.forward, one.cause.forward, words.speed);
    text += line("  anew at each tenth", one.nominal.tenths, one.inertia.tenths, one.cause.tenths, words.speed);
    if (has_cause) text += one.holds ? "  the cause predicts it better than the nominal axis and than another inertia\n"
                                     : "  the cause does not predict it better than the nominal axis and another inertia: do not rely on it\n";
  }
  return text;
}

// Falling probability, the first with its sizes.
std::string causes_text(const AxisDiagnosis& found, const Words& words) {
  std::string text = "\nCauses\n";
  const InTheirPlace instead = in_their_place(found.answer);
  std::vector<std::pair<double, std::string>> untold{{found.answer.probability_unknown, "outside the catalogue (unknown)"}};
  if (!instead.words.empty()) untold.emplace_back(instead.probability, instead.words);
  std::sort(untold.begin(), untold.end(), std::greater<>());
  const auto tell_those_above = [&](double probability) {
    while (!untold.empty() && untold.front().first > probability) {
      text += fmt::format("  {:5.1f} %  {}\n", 100 * untold.front().first, untold.front().second);
      untold.erase(untold.begin());
    }
  };
  for (const BalanceModel& model : found.answer.models) {
    const double probability = diagnosis::believed_probability(found.answer, model);
    tell_those_above(probability);
    const bool is_best = &model == &found.answer.models.front();
    if (!is_best && probability < kWorthNaming) continue;
    text += fmt::format("  {:5.1f} %  {}\n", 100 * probability, model.words());
    if (!is_best) continue;
    const Interval inertia = interval_of(model.inertia, model.inertia_deviation, true);
    text += fmt::format("            {} = {:.4g} {} (90 %: {:.4g} to {:.4g}; the file has {:.4g})\n", words.inertia_name, model.inertia, words.inertia,
                        inertia.low, inertia.high, found.nominal_inertia);
    // Beside a load over the position a constant torque says where that rests.
    const auto is_rest = [&](const BalanceTerm& term) { return term.law == "offset" && model.named().size() < model.terms.size(); };
    for (const BalanceTerm& term : model.terms) {
      for (std::size_t k = 0; k < term.size.size(); ++k) {
        const Interval interval = interval_of(term.size[k], term.deviation[k], k == 0 && term.is_dissipative);
        text += fmt::format("            {}{} = {:.4g} {} (90 %: {:.4g} to {:.4g}; there with {:.0f} %; without it the share of the gap explained falls by {:.1f} %)\n", term.words,
                            k == 1 && term.law == "viscous" ? ", half the difference of the directions"
                            : term.law == "spring"               ? ", from the middle of the range to its end"
                            : is_rest(term)                      ? ", in the middle of the range"
                                                                 : "", term.size[k],
                            unit_of(term, words), interval.low, interval.high, 100 * term.probability, 100 * term.share);
      }
    }
  }
  tell_those_above(-1.0);
  if (!found.answer.best.details.empty() && found.outcome == AxisOutcome::stated) {
    text += "            carried along, as every machine has a little of it, not sure to be there:";
    for (const BalanceTerm& term : found.answer.best.details) {
      text += fmt::format("{} {} {:.3g} +- {:.2g} {}", &term == &found.answer.best.details.front() ? "" : ",", term.words, term.size[0],
                          kNinetyPercent * term.deviation[0], unit_of(term, words));
    }
    text += fmt::format("; with it {} {:.4g} {}", words.inertia_name, found.answer.best.inertia, words.inertia);
    for (const BalanceTerm& term : found.answer.best.terms) text += fmt::format(", {} {:.3g} {}", term.words, term.size[0], unit_of(term, words));
    text += '\n';
  }
  return text;
}

std::string summary_text(const AxisDiagnosis& found, const Words& words) {
  const auto& validation = found.validation;
  const bool is_gap = found.outcome != AxisOutcome::nothing_missing;
  std::string text = fmt::format("{}.\n{}\n\nIs there a gap?  {}. Torque balance on {} (not fitted), RMS of the residual: nominal axis {:.4g} {}, {} alone {:.4g} {}",
                                 found.verdict, found.action, is_gap ? "Yes" : "No", validation.place, validation.nominal.balance, words.effort,
                                 words.inertia_name, validation.inertia.balance, words.effort);
  if (is_gap) text += fmt::format(", with {} {:.4g} {}", found.validated.words(), validation.cause.balance, words.effort);
  text += fmt::format(" (measured {:.4g} {}).\n", validation.effort, words.effort);
  if (found.outcome == AxisOutcome::stated) {
    text += "\nFamilies of laws, and which of their laws are there, alone or beside others\n";
    for (const diagnosis::FamilyProbability& one : diagnosis::family_probabilities(found.answer)) {
      if (one.probability < kWorthNaming) continue;
      text += fmt::format("  {:5.1f} %  {}\n", 100 * one.probability, diagnosis::words_of(one.family));
      for (const diagnosis::LawProbability& law : members_of(found, one.family)) {
        if (law.probability >= kWorthNaming) text += fmt::format("           {:5.1f} %  {}\n", 100 * law.probability, law.words);
      }
    }
  }
  if (found.outcome != AxisOutcome::not_identifiable) text += causes_text(found, words);
  text += fmt::format("\nValidation on {} (not fitted): RMS error, nominal -> {} alone -> with the cause\n", validation.place,
                      words.inertia_name);
  text += fmt::format("  {:24} {:10.4g} -> {:10.4g} -> {:10.4g} {}\n", "torque balance", validation.nominal.balance, validation.inertia.balance,
                      validation.cause.balance, words.effort);
  text += fmt::format("  {:24} {:10.4g} -> {:10.4g} -> {:10.4g} {}\n", "speed, simulated forward", validation.nominal.forward,
                      validation.inertia.forward, validation.cause.forward, words.speed);
  text += fmt::format("  {:24} {:10.4g} -> {:10.4g} -> {:10.4g} {}\n", "  anew at each tenth", validation.nominal.tenths, validation.inertia.tenths,
                      validation.cause.tenths, words.speed);
  text += unseen_text(found, words);
  for (const std::string& remark : found.remarks) text += "  note: " + remark + "\n";
  return text;
}

std::string series_text(const AxisSeries& series) {
  const std::size_t stride = std::max<std::size_t>(1, series.time.size() / kMostDrawn);
  std::string text = "time,position,speed,effort,residual_nominal,residual\n";
  const std::vector<double> effort = diagnosis::decimated(series.effort, stride), before = diagnosis::decimated(series.nominal_residual, stride),
                            after = diagnosis::decimated(series.residual, stride);
  for (std::size_t row = 0; row * stride < series.time.size(); ++row) {
    const std::size_t n = row * stride;
    text += fmt::format("{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n", series.time[n], series.position[n], series.speed[n], effort[row], before[row], after[row]);
  }
  return text;
}

// The axis's file with what was found laid over it.
std::string with_effect_text(const AxisDiagnosis& found, const sim::MachineFile& axis, const std::string& file) {
  std::string text = fmt::format("include: {}\ndescription: The nominal axis with what slewlab diagnose found.\n", file);
  if (found.outcome != AxisOutcome::stated) return text;
  // The motor's own inertia stays; what it moves takes the difference.
  const double own = found.nominal_inertia - axis.parameters.house.inertia;
  if (const double moved = found.answer.best.inertia - own; moved > 0.0) {
    text += fmt::format("{}: {}\n", axis.axis.is_linear ? "mass" : "inertia",
                        common::quantity_text(common::shortest(moved), axis.axis.is_linear ? common::Unit::kilogram : common::Unit::kilogram_square_metre,
                                              "slewlab diagnose"));
  }
  if (!found.effects.empty()) text += common::effects_text(found.effects, sim::effects_for(axis), "slewlab diagnose");
  return text;
}

LongLogSettings long_logs(const sim::MachineFile& axis, const DiagnoseOptions& options, const LoggedRuns& logged) {
  double shortest_period = std::numeric_limits<double>::infinity();
  for (const LoggedRun& one : logged.runs) {
    const std::size_t count = one.run.order.channels[msgs::kEncoderIndex].size();
    if (count > 1) shortest_period = std::min(shortest_period, diagnosis::length_of(one.run) / static_cast<double>(count - 1));
  }
  const double time = sim::characteristic_time(axis.parameters);
  const auto judged_share = [&axis](const MeasuredRun& one) {
    const double length = diagnosis::length_of(one.run);
    const diagnosis::AxisRecord record = diagnosis::axis_record({one.name, one.run}, axis);  // without brakes
    return record.step * static_cast<double>(record.position.size()) / length;
  };
  return {options.fitted_seconds.value_or(kMostSamples * shortest_period), kShortestStretch * time, time, kLeastUnbraked, judged_share};
}

}  // namespace

int diagnose_axis_logs(const sim::MachineFile& axis, const DiagnoseOptions& options, std::ostream& out) {
  LoggedRuns logged = logged_runs(options.logs);
  const LongLogSettings settings = long_logs(axis, options, logged);
  auto [measured, held_out] = fitted_runs(settings, std::move(logged));
  std::vector<diagnosis::NamedRun> unseen;
  for (MeasuredRun& one : held_out.runs) unseen.push_back({one.name, std::move(one.run)});
  std::vector<diagnosis::NamedRun> runs;
  for (MeasuredRun& one : measured.runs) runs.push_back({one.name, std::move(one.run)});
  if (!options.unseen.empty()) {
    MeasuredRuns kept_back = measured_runs(options.unseen);
    for (MeasuredRun& one : kept_back.runs) unseen.push_back({one.name, std::move(one.run)});
  }
  AxisDiagnosis found = diagnosis::diagnose_axis(axis, runs, options.without, unseen);
  for (const MeasuredRun& one : measured.runs) found.remarks.insert(found.remarks.end(), one.remarks.begin(), one.remarks.end());
  if (measured.is_damaged) found.verdict += kOfADamagedLog;
  const Words words = words_of(axis);
  FindingsFolder findings(options.out);
  nlohmann::json json = to_json(found, axis, words);
  json["axis"] = std::filesystem::absolute(options.crane).string();
  for (std::size_t r = 0; r < runs.size(); ++r) json["series"].push_back({{"log", runs[r].name}, {"file", fmt::format("series_{}.csv", r + 1)}});
  for (std::size_t r = 0; r < runs.size(); ++r) findings.write(fmt::format("series_{}.csv", r + 1), series_text(found.series[r]));
  findings.write("diagnosis.json", json.dump(2) + "\n");
  findings.write("axis_with_effect.yaml", with_effect_text(found, axis, seen_from(options.crane, options.out)));
  const std::string summary = summary_text(found, words);
  findings.write("summary.txt", summary);
  findings.keep();
  out << summary << "files: " << options.out.string() << std::endl;
  const int drawn = call_python("diagnosis_report.py", {options.out.string()});
  return drawn == 0 && found.outcome == AxisOutcome::not_identifiable ? kCannotTell : drawn;
}

}  // namespace slewlab::tools
