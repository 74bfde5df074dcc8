#include "diagnosis/balance/axis_diagnosis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "common/unit.h"
#include "diagnosis/balance/balance_priors.h"
#include "diagnosis/balance/balance_setup.h"
#include "diagnosis/balance/balance_sizes.h"
#include "diagnosis/balance/described_axis.h"
#include "sim/effects/balance_effects.h"
#include "sim/effects/catalogue.h"
#include "sim/machine/description.h"
#include "sim/model/crane.h"
#include "sim/model/drive_line.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kNanosecond = 1e-9;         // [s]
constexpr double kOffGrid = 0.25;            // [periods] by which a time stamp may miss the even grid, jitter aside
constexpr double kGross = 3.0;               // factors of the inertia within it may be a machine's own
constexpr double kNoises = 3.0;              // standard deviations by which it lies beyond
constexpr double kInertiaDeviations = 2.0;   // of the spread from unit to unit, beyond which the inertia is another one
constexpr double kBetter = 0.99;             // of an error that counts as smaller
constexpr double kAboveNoise = 3.0;          // times the residual of noise, from which something is missing
constexpr double kImitated = 5.0;            // times the residual, that an inertia may take of a law: of F |F| under a sine, 8 / (3 pi) to a residual of 0.17
constexpr double kRecordShare = 0.004;       // of what the motors give, that step, window and the drive's limits make of a record of the very axis: as WhiteningSettings::discrepancy_share
constexpr double kSure = 0.9;                // probability from which a law is named without its family
constexpr double kMost = 0.5;                // share of the gap on data that were not fitted, that an answer explains at least
constexpr double kWorthSaying = 0.1;         // share of the gap that is not explained, from which it is named
constexpr double kBeyondRating = 20.0;       // times the rated torque or the top speed: no motor is overloaded so far
constexpr double kSlowestJudged = 2e-3;      // of the top speed, below which nothing is judged (balance_setup.cpp)
constexpr int kFiner = 4;                    // steps of the forward simulation per sample
constexpr int kHalvings = 40;                // of the bracket of a speed
constexpr std::size_t kForwardStretches = 10;  // of the record that is held out, from whose beginnings it is simulated

// Torques or positions in a wrong unit, axis or sign show in the inertia that the balance wants, where the records determine it.
void check_units(double nominal, const BalanceModel& model) {
  const double factor = model.inertia / nominal, reach = kNoises * model.inertia_deviation / nominal;
  if (factor + reach > 1.0 / kGross && factor - reach < kGross) return;
  if (factor < 0.0) throw NoBalance("the efforts accelerate the axis against their own direction: check the signs of position and torque");
  throw NoBalance(fmt::format("the motion takes {:.3g} times the inertia of the file, or the efforts are {:.3g} times too {}: check the units of position and "
                              "torque, on which side of the gears they are, the ratio, and whether this is another axis than the nominal one",
                              factor, factor > 1.0 ? factor : 1.0 / factor, factor > 1.0 ? "large" : "small"));
}

// What is a torque on a rotary axis is a force on a linear one.
std::string of_a_linear_axis(std::string words) {
  constexpr std::string_view kTorque = "torque";
  if (const auto at = words.find(kTorque); at != std::string::npos) words.replace(at, kTorque.size(), "force");
  return words;
}

double root_mean_square(const std::vector<double>& values) {
  double square = 0.0;
  for (const double value : values) square += value * value;
  return values.empty() ? 0.0 : std::sqrt(square / static_cast<double>(values.size()));
}

// A column in mA or degrees, or a time in ms, is far from what the axis's file says of its motor.
void check_against_ratings(const std::string& name, double largest_torque, const AxisRecord& record, const sim::MachineFile& axis) {
  const char *torque_unit = axis.axis.is_shaft_linear ? "N" : "N m", *speed_unit = axis.axis.is_linear ? "m/s" : "rad/s";
  if (const double rated = axis.parameters.drive.rated_torque; largest_torque > kBeyondRating * rated) {
    throw NoBalance(fmt::format("{}: the motor's torque reaches {:.3g} {}, {:.0f} times the rated {:.3g} {} of the axis's file: check the units of the torque (a current in "
                                "A or mA takes `scale:` in the map) and on which side of the gears it is",
                                name, largest_torque, torque_unit, largest_torque / rated, rated, torque_unit));
  }
  const std::vector<double> speeds = rough_speed(record.position, record.step);
  double fastest = 0.0;
  for (const double speed : speeds) fastest = std::max(fastest, std::fabs(speed));
  const double top = axis.parameters.drive.top_speed, usual = root_mean_square(speeds);
  if (usual > kBeyondRating * top) {
    throw NoBalance(fmt::format("{}: the axis moves at {:.3g} {} (RMS), {:.0f} times the top speed of {:.3g} {} of its file: check the units of position (deg, mm) and time, "
                                "and on which side of the gears the position is",
                                name, usual, speed_unit, usual / top, top, speed_unit));
  }
  if (fastest > 0.0 && fastest < kSlowestJudged * top) {
    throw NoBalance(fmt::format("{}: the axis moves at {:.3g} {} at most, {:.2g} % of the top speed of {:.3g} {} of its file: check the units of time (ms) and position; a torque "
                                "balance needs moves at several speeds",
                                name, fastest, speed_unit, 100.0 * fastest / top, top, speed_unit));
  }
}

// Cuts a record to its longest stretch without brakes, whose torque nobody records; they need a while to open.
void keep_unbraked(const std::vector<bool>& is_braked, const sim::BrakeSettings& brake, AxisRecord& record) {
  constexpr double kTimeConstants = 5.0;  // in which a brake has opened
  const double opens = static_cast<double>(brake.release_delay) * kNanosecond + kTimeConstants * brake.release_time_constant;
  const auto opening = static_cast<std::size_t>(std::ceil(opens / record.step));
  std::size_t first = 0, count = 0, from = 0;
  for (std::size_t n = 0; n < is_braked.size(); ++n) {
    if (is_braked[n]) {
      from = n + 1 + opening;
    } else if (n + 1 > from + count) {
      first = from;
      count = n + 1 - from;
    }
  }
  if (count == 0) throw NoBalance(record.name + ": TORQUE applies the brakes throughout; a log that moves with open brakes would tell");
  const auto cut = [&](std::vector<double>& values) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first);
    values = std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(count));
  };
  cut(record.position);
  cut(record.effort);
  record.start_time += record.step * static_cast<double>(first);
}

