#include "tools/commands/diagnose_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "common/input_error.h"
#include "common/stop_signal.h"
#include "controller/controller_file.h"
#include "controller/effects/catalogue.h"
#include "diagnosis/admit.h"
#include "diagnosis/balance/axis_diagnosis.h"
#include "diagnosis/decimation.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/discriminate.h"
#include "diagnosis/fit.h"
#include "diagnosis/live_hypotheses.h"
#include "diagnosis/next_manoeuvre.h"
#include "diagnosis/nuisance.h"
#include "diagnosis/prediction.h"
#include "sim/analysis/eigen.h"
#include "sim/drive/scenario_run.h"
#include "sim/machine/machine_file.h"
#include "sim/effects/catalogue.h"
#include "tools/commands/diagnose_axis.h"
#include "tools/commands/findings.h"
#include "tools/commands/long_logs.h"
#include "tools/commands/measured_runs.h"
#include "tools/commands/python_command.h"
#include "tools/commands/status_line.h"

namespace slewlab::tools {

namespace {

constexpr double kWorthNaming = 0.05;  // probability that an effect acts, from which the page says so
constexpr double kWorthFollowing = 0.02;  // residual share of the gap, from which it is said what it follows
constexpr double kLineInterval = 2.0;  // [s] between progress lines where there is no terminal
constexpr int kThreads = 2;            // of a crane, where nothing else is said
// The page's spectrogram: up to half the highest frequency that is judged, over windows of two characteristic times.
constexpr double kShownShare = 0.5, kShownWindow = 2.0;
constexpr double kDrawnRate = 5.0;  // of the highest frequency shown: samples per second of the page's series

using diagnosis::Cause;
using diagnosis::Diagnosis;
using diagnosis::Point;
using diagnosis::Record;

// What would tell the first cause from each of its group, in its order; empty without a controller to run with.
using ToldApartBy = std::vector<diagnosis::Separation>;

ToldApartBy told_apart_by(const sim::MachineSettings& nominal, const std::optional<controller::ControllerSettings>& controller,
                          const Diagnosis& found) {
  ToldApartBy best;
  if (!controller || found.causes.empty()) return best;
  const Cause& first = found.causes.front();
  for (const diagnosis::Alike& alike : first.group) {
    const auto other =
        std::find_if(found.causes.begin(), found.causes.end(), [&](const Cause& cause) { return name_of(cause) == alike.name; });
    if (other == found.causes.end()) return {};
    best.push_back(
        diagnosis::separations(diagnosis::machine_at(nominal, found.nuisances, first.point),
                               diagnosis::machine_at(nominal, found.nuisances, other->point), *controller)
            .front());
  }
  return best;
}

nlohmann::json to_json(const diagnosis::Validation& validation) {
  const auto error = [](const diagnosis::ValidationError& one) {
    nlohmann::json errors{{"residual_variance_ratio", one.residual_ratio}};
    if (one.closed_loop) errors["relative_closed_loop_error"] = *one.closed_loop;
    return errors;
  };
  return {{"nominal", error(validation.nominal)}, {"parameters", error(validation.parameters)}, {"cause", error(validation.cause)},
          {"holds", validation.holds}};
}

nlohmann::json to_json(const Cause& cause, const std::vector<sim::Parameter>& parameters) {
  nlohmann::json json{{"effects", cause.effects},
                      {"probability", cause.probability},
                      {"explained_share", cause.explained},
                      {"residual_power", cause.residual_power},
                      {"prior", cause.prior},
                      {"prior_chance", cause.prior_chance},
                      {"residual_variance_ratio", cause.mean_square},
                      {"fit_ended", diagnosis::name_of(cause.ending)},
                      {"or", cause.also},
                      {"cannot_be_told_from", nlohmann::json::array()},
                      {"sizes", nlohmann::json::array()}};
  for (const diagnosis::Alike& other : cause.group) {
    json["cannot_be_told_from"].push_back({{"cause", other.name}, {"signature_apart", other.apart}});
  }
  for (const diagnosis::Size& size : cause.sizes) {
    json["sizes"].push_back({{"parameter", size.parameter}, {"value", size.value}, {"unit", size.unit},
                             {"low_90", size.low}, {"high_90", size.high}});
  }
  if (cause.validation) json["validation"] = to_json(*cause.validation);
  for (std::size_t k = 0; k < std::min(parameters.size(), cause.point.nuisance.size()); ++k) {
    const std::string name(parameters[k].name);
    const auto factor = [&](double amount) { return 1.0 + parameters[k].spread * amount; };
    json["parameters"][name] = factor(cause.point.nuisance[k]);
    if (k < cause.parameter_intervals.size()) json["parameter_intervals"][name] = {factor(cause.parameter_intervals[k].low), factor(cause.parameter_intervals[k].high)};
  }
  return json;
}

// "speed (71 % of it)", "speed or time, which these records cannot tell apart (71 % of it)"; empty where nothing is followed.
std::string followed_text(const Diagnosis& diagnosis) {
  const std::vector<std::string> variables = diagnosis::followed_variables(diagnosis.discrepancies);
  if (variables.empty()) return "";
  const auto named = std::find_if(diagnosis.discrepancies.begin(), diagnosis.discrepancies.end(), [&](const diagnosis::Discrepancy& one) { return one.variable == variables.front(); });
  const bool is_one = variables.size() == 1;
  return fmt::format("{}{} ({:.0f} % of what is slower than the structure)", variables.front() == "constant" ? "is constant" : "follows the " + fmt::format("{}", fmt::join(variables, " or the ")),
                     is_one ? "" : ", which these records cannot tell apart", 100 * named->share);
}

// Of a missing torque that follows nothing.
std::string where_to_look(const Diagnosis& diagnosis) {
  const std::optional<diagnosis::ChannelShare> most = diagnosis::channel_of_most(diagnosis.bands);
  const auto is_torque = [](const std::string& channel) { return channel.starts_with("torque"); };
  // Of a crane with one motor group nothing tells the motors from what is behind them.
  const bool has_other_motors = std::any_of(diagnosis.bands.begin(), diagnosis.bands.end(), [&](const diagnosis::BandShare& band) { return is_torque(band.channel) && most && band.channel != most->channel; });
  if (!most || (is_torque(most->channel) && !has_other_motors)) return "look behind the motors, and at what is faster";
  return fmt::format("{:.0f} % of the gap is in the {}, look {}", 100 * most->share, most->channel,
                     is_torque(most->channel) ? "at what those motors alone have: their drive, brake, encoder, gearboxes and pinions" : "at that sensor, and at what moves boom and load");
}

// What a person acts on, in one sentence.
std::string answer_sentence(const Diagnosis& diagnosis) {
  if (!diagnosis.gap) {
    const bool is_nominal = diagnosis.mean_square_nominal <= 1.0;
    const std::string with_gains = diagnosis.gains.empty() ? "" : ", with gains of the accelerometers as fitted";
    if (!is_nominal && diagnosis.probability_nothing + diagnosis.probability_hidden < diagnosis::kSure) {
      return fmt::format("Not sure: no effect is missing, {:.0f} %; parameters explain the records{}.", 100 * diagnosis.probability_nothing, with_gains);
    }
    const std::string why = (is_nominal ? "the residual of the nominal machine is no more than noise" : "parameters within their spread explain the records") + with_gains;
    if (diagnosis.probability_nothing >= diagnosis::kSure) return fmt::format("No effect is missing: {}.", why);
    return fmt::format("No effect is missing that these records would show: {}; with {:.0f} % none is, with {:.0f} % one that is too small for them.", why,
                       100 * diagnosis.probability_nothing, 100 * diagnosis.probability_hidden);
  }
  if (diagnosis.is_unknown || diagnosis.causes.empty()) {
    // What is beside an effect may not be known, and the effect be likelier than that nothing known acts.
    if (!diagnosis.effects.empty() && diagnosis.effects.front().second > diagnosis.probability_unknown) {
      const auto& [effect, acts] = diagnosis.effects.front();
      return fmt::format("Not sure: {} acts, {:.0f} %, alone or beside another effect that these records do not tell; outside the catalogue (unknown) {:.0f} %.", effect, 100 * acts,
                         100 * diagnosis.probability_unknown);
    }
    if (!diagnosis.far_parameters.empty() && !diagnosis.refuted) {
      return fmt::format("Outside the catalogue (unknown), {:.0f} %, or another machine than the nominal one: parameters alone leave no more than noise, farther off than machines of one make differ ({}). Check these numbers "
                         "of the machine's file first.", 100 * diagnosis.probability_unknown, diagnosis::in_words(diagnosis.far_parameters));
    }
    const std::string followed = followed_text(diagnosis);
    std::string why = "no known effect explains the gap on data that were not fitted";
    if (diagnosis.refuted) {
      const diagnosis::UnseenRecord& failed = *std::find_if(diagnosis.unseen.begin(), diagnosis.unseen.end(), [](const diagnosis::UnseenRecord& one) { return !one.validation.holds; });
      why = fmt::format("{}, {:.0f} % by the records that were fitted, does not predict {} better than the nominal machine and parameters alone do", failed.cause, 100 * *diagnosis.refuted, failed.record);
    }
    return fmt::format("Outside the catalogue (unknown), {:.0f} %: {}; the missing torque {}.", 100 * diagnosis.probability_unknown, why,
                       followed.empty() ? "follows neither speed nor angle, time, torque or its rate: " + where_to_look(diagnosis) : followed);
  }
  const Cause& first = diagnosis.causes.front();
  std::string text = fmt::format("{}{}, {:.0f} %", diagnosis.lead_acts < diagnosis::kSure ? "Not sure: " : "", told_name(first), 100 * diagnosis.lead_acts);
  if (!first.also.empty()) text += ", indistinguishable in these records";
  if (diagnosis.lead_acts - first.probability > kWorthNaming) text += fmt::format(" ({:.0f} % alone, the rest beside what these records may hide)", 100 * first.probability);
  if (!first.validation && !first.point.effects.empty()) {
    text += "; not tested on data that were not fitted";
  }
  if (first.validation && first.validation->unknown_cost) {
    text += "; on data that were not fitted the residual has the power that it predicts";
  } else if (first.validation && first.validation->nominal.residual_ratio > 1.0) {
    const diagnosis::Validation& validation = *first.validation;
    // Down to the noise, which nothing explains.
    const double left = std::max(0.0, validation.cause.residual_ratio - 1.0) / (validation.nominal.residual_ratio - 1.0);
    text += fmt::format("; it explains {:.1f} % of the gap on data that were not fitted", 100 * std::clamp(1.0 - left, 0.0, 1.0));
    const std::string followed = followed_text(diagnosis);
    if (left > kWorthFollowing && !followed.empty()) text += "; the rest " + followed;
  }
  if (!first.group.empty()) text += "; these records cannot tell it from " + first.group.front().name + (first.group.size() > 1 ? " and others" : "");
  return text + ".";
}

// The same, with the words that it is of the readable part of a damaged log.
std::string answer_sentence(const Diagnosis& diagnosis, bool is_damaged) {
  std::string text = answer_sentence(diagnosis);
  if (is_damaged) text.insert(text.size() - 1, kOfADamagedLog);  // before its full stop
  return text;
}

nlohmann::json to_json(const Diagnosis& diagnosis, bool is_damaged) {
  nlohmann::json json{{"answer", answer_sentence(diagnosis, is_damaged)},
                      {"gap", diagnosis.gap},
                      {"verdict", diagnosis.verdict},
                      {"controller_differs", diagnosis.controller_differs},
                      {"commands_per_row", diagnosis.commands_per_row},  // that the records were taken to have: more than 1 where the controller seems to be faster than the recorder
                      {"residual_variance_ratio_nominal", diagnosis.mean_square_nominal},
                      {"residual_variance_ratio_parameters", diagnosis.mean_square_parameters},
                      {"probability_nothing_missing", diagnosis.probability_nothing},
                      {"probability_hidden", diagnosis.probability_hidden},
                      {"probability_unknown", diagnosis.probability_unknown},
                      {"probability_refuted", diagnosis.refuted.value_or(0.0)},  // what of that a cause had which an unseen log refutes
                      {"simulations", diagnosis.simulations},
                      {"simulation_seconds", diagnosis.simulation_seconds},
                      {"seconds", diagnosis.total_seconds},
                      {"remarks", diagnosis.remarks},
                      {"not_excited", diagnosis.not_excited},
                      {"hidden", diagnosis.hidden},
                      {"subsystems", nlohmann::json::object()},
                      {"effects", nlohmann::json::object()},
                      {"causes", nlohmann::json::array()}};
  for (const auto& [subsystem, probability] : diagnosis.subsystems) json["subsystems"][subsystem] = probability;
  for (const auto& [effect, probability] : diagnosis.effects) json["effects"][effect] = probability;
  for (const diagnosis::AccelerometerGain& one : diagnosis.gains) json["accelerometer_gains"].push_back({{"name", one.name}, {"gain", one.gain}, {"deviation", one.deviation}});
  for (const diagnosis::BandShare& band : diagnosis.bands) {
    json["bands"].push_back({{"signal", band.channel}, {"from_hz", band.from}, {"to_hz", band.to}, {"share", band.share},
                             {"residual_variance_ratio", band.mean_square}});
  }
  for (const diagnosis::Moment& moment : diagnosis.moments) {
    json["moments"].push_back({{"log", moment.record}, {"time_s", moment.time}, {"phase", moment.phase},
                               {"missing_torque_nm", moment.missing_torque}});
  }
  for (const diagnosis::Discrepancy& one : diagnosis.discrepancies) {
    nlohmann::json curves = nlohmann::json::array();
    for (const diagnosis::DiscrepancyCurve& curve : one.curves) {
      curves.push_back({{"part", curve.part}, {"at", curve.at}, {"missing_torque_nm", curve.torque}, {"deviation_nm", curve.deviation}});
    }
    json["discrepancies"].push_back({{"follows", one.variable}, {"unit", one.unit}, {"share", one.share}, {"log_evidence", one.evidence}, {"curves", curves}});
  }
  for (const diagnosis::ControllerReplay& replay : diagnosis.controller_replay) {
    json["controller_replay"].push_back({{"torque_rms_nm", replay.torque_rms}, {"difference_rms_nm", replay.difference_rms},
                                         {"largest_difference_nm", replay.largest_difference}, {"at_s", replay.largest_time}});
  }
  for (const diagnosis::FarParameter& one : diagnosis.far_parameters) json["far_parameters"].push_back({{"parameter", one.name}, {"change", one.change}});
  for (const Cause& cause : diagnosis.causes) json["causes"].push_back(to_json(cause, diagnosis.nuisances.parameters));
  for (const diagnosis::UnseenRecord& one : diagnosis.unseen) {
    json["unseen"].push_back({{"log", one.record}, {"cause", one.cause}, {"validation", to_json(one.validation)},
                              {"missing_torque_rms_nm", {{"nominal", one.nominal_torque}, {"parameters", one.parameters_torque}, {"cause", one.cause_torque}}}});
  }
  return json;
}

// In closed loop, of the record that the page shows.
struct Predicted {
  diagnosis::Prediction before, after;  // by the nominal crane, and with the effect
};

// Measured and missing torque, and what was predicted where there is a controller: every `stride`th value of the grid on which the record was judged,
// filtered so that nothing folds into the page's spectrogram. A record whose beginning was not followed is shown from where it was.
std::string series_text(const Record& record, const diagnosis::Followed& followed, const std::optional<Predicted>& predicted,
                        std::size_t stride) {
  std::string head = "time_s";
  std::vector<std::vector<double>> columns;
  const auto left_out = static_cast<std::size_t>(std::lround((followed.start_time - record.start_time) / record.step));
  const std::size_t points = stride * static_cast<std::size_t>(std::lround(followed.step / record.step));  // of the record, from row to row
  const auto add_followed = [&](const std::string& name, const std::vector<double>& values) {
    head += ',' + name;
    columns.push_back(diagnosis::decimated(values, stride));
  };
  const auto add = [&](const std::string& name, const std::vector<double>& values) {
    head += ',' + name;
    columns.push_back(diagnosis::decimated({values.begin() + static_cast<std::ptrdiff_t>(left_out), values.end()}, points));
  };
  add("speed", record.shaft_speed[0]);
  add_followed("missing_torque", followed.nominal.missing_torque[0]);
  add_followed("missing_torque_after", followed.explained.missing_torque[0]);
  add("torque", record.motor_torque[0]);
  if (predicted) {
    add("torque_before", predicted->before.series.motor_torque[0]);
    add("torque_after", predicted->after.series.motor_torque[0]);
  }
  for (std::size_t a = 0; a < diagnosis::kAccelerometerCount; ++a) {
    if (record.acceleration[a].empty()) continue;
    const std::string name = diagnosis::accelerometer_name(static_cast<int>(a));
    add(name, record.acceleration[a]);
    if (!predicted) continue;
    add(name + "_before", predicted->before.series.acceleration[a]);
    add(name + "_after", predicted->after.series.acceleration[a]);
  }
  std::string text = head + "\n";
  for (std::size_t row = 0; left_out + row * points < record.size(); ++row) {
    text += fmt::format("{:.4f}", record.time(left_out + row * points));
    for (const std::vector<double>& column : columns) text += fmt::format(",{:.6g}", column[row]);
    text += '\n';
  }
  return text;
}

std::string advice(const diagnosis::Separation& apart) {
  if (apart.noise_floors < diagnosis::kSeparated) {
    return "no manoeuvre tried and no sensor on crane or motors would: measure the effect itself";
  }
  return fmt::format("{} would: {} {:.2g} {} apart, {:.0f} times its noise", apart.manoeuvre, apart.signal, apart.difference, apart.unit,
                     apart.noise_floors);
}

// Where the gaps were taken, in words.
std::string place_of_gaps(const Diagnosis& diagnosis, const Cause& first, const Record& last) {
  std::string text = last.name + " (fitted";
  if (diagnosis.held_out) {
    text = diagnosis.held_out->is_half
               ? fmt::format("{} from {:.1f} s on (not fitted", diagnosis.held_out->record, diagnosis.held_out->from_time)
               : diagnosis.held_out->record + " (not fitted";
    if (!first.controller_effects.empty()) text += ", except for the controller's effects";
  }
  text += "; simulated from the operator's commands alone)";
  if (diagnosis.is_unknown) text += ", with " + name_of(first) + ", the nearest cause, which is not the answer";
  return text;
}

// "drive 96 %, house 3 %"
std::string in_per_cent(std::span<const std::pair<std::string, double>> probabilities) {
  std::string text;
  for (const auto& [name, probability] : probabilities) text += fmt::format("{}{} {:.0f} %", text.empty() ? "" : ", ", name, 100 * probability);
  return text;
}

// Of a record that had no part in the answer.
std::string unseen_text(const diagnosis::UnseenRecord& one) {
  const diagnosis::Validation& validation = one.validation;
  const bool has_cause = !one.cause.empty();
  const auto line = [&](const char* what, double nominal, double parameters, double cause, const char* unit) {
    std::string text = fmt::format("  {:24} nominal {:.4g}, best parameters {:.4g}", what, nominal, parameters);
    if (has_cause) text += fmt::format(", with {} {:.4g}", one.cause, cause);
    return text + unit + "\n";
  };
  std::string text = fmt::format("\nValidation on {} (had no part in the answer)\n", one.record);
  text += line("residual variance ratio", validation.nominal.residual_ratio, validation.parameters.residual_ratio, validation.cause.residual_ratio, "");
  text += line("missing torque, RMS", one.nominal_torque, one.parameters_torque, one.cause_torque, " Nm per motor");
  if (validation.nominal.closed_loop && validation.parameters.closed_loop && validation.cause.closed_loop) {
    text += line("relative error, closed loop", *validation.nominal.closed_loop, *validation.parameters.closed_loop, *validation.cause.closed_loop, "");
  }
  if (has_cause && !validation.holds) text += "  the cause does not predict it better than the nominal machine and parameters alone: it is not the answer\n";
  else if (has_cause && validation.is_said_by_parameters) text += "  the cause predicts it better than the nominal machine; parameters alone, farther off than machines of one make differ, say the same\n";
  else if (has_cause) text += "  the cause predicts it better than the nominal machine and than parameters alone\n";
  return text;
}

// What of the machine's file the records contradict, where something explains them.
std::string parameters_told(const Diagnosis& diagnosis) {
  if (diagnosis.is_unknown || diagnosis.causes.empty()) return "";
  const Cause& first = diagnosis.causes.front();
  const std::vector<diagnosis::MovedParameter> moved = diagnosis::moved_parameters(diagnosis.nuisances, first.point.nuisance, first.parameter_intervals);
  if (moved.empty()) return "";
  std::string text = first.effects.empty() ? "\nParameters that these records put elsewhere than the machine's file (all in crane_as_fitted.yaml)\n"
                                           : fmt::format("\nParameters that these records put elsewhere than the machine's file, beside {} (all in crane_as_fitted.yaml)\n", told_name(first));
  for (const diagnosis::MovedParameter& one : moved) text += fmt::format("  {:24} {:+.1f} % (90 %: {:+.1f} to {:+.1f})\n", one.name, 100 * one.change, 100 * one.low, 100 * one.high);
  return text;
}

// The page that the terminal, summary.txt and diagnosis.html show.
std::string summary_text(const Diagnosis& diagnosis, bool is_damaged, const ToldApartBy& apart, const std::optional<Predicted>& predicted,
                         const std::string& place, const std::optional<diagnosis::NextManoeuvre>& next) {
  std::ostringstream out;
  out << answer_sentence(diagnosis, is_damaged) << "\n\n";
  const bool is_of_controller_alone = diagnosis.controller_differs && diagnosis.mean_square_nominal <= 1.0 && diagnosis.counts == 0.0;
  out << fmt::format("Is there a gap?  {}. Residual variance ratio (1 = noise only): nominal {:.4g}, best parameters {:.4g}",
                     !diagnosis.gap ? "No" : is_of_controller_alone ? "Yes, in what the controller answered; the crane moves as its file says" : "Yes",
                     diagnosis.mean_square_nominal, diagnosis.mean_square_parameters);
  if (diagnosis.gap && !diagnosis.causes.empty()) {
    out << fmt::format(", with {} {:.3g}", name_of(diagnosis.causes.front()), diagnosis.causes.front().mean_square);
  }
  out << ".\n";
  out << "Which side?      " << (diagnosis.controller_differs ? "The controller answers otherwise than its settings say.\n"
                                  : diagnosis.controller_replay.empty() ? "The controller was not given.\n"
                                  : !diagnosis.has_controller           ? "These records do not tell what the controller knew.\n"
                                                                        : "The controller answers as its settings say.\n");
  if (diagnosis.gap && !diagnosis.subsystems.empty()) {
    out << "Where?           " << in_per_cent(std::span(diagnosis.subsystems).first(std::min<std::size_t>(3, diagnosis.subsystems.size()))) << "\n";
  }
  const bool is_in_the_motion = diagnosis.gap && !is_of_controller_alone;
  for (std::size_t i = 0; i < diagnosis.bands.size() && i < 2 && is_in_the_motion; ++i) {
    const diagnosis::BandShare& band = diagnosis.bands[i];
    out << fmt::format("                 {:.0f} % of the gap in the {}, {:.2g} to {:.2g} Hz\n", 100 * band.share, band.channel, band.from, band.to);
  }
  if (is_in_the_motion && !diagnosis.moments.empty()) {
    const diagnosis::Moment& moment = diagnosis.moments.front();
    out << fmt::format("When?            most at {:.1f} s of {}, {}: {:.3g} Nm per motor are missing\n", moment.time, moment.record,
                       moment.phase, moment.missing_torque);
  }
  out << "\nCauses\n";
  const std::string unknown = fmt::format("  {:5.1f} %  outside the catalogue (unknown)\n", 100 * diagnosis.probability_unknown);
  bool is_unknown_told = false;
  const bool is_noise_left = diagnosis.mean_square_parameters <= diagnosis::kNoiseAlone;  // a share of it is none of the gap
  for (std::size_t i = 0; i < diagnosis.causes.size() && i < 5; ++i) {
    const Cause& cause = diagnosis.causes[i];
    if (!is_unknown_told && diagnosis.probability_unknown > cause.probability) {
      out << unknown;
      is_unknown_told = true;
    }
    if (cause.effects.empty() && !diagnosis.gap) {
      out << fmt::format("  {:5.1f} %  nothing is missing: the nominal machine, its parameters within their spread\n", 100 * cause.probability);
    } else if (cause.effects.empty()) {  // the gap is what they leave
      out << fmt::format("  {:5.1f} %  {} (residual variance ratio on the fitted records: nominal {:.4g}, with them {:.3g})\n", 100 * cause.probability, told_name(cause), diagnosis.mean_square_nominal,
                         cause.mean_square);
    } else {
      out << fmt::format("  {:5.1f} %  {} ({})\n", 100 * cause.probability, told_name(cause),
                         is_noise_left ? std::string("parameters alone leave no more than noise on the fitted records")
                                       : fmt::format("share of the gap explained on the fitted records: {:.1f} %", 100 * cause.explained));
    }
    if (cause.validation) {
      const diagnosis::Validation& validation = *cause.validation;
      out << fmt::format("            residual variance ratio on data that were not fitted: nominal {:.4g}, parameters alone {:.4g}, with it {:.3g}{}{}\n",
                         validation.nominal.residual_ratio, validation.parameters.residual_ratio, validation.cause.residual_ratio,
                         validation.unknown_cost ? " (1 = noise and the draws of the effect)" : "",
                         validation.holds ? "" : ": it does not predict them better, and cannot lead");
    }
    if (i > 1) continue;
    for (const diagnosis::Size& size : cause.sizes) {
      out << fmt::format("            {} = {:.4g} {} (90 %: {:.4g} to {:.4g})\n", size.parameter, size.value, size.unit, size.low, size.high);
    }
    for (std::size_t k = 0; k < cause.group.size(); ++k) {
      out << fmt::format("            these records cannot tell it from {} (signature {:.1f} % apart)\n", cause.group[k].name,
                         100 * cause.group[k].apart);
      if (i == 0 && k < apart.size()) out << "              " << advice(apart[k]) << "\n";
    }
  }
  if (!is_unknown_told) out << unknown;
  if (diagnosis.probability_hidden > 0.0) {
    out << fmt::format("  {:5.1f} %  an effect that is too small for these records{}{}\n", 100 * diagnosis.probability_hidden,
                       diagnosis.hidden.empty() ? "" : "; more than half of their sizes are, of ", fmt::join(diagnosis.hidden, ", "));
  }
  const auto unlikely = std::find_if(diagnosis.effects.begin(), diagnosis.effects.end(),
                                     [](const auto& effect) { return effect.second < kWorthNaming; });
  const std::string acting = in_per_cent({diagnosis.effects.begin(), unlikely});
  if (!acting.empty()) out << "  each effect, alone or beside another: " << acting << "\n";
  out << parameters_told(diagnosis);
  if (next) {
    out << fmt::format("\nNext manoeuvre    next_manoeuvre.yaml ({}): {:.2f} of the {:.2f} bits that are open are expected of it; {} and {} differ most in the {}, by {:.0f} "
                       "times its noise. Run it, and give its log on top of these.\n",
                       next->manoeuvre.name, next->gain, next->open, next->first, next->second, next->separation.signal, next->separation.noise_floors);
  }
  // Where nothing is missing, the parameters that were fitted to what noise there is are no cause to compare with.
  const bool has_cause = diagnosis.gap;
  if (predicted) {
    out << "\nValidation on " << place << ": RMS error" << (has_cause ? ", nominal -> with the cause\n" : " of the nominal machine\n");
  }
  for (std::size_t i = 0; predicted && i < predicted->before.gaps.size(); ++i) {
    const diagnosis::SignalGap &before = predicted->before.gaps[i], &after = predicted->after.gaps[i];
    out << fmt::format("  {:24} {:10.4g}", before.signal, before.gap) << (has_cause ? fmt::format(" -> {:10.4g}", after.gap) : "") << " " << before.unit << "\n";
  }
  for (const diagnosis::UnseenRecord& one : diagnosis.unseen) out << unseen_text(one);
  for (const std::string& remark : diagnosis.remarks) out << "  note: " << remark << "\n";
  if (!diagnosis.not_excited.empty()) {
    out << fmt::format("\nNot identifiable from these records, because no size that was tried changes them enough: {}\n", fmt::join(diagnosis.not_excited, ", "));
  }
  out << fmt::format("\n{} simulations with {:.1f} s in them, {:.1f} s in all\n", diagnosis.simulations,
                     diagnosis.simulation_seconds, diagnosis.total_seconds);
  return out.str();
}

// Of the nominal crane's boom and gears, with the boom cut as fits cut it; none of a crane that has neither.
nlohmann::json modes_json(const sim::MachineSettings& nominal, double highest) {
  nlohmann::json modes = nlohmann::json::array();
  for (const sim::Mode& mode : sim::crane_modes(nominal.crane)) {
    if (mode.kind == sim::ModeKind::kRigid || mode.kind == sim::ModeKind::kLoad) continue;
    if (mode.frequency > highest) break;
    modes.push_back({{"name", fmt::format("{} {}", sim::name_of(mode.kind), mode.count)}, {"frequency_hz", mode.frequency}});
  }
  return modes;
}

// Of an axis: its laws have names of their own, and one thread does it all.
void check_options_of_an_axis(const DiagnoseOptions& options, common::InputProblems& problems) {
  const std::vector<std::string> known = diagnosis::balance_law_names();
  for (const std::string& name : options.without) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    problems.push_back({{"--without", 0, 0}, "", name, fmt::format("a law of an axis's torque balance: one of {}", fmt::join(known, ", "))});
  }
  if (!options.controller.empty()) {
    problems.push_back({{"--controller", 0, 0}, "", options.controller.string(), "no --controller beside an axis, which is judged by its torque balance"});
  }
  if (options.is_torque_measured) problems.push_back({{"--measured-torque", 0, 0}, "", "it", "no --measured-torque beside an axis, of which every torque may have been measured"});
  if (options.threads) {
    problems.push_back({{"--threads", 0, 0}, "", std::to_string(*options.threads), "no --threads beside an axis, whose diagnosis takes about a second on one"});
  }
}

// Whatever the machine: what does not suit it may be left out as well.
common::EffectCatalogue all_effects() {
  common::EffectCatalogue all;
  for (const sim::EffectDescription* effect : sim::effect_catalogue()) all.effects.push_back(effect->about);
  for (const controller::ControllerEffect* effect : controller::effect_catalogue()) all.effects.push_back(effect->about);
  return all;
}

void check_options_of_a_crane(const DiagnoseOptions& options, common::InputProblems& problems) {
  const common::EffectCatalogue all = all_effects();
  for (const std::string& name : options.without) {
    if (all.find(name) != nullptr) continue;
    problems.push_back({{"--without", 0, 0}, "", name, common::expected_effect_name(all, name)});
  }
}

// What of the command line is wrong, before any work is done.
common::InputProblems problems_of(const DiagnoseOptions& options, sim::MachineKind kind) {
  common::InputProblems problems;
  kind == sim::MachineKind::axis ? check_options_of_an_axis(options, problems) : check_options_of_a_crane(options, problems);
  // What one log says twice would count as two logs that agree.
  std::set<std::filesystem::path> seen;
  const auto check_once = [&](const char* option, const std::vector<std::filesystem::path>& logs) {
    for (const std::filesystem::path& log : logs) {
      if (!seen.insert(std::filesystem::weakly_canonical(log)).second) problems.push_back({{option, 0, 0}, "", log.string(), "each log once"});
    }
  };
  check_once("--log", options.logs);
  check_once("--unseen", options.unseen);
  if (std::filesystem::exists(options.out) && !std::filesystem::is_directory(options.out)) {
    problems.push_back({{"--out", 0, 0}, "", options.out.string(), "a folder, there already or to be made"});
  }
  return problems;
}

// How far a diagnosis is and how long it will still take.
class ProgressDisplay {
 public:
  ProgressDisplay(bool terminal, std::ostream& out) : line_(out, terminal, kLineInterval) {}

