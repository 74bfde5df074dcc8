#include "diagnosis/diagnose.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "common/unit.h"
#include "diagnosis/chance.h"
#include "diagnosis/nuisance.h"
#include "sim/effects/catalogue.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kNinetyPercent = 1.645;       // standard deviations of a normal 90 % interval
constexpr double kIndistinguishable = 0.97;    // cosine of two signatures, nuisances taken out
constexpr double kLeastTrusted = 0.3;           // share of a record that must lie away from impacts
constexpr double kLeastGain = 6.0;              // fall of the cost, forecast linearly, for which an effect is refined
constexpr double kLeastPairGain = 40.0;         // fall of the excess below the best single effect's, forecast, to try a pair
constexpr double kGroupOdds = 20.0;             // of two causes' probabilities, beyond which the records tell them apart
constexpr double kControllerExplained = 0.1;    // share of its difference that the right effect of a controller leaves at most
constexpr const char* kCounts = "encoder_quantisation";
constexpr double kSlowFollower = 4.0;           // by which the shadow is slower behind coarse counts, or they would shake its boom
constexpr double kCoarseNoise = 0.1;            // share by which the noise of coarse counts is known
constexpr double kChanceSize = 0.2;             // relative standard deviation of a size that is found from the power of one draw
constexpr double kLawShare = 0.03;              // relative standard deviation of a size by its law: learned, docs/diagnosis.md
constexpr double kCurvatureFactor = 1.5;        // of the standard deviations that the curvature gives: learned as well
constexpr double kCountError = 1e-3;            // relative, of a quantum found in the positions
constexpr double kSure = 0.98;                  // probability of what needs no fit, or leaves next to nothing
constexpr double kUnlikely = 0.02;              // probability of what was left out, or leaves much
constexpr double kFarOff = 4.0;                 // [standard deviations] of a parameter, beyond which it may be another crane
constexpr double kNegligible = 1e-4;            // probability of a part that is not combined further
constexpr double kSmallShare = 0.25;            // of an effect's typical size, with which it is tried too
constexpr double kLargestAmount = 20.0;         // of the screened size that a linear forecast is trusted with
constexpr double kVisible = 10.0;               // sum of squares of a tried size below which records tell nothing
constexpr double kNearlyTried = 0.1;            // of the size: nearer than that to a start is not worth another look
constexpr double kSameMotion = 1e-6;            // relative difference of two signatures below which two effects are one motion
constexpr double kSameAngle = 1e-9;             // [rad] rounding
constexpr int kStartsPerEffect = 2;             // that are refined
constexpr int kFreshRounds = 2;                 // at most, for a leader
constexpr int kPairsPerLeader = 3;              // that are refined beside each of the three best single effects
constexpr double kParallel = 0.02;              // 1 - cosine^2 of two signatures below which they are not tried as a pair

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

bool is_all_round(const common::EffectParameter& parameter) {
  return parameter.unit == common::Unit::radian && !parameter.absent && parameter.lower <= -std::numbers::pi &&
         parameter.upper >= std::numbers::pi;
}

// The angles of an effect that are looked for all round.
std::vector<std::size_t> turning_angles(const common::EffectAbout& about) {
  std::vector<std::size_t> angles;
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    if (is_all_round(about.parameters[p]) && !about.parameters[p].detail) angles.push_back(p);
  }
  return angles;
}