AxisRecord part_of(const AxisRecord& record, bool second) {
  const auto middle = static_cast<std::ptrdiff_t>(record.position.size() / 2);
  const auto part = [&](const std::vector<double>& values) {
    return second ? std::vector<double>(values.begin() + middle, values.end()) : std::vector<double>(values.begin(), values.begin() + middle);
  };
  return {record.name, record.step, part(record.position), part(record.effort), record.start_time + (second ? record.step * static_cast<double>(middle) : 0.0),
          part(record.load)};
}

double resistance(const std::vector<std::pair<const LawShape*, BalanceTerm>>& laws, const LawMoment& moment) {
  double sum = 0.0;
  for (const auto& [shape, term] : laws) {
    for (std::size_t c = 0; c < shape->columns.size(); ++c) sum += term.size[c] * shape->columns[c](moment);
  }
  return sum;
}

// A recorder's skew is no property of the axis: the nominal one has it as well.
BalanceModel bare(double inertia, double skew) {
  BalanceModel model;
  model.inertia = inertia;
  model.skew = skew;
  return model;
}

AxisError error_of(const AxisRecord& record, const BalanceRecord& smooth, const Balance& balance, const BalanceModel& model) {
  const std::size_t first = (record.position.size() - smooth.motion.speed.size()) / 2;
  const auto speed_error = [&](std::size_t stretch) {
    const std::vector<double> forward = forward_speed(record, smooth.motion, balance.laws, model, stretch);
    std::vector<double> difference(smooth.motion.speed.size());
    for (std::size_t n = 0; n < difference.size(); ++n) difference[n] = smooth.motion.speed[n] - forward[first + n];
    return root_mean_square(difference);
  };
  const std::size_t whole = record.position.size();
  return {root_mean_square(balance_residual(smooth, balance.laws, model, balance.resolved_speed)), speed_error(whole),
          speed_error(std::max<std::size_t>(1, whole / kForwardStretches))};
}

// Better than the nominal axis and than another inertia, in torque balance and in either forward simulation.
bool predicts_better(const AxisValidation& validation, const BalanceModel& cause) {
  const auto is_better = [&](const AxisError& than) {
    return validation.cause.balance < kBetter * than.balance && (validation.cause.forward < kBetter * than.forward || validation.cause.tenths < kBetter * than.tenths);
  };
  return is_better(validation.nominal) && (cause.terms.empty() || is_better(validation.inertia));
}

// RMS of what the motors alone give.
double driving_effort(const AxisRecord& record) {
  std::vector<double> driving = record.effort;
  for (std::size_t n = 0; n < driving.size(); ++n) driving[n] -= record.load[n];
  return root_mean_square(driving);
}

// Whether the nominal axis's residual is so small on each record that even a record without any noise tells no law by it. `smooth`: of the records.
bool is_below_record(const std::vector<AxisRecord>& records, const std::vector<BalanceRecord>& smooth, const Balance& balance, const BalanceModel& nominal) {
  for (std::size_t r = 0; r < records.size(); ++r) {
    if (root_mean_square(balance_residual(smooth[r], balance.laws, nominal, balance.resolved_speed)) >= kRecordShare * driving_effort(records[r])) return false;
  }
  return true;
}

// Which record is held out: the last without which the others tell the ordinary laws; where there is none, the one without which they tell most of them,
// whatever the order. `smooth`: of several records.
std::size_t held_out(const std::vector<BalanceRecord>& smooth, const Balance& balance, double nominal_inertia) {
  const Regression regression = prepared_regression(smooth, balance.laws, nominal_inertia, balance.resolved_speed);
  LawChoice ordinary;
  for (std::size_t l = 0; l < balance.laws.size(); ++l) {
    if (balance.laws[l].is_ordinary) ordinary.laws.emplace_back(static_cast<int>(l), 0);
  }
  const std::vector<Eigen::Index> columns = columns_of(regression, ordinary);
  const RegressionSums all = sums_of(regression, columns);
  std::size_t out = smooth.size() - 1;
  double most = -1.0;
  for (std::size_t r = smooth.size(); r-- > 0;) {
    const double share = least_share(sums_of(regression, columns, [r](const RegressionBlock& block) { return block.record != r; }), all);
    if (share >= kLeastDetermined) return r;
    if (share > most) {
      most = share;
      out = r;
    }
  }
  return out;
}

// Chooses the laws without one record, of a single one without its second half, and asks them to predict it.
void choose_and_validate(const std::vector<AxisRecord>& records, const std::vector<BalanceRecord>& smooth, const Balance& balance, double nominal_inertia, AxisDiagnosis& diagnosis) {
  std::vector<AxisRecord> fitted = records;
  AxisRecord last = records.back();
  if (records.size() > 1) {
    const auto out = fitted.begin() + static_cast<std::ptrdiff_t>(held_out(smooth, balance, nominal_inertia));
    last = *out;
    fitted.erase(out);
    diagnosis.validation.place = last.name;
  } else {
    fitted = {part_of(last, false)};
    last = part_of(last, true);
    diagnosis.validation.place = last.name + ", second half";
  }
  const std::vector<BalanceRecord> seen = smoothed(fitted, balance);
  const BalanceRecord unseen = make_balance_record(last, balance.half_window, balance.lateness);
  BalanceAnswer no_laws = fit_balance(seen, {}, nominal_inertia, balance.resolved_speed);
  const BalanceModel inertia_alone = no_laws.best;
  diagnosis.is_below_record = diagnosis.is_described || is_below_record(records, smooth, balance, bare(nominal_inertia, inertia_alone.skew));
  no_laws.probability_unknown = 0.0;
  diagnosis.answer = diagnosis.is_below_record ? std::move(no_laws) : fit_balance(seen, balance.laws, nominal_inertia, balance.resolved_speed);
  diagnosis.validated = diagnosis.answer.best;
  AxisValidation& validation = diagnosis.validation;
  validation.nominal = error_of(last, unseen, balance, bare(nominal_inertia, inertia_alone.skew));
  validation.inertia = error_of(last, unseen, balance, inertia_alone);
  validation.cause = error_of(last, unseen, balance, diagnosis.validated);
  validation.effort = root_mean_square(unseen.effort);
  validation.floor = std::hypot(nominal_inertia * acceleration_noise(last, balance.half_window), kLawDiscrepancy * validation.effort);
  validation.noise = std::hypot(validation.floor, smoothed_effort_noise(last, balance.half_window));
  const double tenth = last.step * static_cast<double>(last.position.size()) / static_cast<double>(kForwardStretches);
  validation.drift = std::hypot(validation.noise * tenth / (std::sqrt(3.0) * nominal_inertia), unseen.speed_noise);
  validation.nominal_together = correlated_rms(unseen, balance.laws, bare(nominal_inertia, inertia_alone.skew), balance.resolved_speed);
  validation.cause_together = correlated_rms(unseen, balance.laws, diagnosis.validated, balance.resolved_speed);
  validation.speed = root_mean_square(unseen.speed);
  validation.acceleration = root_mean_square(unseen.acceleration);
  validation.is_one_direction = balance.direction != 0;
  for (const int direction : {1, -1}) {
    const auto moves = [&](const BalanceRecord& record) { return moves_along(record, direction, balance.resolved_speed); };
    validation.is_other_direction |= moves(unseen) && std::none_of(seen.begin(), seen.end(), moves);
  }
  validation.holds = predicts_better(validation, diagnosis.validated);
}

