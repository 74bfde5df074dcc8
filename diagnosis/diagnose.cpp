#include "diagnosis/diagnose.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <set>

#include "common/unit.h"
#include "diagnosis/nuisance.h"
#include "sim/effects/catalogue.h"
#include "sim/model/drive_line.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kNinetyPercent = 1.645;       // standard deviations of a normal 90 % interval
constexpr double kIndistinguishable = 0.97;    // cosine of two signatures, nuisances taken out
constexpr double kLeastTrusted = 0.3;           // share of a record that must lie away from impacts
constexpr double kLeastGain = 0.005;            // share of the gap that an effect must take away to be refined
constexpr double kControllerExplained = 0.1;    // share of its difference that the right effect of a controller leaves at most
constexpr double kNegligible = 1e-4;            // probability of a part that is not combined further
constexpr double kSmallShare = 0.25;            // of an effect's typical size, with which it is tried too
constexpr double kLargestAmount = 20.0;         // of the screened size that a linear forecast is trusted with
constexpr double kVisible = 0.02;              // mean square of a tried size below which records tell nothing

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// The points from which an effect is tried: its typical size, and a fraction of it, where most laws are still linear;
// other sizes where the size enters not proportionally; other shapes.
std::vector<common::EffectInstance> starts_of(const common::EffectAbout& about) {
  const common::EffectInstance typical = common::typical_instance(about);
  std::vector<common::EffectInstance> starts{typical};
  common::EffectInstance small = typical;
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    const common::EffectParameter& parameter = about.parameters[p];
    if (!parameter.absent || !std::isfinite(*parameter.absent)) continue;
    small.values[p] = std::clamp(*parameter.absent + kSmallShare * (typical.values[p] - *parameter.absent),
                                 parameter.lower, parameter.upper);
  }
  if (small.values != typical.values) starts.push_back(small);
  const auto add = [&](std::size_t p, double coordinate) {
    common::EffectInstance start = typical;
    const common::EffectParameter& parameter = about.parameters[p];
    start.values[p] = std::clamp(from_coordinate(parameter, to_coordinate(parameter, typical.values[p]) + coordinate),
                                 parameter.lower, parameter.upper);
    if (start.values[p] != typical.values[p]) starts.push_back(start);
  };
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    const common::EffectParameter& parameter = about.parameters[p];
    const bool fades_linearly = parameter.absent && std::isfinite(*parameter.absent);
    if (fades_linearly) continue;
    add(p, -1.0);
    add(p, 1.0);
  }
  return starts;
}

// The start with its fading parameters scaled by `factor`.
common::EffectInstance scaled(const common::EffectAbout& about, common::EffectInstance effect, double factor) {
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    const common::EffectParameter& parameter = about.parameters[p];
    if (!parameter.absent) continue;
    const double absent = *parameter.absent;
    double value = std::isfinite(absent) ? absent + factor * (effect.values[p] - absent)
                                         : effect.values[p] / std::max(factor, 1e-3);
    effect.values[p] = std::clamp(value, parameter.lower, parameter.upper);
  }
  return effect;
}

struct Screened {
  std::string effect;
  common::EffectInstance start;
  Eigen::VectorXd column;       // change of the differences by the start's size
  double visibility = 0.0;      // mean square of the column, nuisances taken out
  double amount = 0.0;          // of the start's size, fitted
  double mean_square = 0.0;     // left by it, linearly
};

// Projects the nuisances out: what of a column they cannot imitate within their priors.
class Projector {
 public:
  Projector(const Problem& problem, const Base& base)
      : columns_(base.nuisance_columns),
        weight_(problem.settings.independent_differences / static_cast<double>(base.difference.size())) {
    Eigen::MatrixXd system = weight_ * columns_.transpose() * columns_;
    system.diagonal().array() += 1.0;
    factor_.compute(system);
  }
  Eigen::VectorXd operator()(const Eigen::VectorXd& vector) const {
    return vector - columns_ * factor_.solve(weight_ * columns_.transpose() * vector);
  }

 private:
  const Eigen::MatrixXd& columns_;
  double weight_;
  Eigen::LDLT<Eigen::MatrixXd> factor_;
};

double mean_square(const Eigen::VectorXd& vector) {
  return vector.squaredNorm() / static_cast<double>(vector.size());
}

