#include "diagnosis/screen.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <numeric>

#include "common/unit.h"
#include "diagnosis/stochastic.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kSmallShare = 0.25;            // of an effect's typical size, with which it is tried too
constexpr int kMostBeginnings = 120;            // of a record longer than a minute, or they would take the time of all other effects
constexpr Eigen::Index kRowsAtOnce = 1 << 16;   // of the columns of all beginnings, side by side: 63 MB
constexpr int kCloserLooks = 3;                 // at most, at a size that the last one forecast
constexpr double kCloserAmount = 2.0;           // at most, of a size that was forecast: forecasts of forecasts run away
constexpr double kNearlyTried = 0.1;            // of the size: nearer than that to a start is not worth another look
constexpr int kSecondAngles = 16;               // half round, between which the better one of two angles is looked for
constexpr double kSameAngle = 1e-9;             // [rad] rounding

// The angles of an effect that are looked for all round.
std::vector<std::size_t> turning_angles(const common::EffectAbout& about) {
  std::vector<std::size_t> angles;
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    if (is_all_round(about.parameters[p]) && !about.parameters[p].detail) angles.push_back(p);
  }
  return angles;
}

// Whether `turned` is `first` with the angle a quarter turn on.
bool is_quarter_on(const common::EffectInstance& first, const common::EffectInstance& turned, std::size_t angle) {
  if (first.name != turned.name) return false;
  common::EffectInstance same = first;
  same.values[angle] = turned.values[angle];
  const double turn = std::remainder(turned.values[angle] - first.values[angle] - 0.5 * std::numbers::pi, 2.0 * std::numbers::pi);
  return same.values == turned.values && std::fabs(turn) < kSameAngle;
}

// An angle of a start, moved on.
void turn(common::EffectInstance& start, std::size_t angle, double by) {
  start.values[angle] = std::remainder(start.values[angle] + by, 2.0 * std::numbers::pi);
}

// The start with each of its angles as it is and up to so many quarter turns on, in every combination; the first angle changes fastest.
std::vector<common::EffectInstance> all_turned(const common::EffectInstance& start, const std::vector<std::size_t>& angles, int quarters) {
  std::vector<common::EffectInstance> turned{start};
  for (const std::size_t angle : angles) {
    const std::vector<common::EffectInstance> before = turned;
    for (common::EffectInstance one : before) {
      for (int quarter = 1; quarter <= quarters; ++quarter) {
        turn(one, angle, 0.5 * std::numbers::pi);
        turned.push_back(one);
      }
    }
  }
  return turned;
}

// The best angle between two looks a quarter turn apart, `first` and `turned` their columns, where the angle enters as a sine.
Screened between_quarters(const common::EffectInstance& start, const Eigen::VectorXd& first, const Eigen::VectorXd& turned,
                          std::size_t angle, const Eigen::VectorXd& target) {
  Screened best{start, {}, 0.0, 0.0, target.squaredNorm()};
  const std::optional<Amounts> amounts = joint_amounts(first, turned, target, 0.0);
  if (!amounts) return best;
  const double x = amounts->x, y = amounts->y;
  const double amount = std::hypot(x, y);
  best.amount = std::min(amount, kLargestAmount);
  turn(best.start, angle, std::atan2(y, x));
  best.left = (target + best.amount / amount * (x * first + y * turned)).squaredNorm();
  return best;
}

// The same for two angles that both enter as sines, from looks at `looks[0]`, with the first angle a quarter on, with the second, with both.
Screened between_quarters(std::span<const Screened> looks, std::size_t first_angle, std::size_t second_angle, const Eigen::VectorXd& target) {
  Screened best{looks[0].start, {}, 0.0, 0.0, std::numeric_limits<double>::infinity()};
  for (int k = 0; k < kSecondAngles; ++k) {  // half a turn: the first angle goes all round
    const double by = std::numbers::pi * k / kSecondAngles;
    common::EffectInstance start = looks[0].start;
    turn(start, second_angle, by);
    const double cosine = std::cos(by), sine = std::sin(by);
    Screened between = between_quarters(start, cosine * looks[0].column + sine * looks[2].column,
                                        cosine * looks[1].column + sine * looks[3].column, first_angle, target);
    if (between.left < best.left) best = std::move(between);
  }
  return best;
}

