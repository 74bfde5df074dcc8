#include "diagnosis/diagnose.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <mutex>
#include <set>
#include <span>

#include "common/unit.h"
#include "controller/effects/catalogue.h"
#include "diagnosis/chance.h"
#include "diagnosis/nuisance.h"
#include "diagnosis/plausibility.h"
#include "diagnosis/screen.h"
#include "sim/effects/catalogue.h"
#include "sim/machine/effect_scales.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kNinetyPercent = 1.645;       // standard deviations of a normal 90 % interval
constexpr double kIndistinguishable = 0.97;    // cosine of two signatures, nuisances taken out
constexpr double kLeastTrusted = 0.3;           // share of a record that must lie away from impacts
constexpr double kGroupOdds = 20.0;             // of two causes' probabilities, beyond which the records tell them apart
constexpr double kWorthAGroup = 0.005;          // probability of a pair below which nobody asks what it is like
constexpr double kThirdPrior = 0.1;  // chosen: of three effects at once, against two
constexpr double kControllerExplained = 0.01;   // share of its difference that the right effect of a controller leaves at most
constexpr double kSlowFollower = 4.0;           // by which the shadow is slower behind coarse counts, or they would shake its boom
constexpr double kCoarseDiscrepancy = 5.0;      // by which mesh and step miss more there: the controller's steps shake the high modes
constexpr double kCoarseNoise = 0.1;            // share by which the noise of coarse counts is known
constexpr double kLawShare = 0.05;              // relative standard deviation of a size by its law: learned, docs/diagnosis/method.md
constexpr double kCurvatureFactor = 1.7;        // of the standard deviations that the curvature gives: learned as well
constexpr double kCountError = 1e-3;            // relative, of a quantum found in the positions
constexpr double kSure = 0.98;                  // probability of what needs no fit, or leaves next to nothing
constexpr double kUnlikely = 0.02;              // probability of what was left out, or leaves much
constexpr double kFarOff = 2.6;                 // [standard deviations] of a parameter, beyond which it may be another crane
constexpr double kWorthASwing = 2e-3;           // [rad] of the load at a record's beginning: an eighth of a metre below 60 m of rope
constexpr double kNegligible = 1e-4;            // probability of a part that is not combined further
constexpr int kHeldOutRounds = 3;               // at most, with fresh columns
// Sum of squares V of the most visible size below which the effect could not be named: s V pays neither price and Occam's share (some 13) nor the
// prior of one among forty effects against nothing missing (2 T times 4.3).
constexpr double kVisible = 130.0;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Where the gap lies: what `difference` has more than `left`, band by band.
void locate(const Problem& problem, const Eigen::VectorXd& difference, const Eigen::VectorXd& left, Diagnosis& diagnosis) {
  // Bands between the modes that the thesis's cranes have: swinging, first bending, second bending, torsion
  // and higher.
  static constexpr std::array<double, 6> kEdges{0.02, 0.5, 2.5, 8.0, 16.0, 40.0};
  struct Sum {
    double square = 0.0, more = 0.0, count = 0.0;
  };
  std::map<std::pair<std::string, int>, Sum> sums;
  Eigen::Index row = 0;
  for (std::size_t r = 0; r < problem.records.size(); ++r) {
    const Whitening& whitening = problem.whitening[r];
    for (const Channel& channel : whitening.channels) {
      const std::string name = channel.is_torque ? fmt::format("torque of group {}", channel.index + 1)
                                                 : fmt::format("{} acceleration", accelerometer_name(channel.index));
      for (std::size_t b = 0; b < whitening.bin_count; ++b) {
        const double frequency = static_cast<double>(whitening.first_bin + b) * whitening.bin_width;
        int band = 0;
        while (band + 2 < static_cast<int>(kEdges.size()) && frequency >= kEdges[static_cast<std::size_t>(band + 1)]) ++band;
        Sum& sum = sums[{name, band}];
        for (const Eigen::Index part : {row, row + 1}) {
          sum.square += difference(part) * difference(part);
          sum.more += difference(part) * difference(part) - left(part) * left(part);
          sum.count += 1.0;
        }
        row += 2;
      }
    }
  }
  double total = 0.0;
  for (const auto& [key, sum] : sums) total += std::max(0.0, sum.more);
  if (total <= 0.0) return;
  for (const auto& [key, sum] : sums) {
    const auto band = static_cast<std::size_t>(key.second);
    diagnosis.bands.push_back(
        {key.first, kEdges[band], kEdges[band + 1], std::max(0.0, sum.more) / total, sum.square / sum.count});
  }
  std::sort(diagnosis.bands.begin(), diagnosis.bands.end(),
            [](const BandShare& a, const BandShare& b) { return a.share > b.share; });
}