void locate(const Problem& problem, const Eigen::VectorXd& difference, Diagnosis& diagnosis) {
  // Bands between the modes that the thesis's cranes have: swinging, first bending, second bending, torsion
  // and higher.
  static constexpr std::array<double, 6> kEdges{0.02, 0.5, 2.5, 8.0, 16.0, 40.0};
  const double total = difference.squaredNorm();
  if (total <= 0.0) return;
  std::map<std::pair<std::string, int>, std::pair<double, double>> sums;  // sum of squares, count
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
        auto& [square, count] = sums[{name, band}];
        square += difference(row) * difference(row) + difference(row + 1) * difference(row + 1);
        count += 2.0;
        row += 2;
      }
    }
  }
  for (const auto& [key, value] : sums) {
    const auto band = static_cast<std::size_t>(key.second);
    diagnosis.bands.push_back({key.first, kEdges[band], kEdges[band + 1], value.first / total,
                               value.first / std::max(1.0, value.second)});
  }
  std::sort(diagnosis.bands.begin(), diagnosis.bands.end(),
            [](const BandShare& a, const BandShare& b) { return a.share > b.share; });
}

void find_moments(const Problem& problem, const Point& point, Diagnosis& diagnosis) {
  const sim::MachineSettings machine = machine_at(problem.nominal, point);
  for (const Record& record : problem.records) {
    const Shadow follower = shadow(machine, record);
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

std::vector<Size> sizes_of(const std::vector<common::EffectInstance>& effects, const std::vector<double>& deviations) {
  std::vector<Size> sizes;
  std::size_t k = 0;
  for (const common::EffectInstance& effect : effects) {
    const common::EffectAbout& about = about_effect(effect.name);
    for (std::size_t p = 0; p < effect.values.size(); ++p, ++k) {
      const common::EffectParameter& parameter = about.parameters[p];
      const double value = effect.values[p];
      const double deviation = deviations[k];
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

Cause make_cause(const FitResult& result, double gap) {
  Cause cause;
  for (const common::EffectInstance& effect : result.point.effects) cause.effects.push_back(effect.name);
  cause.point = result.point;
  cause.mean_square = result.mean_square;
  cause.explained = gap > 0.0 ? 1.0 - result.mean_square / gap : 0.0;
  cause.sizes = sizes_of(result.point.effects, result.deviation);
  return cause;
}

// The controller answers otherwise than its settings say, so every cause needs one of its effects beside what
// the machine's side needs.
void add_controller_causes(const Problem& problem, const controller::ControllerSettings& controller,
                           const DiagnosisSettings& settings, Diagnosis& diagnosis) {
  diagnosis.controller_causes = fit_controller(problem.records, controller, settings.without);
  const double known = diagnosis.controller_causes.empty() ||
                               diagnosis.controller_causes.front().share_left > kControllerExplained
                           ? 0.02
                           : 0.98;
  std::vector<Cause> combined;
  for (const ControllerCause& part : diagnosis.controller_causes) {
    if (part.probability < kNegligible) continue;
    for (const Cause& cause : diagnosis.causes) {
      if (cause.effects.size() > 1) continue;
      Cause both = cause;
      both.effects.push_back(part.effect.name);
      both.controller_effects = {part.effect};
      both.probability *= part.probability * known;
      const std::vector<Size> sizes = sizes_of({part.effect}, part.deviation);
      both.sizes.insert(both.sizes.end(), sizes.begin(), sizes.end());
      combined.push_back(both);
    }
  }
  diagnosis.probability_unknown = 1.0 - (1.0 - diagnosis.probability_unknown) * known;
  diagnosis.causes = std::move(combined);
}

}  // namespace

Diagnosis diagnose(const sim::MachineSettings& nominal, const std::optional<controller::ControllerSettings>& controller,
                   std::vector<Record> records, const DiagnosisSettings& settings, const Progress& progress,
                   const std::atomic<bool>* stop) {
  const auto start_time = std::chrono::steady_clock::now();
  const auto tell = [&](double share, const std::string& doing) {
    if (progress) progress(share, doing);
  };
  Diagnosis diagnosis;
  Problem problem;
  problem.nominal = nominal;
  problem.settings = settings.fit;
  problem.threads = settings.threads;
  problem.stop = stop;
  for (Record& record : records) {
    if (record.group_count != nominal.crane.drive.group_count) {
      throw NotAdmitted(fmt::format("{}: the log has {} motor groups, the nominal crane {}: another crane?", record.name,
                                    record.group_count, nominal.crane.drive.group_count));
    }
    for (const std::string& remark : record.remarks) diagnosis.remarks.push_back(remark);
    const Shadow follower = shadow(nominal, record);
    for (int g = 0; g < record.group_count; ++g) {
      for (const double torque : follower.missing_torque[static_cast<std::size_t>(g)]) {
        if (!std::isfinite(torque)) {
          throw NotAdmitted(fmt::format("{}: the nominal crane cannot follow this record at all; check its inertias, its gear "
                                        "ratios and the record's units",
                                        record.name));
        }
      }
    }
    const std::vector<bool> trusted = trusted_stretches(record, follower);
    const double share = static_cast<double>(std::count(trusted.begin(), trusted.end(), true)) / static_cast<double>(record.size());
    if (share < kLeastTrusted) {
      throw NotAdmitted(fmt::format("{}: only {:.0f} % of the record lies away from impacts of the gears, at least {:.0f} % are "
                                    "needed; switch play compensation on, or accelerate more gently",
                                    record.name, 100.0 * share, 100.0 * kLeastTrusted));
    }
    if (share < 0.999) {
      diagnosis.remarks.push_back(fmt::format("{}: {:.0f} % of the record lie near impacts of the gears and are not judged",
                                              record.name, 100.0 * (1.0 - share)));
    }
    problem.whitening.push_back(make_whitening(record, trusted, sim::drive_inertia(nominal.crane.drive), settings.whitening));
    problem.records.push_back(std::move(record));
  }

  tell(0.0, "replaying the controller");
  if (controller) {
    for (const Record& record : problem.records) {
      diagnosis.controller_replay.push_back(replay_controller(record, *controller));
      const ControllerReplay& replay = diagnosis.controller_replay.back();
      // On a log of the wire both sides are exact; a thousandth leaves room for logs that were rounded.
      if (replay.difference_rms > 1e-3 * replay.torque_rms) diagnosis.controller_differs = true;
    }
  }

  tell(0.02, "fitting the parameters alone");
  const Base base = fit_nuisances(problem);
  diagnosis.mean_square_nominal = base.nominal_mean_square;
  diagnosis.mean_square_parameters = mean_square(base.difference);
  const double nu = settings.fit.independent_differences;
  locate(problem, base.difference, diagnosis);
  find_moments(problem, base.point, diagnosis);

  // Screen: every effect of the catalogue from each of its starts, one simulation each.
  tell(0.15, "trying every effect of the catalogue");
  const std::set<std::string> without(settings.without.begin(), settings.without.end());
  std::vector<Screened> tried;
  std::vector<Point> points;
  std::set<std::string> names;
  for (const sim::EffectDescription* description : sim::effect_catalogue()) {
    const std::string name(description->about.name);
    if (without.count(name) != 0) continue;
    // What the nominal crane has already is not missing, and a machine takes an effect once.
    if (std::any_of(nominal.effects.begin(), nominal.effects.end(),
                    [&](const common::EffectInstance& effect) { return effect.name == name; })) {
      continue;
    }
    names.insert(name);
    for (const common::EffectInstance& start : starts_of(description->about)) {
      Point point = base.point;
      point.effects.push_back(start);
      tried.push_back({name, start, {}, 0.0, 0.0, 0.0});
      points.push_back(point);
    }
  }
  const Projector project(problem, base);
  const Eigen::VectorXd gap = project(base.difference);
  const double gap_square = mean_square(gap);
  {
    const std::size_t batch = 8 * static_cast<std::size_t>(std::max(1, settings.threads));
    for (std::size_t from = 0; from < points.size(); from += batch) {
      const std::size_t count = std::min(batch, points.size() - from);
      const auto results = differences(problem, std::span<const Point>(points).subspan(from, count));
      for (std::size_t i = 0; i < count; ++i) {
        Screened& screened = tried[from + i];
        screened.column = project(results[i] - base.difference);
        screened.visibility = mean_square(screened.column);
        // The differences fall by the column times the amount.
        const double norm = screened.column.squaredNorm();
        screened.amount = norm > 0.0 && std::isfinite(norm) ? -screened.column.dot(gap) / norm : 0.0;
        const common::EffectParameter& parameter = about_effect(screened.effect).parameters.front();
        const bool may_turn = parameter.lower < 0.0 && parameter.upper > 0.0;
        screened.amount = std::clamp(screened.amount, may_turn ? -kLargestAmount : 0.0, kLargestAmount);
        screened.mean_square = mean_square(gap + screened.amount * screened.column);
      }
      tell(0.15 + 0.35 * static_cast<double>(from + count) / static_cast<double>(points.size()),
           "trying every effect of the catalogue");
    }
  }
  // The best start of each effect.
  std::map<std::string, const Screened*> best;
  for (const Screened& screened : tried) {
    const Screened*& entry = best[screened.effect];
    if (entry == nullptr || screened.mean_square < entry->mean_square) entry = &screened;
  }
  std::vector<const Screened*> ranked;
  for (const auto& [name, screened] : best) {
    ranked.push_back(screened);
    if (screened->visibility < kVisible) {
      diagnosis.cannot_tell.push_back(fmt::format("{}: a typical size changes nothing in these records", name));
    }
  }
  std::sort(ranked.begin(), ranked.end(),
            [](const Screened* a, const Screened* b) { return a->mean_square < b->mean_square; });

  // Refine the best ones with everything free.
  std::vector<FitResult> fits;
  const auto refine = [&](const std::vector<const Screened*>& effects, const std::vector<double>& amounts) {
    Point start = base.point;
    for (std::size_t e = 0; e < effects.size(); ++e) {
      start.effects.push_back(scaled(about_effect(effects[e]->effect), effects[e]->start, amounts[e]));
    }
    fits.push_back(fit(problem, base, start, 1));
  };
  const auto converge = [&](const FitResult& from) { return fit(problem, base, from.point, 3); };
  // Worth refining: what takes away a fair part of the gap, and is not far behind the best.
  const auto promising = [&](const Screened& screened) {
    return screened.mean_square < (1.0 - kLeastGain) * gap_square;
  };
  const auto singles = static_cast<int>(
      std::min<std::ptrdiff_t>(settings.singles_to_refine,
                               std::count_if(ranked.begin(), ranked.end(), [&](const Screened* s) { return promising(*s); })));
  for (int i = 0; i < singles; ++i) {
    tell(0.5 + 0.3 * i / singles, "refining " + ranked[static_cast<std::size_t>(i)]->effect);
    refine({ranked[static_cast<std::size_t>(i)]}, {ranked[static_cast<std::size_t>(i)]->amount});
  }
  // The leaders again with fresh columns, so that none loses for want of convergence.
  std::sort(fits.begin(), fits.end(), [](const FitResult& a, const FitResult& b) { return a.cost < b.cost; });
  for (std::size_t i = 0; i < fits.size() && static_cast<int>(i) < settings.leaders; ++i) {
    if (fits[i].mean_square < settings.evidence.usual_mean_square) break;
    tell(0.7 + 0.03 * static_cast<double>(i), "converging " + fits[i].point.effects[0].name);
    fits[i] = converge(fits[i]);
  }
  double best_single = gap_square;
  for (const FitResult& result : fits) best_single = std::min(best_single, result.mean_square);

  // Pairs, linearly: every two effects' columns jointly, nuisances taken out already.
  if (best_single > settings.evidence.unknown_floor && settings.pairs_to_refine > 0) {
    struct Pair {
      const Screened *first, *second;
      double amount_first, amount_second, mean_square;
    };
    std::vector<Pair> pairs;
    const double rows = static_cast<double>(gap.size());
    for (std::size_t i = 0; i < ranked.size(); ++i) {
      for (std::size_t j = i + 1; j < ranked.size(); ++j) {
        const Eigen::VectorXd &a = ranked[i]->column, &b = ranked[j]->column;
        const double aa = a.squaredNorm(), bb = b.squaredNorm(), ab = a.dot(b);
        const double determinant = aa * bb - ab * ab;
        if (determinant < 0.02 * aa * bb || aa <= 0.0 || bb <= 0.0) continue;
        const double ga = a.dot(gap), gb = b.dot(gap);
        const double x = -(bb * ga - ab * gb) / determinant, y = -(aa * gb - ab * ga) / determinant;
        const auto allowed = [](const Screened& s, double amount) {
          const common::EffectParameter& parameter = about_effect(s.effect).parameters.front();
          return std::fabs(amount) <= kLargestAmount && (amount > 0.0 || (parameter.lower < 0.0 && parameter.upper > 0.0));
        };
        if (!allowed(*ranked[i], x) || !allowed(*ranked[j], y)) continue;
        const double left = (gap.squaredNorm() + x * ga + y * gb) / rows;
        pairs.push_back({ranked[i], ranked[j], x, y, left});
      }
    }
    std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.mean_square < b.mean_square; });
    const std::size_t count = std::min<std::size_t>(static_cast<std::size_t>(settings.pairs_to_refine), pairs.size());
    for (std::size_t i = 0; i < count; ++i) {
      tell(0.8 + 0.18 * static_cast<double>(i) / static_cast<double>(count),
           "refining " + pairs[i].first->effect + " with " + pairs[i].second->effect);
      refine({pairs[i].first, pairs[i].second}, {pairs[i].amount_first, pairs[i].amount_second});
    }
  }

  // Weigh.
  std::vector<Candidate> candidates{{{}, base.cost / nu}};
  Cause none;
  none.point = base.point;
  none.mean_square = diagnosis.mean_square_parameters;
  diagnosis.causes.push_back(none);
  for (const FitResult& result : fits) {
    diagnosis.causes.push_back(make_cause(result, diagnosis.mean_square_parameters));
    candidates.push_back({diagnosis.causes.back().effects, result.cost / nu});
  }
  const Probabilities probabilities = weigh(candidates, static_cast<int>(names.size()), settings.evidence);
  for (std::size_t i = 0; i < diagnosis.causes.size(); ++i) {
    diagnosis.causes[i].probability = probabilities.candidate[i];
  }
  diagnosis.probability_unknown = probabilities.unknown;
  // Groups: single causes whose signatures, as fitted, cannot be told apart.
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (fits[i].point.effects.size() != 1) continue;
    const Eigen::VectorXd mine = project(fits[i].difference - base.difference);
    double nearest = 1.0;
    for (std::size_t j = 0; j < fits.size(); ++j) {
      if (j == i || fits[j].point.effects.size() != 1) continue;
      const Eigen::VectorXd other = project(fits[j].difference - base.difference);
      const double scale = mine.norm() * other.norm();
      if (scale <= 0.0) continue;
      const double cosine = std::fabs(mine.dot(other)) / scale;
      if (cosine > kIndistinguishable) {
        diagnosis.causes[i + 1].group.push_back(fits[j].point.effects[0].name);
        nearest = std::min(nearest, std::sqrt(std::max(0.0, 1.0 - cosine * cosine)));
      }
    }
    diagnosis.causes[i + 1].group_distance = nearest;
  }
  if (diagnosis.controller_differs) add_controller_causes(problem, *controller, settings, diagnosis);
  std::stable_sort(diagnosis.causes.begin(), diagnosis.causes.end(),
                   [](const Cause& a, const Cause& b) { return a.probability > b.probability; });
  std::map<std::string, double> by_subsystem;
  diagnosis.probability_nothing = 0.0;
  for (const Cause& cause : diagnosis.causes) {
    if (cause.effects.empty()) diagnosis.probability_nothing += cause.probability;
    std::set<std::string> touched;
    for (const std::string& effect : cause.effects) {
      touched.insert(std::string(common::name_of(about_effect(effect).subsystem)));
    }
    for (const std::string& subsystem : touched) by_subsystem[subsystem] += cause.probability;
  }
  diagnosis.subsystems.assign(by_subsystem.begin(), by_subsystem.end());
  std::sort(diagnosis.subsystems.begin(), diagnosis.subsystems.end(),
            [](const auto& a, const auto& b) { return a.second > b.second; });

  static const Cause kNone;
  const Cause& first = diagnosis.causes.empty() ? kNone : diagnosis.causes.front();
  diagnosis.gap = diagnosis.controller_differs || diagnosis.probability_nothing < 0.5;
  if (diagnosis.probability_unknown > first.probability) {
    diagnosis.verdict = "not in the catalogue: no known effect explains what is missing";
  } else if (first.effects.empty()) {
    diagnosis.verdict = "no effect is missing; parameters within their spread explain the records";
  } else {
    diagnosis.verdict = first.effects[0];
    if (first.effects.size() > 1) diagnosis.verdict += " with " + first.effects[1];
  }
  diagnosis.simulations = problem.simulations;
  diagnosis.total_seconds = seconds_since(start_time);
  tell(1.0, "done");
  return diagnosis;
}

}  // namespace slewlab::diagnosis