// The answer, fitted to all logs, on one that had no part in it.
AxisValidation tried_on(const AxisRecord& record, const Balance& balance, const BalanceModel& inertia_alone, const AxisDiagnosis& diagnosis) {
  const BalanceRecord smooth = make_balance_record(record, balance.half_window, balance.lateness);
  AxisValidation validation;
  validation.place = record.name;
  validation.nominal = error_of(record, smooth, balance, bare(diagnosis.nominal_inertia, inertia_alone.skew));
  validation.inertia = error_of(record, smooth, balance, inertia_alone);
  validation.cause = error_of(record, smooth, balance, diagnosis.answer.best);
  validation.effort = root_mean_square(smooth.effort);
  validation.speed = root_mean_square(smooth.speed);
  validation.holds = predicts_better(validation, diagnosis.answer.best);
  return validation;
}

// Whether a residual is more than noise. A torque that is measured, or written down in coarse steps, brings white noise, which no law could explain: what
// is hidden in it shows by going together over more than the window.
bool is_above_noise(const AxisValidation& validation, double rms, double together) {
  return rms > kAboveNoise * validation.noise || together > kAboveNoise * validation.floor;
}

// The residual of all records: how they differ shows in no fewer. A residual that follows something is no noise.
void take_remainder(const sim::MachineFile& axis, const FittedSizes& sizes, AxisDiagnosis& diagnosis) {
  Remainder& remainder = diagnosis.answer.remainder;
  remainder = sizes.remainder;
  if (axis.axis.is_linear) {
    remainder.variable = of_a_linear_axis(std::move(remainder.variable));
    remainder.words = of_a_linear_axis(std::move(remainder.words));
  }
  AxisValidation& validation = diagnosis.validation;
  const double together = std::sqrt(remainder.share) * sizes.rest;
  validation.cause_together = std::max(validation.cause_together, together);
  validation.nominal_together = std::max(validation.nominal_together, together);
}

const BalanceTerm* term_of(const BalanceModel& model, std::string_view law) {
  for (const std::vector<BalanceTerm>* terms : {&model.terms, &model.details}) {
    const auto found = std::find_if(terms->begin(), terms->end(), [&](const BalanceTerm& term) { return term.law == law; });
    if (found != terms->end()) return &*found;
  }
  return nullptr;
}

// The effects of the catalogue that are the model's laws, with their sizes; what has none, or lies out of an effect's bounds, is remarked.
void take_effects(const sim::MachineFile& axis, double first_position, AxisDiagnosis& diagnosis) {
  const BalanceModel& model = diagnosis.answer.best;
  const auto size = [&](std::string_view law, std::size_t k = 0) {
    const BalanceTerm* term = term_of(model, law);
    return term == nullptr || k >= term->size.size() ? 0.0 : term->size[k];
  };
  const auto shape = [&](std::string_view law) {
    const BalanceTerm* term = term_of(model, law);
    return term == nullptr ? 0.0 : term->shape;
  };
  const auto is_named = [&](std::string_view law) {
    return std::any_of(model.terms.begin(), model.terms.end(), [&](const BalanceTerm& term) { return term.law == law; });
  };
  const double offset = is_named("spring") ? 0.0 : size("offset");  // which without the spring would be no load of this axis
  sim::BalanceEffects found = sim::effects_of_balance(
      {.dry = size("dry"), .viscous = size("viscous"), .viscous_difference = size("viscous", 1), .dry_difference = is_named("offset") ? 0.0 : offset, .offset = is_named("offset") ? offset : 0.0,
       .breakaway_excess = size("stribeck"), .stribeck_speed = shape("stribeck"), .rising = size("rising"), .rising_speed = shape("rising"),
       .gravity_sine = size("gravity", 0), .gravity_cosine = size("gravity", 1), .first_position = first_position, .lag = size("lag"), .delay = size("delay")},
      sim::effects_for(axis));
  diagnosis.effects = std::move(found.effects);
  diagnosis.remarks.insert(diagnosis.remarks.end(), found.left_out.begin(), found.left_out.end());
  for (const BalanceTerm& term : model.named()) {
    constexpr std::string_view kWritten[] = {"dry", "viscous", "offset", "stribeck", "rising", "gravity", "lag", "delay"};
    if (std::find(std::begin(kWritten), std::end(kWritten), term.law) != std::end(kWritten)) continue;
    diagnosis.remarks.push_back(term.words + ": no effect of the catalogue has this law with these sizes; it is not in the file");
  }
}

std::string inertia_words(const sim::MachineFile& axis, double nominal, double found) {
  return fmt::format("{} {:.0f} % {} the file's", axis.axis.is_linear ? "a mass" : "an inertia", 100.0 * std::fabs(found / nominal - 1.0),
                     found > nominal ? "above" : "below");
}

// What the laws lose goes to the unknown.
void keep_only(double factor, BalanceAnswer& answer) {
  for (BalanceModel& model : answer.models) model.probability *= factor;
  answer.best.probability *= factor;
  for (LawProbability& law : answer.laws) law.probability *= factor;
  for (BalanceTerm& term : answer.best.terms) term.probability *= factor;
  for (BalanceTerm& term : answer.models.front().terms) term.probability *= factor;
  answer.probability_unknown = 1.0 - factor * (1.0 - answer.probability_unknown);
}