void find_moments(const Problem& problem, const Point& point, Diagnosis& diagnosis) {
  for (std::size_t r = 0; r < problem.records.size(); ++r) {
    const Record& record = problem.records[r];
    const Shadow follower = shadow_at(problem, point, r);
    const auto second = static_cast<std::size_t>(std::lround(1.0 / record.step));
    double top_speed = 0.0;
    for (const double speed : record.shaft_speed[0]) top_speed = std::max(top_speed, std::fabs(speed));
    for (std::size_t n = 0; n + second <= record.size(); n += second) {
      double square = 0.0;
      for (std::size_t i = n; i < n + second; ++i) {
        for (int g = 0; g < record.group_count; ++g) {
          const double missing = follower.missing_torque[static_cast<std::size_t>(g)][i];
          square += missing * missing / record.group_count;
        }
      }
      const double change = std::fabs(record.shaft_speed[0][n + second - 1]) - std::fabs(record.shaft_speed[0][n]);
      const double level = std::fabs(record.shaft_speed[0][n + second / 2]);
      const char* phase = level < 0.02 * top_speed            ? "standing"
                          : change > 0.05 * top_speed         ? "accelerating"
                          : change < -0.05 * top_speed        ? "braking"
                          : record.shaft_speed[0][n] * record.shaft_speed[0][n + second - 1] < 0.0 ? "reversing"
                                                                                                    : "constant speed";
      diagnosis.moments.push_back({record.name, record.time(n) + 0.5, phase,
                                   std::sqrt(square / static_cast<double>(second))});
    }
  }
  std::sort(diagnosis.moments.begin(), diagnosis.moments.end(),
            [](const Moment& a, const Moment& b) { return a.missing_torque > b.missing_torque; });
  if (diagnosis.moments.size() > 8) diagnosis.moments.resize(8);
}

std::vector<Size> sizes_of(const common::EffectCatalogue& catalogue, const std::vector<common::EffectInstance>& effects, const std::vector<double>& deviations) {
  std::vector<Size> sizes;
  std::size_t k = 0;
  for (const common::EffectInstance& effect : effects) {
    const common::EffectAbout& about = catalogue.at(effect.name);
    for (std::size_t p = 0; p < effect.values.size(); ++p, ++k) {
      const common::EffectParameter& parameter = about.parameters[p];
      const double value = effect.values[p];
      // No law is quite the machine's: its size is not known better than that, however well it fits.
      const double deviation = std::hypot(kCurvatureFactor * deviations[k], kLawShare * value);
      Size size{fmt::format("{}.{}", effect.name, parameter.name), std::string(common::name_of(parameter.unit)), value,
                deviation, 0.0, 0.0};
      if (parameter.scale == common::ParameterScale::logarithmic) {
        const double factor = std::exp(kNinetyPercent * deviation / std::max(1e-300, std::fabs(value)));
        size.low = value / factor;
        size.high = value * factor;
      } else {
        size.low = value - kNinetyPercent * deviation;
        size.high = value + kNinetyPercent * deviation;
      }
      sizes.push_back(size);
    }
  }
  return sizes;
}

Cause make_cause(const common::EffectCatalogue& catalogue, const FitResult& result) {
  Cause cause;
  for (const common::EffectInstance& effect : result.point.effects) cause.effects.push_back(effect.name);
  cause.point = result.point;
  cause.mean_square = result.mean_square;
  cause.excess = result.excess;
  cause.prior = result.prior;
  cause.information = result.information;
  cause.sizes = sizes_of(catalogue, result.point.effects, result.deviation);
  return cause;
}