// Gives `screened` what of a column with this square and product with the target serves best.
void try_amount(const common::EffectCatalogue& catalogue, double square, double product, double target_square, Screened& screened,
                double farthest) {
  screened.amount = square > 0.0 && std::isfinite(square) ? -product / square : 0.0;
  screened.amount = std::clamp(screened.amount, size_turns_sign(catalogue.at(screened.start.name)) ? -farthest : 0.0, farthest);
  screened.left = target_square + screened.amount * (2.0 * product + screened.amount * square);
}

}  // namespace

SpellPlaces places_of(const common::EffectAbout& about) {
  return {index_of(about, about.spell->begin), index_of(about, about.spell->duration), index_of(about, about.spell->fade)};
}

Screened between_beginnings(const common::EffectCatalogue& catalogue, const std::vector<const Screened*>& endless, const Eigen::VectorXd& target) {
  const common::EffectAbout& about = catalogue.at(endless.front()->start.name);
  const SpellPlaces spell = places_of(about);
  const common::EffectParameter& duration = about.parameters[spell.duration];
  const auto count = static_cast<Eigen::Index>(endless.size());
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd with_target = Eigen::VectorXd::Zero(count);
  for (Eigen::Index row = 0; row < target.size(); row += kRowsAtOnce) {
    const Eigen::Index rows = std::min(kRowsAtOnce, target.size() - row);
    Eigen::MatrixXd columns(rows, count);
    for (Eigen::Index i = 0; i < count; ++i) columns.col(i) = endless[static_cast<std::size_t>(i)]->column.segment(row, rows);
    products += columns.transpose() * columns;
    with_target += columns.transpose() * target.segment(row, rows);
  }
  const double target_square = target.squaredNorm();
  Screened best{{}, {}, 0.0, 0.0, std::numeric_limits<double>::infinity()};
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = i + 1; j < count; ++j) {
      Screened spent{endless[static_cast<std::size_t>(i)]->start, {}, 0.0, 0.0, 0.0};
      try_amount(catalogue, products(i, i) + products(j, j) - 2.0 * products(i, j), with_target(i) - with_target(j), target_square, spent, kLargestAmount);
      if (spent.left >= best.left) continue;
      std::vector<double>& values = spent.start.values;
      const double lasts = endless[static_cast<std::size_t>(j)]->start.values[spell.begin] - values[spell.begin] + values[spell.fade];
      values[spell.duration] = std::clamp(lasts, duration.lower, duration.upper);
      best = std::move(spent);
    }
  }
  return best;
}

std::vector<common::EffectInstance> starts_of(const common::EffectAbout& about, double duration, double spell_every) {
  const common::EffectInstance typical = common::typical_instance(about);
  std::vector<common::EffectInstance> shapes{typical};
  common::EffectInstance small = typical;
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    const common::EffectParameter& parameter = about.parameters[p];
    if (!parameter.absent || !std::isfinite(*parameter.absent)) continue;
    small.values[p] = std::clamp(*parameter.absent + kSmallShare * (typical.values[p] - *parameter.absent),
                                 parameter.lower, parameter.upper);
  }
  // Values worth a try, those of several parameters in every combination.
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    const std::vector<common::EffectInstance> before = shapes;
    for (common::EffectInstance shape : before) {
      for (const double value : about.parameters[p].tries) {
        shape.values[p] = value;
        shapes.push_back(shape);
      }
    }
  }
  std::vector<common::EffectInstance> others;
  if (small.values != typical.values) others.push_back(small);
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    const common::EffectParameter& parameter = about.parameters[p];
    const bool fades_linearly = parameter.absent && std::isfinite(*parameter.absent);
    const bool is_when = about.spell && (parameter.name == about.spell->begin || parameter.name == about.spell->duration);
    if (fades_linearly || is_all_round(parameter) || parameter.detail || is_when || !parameter.tries.empty()) continue;
    for (const double coordinate : {-1.0, 1.0}) {
      common::EffectInstance start = typical;
      start.values[p] = value_at(parameter, to_coordinate(parameter, typical.values[p]) + coordinate);
      if (start.values[p] != typical.values[p]) others.push_back(start);
    }
  }
  if (about.spell) {
    const SpellPlaces spell = places_of(about);
    const double every = std::max(spell_every, duration / kMostBeginnings), latest = about.parameters[spell.begin].upper;
    for (int k = 0; every * k < duration && every * k <= latest; ++k) {
      common::EffectInstance endless = typical;
      endless.values[spell.begin] = every * k;
      endless.values[spell.duration] = about.parameters[spell.duration].upper;
      others.push_back(endless);
    }
  }
  const std::vector<std::size_t> angles = turning_angles(about);
  std::vector<common::EffectInstance> starts;
  if (angles.size() == 1) {
    shapes.insert(shapes.end(), others.begin(), others.end());
  } else {
    starts = others;
  }
  const int quarters = angles.size() == 1 || about.angles_multiply ? 1 : 3;
  for (const common::EffectInstance& shape : shapes) {
    const std::vector<common::EffectInstance> turned = all_turned(shape, angles, quarters);
    starts.insert(starts.end(), turned.begin(), turned.end());
  }
  return starts;
}