// Something unknown whose residual is a larger share of the gap than a rare law explains may be what that law was fitted to.
void doubt_what_an_unknown_may_imitate(AxisDiagnosis& diagnosis) {
  BalanceAnswer& answer = diagnosis.answer;
  for (LawProbability& doubted : answer.laws) {
    const auto law = std::find_if(diagnosis.laws.begin(), diagnosis.laws.end(), [&](const BalanceLaw& one) { return one.name == doubted.law; });
    const auto term = std::find_if(answer.best.terms.begin(), answer.best.terms.end(), [&](const BalanceTerm& one) { return one.law == doubted.law; });
    if (law == diagnosis.laws.end() || law->is_ordinary || term == answer.best.terms.end()) continue;
    doubted.belief = term->share / (term->share + diagnosis.unexplained);
    doubted.probability *= doubted.belief;
    for (std::vector<BalanceTerm>* terms : {&answer.best.terms, &answer.models.front().terms}) {
      for (BalanceTerm& one : *terms) {
        if (one.law == doubted.law) one.probability *= doubted.belief;
      }
    }
  }
}

// What the residual follows, in words.
std::string what_it_follows(const sim::MachineFile& axis, const AxisDiagnosis& diagnosis) {
  const std::string& rest = diagnosis.answer.remainder.words;
  if (!rest.empty()) return rest;
  return fmt::format("follows neither speed, position, time nor {}", axis.axis.is_linear ? "force" : "torque");
}

bool is_each_sure(const BalanceModel& model) {
  const std::vector<BalanceTerm> named = model.named();
  return std::all_of(named.begin(), named.end(), [](const BalanceTerm& term) { return term.probability >= kSure; });
}

// What the answer is decided by.
struct Judgement {
  bool is_inertia_off = false;      // beyond its spread, and known well enough to say so
  bool is_gap = false;              // the nominal axis's residual is more than noise
  bool is_faster = false;           // not the balance's, but what the nominal axis drifts by: more than any such residual makes, and so hidden by the window
  bool is_rest = false;             // so is the cause's
  bool is_inertia_doubted = false;  // the cause's residual goes together, and is so large that its law may be what the inertia was fitted to
  double share = 0.0;               // of the gap, that the cause explains on data that were not fitted
};

Judgement judged(double inertia_spread, const AxisDiagnosis& diagnosis) {
  const BalanceModel& best = diagnosis.answer.best;
  const AxisValidation& validation = diagnosis.validation;
  const double nominal = diagnosis.nominal_inertia;
  const double before = validation.nominal.balance * validation.nominal.balance, after = validation.cause.balance * validation.cause.balance;
  Judgement judgement;
  judgement.is_inertia_off = !diagnosis.is_described && std::fabs(best.inertia - nominal) > kInertiaDeviations * std::hypot(inertia_spread * nominal, best.inertia_deviation);
  judgement.is_gap = !diagnosis.is_below_record && is_above_noise(validation, validation.nominal.balance, validation.nominal_together);
  judgement.is_faster = !diagnosis.is_below_record && !judgement.is_gap && validation.nominal.tenths > kAboveNoise * validation.drift;
  judgement.is_gap |= judgement.is_faster;
  judgement.is_rest = is_above_noise(validation, validation.cause.balance, validation.cause_together) && diagnosis.transmission < kMost * after;
  const double moved = std::fabs(best.inertia - nominal) * validation.acceleration;  // by the inertia that is off
  judgement.is_inertia_doubted = !validation.is_other_direction && validation.cause_together > validation.floor && moved < kImitated * validation.cause_together;
  judgement.share = before > 0.0 ? 1.0 - after / before : 0.0;
  return judgement;
}

void say_unknown(const sim::MachineFile& axis, const Judgement& judgement, const std::string& why, AxisDiagnosis& diagnosis) {
  const AxisValidation& validation = diagnosis.validation;
  diagnosis.outcome = AxisOutcome::unknown;
  if (judgement.is_faster) {
    diagnosis.verdict = fmt::format("outside the catalogue (unknown): by the recorded effort the axis of the file is {:.3g} {} of {:.3g} off within a tenth of {}, which nothing that is slower than the balance's window of {:.3g} s "
                                    "does, and {}", validation.nominal.tenths, axis.axis.is_linear ? "m/s" : "rad/s", validation.speed, validation.place, diagnosis.window, why);
  } else {
    diagnosis.verdict = fmt::format("outside the catalogue (unknown): {:.3g} {} of {:.3g} are missing on {}, and {}", validation.nominal.balance,
                                    axis.axis.is_linear ? "N" : "Nm", validation.effort, validation.place, why);
  }
  if (judgement.is_inertia_off && diagnosis.answer.best.terms.empty()) {
    diagnosis.remarks.push_back(fmt::format("{} would explain {:.0f} % of the gap, and its residual is more than noise: something unknown may be what looks like it",
                                            inertia_words(axis, diagnosis.nominal_inertia, diagnosis.answer.best.inertia), 100.0 * std::clamp(judgement.share, 0.0, 1.0)));
  }
  if (const std::string& rest = diagnosis.answer.remainder.words; !rest.empty()) diagnosis.verdict += "; the residual of the known laws " + rest;
}

void say_not_identifiable(const std::string& why, AxisDiagnosis& diagnosis) {
  diagnosis.outcome = AxisOutcome::not_identifiable;
  const double unknown = diagnosis.answer.probability_unknown;  // that no law can be told is no sign of it
  keep_only(0.0, diagnosis.answer);
  diagnosis.answer.probability_unknown = unknown;
  diagnosis.verdict = "cannot tell: " + why;
}