// Causes whose signatures, as fitted, cannot be told apart: single ones by all that they do, pairs that share an effect by what
// the other one does beside it. Probabilities and causes stand in the order of the fits.
void find_groups(const Problem& problem, const FitResult& base, const Projector& project, const std::vector<FitResult>& fits,
                 std::span<const double> probability, std::span<Cause> causes) {
  struct Signature {
    std::size_t fit;
    std::string beside;  // the effect shared; none of single causes
    Eigen::VectorXd column;
  };
  std::vector<Signature> signatures;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    if (fits[k].point.effects.size() != 1) continue;
    signatures.push_back({k, "", project(fits[k].difference - base.difference)});
    if (fits[k].columns.size() == 0) continue;
    const std::string& shared = fits[k].point.effects[0].name;
    std::optional<Projector> beside;
    for (std::size_t i = 0; i < fits.size(); ++i) {
      const std::vector<common::EffectInstance>& effects = fits[i].point.effects;
      const bool is_pair = effects.size() == 2 && probability[i] > kWorthAGroup && has_effect(effects, shared);
      if (!is_pair || comes_by_chance(problem.catalogue.at(effects[0].name)) || comes_by_chance(problem.catalogue.at(effects[1].name))) continue;
      if (!beside) beside.emplace(problem.catalogue, fits[k].columns, fits[k].point, data_weight(fits[k].difference, problem.settings));
      signatures.push_back({i, shared, (*beside)(fits[i].difference - fits[k].difference)});
    }
  }
  for (const Signature& one : signatures) {
    Cause& cause = causes[one.fit];
    for (const Signature& other : signatures) {
      if (other.fit == one.fit || other.beside != one.beside) continue;
      const double scale = one.column.norm() * other.column.norm();
      if (scale <= 0.0) continue;
      const double cosine = std::fabs(one.column.dot(other.column)) / scale;
      const double odds = probability[other.fit] / std::max(1e-300, probability[one.fit]);
      if (cosine > kIndistinguishable && odds < kGroupOdds && odds > 1.0 / kGroupOdds) {
        cause.group.push_back({name_of(causes[other.fit]), std::sqrt(std::max(0.0, 1.0 - cosine * cosine))});
      }
    }
  }
}

// Every cause gets the found effect beside what it has. `known` is the probability that it is the catalogue's.
void add_beside(const common::EffectInstance& effect, const std::vector<Size>& sizes, double known, Diagnosis& diagnosis) {
  for (Cause& cause : diagnosis.causes) {
    cause.effects.push_back(effect.name);
    cause.point.effects.push_back(effect);
    cause.probability *= known;
    for (Alike& other : cause.group) other.name += " with " + effect.name;
    cause.sizes.insert(cause.sizes.end(), sizes.begin(), sizes.end());
  }
  diagnosis.probability_unknown = 1.0 - (1.0 - diagnosis.probability_unknown) * known;
}

// The effect whose size a record shows so; nullptr where the catalogue has none.
const common::EffectAbout* read_off(const common::EffectCatalogue& catalogue, common::ReadOff from) {
  for (const common::EffectAbout& about : catalogue.effects) {
    if (about.read_off == from) return &about;
  }
  return nullptr;
}

// Counts are seen in the positions themselves, to the count: they need no fit.
void add_counts(const Problem& problem, const DiagnosisSettings& settings, Diagnosis& diagnosis) {
  double quantum = 0.0;
  for (const Record& record : problem.records) quantum = std::max(quantum, record.encoder_quantum);
  const common::EffectAbout* const counts = read_off(problem.catalogue, common::ReadOff::encoder_counts);
  if (quantum < kCoarseCount || counts == nullptr || has_effect(problem.nominal.effects, counts->name)) return;
  diagnosis.counts = quantum;
  common::EffectInstance effect = common::typical_instance(*counts);
  effect.values[common::kSize] = quantum;
  std::vector<double> deviations(effect.values.size(), 0.0);
  deviations[common::kSize] = kCountError * quantum;
  const bool left_out = std::find(settings.without.begin(), settings.without.end(), counts->name) != settings.without.end();
  add_beside(effect, sizes_of(problem.catalogue, {effect}, deviations), left_out ? kUnlikely : kSure, diagnosis);
}