Point with_amount(const common::EffectCatalogue& catalogue, Point point, const Screened& screened, double amount) {
  common::EffectInstance effect = screened.start;
  const common::EffectAbout& about = catalogue.at(effect.name);
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    const common::EffectParameter& parameter = about.parameters[p];
    if (!parameter.absent) continue;
    const double absent = *parameter.absent;
    const double value = std::isfinite(absent) ? absent + amount * (effect.values[p] - absent) : effect.values[p] / std::max(amount, 1e-3);
    effect.values[p] = std::clamp(value, parameter.lower, parameter.upper);
  }
  point.effects.push_back(std::move(effect));
  return point;
}

Projector projector_of(const Problem& problem, const FitResult& fitted) {
  return Projector(fitted.columns, prior_rows(problem, fitted.point), data_weight(fitted.difference, problem.settings));
}

FitResult common_ground(Problem& problem, const FitResult& fitted, const Point& other) {
  FitResult ground;
  ground.point.nuisance = fitted.point.nuisance;
  const auto nuisances = static_cast<Eigen::Index>(fitted.point.nuisance.size());
  std::vector<Eigen::Index> kept(fitted.point.nuisance.size());
  std::iota(kept.begin(), kept.end(), Eigen::Index{0});
  Eigen::Index column = nuisances;
  for (const common::EffectInstance& effect : fitted.point.effects) {
    const bool is_common = has_effect(other.effects, effect.name);
    if (is_common) ground.point.effects.push_back(effect);
    for (std::size_t p = 0; p < effect.values.size(); ++p, ++column) {
      if (is_common) kept.push_back(column);
    }
  }
  ground.columns = fitted.columns(Eigen::all, kept);
  ground.difference = differences(problem, ground.point);
  return ground;
}

void try_amount(const common::EffectCatalogue& catalogue, const Eigen::VectorXd& column, const Eigen::VectorXd& target, Screened& screened, double farthest) {
  try_amount(catalogue, column.squaredNorm(), column.dot(target), target.squaredNorm(), screened, farthest);
}

std::optional<Amounts> joint_amounts(const Eigen::VectorXd& a, const Eigen::VectorXd& b, const Eigen::VectorXd& target, double least) {
  const double aa = a.squaredNorm(), bb = b.squaredNorm(), ab = a.dot(b), at = a.dot(target), bt = b.dot(target);
  const double determinant = aa * bb - ab * ab;
  if (!(determinant > least * aa * bb) || !std::isfinite(determinant)) return std::nullopt;
  return Amounts{-(bb * at - ab * bt) / determinant, -(aa * bt - ab * at) / determinant, at, bt};
}

bool has_effect(std::span<const common::EffectInstance> effects, std::string_view name) {
  return std::any_of(effects.begin(), effects.end(), [&](const common::EffectInstance& effect) { return effect.name == name; });
}

double forecast(const Problem& problem, const FitResult& from, const Screening& screening, const Screened& screened) {
  // Where the parameters have not been fitted, without what they would take away.
  const double independent = problem.settings.independent_share, count = static_cast<double>(from.difference.size());
  const double left = std::min(residual_power(from.difference, problem.settings), independent * (screening.gap.squaredNorm() - count)), nu = problem.settings.law_freedom;
  const double fall = independent * (screening.gap.squaredNorm() - screened.left);
  return discounted(left, nu) - discounted(left - fall, nu);
}

std::vector<common::EffectInstance> recurring_starts(const common::EffectAbout& about, std::span<const double> lengths) {
  std::vector<common::EffectInstance> starts;
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    const common::EffectParameter& parameter = about.parameters[p];
    if (!parameter.recurs) continue;
    for (const double length : lengths) {
      if (length < parameter.lower || length > parameter.upper) continue;
      common::EffectInstance start = common::typical_instance(about);
      start.values[p] = length;
      const std::vector<common::EffectInstance> turned = all_turned(start, turning_angles(about), 3);
      starts.insert(starts.end(), turned.begin(), turned.end());
    }
  }
  return starts;
}