// The laws of the answer; where the members of a family cannot be told, the family leads.
std::string laws_in_words(const BalanceAnswer& answer) {
  if (is_each_sure(answer.best)) return answer.best.words();
  std::string words;
  for (const FamilyProbability& family : family_probabilities(answer)) {
    std::string likely, perhaps;
    for (const BalanceTerm& term : answer.best.named()) {
      if (term.family != family.family) continue;
      std::string& members = term.probability >= 0.5 ? likely : perhaps;
      members += fmt::format("{}{} ({:.0f} %)", members.empty() ? "" : " and ", term.words, 100.0 * term.probability);
    }
    if (likely.empty() && perhaps.empty()) continue;
    words += fmt::format("{}{} ({:.0f} %)", words.empty() ? "" : "; ", words_of(family.family), 100.0 * family.probability);
    if (!likely.empty()) words += ", most likely " + likely;
    if (!perhaps.empty()) words += ", perhaps " + perhaps;
  }
  return words;
}

// What one may take for another where the logs do not tell.
void remark_what_is_alike(const sim::MachineFile& axis, const Judgement& judgement, AxisDiagnosis& diagnosis) {
  const AxisValidation& validation = diagnosis.validation;
  const BalanceModel& best = diagnosis.answer.best;
  if (validation.is_other_direction && 1.0 - judgement.share > kWorthSaying) {
    diagnosis.remarks.push_back(validation.place + " moves in a direction in which the other data do not: the residual there may be that direction's own "
                                                   "friction; a log that goes both ways would tell");
  }
  if (validation.is_one_direction && (term_of(best, "dry") != nullptr || term_of(best, "offset") != nullptr)) {
    diagnosis.remarks.push_back(fmt::format("all logs move in one direction: there dry friction and a constant {} are the same; a log that goes both ways would tell them apart",
                                            axis.axis.is_linear ? "force" : "torque"));
  }
  if (judgement.is_inertia_off) {
    diagnosis.remarks.push_back(fmt::format("a torque constant that is {:.0f} % off would show the same; all other sizes then change by as much",
                                            100.0 * std::fabs(diagnosis.nominal_inertia / best.inertia - 1.0)));
  }
}

// An inertia that something unknown may imitate is known no better than to the file's.
void doubt_inertia(AxisDiagnosis& diagnosis) {
  for (BalanceModel* model : {&diagnosis.answer.best, &diagnosis.answer.models.front()}) {
    model->inertia_deviation = std::hypot(model->inertia_deviation, model->inertia - diagnosis.nominal_inertia);
  }
}

// How stiff a load over the position is and where it rests, in the axis's own positions.
void remark_spring(const sim::MachineFile& axis, AxisDiagnosis& diagnosis) {
  const BalanceTerm* spring = term_of(diagnosis.answer.best, "spring");
  if (spring == nullptr || spring->size[0] == 0.0) return;
  const auto& along = shape_of(diagnosis.laws, *spring).columns.front();
  const double at_zero = along({.position = 0.0}), per_unit = along({.position = 1.0}) - at_zero;
  const BalanceTerm* constant = term_of(diagnosis.answer.best, "offset");
  const double middle = constant == nullptr ? 0.0 : constant->size[0];  // torque in the middle of the range
  const double stiffness = spring->size[0] * per_unit, rest = (-middle / spring->size[0] - at_zero) / per_unit;
  diagnosis.remarks.push_back(fmt::format("{}: {:.3g} {} {} {:.4g} {}", spring->words, std::fabs(stiffness), axis.axis.is_linear ? "N/m" : "Nm/rad",
                                          stiffness > 0.0 ? "towards" : "away from", rest, axis.axis.is_linear ? "m" : "rad"));
}

void state(const sim::MachineFile& axis, const Judgement& judgement, AxisDiagnosis& diagnosis) {
  const BalanceModel& best = diagnosis.answer.best;
  const AxisValidation& validation = diagnosis.validation;
  diagnosis.outcome = AxisOutcome::stated;
  diagnosis.unexplained = 1.0 - judgement.share;
  diagnosis.has_remainder = judgement.is_rest && !validation.is_other_direction;
  if (diagnosis.has_remainder) doubt_what_an_unknown_may_imitate(diagnosis);
  remark_what_is_alike(axis, judgement, diagnosis);
  remark_spring(axis, diagnosis);
  std::string words = best.terms.empty() ? "only " : laws_in_words(diagnosis.answer);
  if (judgement.is_inertia_off) {
    words += (best.terms.empty() ? "" : judgement.is_inertia_doubted ? ", perhaps beside " : ", beside ") + inertia_words(axis, diagnosis.nominal_inertia, best.inertia);
    if (judgement.is_inertia_doubted) doubt_inertia(diagnosis);
  }
  diagnosis.verdict = fmt::format("{}: {:.1f} % of the gap on data that were not fitted", words, 100.0 * judgement.share);
  const std::string follows = what_it_follows(axis, diagnosis);
  if (diagnosis.has_remainder) {
    diagnosis.verdict += fmt::format("; the residual, {:.3g} {} of {:.3g}, is of no known law (unknown) and {}", validation.cause.balance,
                                     axis.axis.is_linear ? "N" : "Nm", validation.effort, follows);
  } else if ((!diagnosis.answer.remainder.words.empty() && validation.cause_together > validation.floor) || diagnosis.unexplained > kWorthSaying) {
    diagnosis.verdict += "; the rest " + follows;
  }
}

// Laws that do not predict what the nominal axis predicts to the noise are none: moves of one frequency do not tell a spring from an inertia, nor records that hardly move any law.
void give_up_best(AxisDiagnosis& diagnosis) {
  BalanceAnswer& answer = diagnosis.answer;
  const auto alone = std::find_if(answer.models.begin(), answer.models.end(), [](const BalanceModel& model) { return model.terms.empty(); });
  if (alone == answer.models.end()) return;
  diagnosis.remarks.push_back(fmt::format("{}: fitted to the other data, it does not predict {}, which the nominal axis does to the noise", answer.best.words(), diagnosis.validation.place));
  for (LawProbability& law : answer.laws) {
    const auto is_of_it = [&](const BalanceTerm& term) { return term.law == law.law; };
    if (std::any_of(answer.best.terms.begin(), answer.best.terms.end(), is_of_it)) law.probability = std::max(0.0, law.probability - answer.best.probability);
  }
  alone->probability += std::exchange(answer.models.front().probability, 0.0);
  std::rotate(answer.models.begin(), alone, alone + 1);
  answer.best = answer.models.front();
  diagnosis.validation.cause = diagnosis.validation.inertia;
  diagnosis.validation.cause_together = diagnosis.validation.nominal_together;
}