// The controller answers otherwise than its settings say, so every cause needs one of its effects beside what
// the machine's side needs.
void add_controller_causes(const Problem& problem, const controller::ControllerSettings& controller,
                           const DiagnosisSettings& settings, Diagnosis& diagnosis) {
  diagnosis.controller_causes = fit_controller(problem.records, controller, settings.without, problem.is_stopped);
  const double known = diagnosis.controller_causes.empty() ||
                               diagnosis.controller_causes.front().share_left > kControllerExplained
                           ? kUnlikely
                           : kSure;
  std::vector<Cause> combined;
  for (const ControllerCause& part : diagnosis.controller_causes) {
    if (part.probability < kNegligible) continue;
    for (const Cause& cause : diagnosis.causes) {
      if (cause.effects.size() + part.effects.size() > 2) continue;
      Cause both = cause;
      for (const common::EffectInstance& effect : part.effects) both.effects.push_back(effect.name);
      for (const common::EffectInstance& effect : part.effects) {
        for (Alike& other : both.group) other.name += " with " + effect.name;
      }
      both.controller_effects = part.effects;
      both.probability *= part.probability * known;
      const std::vector<Size> sizes = sizes_of(controller::effects_for(controller), part.effects, part.deviation);
      both.sizes.insert(both.sizes.end(), sizes.begin(), sizes.end());
      combined.push_back(both);
    }
  }
  diagnosis.probability_unknown = 1.0 - (1.0 - diagnosis.probability_unknown) * known;
  // What needs a third effect is not looked for, and rare; what it has goes to what is not known.
  double two = 0.0;
  for (const Cause& cause : combined) two += cause.probability;
  const double three = std::max(0.0, 1.0 - diagnosis.probability_unknown - two);
  const double share = (1.0 - diagnosis.probability_unknown) / (two + kThirdPrior * three);
  for (Cause& cause : combined) cause.probability *= share;
  diagnosis.probability_unknown = 1.0 - share * two;
  diagnosis.causes = std::move(combined);
}

// The cause fitted once more, from the nominal machine, without the last record, or of a single one without its second half: that is
// taken out of the problem for good. `follower` is the nominal machine's shadow of it.
HeldOut fit_without_last(Problem& problem, const WhiteningSettings& settings, const Shadow& follower, const Point& answer) {
  const Record& last = problem.records.back();
  HeldOut held{answer, last.name, last.start_time, problem.records.size() == 1};
  if (held.is_half) {
    std::vector<bool> trusted = trusted_stretches(last, follower);
    std::fill(trusted.begin() + static_cast<std::ptrdiff_t>(last.size() / 2), trusted.end(), false);
    problem.whitening = {make_whitening(last, trusted, problem.gains, follower, settings)};
    held.from_time = last.time(last.size() / 2);
  } else {
    problem.records.pop_back();
    problem.whitening.pop_back();
  }
  held.point.nuisance.assign(nuisance_count(problem), 0.0);
  const auto nuisances = static_cast<Eigen::Index>(held.point.nuisance.size());
  FitResult result = fit(problem, Eigen::MatrixXd::Zero(difference_count(problem), nuisances), held.point);
  settle(problem, result, kHeldOutRounds);
  held.point = result.point;
  return held;
}

}  // namespace

std::string name_of(const Cause& cause) {
  if (cause.effects.empty()) return "only parameters are off";
  std::string name = cause.effects[0];
  for (std::size_t e = 1; e < cause.effects.size(); ++e) name += " with " + cause.effects[e];
  return name;
}

