#include "diagnosis/screen.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "common/unit.h"
#include "diagnosis/chance.h"
#include "sim/effects/catalogue.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kSmallShare = 0.25;            // of an effect's typical size, with which it is tried too
constexpr double kNearlyTried = 0.1;            // of the size: nearer than that to a start is not worth another look
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

// The best angle between two looks a quarter turn apart, where the angle enters as a sine.
Screened between_quarters(const Screened& first, const Screened& turned, std::size_t angle, const Eigen::VectorXd& target) {
  Screened best{first.start, {}, 0.0, 0.0, target.squaredNorm()};
  const std::optional<Amounts> amounts = joint_amounts(first.column, turned.column, target, 0.0);
  if (!amounts) return best;
  const double x = amounts->x, y = amounts->y;
  const double amount = std::hypot(x, y);
  best.amount = std::min(amount, kLargestAmount);
  best.start.values[angle] =
      std::remainder(first.start.values[angle] + std::atan2(y, x), 2.0 * std::numbers::pi);
  best.left = (target + best.amount / amount * (x * first.column + y * turned.column)).squaredNorm();
  return best;
}

}  // namespace

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
    if (fades_linearly || is_all_round(parameter) || parameter.detail || !parameter.tries.empty()) continue;
    for (const double coordinate : {-1.0, 1.0}) {
      common::EffectInstance start = typical;
      start.values[p] = value_at(parameter, to_coordinate(parameter, typical.values[p]) + coordinate);
      if (start.values[p] != typical.values[p]) others.push_back(start);
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

Point with_amount(Point point, const Screened& screened, double amount) {
  common::EffectInstance effect = screened.start;
  const common::EffectAbout& about = about_effect(effect.name);
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

bool may_turn(const std::string& effect) {
  const common::EffectParameter& parameter = about_effect(effect).parameters.front();
  return parameter.absent && parameter.lower < *parameter.absent && parameter.upper > *parameter.absent;
}

void try_amount(const Eigen::VectorXd& column, const Eigen::VectorXd& target, Screened& screened) {
  const double norm = column.squaredNorm();
  screened.amount = norm > 0.0 && std::isfinite(norm) ? -column.dot(target) / norm : 0.0;
  screened.amount = std::clamp(screened.amount, may_turn(screened.start.name) ? -kLargestAmount : 0.0, kLargestAmount);
  screened.left = (target + screened.amount * column).squaredNorm();
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
  const double left = excess(from.difference, problem.settings), nu = problem.settings.law_freedom;
  const double fall = problem.settings.independent_share * (screening.gap.squaredNorm() - screened.left);
  return discounted(left, nu) - discounted(left - fall, nu);
}

std::vector<common::EffectInstance> catalogue_starts(const sim::MachineSettings& nominal, std::span<const std::string> without) {
  std::vector<common::EffectInstance> starts;
  for (const sim::EffectDescription* description : sim::effect_catalogue()) {
    const std::string name(description->about.name);
    if (std::find(without.begin(), without.end(), name) != without.end() || name == kCounts) continue;
    // What the nominal crane has already is not missing, and a machine takes an effect once.
    if (has_effect(nominal.effects, name)) continue;
    const std::vector<common::EffectInstance> own = starts_of(description->about);
    starts.insert(starts.end(), own.begin(), own.end());
  }
  return starts;
}

std::vector<const Screened*> best_of_each(std::vector<const Screened*> screened) {
  std::stable_sort(screened.begin(), screened.end(), [](const Screened* a, const Screened* b) { return a->left < b->left; });
  std::set<std::string> seen;
  std::erase_if(screened, [&](const Screened* one) { return !seen.insert(one->start.name).second; });
  return screened;
}

std::vector<common::EffectInstance> best_starts(const Screening& screening) {
  std::vector<const Screened*> tried;
  for (const Screened& screened : screening.tried) tried.push_back(&screened);
  std::vector<common::EffectInstance> starts;
  for (const Screened* screened : best_of_each(std::move(tried))) {
    starts.push_back(screened->start);
    for (const std::size_t p : turning_angles(about_effect(screened->start.name))) {
      common::EffectInstance turned = screened->start;
      turned.values[p] = std::remainder(turned.values[p] + 0.5 * std::numbers::pi, 2.0 * std::numbers::pi);
      starts.push_back(turned);
    }
  }
  return starts;
}

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
  const auto look = [&](Screened& screened, const Eigen::VectorXd& difference) {
    screened.column = project(difference - from.difference);
    screened.visibility = screened.column.squaredNorm();
    try_amount(screened.column, gap, screened);
  };
  {
    const std::size_t batch = 8 * static_cast<std::size_t>(std::max(1, problem.threads));
    for (std::size_t first = 0; first < points.size(); first += batch) {
      const std::size_t count = std::min(batch, points.size() - first);
      const auto results = differences(problem, std::span<const Point>(points).subspan(first, count));
      for (std::size_t i = 0; i < count; ++i) look(tried[first + i], results[i]);
      tell(0.9 * static_cast<double>(first + count) / static_cast<double>(points.size()), "trying every effect of the catalogue");
    }
  }
  // A second look at the best of each effect at the size just found: few laws are linear from nothing to their typical size.
  {
    std::vector<Screened> between;
    for (std::size_t i = 0; i + 1 < tried.size(); ++i) {
      const std::vector<std::size_t> angles = turning_angles(about_effect(tried[i].start.name));
      if (angles.size() == 1 && is_quarter_on(tried[i].start, tried[i + 1].start, angles[0])) {
        between.push_back(between_quarters(tried[i], tried[i + 1], angles[0], gap));
      }
    }
    std::vector<const Screened*> looks;
    for (const Screened& screened : tried) looks.push_back(&screened);
    for (const Screened& screened : between) looks.push_back(&screened);
    std::vector<Screened> again;
    std::vector<Point> at;
    for (const Screened* screened : best_of_each(std::move(looks))) {
      const bool is_tried = screened->column.size() != 0 && std::fabs(screened->amount - 1.0) < kNearlyTried;
      if (forecast(problem, from, screening, *screened) < kLeastGain || is_tried) continue;
      at.push_back(with_amount(from.point, *screened, screened->amount));
      again.push_back({at.back().effects.back(), {}, 0.0, 0.0, 0.0});
    }
    tell(0.9, "looking again at the promising effects");
    const auto results = differences(problem, at);
    for (std::size_t i = 0; i < again.size(); ++i) look(again[i], results[i]);
    tried.insert(tried.end(), std::make_move_iterator(again.begin()), std::make_move_iterator(again.end()));
  }
  for (const Screened& screened : tried) {
    if (comes_by_chance(screened.start.name)) continue;
    double& largest = screening.visibility[screened.start.name];
    largest = std::max(largest, screened.visibility);
  }
  return screening;
}

}  // namespace slewlab::diagnosis