void name_answer(const sim::MachineFile& axis, double inertia_spread, AxisDiagnosis& diagnosis) {
  const BalanceModel& best = diagnosis.answer.best;
  const AxisValidation& validation = diagnosis.validation;
  Judgement judgement = judged(inertia_spread, diagnosis);
  if (!judgement.is_gap && !best.terms.empty() && !validation.holds) {
    give_up_best(diagnosis);
    judgement = judged(inertia_spread, diagnosis);
  }
  if (best.terms.empty() && !judgement.is_inertia_off && !judgement.is_gap) {
    diagnosis.outcome = AxisOutcome::nothing_missing;
    diagnosis.verdict = diagnosis.is_described ? "no effect is missing; the axis of the file, simulated with its transmission by the recorded efforts, has the residual of the records"
                                               : "no effect is missing; the inertia is within its spread";
    return;
  }
  const bool is_answer = !best.terms.empty() || judgement.is_inertia_off;
  const bool is_little = judgement.is_gap && validation.holds && judgement.share < kMost;
  const bool is_unpredicted = judgement.is_gap && judgement.is_rest && !validation.holds;
  const bool is_imitated = best.terms.empty() && judgement.is_inertia_doubted;  // the inertia alone
  if (!is_answer || is_little || is_unpredicted || is_imitated) {
    say_unknown(axis, judgement,
                !is_answer || is_little ? "no known law explains most of it" : is_unpredicted ? "no known law predicts it" : "another inertia does not explain it", diagnosis);
    keep_only(is_answer ? std::clamp(judgement.share, 0.0, kMost) : 0.0, diagnosis.answer);
    doubt_inertia(diagnosis);
  } else if (diagnosis.answer.probability_unknown > best.probability) {
    say_unknown(axis, judgement, "a smooth function of speed, position and time predicts them better than the known laws", diagnosis);
  } else if (!validation.holds) {
    say_not_identifiable("no law predicts " + validation.place + " better than the nominal axis, in torque balance and forward simulation", diagnosis);
  } else if (!diagnosis.is_physical) {
    say_not_identifiable(fmt::format("{} predicts {}, but fitted to all records a size comes out that it cannot have, or that they do not determine",
                                     best.terms.empty() ? "another inertia" : best.words(), validation.place), diagnosis);
  } else {
    state(axis, judgement, diagnosis);
  }
}

// One sentence that a person can act on.
void say_what_to_do(const sim::MachineFile& axis, AxisDiagnosis& diagnosis) {
  const std::string look = what_it_follows(axis, diagnosis);
  if (diagnosis.outcome == AxisOutcome::nothing_missing) {
    diagnosis.action = "Keep the axis's file: it describes this axis.";
  } else if (diagnosis.is_hidden_by_transmission) {
    diagnosis.action = "Compare stiffness and play of the axis's file with the machine, and record slower moves, in which its transmission swings less; then ask again.";
  } else if (diagnosis.outcome == AxisOutcome::not_identifiable) {
    diagnosis.action = "Record one more log of moves in both directions, at several steady speeds and with ramps between them, and ask again with all logs.";
  } else if (diagnosis.outcome == AxisOutcome::unknown) {
    diagnosis.action = fmt::format("Look at the axis for what {}; no file is changed.", look);
  } else if (diagnosis.has_remainder) {
    diagnosis.action = fmt::format("Use axis_with_effect.yaml in place of the axis's file, and look at the axis for what {}.", look);
  } else if (!is_each_sure(diagnosis.answer.best)) {
    diagnosis.action = "Use axis_with_effect.yaml in place of the axis's file; a log of several steady speeds, slow ones among them, in both directions would tell the laws apart.";
  } else {
    diagnosis.action = "Use axis_with_effect.yaml in place of the axis's file.";
  }
}

// What a transmission that gives makes of the balance of one inertia; mean squares.
struct TransmissionGap {
  double measured = 0.0;    // of the nominal axis's residual on a record
  double described = 0.0;   // and on the described axis's own, simulated by the recorded efforts
  double difference = 0.0;  // of the two
};

// `measured`: the record, smoothed.
TransmissionGap transmission_gap(const sim::MachineFile& axis, const AxisRecord& record, const BalanceRecord& measured, GearBeginning beginning, const Balance& balance,
                                 double nominal_inertia) {
  const BalanceModel nominal = bare(nominal_inertia, 0.0);
  std::vector<double> speed;  // the motion's, beyond its ends as there
  const std::size_t first = (record.position.size() - measured.motion.speed.size()) / 2;
  for (std::size_t n = 0; n < record.position.size(); ++n) speed.push_back(measured.motion.speed[std::clamp(n, first, first + measured.motion.speed.size() - 1) - first]);
  const BalanceRecord described = make_balance_record(described_record(axis, record, beginning, speed), balance.half_window);
  const std::vector<double> left = balance_residual(measured, balance.laws, nominal, -1.0), own = balance_residual(described, balance.laws, nominal, -1.0);
  const std::vector<std::size_t> moving = moving_samples(measured, balance.resolved_speed);
  TransmissionGap gap;
  for (const std::size_t n : moving) {
    gap.measured += left[n] * left[n] / static_cast<double>(moving.size());
    gap.described += own[n] * own[n] / static_cast<double>(moving.size());
    gap.difference += (left[n] - own[n]) * (left[n] - own[n]) / static_cast<double>(moving.size());
  }
  const bool is_finite = std::isfinite(gap.difference);  // what runs away tells nothing
  return is_finite ? gap : TransmissionGap{gap.measured, 0.0, std::numeric_limits<double>::infinity()};
}

// Of all records, each begun as the described axis follows it better; and whether it does to what a record can tell.
TransmissionGap transmission_gap(const sim::MachineFile& axis, const std::vector<AxisRecord>& records, const std::vector<BalanceRecord>& smooth, const Balance& balance,
                                 AxisDiagnosis& diagnosis) {
  TransmissionGap all;
  if (axis.parameters.drive.is_rigid) return all;
  diagnosis.is_described = true;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const AxisRecord& record = records[r];
    const auto begun = [&](GearBeginning beginning) { return transmission_gap(axis, record, smooth[r], beginning, balance, diagnosis.nominal_inertia); };
    TransmissionGap gap = begun(GearBeginning::carrying);
    const TransmissionGap other = begun(GearBeginning::middle);
    if (other.difference < gap.difference) gap = other;
    const double noise = std::hypot(diagnosis.nominal_inertia * acceleration_noise(record, balance.half_window), smoothed_effort_noise(record, balance.half_window));
    diagnosis.is_described &= std::sqrt(gap.difference) < std::hypot(kRecordShare * driving_effort(record), noise);
    all.measured += gap.measured / static_cast<double>(records.size());
    all.described += gap.described / static_cast<double>(records.size());
  }
  return all;
}