Diagnosis diagnose(const sim::MachineSettings& nominal, const std::optional<controller::ControllerSettings>& controller,
                   std::vector<Record> records, const DiagnosisSettings& settings, const Progress& progress,
                   const std::function<bool()>& is_stopped) {
  const auto start_time = std::chrono::steady_clock::now();
  std::mutex telling;
  const auto tell = [&](double share, const std::string& doing) {
    const std::lock_guard lock(telling);
    if (progress) progress(share, doing);
  };
  Diagnosis diagnosis;
  Problem problem;
  problem.nominal = nominal;
  if (!problem.nominal.scales) problem.nominal.scales = sim::effect_scales(nominal.crane, nominal.drive_protection);
  problem.catalogue = sim::effects_for(problem.nominal);
  ShadowSettings shadow_settings;
  const bool is_coarse = std::any_of(records.begin(), records.end(),
                                     [](const Record& record) { return record.encoder_quantum >= kCoarseCount; });
  WhiteningSettings whitening = settings.whitening;
  if (is_coarse) {
    whitening.discrepancy_share *= kCoarseDiscrepancy;
    shadow_settings.speed_rate /= kSlowFollower;
    shadow_settings.position_rate /= kSlowFollower * kSlowFollower;
  }
  problem.gains = shadow_gains(nominal.crane, shadow_settings);
  problem.latency_deviation = is_coarse ? kCoarseLatencyDeviation : kLatencyDeviation;
  problem.settings = settings.fit;
  problem.threads = settings.threads;
  if (is_stopped) problem.is_stopped = is_stopped;
  std::string not_judged;  // the records that are left out, with the reason
  for (Record& record : records) {
    if (record.group_count != nominal.crane.drive.group_count) {
      throw NotAdmitted(fmt::format("{}: the log has {} motor groups, the nominal crane {}: another crane?", record.name,
                                    record.group_count, nominal.crane.drive.group_count));
    }
    for (const std::string& remark : record.remarks) diagnosis.remarks.push_back(remark);
    Shadow follower = shadow(nominal, record, problem.gains);
    for (int g = 0; g < record.group_count; ++g) {
      for (const double torque : follower.missing_torque[static_cast<std::size_t>(g)]) {
        if (!std::isfinite(torque)) {
          throw NotAdmitted(fmt::format("{}: the nominal crane cannot follow this record at all; check its inertias, its gear "
                                        "ratios and the record's units",
                                        record.name));
        }
      }
    }
    check_torques(record, follower, nominal);
    const std::vector<bool> trusted = trusted_stretches(record, follower);
    const double share = static_cast<double>(std::count(trusted.begin(), trusted.end(), true)) / static_cast<double>(record.size());
    if (share < kLeastTrusted) {
      not_judged += fmt::format("{}{}: only {:.0f} % of the record lies away from impacts of the gears, at least {:.0f} % are needed",
                                not_judged.empty() ? "" : "; ", record.name, 100.0 * share, 100.0 * kLeastTrusted);
      continue;
    }
    if (share < 0.999) {
      diagnosis.remarks.push_back(fmt::format("{}: {:.0f} % of the record lie near impacts of the gears and are not judged",
                                              record.name, 100.0 * (1.0 - share)));
    }
    problem.whitening.push_back(make_whitening(record, trusted, problem.gains, follower, whitening));
    diagnosis.followed = {record.name, std::move(follower), {}};  // the last one stays
    problem.records.push_back(std::move(record));
  }

  if (problem.records.empty()) {
    throw NotAdmitted(not_judged + "; switch play compensation on, or accelerate more gently");
  }
  if (!not_judged.empty()) diagnosis.remarks.push_back(not_judged + "; left out, the answer stands on the other records");

  tell(0.0, "replaying the controller");
  if (controller) {
    for (const Record& record : problem.records) {
      check_replayable(record, *controller);
      diagnosis.controller_replay.push_back(replay_controller(record, *controller));
      const ControllerReplay& replay = diagnosis.controller_replay.back();
      // On a log of the wire both sides are exact; a thousandth leaves room for logs that were rounded.
      if (replay.difference_rms > 1e-3 * replay.torque_rms) diagnosis.controller_differs = true;
    }
  }

  tell(kFitParameters.from, "fitting the parameters alone");
  const FitResult nominal_machine = nominal_fit(problem);
  const FitResult base = fit_nuisances(problem, nominal_machine);
  diagnosis.mean_square_nominal = nominal_machine.mean_square;
  diagnosis.mean_square_parameters = base.mean_square;
  find_moments(problem, base.point, diagnosis);

  const Projector project(problem.catalogue, base.columns, base.point, data_weight(base.difference, settings.fit));
  const Screening screening = screen(problem, base, project, catalogue_starts(problem.catalogue, problem.nominal, settings.without, longest_record(problem)),
                                     within(tell, kScreen));
  for (const auto& [name, square] : screening.visibility) {
    if (square < kVisible) diagnosis.not_excited.push_back(name);
  }
  const Found found = search(problem, base, screening, settings.search, tell);
  const FitResult& nothing = found.nothing;
  const std::vector<FitResult>& fits = found.fits;

  // Weigh.
  EvidenceSettings evidence = settings.evidence;
  evidence.independent_share = settings.fit.independent_share;
  double least = std::min(0.0, nothing.excess);
  for (const FitResult& result : fits) least = std::min(least, result.excess);
  const MisfitCost misfit_cost(evidence, nothing.excess - least);
  std::vector<Candidate> candidates;
  const auto add_candidate = [&](const FitResult& result) {
    Cause cause = make_cause(problem.catalogue, result);
    const Relaxed relaxed = relax(problem, result, misfit_cost, least);
    cause.excess = relaxed.excess;
    cause.prior = relaxed.prior;
    candidates.push_back({cause.effects, cause.excess, cause.prior, cause.information});
    diagnosis.causes.push_back(std::move(cause));
  };
  add_candidate(nothing);
  for (const FitResult& result : fits) add_candidate(result);
  if (is_coarse) {
    evidence.unknown_floor += kCoarseNoise * settings.fit.independent_share * static_cast<double>(base.difference.size());
  }
  const Probabilities probabilities = weigh(candidates, static_cast<int>(screening.names.size()), evidence);
  for (std::size_t i = 0; i < diagnosis.causes.size(); ++i) {
    diagnosis.causes[i].probability = probabilities.candidate[i];
  }
  diagnosis.probability_unknown = probabilities.unknown;
  // What is explained is counted down to what the noise, or the best of all fits, leaves.
  const double floor = probabilities.floor;
  for (Cause& cause : diagnosis.causes) {
    cause.explained = nothing.excess > floor ? std::clamp((nothing.excess - cause.excess) / (nothing.excess - floor), 0.0, 1.0) : 0.0;
  }
  // The gap lies where the most probable cause takes something away; where none does, where more than noise is left.
  const auto likeliest = std::max_element(probabilities.candidate.begin() + 1, probabilities.candidate.end());
  const FitResult* const answer_fit = likeliest != probabilities.candidate.end() && probabilities.unknown < *likeliest
                                          ? &fits[static_cast<std::size_t>(likeliest - probabilities.candidate.begin() - 1)]
                                          : nullptr;
  locate(problem, base.difference,
         answer_fit != nullptr && !comes_by_chance(problem.catalogue.at(answer_fit->point.effects[0].name)) ? answer_fit->difference
                                                                                      : Eigen::VectorXd::Ones(base.difference.size()),
         diagnosis);
  find_groups(problem, base, project, fits, std::span(probabilities.candidate).subspan(1), std::span(diagnosis.causes).subspan(1));
  if (diagnosis.controller_differs) tell(kHoldOut.from, "fitting the controller");
  if (diagnosis.controller_differs) add_controller_causes(problem, *controller, settings, diagnosis);
  add_counts(problem, settings, diagnosis);
  std::stable_sort(diagnosis.causes.begin(), diagnosis.causes.end(),
                   [](const Cause& a, const Cause& b) { return a.probability > b.probability; });
  // Of the groups, those with a third effect are gone.
  std::set<std::string> names;
  for (const Cause& cause : diagnosis.causes) names.insert(name_of(cause));
  for (Cause& cause : diagnosis.causes) std::erase_if(cause.group, [&](const Alike& other) { return !names.contains(other.name); });
  const common::EffectCatalogue known = controller ? joined(problem.catalogue, controller::effects_for(*controller)) : problem.catalogue;
  std::map<std::string, double> by_subsystem, by_effect;
  diagnosis.probability_nothing = 0.0;
  for (const Cause& cause : diagnosis.causes) {
    if (cause.effects.empty()) diagnosis.probability_nothing += cause.probability;
    std::set<std::string> touched;
    for (const std::string& effect : cause.effects) {
      touched.insert(std::string(common::name_of(known.at(effect).subsystem)));
      by_effect[effect] += cause.probability;
    }
    for (const std::string& subsystem : touched) by_subsystem[subsystem] += cause.probability;
  }
  const auto falling = [](const std::map<std::string, double>& by_name) {
    std::vector<std::pair<std::string, double>> all(by_name.begin(), by_name.end());
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
    return all;
  };
  diagnosis.subsystems = falling(by_subsystem);
  diagnosis.effects = falling(by_effect);

  static const Cause kNone;
  const Cause& first = diagnosis.causes.empty() ? kNone : diagnosis.causes.front();
  diagnosis.gap = diagnosis.controller_differs || diagnosis.counts > 0.0 || diagnosis.probability_nothing < 0.5;
  diagnosis.is_unknown = diagnosis.probability_unknown > first.probability;
  if (diagnosis.is_unknown) {
    diagnosis.verdict = "not in the catalogue: no known effect explains what is missing";
  } else if (first.effects.empty()) {
    diagnosis.verdict = "no effect is missing; parameters within their spread explain the records";
  } else {
    diagnosis.verdict = name_of(first);
  }
  // Parameters that had to go farther than machines of one make differ.
  const Point& answer = first.point.nuisance.empty() ? base.point : first.point;
  std::string far;
  for (std::size_t k = 0; k < std::min(answer.nuisance.size(), nuisances().size()); ++k) {
    if (std::fabs(answer.nuisance[k]) < kFarOff) continue;
    far += fmt::format("{}{} {:+.0f} %", far.empty() ? "" : ", ", nuisances()[k].name, 100.0 * nuisances()[k].spread * answer.nuisance[k]);
  }
  for (std::size_t r = 0; r < problem.records.size(); ++r) {
    const double reach = swing_reach(answer.nuisance, r);
    if (reach < kWorthASwing) continue;
    diagnosis.remarks.push_back(fmt::format("{}: the load swings when the record begins, up to {:.1f} mrad from where it would hang still",
                                            problem.records[r].name, 1e3 * reach));
  }
  if (!far.empty() || diagnosis.is_unknown) {
    diagnosis.remarks.push_back(
        fmt::format("cannot tell whether this is another crane than the nominal one: {}; check that the crane file is this crane's",
                    far.empty() ? "neither a known effect nor parameters within their spread explain it"
                                : "the best fit wants " + far + ", more than machines of one make differ"));
  }
  const auto has_no_fit = [&](const common::EffectInstance& effect) {
    const common::EffectAbout& about = known.at(effect.name);
    return about.read_off != common::ReadOff::none || comes_by_chance(about);
  };
  const bool has_a_fit = std::none_of(first.point.effects.begin(), first.point.effects.end(), has_no_fit);
  Point followed = answer;
  std::erase_if(followed.effects, has_no_fit);
  diagnosis.followed.explained = shadow_at(problem, followed, problem.records.size() - 1);
  if (settings.hold_out && has_a_fit && !first.point.nuisance.empty()) {
    tell(kHoldOut.from, "fitting the answer without the last record");
    diagnosis.held_out = fit_without_last(problem, whitening, diagnosis.followed.nominal, first.point);
  }
  diagnosis.simulations = problem.simulations;
  diagnosis.simulation_seconds = 1e-9 * static_cast<double>(problem.simulation_time);
  diagnosis.total_seconds = seconds_since(start_time);
  tell(1.0, "done");
  return diagnosis;
}

}  // namespace slewlab::diagnosis