std::vector<common::EffectInstance> catalogue_starts(const common::EffectCatalogue& catalogue, const sim::MachineSettings& nominal,
                                                     std::span<const std::string> without, double duration, double spell_every, std::span<const double> lengths) {
  std::vector<common::EffectInstance> starts;
  for (const common::EffectAbout& about : catalogue.effects) {
    const std::string name(about.name);
    if (std::find(without.begin(), without.end(), name) != without.end() || about.read_off != common::ReadOff::none || about.of_every_machine) continue;
    // What the nominal crane has already is not missing, and a machine takes an effect once.
    if (has_effect(nominal.effects, name)) continue;
    const std::vector<common::EffectInstance> own = starts_of(about, duration, spell_every), recurring = recurring_starts(about, lengths);
    starts.insert(starts.end(), own.begin(), own.end());
    starts.insert(starts.end(), recurring.begin(), recurring.end());
  }
  return starts;
}

std::vector<common::EffectInstance> what_every_machine_does(const common::EffectCatalogue& catalogue, const sim::MachineSettings& nominal, std::span<const std::string> without) {
  std::vector<common::EffectInstance> all;
  for (const common::EffectAbout& about : catalogue.effects) {
    const bool is_left_out = std::find(without.begin(), without.end(), about.name) != without.end();
    if (about.of_every_machine && !is_left_out && !has_effect(nominal.effects, about.name)) all.push_back(common::typical_instance(about));
  }
  return all;
}

std::vector<const Screened*> best_of_each(std::vector<const Screened*> screened) {
  std::stable_sort(screened.begin(), screened.end(), [](const Screened* a, const Screened* b) { return a->left < b->left; });
  std::set<std::string> seen;
  std::erase_if(screened, [&](const Screened* one) { return !seen.insert(one->start.name).second; });
  return screened;
}

std::vector<const Screened*> best_of_each(const Screening& screening) {
  std::vector<const Screened*> tried;
  for (const Screened& screened : screening.tried) tried.push_back(&screened);
  return best_of_each(std::move(tried));
}

std::vector<common::EffectInstance> with_quarters(const common::EffectAbout& about, const common::EffectInstance& start) { return all_turned(start, turning_angles(about), 1); }

std::vector<common::EffectInstance> best_starts(const Problem& problem, const Screening& screening) {
  std::vector<common::EffectInstance> starts;
  for (const Screened* screened : best_of_each(screening)) {
    const common::EffectAbout& about = problem.catalogue.at(screened->start.name);
    const std::vector<common::EffectInstance> turned = with_quarters(about, screened->start);
    starts.insert(starts.end(), turned.begin(), turned.end());
    if (about.spell) {  // when, cannot be told before the place is known
      const std::vector<common::EffectInstance> all = starts_of(about, last_moment(problem), problem.thresholds.spell_every);
      starts.insert(starts.end(), all.begin(), all.end());
    }
  }
  return starts;
}

namespace {

// Between the starts of one effect that have been looked at: better angles, beginnings and ends.
void look_between(const common::EffectCatalogue& catalogue, std::span<const Screened> tried, const Eigen::VectorXd& gap, std::vector<Screened>& between) {
  std::vector<const Screened*> endless;
  for (std::size_t i = 0; i < tried.size(); ++i) {
    const common::EffectAbout& about = catalogue.at(tried[i].start.name);
    const std::vector<std::size_t> angles = turning_angles(about);
    const auto is_turned = [&](std::size_t one, std::size_t other, std::size_t angle) {
      return other < tried.size() && is_quarter_on(tried[one].start, tried[other].start, angle);
    };
    if (angles.size() == 1 && is_turned(i, i + 1, angles[0])) {
      between.push_back(between_quarters(tried[i].start, tried[i].column, tried[i + 1].column, angles[0], gap));
    }
    if (about.angles_multiply && is_turned(i, i + 1, angles[0]) && is_turned(i, i + 2, angles[1]) && is_turned(i + 2, i + 3, angles[0])) {
      between.push_back(between_quarters(tried.subspan(i, 4), angles[0], angles[1], gap));
    }
    if (about.spell && tried[i].start.values[places_of(about).duration] == about.parameters[places_of(about).duration].upper) endless.push_back(&tried[i]);
  }
  if (endless.size() > 1) between.push_back(between_beginnings(catalogue, endless, gap));
}

// Hundreds of columns of a long record are gigabytes: of each effect the best starts keep theirs, and those of which draws and delays are made.
void keep_the_best(const common::EffectCatalogue& catalogue, std::span<Screened> tried) {
  std::map<std::string, std::vector<Screened*>> by_effect;
  for (Screened& one : tried) {
    const common::EffectAbout& about = catalogue.at(one.start.name);
    if (!is_stochastic(about) && !is_steady_delay(about)) by_effect[one.start.name].push_back(&one);
  }
  for (auto& [name, starts] : by_effect) {
    std::stable_sort(starts.begin(), starts.end(), [](const Screened* a, const Screened* b) { return a->left < b->left; });
    for (std::size_t k = kStartsPerEffect; k < starts.size(); ++k) starts[k]->column = {};
  }
}

}  // namespace