// What no law predicts is no unknown where the described transmission alone would make most of it, and what seems to come late is what swings behind it.
void judge_transmission(const sim::MachineFile& axis, double measured, AxisDiagnosis& diagnosis) {
  const std::vector<BalanceTerm>& named = diagnosis.answer.best.terms;
  const bool is_late = diagnosis.outcome == AxisOutcome::stated && std::any_of(named.begin(), named.end(), [](const BalanceTerm& term) { return term.family == LawFamily::drive; });
  const bool is_open = !axis.parameters.drive.is_rigid && (is_late || diagnosis.outcome == AxisOutcome::unknown || diagnosis.outcome == AxisOutcome::not_identifiable);
  if (!is_open || diagnosis.transmission < kMost * measured) return;
  diagnosis.is_hidden_by_transmission = true;
  const char* unit = axis.axis.is_linear ? "N" : "Nm";
  say_not_identifiable(fmt::format("the balance takes motor and load for one inertia, and for the transmission of the file alone its residual is {:.3g} {}, for the records {:.3g} {}",
                                   std::sqrt(diagnosis.transmission), unit, std::sqrt(measured), unit), diagnosis);
}

AxisSeries series_of(const BalanceRecord& smooth, const Balance& balance, double nominal_inertia, const BalanceModel& model) {
  AxisSeries series{smooth.time, smooth.position, smooth.speed, smooth.effort, {}, {}};
  // The residual where the axis stands is not determined; drawn as if it moved.
  series.nominal_residual = balance_residual(smooth, balance.laws, bare(nominal_inertia, model.skew), -1.0);
  series.residual = balance_residual(smooth, balance.laws, model, -1.0);
  return series;
}

}  // namespace

AxisRecord axis_record(const NamedRun& named, const sim::MachineFile& axis) {
  const msgs::RunLog& run = named.run;
  if (axis.parameters.drive.group_count != 1) throw NoBalance(named.name + ": a torque balance is drawn of an axis with one motor group");
  if (run.encoder.size() < 2) throw NoBalance(named.name + ": no ENCODER messages; without positions there is no motion to balance");
  if (run.torque.empty()) throw NoBalance(named.name + ": no TORQUE messages; without torques there is nothing to balance the motion with");
  const double ratio = sim::total_ratio(axis.parameters.drive), motors = axis.parameters.drive.motors_per_group;
  const double limit = axis.drive_protection.torque_limit;
  std::map<std::int64_t, const msgs::Torque*> answers;
  for (const msgs::Torque& torque : run.torque) answers[torque.answered_sequence] = &torque;
  AxisRecord record;
  record.name = named.name;
  const auto count = static_cast<double>(run.encoder.size() - 1);
  record.step = static_cast<double>(run.encoder.back().simulated_time - run.encoder.front().simulated_time) * kNanosecond / count;
  if (!(record.step > 0.0)) throw NoBalance(named.name + ": the time of ENCODER does not rise");
  const msgs::Torque* held = &run.torque.front();
  std::vector<bool> is_braked;
  double largest = 0.0;  // torque of a motor
  for (std::size_t n = 0; n < run.encoder.size(); ++n) {
    const msgs::Encoder& encoder = run.encoder[n];
    const double time = static_cast<double>(encoder.simulated_time - run.encoder.front().simulated_time) * kNanosecond;
    if (std::fabs(time - record.step * static_cast<double>(n)) > kOffGrid * record.step) {
      throw NoBalance(fmt::format("{}: ENCODER at {:.4f} s misses the even grid of {:.4g} ms by {:.2g} ms; cut the log at its gap (slewlab cut), or import it with "
                                  "`resample: linear`",
                                  named.name, static_cast<double>(encoder.simulated_time) * kNanosecond, 1e3 * record.step,
                                  1e3 * std::fabs(time - record.step * static_cast<double>(n))));
    }
    if (const auto answer = answers.find(encoder.sequence); answer != answers.end()) held = answer->second;
    if (encoder.shaft_position.empty() || held->motor_torque.empty()) throw NoBalance(named.name + ": a message of no motor group");
    const double position = encoder.shaft_position[0] / ratio, torque = held->motor_torque[0];
    if (!std::isfinite(position) || !std::isfinite(torque)) {
      throw NoBalance(fmt::format("{}: a position or torque at {:.4f} s is no number", named.name, static_cast<double>(encoder.simulated_time) * kNanosecond));
    }
    largest = std::max(largest, std::fabs(torque));
    is_braked.push_back(held->brake);
    record.position.push_back(position);
    record.effort.push_back(ratio * motors * std::clamp(torque, -limit, limit));
  }
  check_against_ratings(record.name, largest, record, axis);
  keep_unbraked(is_braked, axis.drive_protection.brake, record);
  record.load = described_load(axis, record.position, record.step);
  if (root_mean_square(record.effort) == 0.0 && root_mean_square(record.load) == 0.0) {
    throw NoBalance(named.name + ": the torque is zero throughout; there is nothing to balance the motion with");
  }
  for (std::size_t n = 0; n < record.load.size(); ++n) record.effort[n] += record.load[n];
  return record;
}