  void operator()(double share, const std::string& doing) {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    forecast_.tell(seconds, share);
    const std::optional<double> left = forecast_.left();
    line_.show(seconds, fmt::format("{:3.0f} %  {:16}  {:.50}", 100.0 * forecast_.share(), left ? fmt::format("about {:3.0f} s left", *left) : "", doing),
               share >= 1.0);
  }
  void keep() { line_.keep(); }

 private:
  StatusLine line_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  diagnosis::Forecast forecast_;
};

// Throws diagnosis::NotAdmitted; of a damaged log with what is lost, for that may be why. The runs' messages are gone then: of an
// hour they are as large as its record.
std::vector<Record> admitted_records(MeasuredRuns&& measured, const diagnosis::AdmissionSettings& settings) {
  std::vector<Record> records;
  for (MeasuredRun& one : measured.runs) {
    try {
      records.push_back(diagnosis::make_record(one.run, one.name, settings));
    } catch (const diagnosis::NotAdmitted& problem) {
      if (!measured.is_damaged) throw;
      std::string losses;
      for (const MeasuredRun& other : measured.runs) {
        for (const std::string& remark : other.remarks) losses += "\n  " + remark;
      }
      throw diagnosis::NotAdmitted(std::string(problem.what()) + "\nThis log is damaged, and that may be why:" + losses);
    }
    one.run = {};
    records.back().remarks.insert(records.back().remarks.end(), one.remarks.begin(), one.remarks.end());
  }
  return records;
}

FittedRuns fitted_runs_of(const DiagnoseOptions& options, const sim::MachineSettings& nominal, const diagnosis::Thresholds& thresholds) {
  const auto judged_share = [&](const MeasuredRun& one) { return diagnosis::judged_share(nominal, diagnosis::make_record(one.run, one.name, thresholds.admission)); };
  return fitted_runs({options.fitted_seconds.value_or(thresholds.fitted_time), thresholds.shortest_stretch, thresholds.time, diagnosis::kLeastTrusted, judged_share},
                     logged_runs(options.logs));
}

// A diagnosis of a crane and what it was made of, for all that is written of it.
struct Made {
  const DiagnoseOptions& options;
  const sim::MachineSettings& nominal;
  const std::optional<controller::ControllerSettings>& controller;
  const Diagnosis& found;
  bool is_damaged;           // a log of it
  sim::MachineSettings cut;  // nominal, its boom cut as fits cut it
  Cause first;               // the most probable one
  Cause answer;              // the same, or nothing where no known effect is the answer: the gap is shown with what comes nearest, and says so
};

nlohmann::json told_apart_json(const Made& made, const ToldApartBy& apart) {
  nlohmann::json json = nlohmann::json::array();
  for (std::size_t k = 0; k < apart.size(); ++k) {
    json.push_back({{"from", made.first.group[k].name}, {"manoeuvre", apart[k].manoeuvre}, {"signal", apart[k].signal},
                    {"difference_rms", apart[k].difference}, {"unit", apart[k].unit}, {"noise_floors", apart[k].noise_floors}, {"advice", advice(apart[k])}});
  }
  return json;
}

nlohmann::json next_json(const diagnosis::NextManoeuvre& next) {
  return {{"scenario", "next_manoeuvre.yaml"}, {"expected_gain_bits", next.gain}, {"open_bits", next.open},
          {"signal", next.separation.signal}, {"noise_floors", next.separation.noise_floors}};
}

std::string next_text(const Made& made, const diagnosis::NextManoeuvre& next, const Record& at_the_rate_of) {
  const DiagnoseOptions& options = made.options;
  controller::ControllerSettings at_its_rate = *made.controller;
  at_its_rate.period = at_the_rate_of.encoder_period;
  return diagnosis::scenario_text(next, seen_from(options.crane, options.out), seen_from(options.controller, options.out), at_its_rate, made.nominal.step);
}

// The record's motion by the operator's commands alone, without what was found and with it; nothing without a controller.
std::optional<Predicted> predicted_of(const Made& made, const Record& record) {
  if (!made.controller || made.found.followed.begins_bent) return std::nullopt;
  const controller::ControllerSettings explained = controller::with_effects(*made.controller, made.first.controller_effects);
  const Point& unbiased = made.found.held_out ? made.found.held_out->point : made.first.point;
  const double from_time = made.found.held_out ? made.found.held_out->from_time : record.start_time;
  return Predicted{diagnosis::predict(made.cut, *made.controller, record, from_time),
                   diagnosis::predict(diagnosis::machine_at(made.cut, made.found.nuisances, unbiased), explained, record, from_time)};
}

nlohmann::json gaps_json(const Predicted& predicted) {
  nlohmann::json json = nlohmann::json::array();
  for (std::size_t i = 0; i < predicted.before.gaps.size(); ++i) {
    const diagnosis::SignalGap& before = predicted.before.gaps[i];
    json.push_back({{"signal", before.signal}, {"unit", before.unit}, {"measured_rms", before.measured},
                    {"before", before.gap}, {"after", predicted.after.gaps[i].gap}});
  }
  return json;
}

// crane_with_effect.yaml
std::string crane_text(const Made& made) {
  const sim::MachineSettings explained = diagnosis::machine_at(made.cut, made.found.nuisances, made.answer.point);
  std::string text = fmt::format("include: {}\ndescription: The nominal crane with what slewlab diagnose found.\n",
                                 seen_from(made.options.crane, made.options.out));
  if (explained.crane.boom.element_count != made.nominal.crane.boom.element_count) {
    text += fmt::format("boom:\n  elements: {}\n", common::quantity_text(std::to_string(explained.crane.boom.element_count), common::Unit::none,
                                                                        "slewlab diagnose, as the sizes were fitted"));
  }
  if (!made.found.gains.empty()) text += "sensors:\n";
  sim::CraneParameters read_so = explained.crane;
  for (const diagnosis::AccelerometerGain& one : made.found.gains) {
    text += fmt::format("  {}: {}\n", one.number.key, common::quantity_text(common::shortest(one.number.of(read_so)), one.number.unit, fmt::format("slewlab diagnose, standard deviation {:.2g}", one.deviation)));
  }
  std::map<std::string, std::string> intervals;
  for (const diagnosis::Size& size : made.answer.sizes) intervals[size.parameter] = fmt::format("90 %: {:.4g} to {:.4g}", size.low, size.high);
  if (!explained.effects.empty()) {
    text += common::effects_text(explained.effects, sim::effects_for(made.nominal), "slewlab diagnose, " + made.found.verdict, intervals);
  }
  return text;
}

void write_machines(const Made& made, FindingsFolder& findings) {
  findings.write("crane_with_effect.yaml", crane_text(made));
  findings.write("crane_as_fitted.yaml",
                 "include: crane_with_effect.yaml\ndescription: The same, with the parameters as slewlab diagnose fitted them.\n" +
                     diagnosis::parameters_text(made.found.nuisances, made.nominal.crane, made.answer.point.nuisance, made.answer.parameter_intervals, "slewlab diagnose"));
  std::filesystem::remove(made.options.out / "controller_with_effect.yaml");  // of a diagnosis before, which found something there
  if (made.answer.controller_effects.empty()) return;
  findings.write("controller_with_effect.yaml",
                 fmt::format("include: {}\ndescription: The nominal controller with what slewlab diagnose found.\n",
                             seen_from(made.options.controller, made.options.out)) +
                     controller::changes_text(*made.controller, controller::with_effects(*made.controller, made.answer.controller_effects),
                                              "slewlab diagnose, " + made.found.verdict));
}

// Logs, or folders of runs.
nlohmann::json files_json(const std::vector<std::filesystem::path>& places) {
  nlohmann::json files = nlohmann::json::array();
  for (const std::filesystem::path& place : places) files.push_back(std::filesystem::absolute(place).string());
  return files;
}

// All files of a diagnosis but the page; answers with the summary.
std::string write_findings(const Made& made, const std::vector<Record>& records, const diagnosis::Thresholds& thresholds) {
  const Diagnosis& found = made.found;
  const DiagnoseOptions& options = made.options;
  FindingsFolder findings(options.out);
  nlohmann::json json = to_json(found, made.is_damaged);
  const ToldApartBy apart = told_apart_by(made.cut, made.controller, found);
  if (!apart.empty()) json["told_apart_by"] = told_apart_json(made, apart);
  std::optional<diagnosis::NextManoeuvre> next;
  if (made.controller) next = diagnosis::manoeuvre_after(made.cut, *made.controller, found, records.front(), common::stop_requested);
  std::filesystem::remove(options.out / "next_manoeuvre.yaml");  // of a diagnosis before, which was not sure
  if (next) {
    json["next_manoeuvre"] = next_json(*next);
    findings.write("next_manoeuvre.yaml", next_text(made, *next, records.front()));
  }
  const Record& last = *std::find_if(records.begin(), records.end(), [&](const Record& record) { return record.name == found.followed.record; });
  const std::string place = place_of_gaps(found, made.first, last);
  const std::optional<Predicted> predicted = predicted_of(made, last);
  if (predicted) {
    json["gaps_on"] = place;
    json["gaps"] = gaps_json(*predicted);
  }
  const double highest_shown = kShownShare * thresholds.whitening.highest_frequency;
  const auto stride = static_cast<std::size_t>(std::max(1L, std::lround(1.0 / (kDrawnRate * highest_shown * found.followed.step))));
  findings.write("series.csv", series_text(last, found.followed, predicted, stride));
  json["crane"] = std::filesystem::absolute(options.crane).string();
  if (!options.controller.empty()) json["controller"] = std::filesystem::absolute(options.controller).string();
  json["logs"] = files_json(options.logs);
  json["unseen_logs"] = files_json(options.unseen);
  json["spectrogram"] = {{"highest_hz", highest_shown}, {"window_s", kShownWindow * thresholds.time}};
  json["modes"] = modes_json(made.cut, highest_shown);
  findings.write("diagnosis.json", json.dump(2) + "\n");
  write_machines(made, findings);
  std::string summary = summary_text(found, made.is_damaged, apart, predicted, place, next);
  findings.write("summary.txt", summary);
  findings.keep();
  return summary;
}

// Every machine that is tried assembles its modes anew, which takes the cube of the elements: of a thousand a minute or two each.
sim::MachineFile cut_for_fits(sim::MachineFile crane, std::ostream& complaints) {
  constexpr int kMostElements = 32;  // with 12 the error of the judged modes does not show in a residual (diagnosis/problem.h)
  int& count = crane.parameters.boom.element_count;
  if (count > kMostElements) {
    complaints << fmt::format("note: the boom is cut into {} elements here, for {} of its file: that moves no mode that is judged, and each of some thousand machines that are tried assembles its modes anew\n",
                              kMostElements, count);
    count = kMostElements;
  }
  return crane;
}

int diagnose_crane_logs(const sim::MachineFile& as_described, const DiagnoseOptions& options, std::ostream& out, std::ostream& complaints) {
  const sim::MachineFile crane = cut_for_fits(as_described, complaints);
  const sim::MachineSettings nominal = sim::machine_settings(crane);
  std::optional<controller::ControllerSettings> controller;
  if (!options.controller.empty()) controller = controller::load_controller_file(options.controller).settings;
  diagnosis::Thresholds thresholds = diagnosis::thresholds_of(sim::describe(crane));
  thresholds.admission.is_torque_measured = options.is_torque_measured;
  FittedRuns measured = fitted_runs_of(options, nominal, thresholds);
  const std::vector<Record> records = admitted_records(std::move(measured.fitted), thresholds.admission);
  std::vector<Record> unseen = admitted_records(std::move(measured.unseen), thresholds.admission);
  for (Record& record : admitted_records(measured_runs(options.unseen), thresholds.admission)) unseen.push_back(std::move(record));

  diagnosis::DiagnosisSettings settings;
  settings.without = options.without;
  settings.threads = options.threads.value_or(kThreads);
  settings.hold_out = true;
  ProgressDisplay progress(options.terminal, complaints);
  Diagnosis found = diagnosis::diagnose(nominal, controller, records, settings, std::ref(progress), common::stop_requested, std::move(unseen));
  progress.keep();
  if (measured.fitted.is_damaged) found.verdict += kOfADamagedLog;
  if (common::stop_requested()) throw diagnosis::Interrupted{};  // what follows takes seconds, and then it is written

  const Cause first = found.causes.empty() ? Cause{} : found.causes.front();
  const Made made{options, nominal, controller, found, measured.fitted.is_damaged, diagnosis::as_fitted(nominal, found),
                  first, found.is_unknown ? Cause{} : first};
  const std::string summary = write_findings(made, records, thresholds);
  out << summary << "files: " << options.out.string() << std::endl;
  // Becomes the program that draws; without an interpreter it says so, and the findings stand all the same.
  run_python("diagnosis_report.py", {options.out.string()});
  return 0;
}

}  // namespace