Screening screen(Problem& problem, const FitResult& from, const Projector& project, std::span<const common::EffectInstance> starts,
                 const Progress& tell) {
  // One simulation from each start.
  tell(0.0, "trying every effect of the catalogue");
  Screening screening;
  std::vector<Screened>& tried = screening.tried;
  std::vector<Point> points;
  for (const common::EffectInstance& start : starts) {
    if (has_effect(from.point.effects, start.name)) continue;
    screening.names.insert(start.name);
    Point point = from.point;
    point.effects.push_back(start);
    tried.push_back({start, {}, 0.0, 0.0, 0.0});
    points.push_back(point);
  }
  screening.gap = project.gap(from.difference);
  const Eigen::VectorXd& gap = screening.gap;
  const auto look = [&](Screened& screened, const Eigen::VectorXd& difference, double farthest) {
    screened.column = project(difference - from.difference);
    screened.visibility = screened.column.squaredNorm();
    try_amount(problem.catalogue, screened.column, gap, screened, farthest);
  };
  std::vector<Screened> between;
  std::size_t closed = 0;  // starts of effects all of whose starts have been looked at: those of one effect stand together
  {
    const std::size_t batch = 8 * static_cast<std::size_t>(std::max(1, problem.threads));
    for (std::size_t first = 0; first < points.size(); first += batch) {
      const std::size_t count = std::min(batch, points.size() - first), seen = first + count;
      const auto results = differences(problem, std::span<const Point>(points).subspan(first, count));
      share_out(problem, count, [&](std::size_t i) { look(tried[first + i], results[i], kLargestAmount); });
      for (std::size_t end = closed + 1; end <= seen; ++end) {
        const bool is_last = end == tried.size() || tried[end].start.name != tried[closed].start.name;
        if (!is_last) continue;
        look_between(problem.catalogue, std::span<const Screened>(tried).subspan(closed, end - closed), gap, between);
        closed = end;
      }
      keep_the_best(problem.catalogue, std::span(tried).first(closed));
      tell(0.9 * static_cast<double>(seen) / static_cast<double>(points.size()), "trying every effect of the catalogue");
    }
  }
  // Closer looks at the best of each effect at the size just found: few laws are linear from nothing to their typical size.
  std::vector<const Screened*> looks;
  for (const Screened& screened : tried) looks.push_back(&screened);
  for (const Screened& screened : between) looks.push_back(&screened);
  for (int closer = 0; closer < kCloserLooks; ++closer) {
    std::vector<Screened> again;
    std::vector<Point> at;
    for (const Screened* screened : best_of_each(std::move(looks))) {
      const bool is_tried = screened->column.size() != 0 && std::fabs(screened->amount - 1.0) < kNearlyTried;
      if (forecast(problem, from, screening, *screened) < kLeastGain || is_tried) continue;
      at.push_back(with_amount(problem.catalogue, from.point, *screened, screened->amount));
      again.push_back({at.back().effects.back(), {}, 0.0, 0.0, 0.0});
    }
    tell(0.9 + 0.1 * closer / kCloserLooks, "looking again at the promising effects");
    const auto results = differences(problem, at);
    share_out(problem, again.size(), [&](std::size_t i) { look(again[i], results[i], kCloserAmount); });
    const std::size_t known = tried.size();
    tried.insert(tried.end(), std::make_move_iterator(again.begin()), std::make_move_iterator(again.end()));
    keep_the_best(problem.catalogue, tried);
    looks.clear();
    for (std::size_t i = known; i < tried.size(); ++i) looks.push_back(&tried[i]);
  }
  for (const Screened& screened : tried) {
    if (is_stochastic(problem.catalogue.at(screened.start.name))) continue;
    double& largest = screening.visibility[screened.start.name];
    largest = std::max(largest, screened.visibility);
  }
  return screening;
}

}  // namespace slewlab::diagnosis