std::vector<double> forward_speed(const AxisRecord& record, const BalanceMotion& motion, const std::vector<BalanceLaw>& laws,
                                  const BalanceModel& model, std::size_t stretch) {
  std::vector<std::pair<const LawShape*, BalanceTerm>> acting;
  for (BalanceTerm& term : model.acting()) acting.emplace_back(&shape_of(laws, term), std::move(term));
  const std::size_t first = (record.position.size() - motion.speed.size()) / 2;
  const auto along = [&](const std::vector<double>& series, std::size_t n) {
    return series[std::clamp<std::size_t>(n, first, first + series.size() - 1) - first];
  };
  const double step = record.step / kFiner;
  std::vector<double> speeds(record.position.size());
  LawMoment moment{record.start_time, along(motion.position, 0), along(motion.speed, 0), 0.0};
  moment.is_exact = true;
  // The first speed that is known is that in the middle of the first window: what acts before it has already acted.
  std::fill(speeds.begin(), speeds.begin() + static_cast<std::ptrdiff_t>(first), moment.speed);
  moment.time += record.step * static_cast<double>(first);
  for (std::size_t n = first; n < speeds.size(); ++n) {
    if ((n - first) % stretch == 0) {
      moment.position = along(motion.position, n);
      moment.speed = along(motion.speed, n);
    }
    speeds[n] = moment.speed;
    moment.effort_rate = along(motion.effort_rate, n);
    if (motion.late_count > 0) moment.late = &motion.late[(std::clamp<std::size_t>(n, first, first + motion.speed.size() - 1) - first) * motion.late_count];
    const double effort = record.effort[n] - model.skew * moment.effort_rate;
    for (int i = 0; i < kFiner; ++i) {
      // J (v - v0) / h + R(v) = F for the speed at the step's end: its left side rises with v, dry friction's jump included.
      const double before = moment.speed;
      const auto rest = [&](double speed) {
        LawMoment end = moment;
        end.speed = speed;
        return model.inertia * (speed - before) / step + resistance(acting, end) - effort;
      };
      double reach = std::max(std::numeric_limits<double>::min(), std::fabs(step / model.inertia * rest(before)));  // doubled, it must grow
      while (rest(before - reach) > 0.0 && std::isfinite(reach)) reach *= 2.0;
      double low = before - reach, high = before + reach;
      while (rest(high) < 0.0 && std::isfinite(high)) high += reach *= 2.0;
      for (int halving = 0; halving < kHalvings; ++halving) {
        const double middle = 0.5 * (low + high);
        (rest(middle) > 0.0 ? high : low) = middle;
      }
      moment.speed = 0.5 * (low + high);
      moment.position += 0.5 * step * (before + moment.speed);
      moment.time += step;
    }
  }
  return speeds;
}

AxisDiagnosis diagnose_axis(const sim::MachineFile& axis, const std::vector<NamedRun>& runs, const std::vector<std::string>& without,
                            const std::vector<NamedRun>& unseen) {
  AxisDiagnosis diagnosis;
  diagnosis.nominal_inertia = sim::rigid_inertia(axis.parameters);
  std::vector<AxisRecord> records;
  for (const NamedRun& run : runs) records.push_back(axis_record(run, axis));
  TransmissionGap gap;
  try {
    Balance balance = balance_of(records, diagnosis.nominal_inertia, axis.parameters.drive.top_speed, !axis.axis.is_linear);
    std::erase_if(balance.laws, [&](const BalanceLaw& law) {
      const auto is_left_out = [&](const std::string& name) { return std::find(without.begin(), without.end(), name) != without.end(); };
      return is_left_out(law.name) || is_left_out(law.needs);
    });
    diagnosis.laws = balance.laws;
    diagnosis.half_window = balance.half_window;
    diagnosis.window = records.front().step * static_cast<double>(2 * balance.half_window + 1);
    diagnosis.lateness = balance.lateness;
    if (axis.axis.is_linear) {
      for (BalanceLaw& law : balance.laws) law.words = of_a_linear_axis(std::move(law.words));
      diagnosis.laws = balance.laws;
    }
    const std::vector<BalanceRecord> smooth = smoothed(records, balance);
    gap = transmission_gap(axis, records, smooth, balance, diagnosis);
    diagnosis.transmission = gap.described;
    choose_and_validate(records, smooth, balance, diagnosis.nominal_inertia, diagnosis);
    BalanceModel& best = diagnosis.answer.best;
    FittedSizes sizes = refitted(smooth, balance.laws, diagnosis.validated, diagnosis.nominal_inertia, balance.resolved_speed,
                                 axis.axis.is_shaft_linear ? 0.0 : sim::total_ratio(axis.parameters.drive));
    diagnosis.is_physical = sizes.is_physical;
    take_remainder(axis, sizes, diagnosis);
    best = std::move(sizes.best);
    diagnosis.answer.models.front() = std::move(sizes.stated);
    check_units(diagnosis.nominal_inertia, best);
    if (!unseen.empty()) {
      const BalanceModel inertia_alone = fit_balance(smooth, {}, diagnosis.nominal_inertia, balance.resolved_speed).best;
      for (const NamedRun& run : unseen) diagnosis.unseen.push_back(tried_on(axis_record(run, axis), balance, inertia_alone, diagnosis));
    }
    for (const BalanceRecord& record : smooth) {
      diagnosis.series.push_back(series_of(record, balance, diagnosis.nominal_inertia, diagnosis.answer.best));
    }
  } catch (const std::invalid_argument& problem) {
    throw NoBalance(problem.what());
  }
  double spread = sim::kUnitDeviation;
  for (const sim::Parameter& parameter : sim::describe(axis).parameters) {
    if (parameter.name == "inertia" || parameter.name == "mass") spread = parameter.spread;
  }
  name_answer(axis, spread, diagnosis);
  judge_transmission(axis, gap.measured, diagnosis);
  if (diagnosis.outcome == AxisOutcome::stated) {
    const auto failed = std::find_if(diagnosis.unseen.begin(), diagnosis.unseen.end(), [](const AxisValidation& one) { return !one.holds; });
    if (failed != diagnosis.unseen.end()) {
      diagnosis.verdict = fmt::format("Not sure: {}; but it does not predict {} better than the nominal axis and another inertia do", diagnosis.verdict, failed->place);
    }
  }
  say_what_to_do(axis, diagnosis);
  if (diagnosis.outcome == AxisOutcome::stated && !diagnosis.answer.best.terms.empty()) take_effects(axis, records.front().position.front(), diagnosis);
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (records[r].position.size() == runs[r].run.encoder.size()) continue;
    diagnosis.remarks.push_back(fmt::format("{}: judged is its longest stretch without brakes, {:.4g} s from {:.4g} s on", runs[r].name,
                                            records[r].step * static_cast<double>(records[r].position.size()), records[r].start_time));
  }
  if (!axis.parameters.drive.is_rigid) {
    diagnosis.remarks.push_back("the balance takes motor and load for one inertia: what swings behind the transmission is part of the residual");
  }
  return diagnosis;
}

}  // namespace slewlab::diagnosis