// The points from which an effect is tried: its typical size, and a fraction of it, where most laws are still linear;
// other sizes where the size enters not proportionally; other shapes. A single angle that enters as a sine needs two
// quarters of each: the others follow from them (between_quarters). Two angles are turned all round in every combination, but
// with the typical size and the values worth a try only.
std::vector<common::EffectInstance> starts_of(const common::EffectAbout& about) {
  const common::EffectInstance typical = common::typical_instance(about);
  std::vector<common::EffectInstance> shapes{typical};
  common::EffectInstance small = typical;
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    const common::EffectParameter& parameter = about.parameters[p];
    if (!parameter.absent || !std::isfinite(*parameter.absent)) continue;
    small.values[p] = std::clamp(*parameter.absent + kSmallShare * (typical.values[p] - *parameter.absent),
                                 parameter.lower, parameter.upper);
  }
  std::vector<common::EffectInstance> others;
  if (small.values != typical.values) others.push_back(small);
  const auto add = [&](std::size_t p, double value, std::vector<common::EffectInstance>& list) {
    common::EffectInstance start = typical;
    start.values[p] = std::clamp(value, about.parameters[p].lower, about.parameters[p].upper);
    if (start.values[p] != typical.values[p]) list.push_back(start);
  };
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    const common::EffectParameter& parameter = about.parameters[p];
    const bool fades_linearly = parameter.absent && std::isfinite(*parameter.absent);
    for (const double value : parameter.tries) add(p, value, shapes);
    if (fades_linearly || is_all_round(parameter) || parameter.detail || !parameter.tries.empty()) continue;
    for (const double coordinate : {-1.0, 1.0}) {
      add(p, from_coordinate(parameter, to_coordinate(parameter, typical.values[p]) + coordinate), others);
    }
  }
  const std::vector<std::size_t> angles = turning_angles(about);
  std::vector<common::EffectInstance> starts;
  if (angles.size() == 1) {
    shapes.insert(shapes.end(), others.begin(), others.end());
  } else {
    starts = others;
  }
  for (const common::EffectInstance& shape : shapes) {
    std::vector<common::EffectInstance> turned{shape};
    for (const std::size_t p : angles) {
      const std::vector<common::EffectInstance> before = turned;
      for (common::EffectInstance start : before) {
        for (int quarter = 1; quarter <= (angles.size() == 1 ? 1 : 3); ++quarter) {
          start.values[p] = std::remainder(shape.values[p] + 0.5 * std::numbers::pi * quarter, 2.0 * std::numbers::pi);
          turned.push_back(start);
        }
      }
    }
    starts.insert(starts.end(), turned.begin(), turned.end());
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
  double visibility = 0.0;      // sum of squares of the column, nuisances taken out
  double amount = 0.0;          // of the start's size, fitted
  double left = 0.0;            // sum of squares that it leaves, linearly
  Eigen::VectorXd profile{};    // of an effect that comes by chance (chance.h)
};

// Projects out what fitted parameters can imitate. Below the differences stand the rows of their prior, so that an effect
// that relieves parameters of an unlikely value counts for that too.
class Projector {
 public:
  Projector(const Eigen::MatrixXd& columns, const Point& point, double weight)
      : prior_(prior_rows(point)), scale_(1.0 / std::sqrt(weight)), columns_(columns.rows() + columns.cols(), columns.cols()) {
    columns_.topRows(columns.rows()) = columns;
    columns_.bottomRows(columns.cols()) = (scale_ * prior_.slope).asDiagonal();
    factor_.compute(columns_.transpose() * columns_);
  }
  // Of the differences at the point itself.
  Eigen::VectorXd gap(const Eigen::VectorXd& difference) const {
    Eigen::VectorXd vector(columns_.rows());
    vector << difference, scale_ * prior_.value;
    return project(vector);
  }
  // Of a change of the differences, or of what another projector has made of one.
  Eigen::VectorXd operator()(const Eigen::VectorXd& change) const {
    Eigen::VectorXd vector = Eigen::VectorXd::Zero(columns_.rows());
    vector.head(change.size()) = change;
    return project(vector);
  }

 private:
  Eigen::VectorXd project(const Eigen::VectorXd& vector) const {
    return vector - columns_ * factor_.solve(columns_.transpose() * vector);
  }

  PriorRows prior_;
  double scale_;
  Eigen::MatrixXd columns_;
  Eigen::LDLT<Eigen::MatrixXd> factor_;
};

// Whether the effect acts the other way round with its size turned.
bool may_turn(const std::string& effect) {
  const common::EffectParameter& parameter = about_effect(effect).parameters.front();
  return parameter.absent && parameter.lower < *parameter.absent && parameter.upper > *parameter.absent;
}

// How much of `target` a multiple of the column takes away.
void try_amount(const Eigen::VectorXd& column, const Eigen::VectorXd& target, Screened& screened) {
  const double norm = column.squaredNorm();
  screened.amount = norm > 0.0 && std::isfinite(norm) ? -column.dot(target) / norm : 0.0;
  screened.amount = std::clamp(screened.amount, may_turn(screened.effect) ? -kLargestAmount : 0.0, kLargestAmount);
  screened.left = (target + screened.amount * column).squaredNorm();
}

// Whether `turned` is `first` with the angle a quarter turn on.
bool is_quarter_on(const common::EffectInstance& first, const common::EffectInstance& turned, std::size_t angle) {
  if (first.name != turned.name) return false;
  common::EffectInstance same = first;
  same.values[angle] = turned.values[angle];
  const double turn = std::remainder(turned.values[angle] - first.values[angle] - 0.5 * std::numbers::pi, 2.0 * std::numbers::pi);
  return same.values == turned.values && std::fabs(turn) < kSameAngle;
}