std::vector<std::string> names_left_out() {
  std::vector<std::string> names = diagnosis::balance_law_names();
  for (const auto& effect : all_effects().effects) names.emplace_back(effect.name);
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

int diagnose_logs(const DiagnoseOptions& options, std::ostream& out, std::ostream& complaints) {
  common::catch_stop_signals();
  try {
    const sim::MachineFile machine = sim::load_machine_file(options.crane);
    const common::InputProblems problems = problems_of(options, machine.kind);
    if (!problems.empty()) throw common::InputError(problems);
    if (machine.kind == sim::MachineKind::axis) return diagnose_axis_logs(machine, options, out);
    return diagnose_crane_logs(machine, options, out, complaints);
  } catch (const diagnosis::NotAdmitted& problem) {
    complaints << "cannot tell, because " << problem.what() << "\n";
    return kCannotTell;
  } catch (const diagnosis::NoBalance& problem) {
    complaints << "cannot tell, because " << problem.what() << "\n";
    return kCannotTell;
  } catch (const diagnosis::Interrupted&) {
    complaints << "interrupted; nothing was written\n";
    return common::stop_exit_code();
  } catch (const common::InputError& problem) {
    complaints << problem.what() << "\n";
    return 2;
  } catch (const msgs::LogError& problem) {  // of reading: a diagnosis writes no log
    complaints << "slewlab diagnose: " << problem.what() << "\n";
    return 2;
  } catch (const std::exception& problem) {
    complaints << "slewlab diagnose: " << problem.what() << "\n";
    return 1;
  }
}

}  // namespace slewlab::tools