// The best angle between two looks a quarter turn apart, where the angle enters as a sine.
Screened between_quarters(const Screened& first, const Screened& turned, std::size_t angle, const Eigen::VectorXd& target) {
  const Eigen::VectorXd &a = first.column, &b = turned.column;
  const double aa = a.squaredNorm(), bb = b.squaredNorm(), ab = a.dot(b), at = a.dot(target), bt = b.dot(target);
  const double determinant = aa * bb - ab * ab;
  Screened best{first.effect, first.start, {}, 0.0, 0.0, target.squaredNorm()};
  if (!(determinant > 0.0) || !std::isfinite(determinant)) return best;
  const double x = -(bb * at - ab * bt) / determinant, y = -(aa * bt - ab * at) / determinant;
  const double amount = std::hypot(x, y);
  best.amount = std::min(amount, kLargestAmount);
  best.start.values[angle] =
      std::remainder(first.start.values[angle] + std::atan2(y, x), 2.0 * std::numbers::pi);
  best.left = (target + best.amount / amount * (x * a + y * b)).squaredNorm();
  return best;
}

double mean_square(const Eigen::VectorXd& vector) {
  return vector.squaredNorm() / static_cast<double>(vector.size());
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
  const sim::MachineSettings machine = machine_at(problem.nominal, point);
  for (const Record& record : problem.records) {
    const Shadow follower = shadow(machine, record, problem.gains);
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

Cause make_cause(const FitResult& result) {
  Cause cause;
  for (const common::EffectInstance& effect : result.point.effects) cause.effects.push_back(effect.name);
  cause.point = result.point;
  cause.mean_square = result.mean_square;
  cause.excess = result.excess;
  cause.prior = result.prior;
  cause.information = result.information;
  cause.sizes = sizes_of(result.point.effects, result.deviation);
  return cause;
}

bool has_effect(const sim::MachineSettings& machine, std::string_view name) {
  return std::any_of(machine.effects.begin(), machine.effects.end(),
                     [&](const common::EffectInstance& effect) { return effect.name == name; });
}

// Every cause gets the found effect beside what it has. `known` is the probability that it is the catalogue's.
void add_beside(const common::EffectInstance& effect, const std::vector<Size>& sizes, double known, Diagnosis& diagnosis) {
  for (Cause& cause : diagnosis.causes) {
    cause.effects.push_back(effect.name);
    cause.point.effects.push_back(effect);
    cause.probability *= known;
    cause.sizes.insert(cause.sizes.end(), sizes.begin(), sizes.end());
  }
  diagnosis.probability_unknown = 1.0 - (1.0 - diagnosis.probability_unknown) * known;
}

// Counts are seen in the positions themselves, to the count: they need no fit.
void add_counts(const Problem& problem, const DiagnosisSettings& settings, Diagnosis& diagnosis) {
  double quantum = 0.0;
  for (const Record& record : problem.records) quantum = std::max(quantum, record.encoder_quantum);
  if (quantum < kCoarseCount || has_effect(problem.nominal, kCounts)) return;
  diagnosis.counts = quantum;
  common::EffectInstance effect = common::typical_instance(about_effect(kCounts));
  effect.values[0] = quantum;
  std::vector<double> deviations(effect.values.size(), 0.0);
  deviations[0] = kCountError * quantum;
  const bool left_out = std::find(settings.without.begin(), settings.without.end(), kCounts) != settings.without.end();
  add_beside(effect, sizes_of({effect}, deviations), left_out ? kUnlikely : kSure, diagnosis);
}

// The controller answers otherwise than its settings say, so every cause needs one of its effects beside what
// the machine's side needs.
void add_controller_causes(const Problem& problem, const controller::ControllerSettings& controller,
                           const DiagnosisSettings& settings, Diagnosis& diagnosis) {
  diagnosis.controller_causes = fit_controller(problem.records, controller, settings.without);
  const double known = diagnosis.controller_causes.empty() ||
                               diagnosis.controller_causes.front().share_left > kControllerExplained
                           ? kUnlikely
                           : kSure;
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

// Of each effect that comes by chance its best draw, by the variance of what parameters alone leave.
void add_chance(const Problem& problem, const Base& base, const std::vector<Screened>& tried, std::vector<FitResult>& fits) {
  const double free_cost = free_power_cost(problem, base.difference);
  std::map<std::string, FitResult> best;
  for (const Screened& screened : tried) {
    if (screened.profile.size() == 0) continue;
    const ChanceFit chance = fit_chance(base.difference, screened.profile);
    if (chance.scale == 0.0 || !is_near_free_power(chance, free_cost, base.difference.size())) continue;
    FitResult result;
    result.point = base.point;
    result.point.effects.push_back(with_power(screened.start, chance.scale));
    result.difference = base.difference;
    result.mean_square = mean_square(base.difference);
    result.excess = problem.settings.independent_share * (chance.cost - static_cast<double>(base.difference.size()));
    result.prior = base.prior;
    result.information = base.information;
    const common::EffectInstance& effect = result.point.effects.front();
    const common::EffectAbout& about = about_effect(effect.name);
    for (std::size_t p = 0; p < effect.values.size(); ++p) {
      const common::EffectParameter& parameter = about.parameters[p];
      result.prior += effect_prior(to_coordinate(parameter, effect.values[p])).cost;
      result.deviation.push_back(p == 0 ? kChanceSize * effect.values[p]
                                        : std::fabs(value_per_deviation(parameter, effect.values[p])));
    }
    const auto [entry, is_new] = best.try_emplace(screened.effect, result);
    if (!is_new && result.excess + result.prior < entry->second.excess + entry->second.prior) entry->second = result;
  }
  for (auto& [name, result] : best) fits.push_back(std::move(result));
}

bool cheaper(const FitResult& a, const FitResult& b) { return a.cost < b.cost; }

// The best `contenders` get another round. The best of them goes on with fresh nuisance columns until it settles; `leaders` go on
// with these columns, and where one of them overtakes, it gets fresh ones as well.
void go_on(Problem& problem, std::vector<FitResult>& fits, int contenders, int leaders,
           const std::function<void(double, const FitResult&)>& tell) {
  if (fits.empty()) return;
  const auto first = static_cast<double>(contenders), all = static_cast<double>(contenders + leaders);
  std::stable_sort(fits.begin(), fits.end(), cheaper);
  for (std::size_t i = 0; i < fits.size() && static_cast<int>(i) < contenders; ++i) {
    tell(static_cast<double>(i) / all, fits[i]);
    improve(problem, fits[i], false);
  }
  std::stable_sort(fits.begin(), fits.end(), cheaper);
  tell(first / all, fits.front());
  for (int round = 0; round < kFreshRounds && improve(problem, fits.front(), true); ++round) {
  }
  for (std::size_t i = 1; i < fits.size() && static_cast<int>(i) < leaders; ++i) {
    tell((first + static_cast<double>(i)) / all, fits[i]);
    take_nuisance_columns(fits.front().columns, fits[i]);
    improve(problem, fits[i], false);
  }
  const auto best = std::min_element(fits.begin(), fits.end(), cheaper);
  if (best != fits.begin()) improve(problem, *best, true);
  std::stable_sort(fits.begin(), fits.end(), cheaper);
}

// From the best fit of `effects` effects to those with one less; they take their places where they are cheaper.
void go_back(Problem& problem, const Eigen::MatrixXd& nuisance_columns, std::size_t effects, std::vector<FitResult>& fits) {
  const auto best =
      std::find_if(fits.begin(), fits.end(), [&](const FitResult& result) { return result.point.effects.size() == effects; });
  if (best == fits.end()) return;
  const FitResult from = *best;
  for (std::size_t left_out = 0; left_out < effects; ++left_out) {
    Point start = from.point;
    start.effects.erase(start.effects.begin() + static_cast<std::ptrdiff_t>(left_out));
    FitResult again = fit(problem, nuisance_columns, start);
    take_nuisance_columns(from.columns, again);
    improve(problem, again, false);
    const auto same = std::find_if(fits.begin(), fits.end(), [&](const FitResult& result) {
      return std::equal(result.point.effects.begin(), result.point.effects.end(), again.point.effects.begin(), again.point.effects.end(),
                        [](const common::EffectInstance& a, const common::EffectInstance& b) { return a.name == b.name; });
    });
    if (same == fits.end()) {
      fits.push_back(std::move(again));
    } else if (again.cost < same->cost) {
      *same = std::move(again);
    }
  }
  std::stable_sort(fits.begin(), fits.end(), cheaper);
}

// Pairs worth refining. First what two columns do jointly from where nothing is added, then what a second effect
// takes away of what each of the best single fits left: where effects are large, only that is near enough.
std::vector<Point> pair_starts(const Problem& problem, const Base& base, const Eigen::VectorXd& gap,
                               const std::vector<const Screened*>& best, const std::vector<FitResult>& singles, int count) {
  struct Pair {
    Point start;
    double left;
  };
  const auto by_left = [](const Pair& a, const Pair& b) { return a.left < b.left; };
  std::vector<Pair> joint;
  for (std::size_t i = 0; i < best.size(); ++i) {
    for (std::size_t j = i + 1; j < best.size(); ++j) {
      const Eigen::VectorXd &a = best[i]->column, &b = best[j]->column;
      const double aa = best[i]->visibility, bb = best[j]->visibility, ab = a.dot(b);
      const double determinant = aa * bb - ab * ab;
      if (!(determinant > kParallel * aa * bb) || aa <= 0.0 || bb <= 0.0) continue;
      const double ga = a.dot(gap), gb = b.dot(gap);
      const double x = -(bb * ga - ab * gb) / determinant, y = -(aa * gb - ab * ga) / determinant;
      const auto allowed = [](const Screened& s, double amount) {
        return std::fabs(amount) <= kLargestAmount && (amount > 0.0 || may_turn(s.effect));
      };
      if (!allowed(*best[i], x) || !allowed(*best[j], y)) continue;
      Point start = base.point;
      start.effects.push_back(scaled(about_effect(best[i]->effect), best[i]->start, x));
      start.effects.push_back(scaled(about_effect(best[j]->effect), best[j]->start, y));
      joint.push_back({start, gap.squaredNorm() + x * ga + y * gb});
    }
  }
  std::stable_sort(joint.begin(), joint.end(), by_left);
  // Forecasts from where nothing is added are compared with each other, those beside a single fit with that fit.
  double best_single = gap.squaredNorm();
  for (const Screened* screened : best) best_single = std::min(best_single, screened->left);
  const double worth = kLeastPairGain / problem.settings.independent_share;
  std::erase_if(joint, [&](const Pair& pair) { return pair.left > best_single - worth; });
  std::vector<Point> starts;
  std::set<std::set<std::string>> taken;
  const auto take = [&](const Point& start) {
    if (taken.insert({start.effects[0].name, start.effects[1].name}).second) starts.push_back(start);
  };
  for (std::size_t i = 0; i < joint.size() && static_cast<int>(starts.size()) < count / 2; ++i) take(joint[i].start);

  for (std::size_t leader = 0; leader < std::min<std::size_t>(3, singles.size()); ++leader) {
    const FitResult& single = singles[leader];
    const Projector project(single.columns, single.point, data_weight(single.difference, problem.settings));
    const Eigen::VectorXd left = project.gap(single.difference);
    std::vector<Pair> seconds;
    for (const Screened* screened : best) {
      if (screened->effect == single.point.effects[0].name) continue;
      Screened beside = *screened;
      try_amount(project(screened->column), left, beside);
      Point start = single.point;
      start.effects.push_back(scaled(about_effect(beside.effect), beside.start, beside.amount));
      if (left.squaredNorm() - beside.left > worth) seconds.push_back({start, beside.left});
    }
    std::stable_sort(seconds.begin(), seconds.end(), by_left);
    for (std::size_t k = 0; k < std::min<std::size_t>(kPairsPerLeader, seconds.size()); ++k) take(seconds[k].start);
  }
  return starts;
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
  ShadowSettings shadow_settings;
  const bool is_coarse = std::any_of(records.begin(), records.end(),
                                     [](const Record& record) { return record.encoder_quantum >= kCoarseCount; });
  if (is_coarse) {
    shadow_settings.speed_rate /= kSlowFollower;
    shadow_settings.position_rate /= kSlowFollower * kSlowFollower;
  }
  problem.gains = shadow_gains(nominal.crane, shadow_settings);
  problem.latency_deviation = is_coarse ? kCoarseLatencyDeviation : kLatencyDeviation;
  problem.settings = settings.fit;
  problem.threads = settings.threads;
  problem.stop = stop;
  for (Record& record : records) {
    if (record.group_count != nominal.crane.drive.group_count) {
      throw NotAdmitted(fmt::format("{}: the log has {} motor groups, the nominal crane {}: another crane?", record.name,
                                    record.group_count, nominal.crane.drive.group_count));
    }
    for (const std::string& remark : record.remarks) diagnosis.remarks.push_back(remark);
    const Shadow follower = shadow(nominal, record, problem.gains);
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
    problem.whitening.push_back(make_whitening(record, trusted, problem.gains, follower, settings.whitening));
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
  const Point as_given{std::vector<double>(nuisance_count(), 0.0), {}};
  diagnosis.mean_square_nominal = mean_square(differences(problem, as_given));
  const Base base = fit_nuisances(problem);
  diagnosis.mean_square_parameters = mean_square(base.difference);
  const double base_excess = excess(base.difference, settings.fit);
  find_moments(problem, base.point, diagnosis);

  // Screen: every effect of the catalogue from each of its starts, one simulation each.
  tell(0.15, "trying every effect of the catalogue");
  const std::set<std::string> without(settings.without.begin(), settings.without.end());
  std::vector<Screened> tried;
  std::vector<Point> points;
  std::set<std::string> names;
  for (const sim::EffectDescription* description : sim::effect_catalogue()) {
    const std::string name(description->about.name);
    if (without.count(name) != 0 || name == kCounts) continue;
    // What the nominal crane has already is not missing, and a machine takes an effect once.
    if (has_effect(nominal, name)) continue;
    names.insert(name);
    for (const common::EffectInstance& start : starts_of(description->about)) {
      Point point = base.point;
      point.effects.push_back(start);
      tried.push_back({name, start, {}, 0.0, 0.0, 0.0});
      points.push_back(point);
    }
  }
  const Projector project(base.nuisance_columns, base.point, data_weight(base.difference, settings.fit));
  const Eigen::VectorXd gap = project.gap(base.difference);
  const double gap_square = gap.squaredNorm();
  const auto look = [&](Screened& screened, const Eigen::VectorXd& difference) {
    if (comes_by_chance(screened.effect)) screened.profile = power_profile(problem, difference - base.difference);
    screened.column = project(difference - base.difference);
    screened.visibility = screened.column.squaredNorm();
    try_amount(screened.column, gap, screened);
  };
  const auto forecast = [&](const Screened& screened) {
    const double nu = settings.fit.law_freedom;
    return discounted(base_excess, nu) - discounted(base_excess - settings.fit.independent_share * (gap_square - screened.left), nu);
  };
  {
    const std::size_t batch = 8 * static_cast<std::size_t>(std::max(1, settings.threads));
    for (std::size_t from = 0; from < points.size(); from += batch) {
      const std::size_t count = std::min(batch, points.size() - from);
      const auto results = differences(problem, std::span<const Point>(points).subspan(from, count));
      for (std::size_t i = 0; i < count; ++i) look(tried[from + i], results[i]);
      tell(0.15 + 0.35 * static_cast<double>(from + count) / static_cast<double>(points.size()),
           "trying every effect of the catalogue");
    }
  }
  // A second look at the best of each effect at the size just found: few laws are linear from nothing to their typical size.
  {
    std::map<std::string, Screened> nearest;
    const auto consider = [&](const Screened& screened) {
      const auto [entry, is_new] = nearest.try_emplace(screened.effect, screened);
      if (!is_new && screened.left < entry->second.left) entry->second = screened;
    };
    for (std::size_t i = 0; i < tried.size(); ++i) {
      consider(tried[i]);
      const std::vector<std::size_t> angles = turning_angles(about_effect(tried[i].effect));
      if (angles.size() == 1 && i + 1 < tried.size() && is_quarter_on(tried[i].start, tried[i + 1].start, angles[0])) {
        consider(between_quarters(tried[i], tried[i + 1], angles[0], gap));
      }
    }
    std::vector<Screened> again;
    std::vector<Point> at;
    for (const auto& [name, screened] : nearest) {
      const bool is_tried = screened.column.size() != 0 && std::fabs(screened.amount - 1.0) < kNearlyTried;
      if (forecast(screened) < kLeastGain || is_tried) continue;
      again.push_back({name, scaled(about_effect(name), screened.start, screened.amount), {}, 0.0, 0.0, 0.0});
      at.push_back(base.point);
      at.back().effects.push_back(again.back().start);
    }
    tell(0.47, "looking again at the promising effects");
    const auto results = differences(problem, at);
    for (std::size_t i = 0; i < again.size(); ++i) look(again[i], results[i]);
    tried.insert(tried.end(), std::make_move_iterator(again.begin()), std::make_move_iterator(again.end()));
  }
  // All starts by what they leave, and of them the best of each effect.
  std::vector<const Screened*> ranked, best;
  for (const Screened& screened : tried) {
    if (!comes_by_chance(screened.effect)) ranked.push_back(&screened);
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const Screened* a, const Screened* b) { return a->left < b->left; });
  std::map<std::string, int> seen;
  std::map<std::string, double> visibility;
  for (const Screened* screened : ranked) {
    if (++seen[screened->effect] == 1) best.push_back(screened);
    visibility[screened->effect] = std::max(visibility[screened->effect], screened->visibility);
  }
  for (const auto& [name, square] : visibility) {
    if (square < kVisible) {
      diagnosis.cannot_tell.push_back(fmt::format("{}: a typical size changes nothing in these records", name));
    }
  }

  // Refine the best ones with everything free: what takes away more than chance would.
  std::vector<const Screened*> chosen;
  seen.clear();
  // Two effects that are the same motion are fitted once and named both.
  std::map<std::string, std::string> same_as;
  for (const Screened* screened : ranked) {
    if (static_cast<int>(chosen.size()) >= settings.singles_to_refine || forecast(*screened) < kLeastGain) break;
    if (same_as.count(screened->effect) != 0) continue;
    const auto same = std::find_if(chosen.begin(), chosen.end(), [&](const Screened* other) {
      return other->effect != screened->effect && other->start.values == screened->start.values &&
             (other->column - screened->column).squaredNorm() <= kSameMotion * kSameMotion * screened->visibility;
    });
    if (same != chosen.end()) {
      same_as[screened->effect] = (*same)->effect;
    } else if (++seen[screened->effect] <= kStartsPerEffect) {
      chosen.push_back(screened);
    }
  }
  std::erase_if(best, [&](const Screened* screened) { return same_as.count(screened->effect) != 0; });
  std::vector<FitResult> fits;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    tell(0.5 + 0.2 * static_cast<double>(i) / static_cast<double>(chosen.size()), "refining " + chosen[i]->effect);
    Point start = base.point;
    start.effects.push_back(scaled(about_effect(chosen[i]->effect), chosen[i]->start, chosen[i]->amount));
    fits.push_back(fit(problem, base.nuisance_columns, start));
  }
  // One fit per effect, the better one. The leaders go on, the best of them with fresh columns, so that none loses for
  // want of convergence.
  std::stable_sort(fits.begin(), fits.end(), cheaper);
  seen.clear();
  std::erase_if(fits, [&](const FitResult& result) { return ++seen[result.point.effects[0].name] > 1; });
  go_on(problem, fits, settings.contenders, settings.leaders, [&](double share, const FitResult& result) {
    tell(0.7 + 0.1 * share, "converging " + result.point.effects[0].name);
  });
  if (!fits.empty() && settings.pairs_to_refine > 0) {
    const std::vector<Point> starts = pair_starts(problem, base, gap, best, fits, settings.pairs_to_refine);
    std::vector<FitResult> pairs;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      tell(0.8 + 0.12 * static_cast<double>(i) / static_cast<double>(starts.size()),
           "refining " + starts[i].effects[0].name + " with " + starts[i].effects[1].name);
      pairs.push_back(fit(problem, base.nuisance_columns, starts[i]));
      take_nuisance_columns(fits.front().columns, pairs.back());
    }
    go_on(problem, pairs, settings.pair_contenders, settings.pair_leaders, [&](double share, const FitResult& result) {
      tell(0.92 + 0.07 * share,
           "converging " + result.point.effects[0].name + " with " + result.point.effects[1].name);
    });
    fits.insert(fits.end(), std::make_move_iterator(pairs.begin()), std::make_move_iterator(pairs.end()));
  }

  // What fits with one effect more may show the way to those with less: a descent that stopped short elsewhere goes on from there.
  tell(0.99, "going back to fewer effects");
  std::stable_sort(fits.begin(), fits.end(), cheaper);
  go_back(problem, base.nuisance_columns, 2, fits);
  go_back(problem, base.nuisance_columns, 1, fits);
  FitResult nothing;
  nothing.point = base.point;
  nothing.difference = base.difference;
  nothing.columns = base.nuisance_columns;
  nothing.cost = base.cost;
  const auto without_effects =
      std::find_if(fits.begin(), fits.end(), [](const FitResult& result) { return result.point.effects.empty(); });
  if (without_effects != fits.end()) {
    if (without_effects->cost < nothing.cost) nothing = *without_effects;
    fits.erase(without_effects);
  }
  conclude(problem, nothing);
  for (FitResult& result : fits) conclude(problem, result);
  add_chance(problem, base, tried, fits);
  for (const auto& [name, other] : same_as) {
    for (std::size_t i = 0; i < fits.size(); ++i) {
      for (std::size_t e = 0; e < fits[i].point.effects.size(); ++e) {
        if (fits[i].point.effects[e].name != other) continue;
        FitResult twin = fits[i];
        twin.point.effects[e].name = name;
        fits.push_back(std::move(twin));
        break;
      }
    }
  }

  // A fit that was shaken to pieces is no candidate.
  std::erase_if(fits, [](const FitResult& result) { return !std::isfinite(result.cost + result.information.sum()); });

  // Weigh.
  std::vector<Candidate> candidates{{{}, nothing.excess, nothing.prior, nothing.information}};
  diagnosis.causes.push_back(make_cause(nothing));
  for (const FitResult& result : fits) {
    diagnosis.causes.push_back(make_cause(result));
    candidates.push_back({diagnosis.causes.back().effects, diagnosis.causes.back().excess, result.prior, result.information});
  }
  EvidenceSettings evidence = settings.evidence;
  if (is_coarse) {
    evidence.unknown_floor += kCoarseNoise * settings.fit.independent_share * static_cast<double>(base.difference.size());
  }
  const Probabilities probabilities = weigh(candidates, static_cast<int>(names.size()), evidence);
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
  const bool is_explained = likeliest != probabilities.candidate.end() && probabilities.unknown < *likeliest;
  locate(problem, base.difference,
         is_explained && !comes_by_chance(diagnosis.causes[static_cast<std::size_t>(likeliest - probabilities.candidate.begin())].effects[0])
             ? fits[static_cast<std::size_t>(likeliest - probabilities.candidate.begin() - 1)].difference
             : Eigen::VectorXd::Ones(base.difference.size()),
         diagnosis);
  // Groups: single causes whose signatures, as fitted, cannot be told apart.
  std::vector<Eigen::VectorXd> signatures(fits.size());  // empty: not a single cause
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (fits[i].point.effects.size() == 1) signatures[i] = project(fits[i].difference - base.difference);
  }
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (signatures[i].size() == 0) continue;
    double nearest = 1.0;
    for (std::size_t j = 0; j < fits.size(); ++j) {
      if (j == i || signatures[j].size() == 0) continue;
      const double scale = signatures[i].norm() * signatures[j].norm();
      if (scale <= 0.0) continue;
      const double cosine = std::fabs(signatures[i].dot(signatures[j])) / scale;
      const double odds = probabilities.candidate[j + 1] / std::max(1e-300, probabilities.candidate[i + 1]);
      if (cosine > kIndistinguishable && odds < kGroupOdds && odds > 1.0 / kGroupOdds) {
        diagnosis.causes[i + 1].group.push_back(fits[j].point.effects[0].name);
        nearest = std::min(nearest, std::sqrt(std::max(0.0, 1.0 - cosine * cosine)));
      }
    }
    diagnosis.causes[i + 1].group_distance = nearest;
  }
  if (diagnosis.controller_differs) add_controller_causes(problem, *controller, settings, diagnosis);
  add_counts(problem, settings, diagnosis);
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
  diagnosis.gap = diagnosis.controller_differs || diagnosis.counts > 0.0 || diagnosis.probability_nothing < 0.5;
  const bool is_unknown = diagnosis.probability_unknown > first.probability;
  if (is_unknown) {
    diagnosis.verdict = "not in the catalogue: no known effect explains what is missing";
  } else if (first.effects.empty()) {
    diagnosis.verdict = "no effect is missing; parameters within their spread explain the records";
  } else {
    diagnosis.verdict = first.effects[0];
    if (first.effects.size() > 1) diagnosis.verdict += " with " + first.effects[1];
  }
  // Parameters that had to go farther than machines of one make differ.
  const Point& answer = first.point.nuisance.empty() ? base.point : first.point;
  std::string far;
  for (std::size_t k = 0; k < std::min(answer.nuisance.size(), nuisances().size()); ++k) {
    if (std::fabs(answer.nuisance[k]) < kFarOff) continue;
    far += fmt::format("{}{} {:+.0f} %", far.empty() ? "" : ", ", nuisances()[k].name, 100.0 * nuisances()[k].spread * answer.nuisance[k]);
  }
  if (!far.empty() || is_unknown) {
    diagnosis.remarks.push_back(
        fmt::format("cannot tell whether this is another crane than the nominal one: {}; check that the crane file is this crane's",
                    far.empty() ? "neither a known effect nor parameters within their spread explain it"
                                : "the best fit wants " + far + ", more than machines of one make differ"));
  }
  diagnosis.simulations = problem.simulations;
  diagnosis.simulation_seconds = 1e-9 * static_cast<double>(problem.simulation_time);
  diagnosis.total_seconds = seconds_since(start_time);
  tell(1.0, "done");
  return diagnosis;
}

}  // namespace slewlab::diagnosis
