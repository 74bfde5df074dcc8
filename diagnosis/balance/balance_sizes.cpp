#include "diagnosis/balance/balance_sizes.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "diagnosis/balance/balance_priors.h"
#include "diagnosis/balance/balance_unknown.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kDetail = 1.0;  // of the effort, what an ordinary law that is not named may make; chosen
constexpr double kTold = 0.005;  // of the square of a law's first column, that the named ones do not have as well, for the records to tell it; chosen

// Whether the records tell an ordinary law from those that are named: of its first column enough is no sum of theirs. Where all move one way, a
// constant torque is dry friction.
bool is_told_apart(const Regression& regression, const LawChoice& named, const std::pair<int, std::size_t>& law) {
  LawChoice both = named;
  both.laws.push_back(law);
  const auto is_first = [&](Eigen::Index c) {
    const RegressionColumn& column = regression.columns[static_cast<std::size_t>(c)];
    return column.law == law.first && column.shape == law.second;
  };
  const std::vector<Eigen::Index> others = columns_of(regression, named), all = columns_of(regression, both);
  const auto own = std::find_if(all.begin(), all.end(), is_first);
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(others.size()), static_cast<Eigen::Index>(others.size()));
  Eigen::VectorXd with = Eigen::VectorXd::Zero(products.rows());
  double square = 0.0;
  for (const RegressionBlock& block : regression.blocks) {
    products += block.products(others, others);
    with += block.products(others, *own);
    square += block.products(*own, *own);
  }
  return square - with.dot(solve({products, with})) > kTold * square;
}

}  // namespace

BalanceModel to_model(const Regression& regression, const std::vector<BalanceLaw>& laws, const ValidatedChoice& validated, double independent) {
  BalanceModel model;
  const std::vector<Eigen::Index> columns = columns_of(regression, validated.choice);
  const RegressionSums sums = sums_of(regression, columns);
  const double variance = validated.of_blocks * regression.count / std::max(1.0, independent);
  const Eigen::VectorXd scale = sums.products.diagonal().cwiseSqrt();
  const Eigen::MatrixXd inverse = (scale.cwiseInverse().asDiagonal() * sums.products * scale.cwiseInverse().asDiagonal()).ldlt().solve(
      Eigen::MatrixXd::Identity(sums.products.rows(), sums.products.cols()));
  const auto deviation = [&](Eigen::Index k) { return std::sqrt(std::max(0.0, variance * inverse(k, k))) / scale(k); };
  model.inertia = validated.sizes(0);
  model.inertia_deviation = deviation(0);
  if (columns.size() > 1 && columns[1] == kSkewColumn) model.skew = validated.sizes(1);
  model.validation = compared(validated, validated).first;
  for (const auto& [law, shape] : validated.choice.laws) {
    const BalanceLaw& description = laws[static_cast<std::size_t>(law)];
    BalanceTerm term{description.name, description.words, description.family, description.shapes[shape].shape, description.is_dissipative, {}, {}, 0.0};
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const RegressionColumn& column = regression.columns[static_cast<std::size_t>(columns[k])];
      if (column.law != law || column.shape != shape) continue;
      term.size.push_back(validated.sizes(static_cast<Eigen::Index>(k)));
      term.deviation.push_back(deviation(static_cast<Eigen::Index>(k)));
    }
    model.terms.push_back(std::move(term));
  }
  return model;
}

ValidatedChoice with_details(const Regression& regression, const std::vector<BalanceLaw>& laws, const ValidatedChoice& named) {
  LawChoice whole = named.choice;
  for (std::size_t l = 0; l < laws.size(); ++l) {
    const bool is_in = std::any_of(whole.laws.begin(), whole.laws.end(), [&](const auto& law) {
      return law.first == static_cast<int>(l) || laws[static_cast<std::size_t>(law.first)].name == laws[l].instead_of;
    });
    const std::pair<int, std::size_t> law{static_cast<int>(l), 0};
    if (laws[l].is_ordinary && !is_in && is_told_apart(regression, whole, law)) whole.laws.push_back(law);
  }
  Regression shrunk = regression;
  double square = 0.0;
  for (const RegressionBlock& block : regression.blocks) square += block.square;
  const double noise = named.of_blocks * correlation_length(regression, named), prior = kDetail * kDetail * square / regression.count;
  for (std::size_t k = named.choice.laws.size(); k < whole.laws.size(); ++k) {
    for (std::size_t c = 0; c < regression.columns.size(); ++c) {
      if (regression.columns[c].law != whole.laws[k].first) continue;
      double column = 0.0;
      for (const RegressionBlock& block : regression.blocks) column += block.products(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(c));
      if (column > 0.0) shrunk.ridge(static_cast<Eigen::Index>(c)) += noise / prior * column / regression.count;
    }
  }
  while (whole.laws.size() > named.choice.laws.size()) {
    const ValidatedChoice all = validate(shrunk, laws, whole);
    const std::vector<Eigen::Index> columns = columns_of(regression, whole);
    std::size_t pushes = whole.laws.size();
    for (std::size_t k = named.choice.laws.size(); k < whole.laws.size(); ++k) {
      if (!has_possible_sizes(regression, laws, columns, whole.laws[k], all.sizes)) pushes = k;
    }
    if (pushes == whole.laws.size()) return all;
    whole.laws.erase(whole.laws.begin() + static_cast<std::ptrdiff_t>(pushes));
  }
  return validate(regression, laws, whole);
}

void take_details(const BalanceModel& model, BalanceModel& other) {
  other.probability = model.probability;
  std::vector<BalanceTerm> all;
  all.swap(other.terms);
  for (BalanceTerm& term : all) {
    const auto named = std::find_if(model.terms.begin(), model.terms.end(), [&](const BalanceTerm& one) { return one.law == term.law; });
    if (named != model.terms.end()) {
      term.share = named->share;
      term.probability = named->probability;
      other.terms.push_back(std::move(term));
      continue;
    }
    const auto detail = std::find_if(model.details.begin(), model.details.end(), [&](const BalanceTerm& one) { return one.law == term.law; });
    if (detail != model.details.end()) term.probability = detail->probability;
    other.details.push_back(std::move(term));
  }
}

void widen(const BalanceModel& with_details, BalanceModel& stated) {
  stated.inertia_deviation = std::hypot(stated.inertia_deviation, with_details.inertia - stated.inertia);
  for (BalanceTerm& term : stated.terms) {
    const auto same = std::find_if(with_details.terms.begin(), with_details.terms.end(), [&](const BalanceTerm& one) { return one.law == term.law; });
    for (std::size_t k = 0; k < term.size.size() && same != with_details.terms.end(); ++k) {
      term.deviation[k] = std::hypot(term.deviation[k], same->size[k] - term.size[k]);
    }
  }
  stated.details = with_details.details;
}

FittedSizes refitted(const std::vector<BalanceRecord>& records, const std::vector<BalanceLaw>& laws, const BalanceModel& model,
                     double nominal_inertia, double resolved_speed, double motor_angle) {
  const Regression regression = prepared_regression(records, laws, nominal_inertia, resolved_speed);
  LawChoice choice;
  for (std::size_t l = 0; l < laws.size(); ++l) {
    for (const BalanceTerm& term : model.terms) {
      if (term.law == laws[l].name) choice.laws.emplace_back(static_cast<int>(l), static_cast<std::size_t>(&shape_of(laws, term) - laws[l].shapes.data()));
    }
  }
  const ValidatedChoice named = validate(regression, laws, choice);
  const double independent = regression.count / correlation_length(regression, named);
  BalanceModel stated = to_model(regression, laws, named, independent);
  take_details(model, stated);
  const ValidatedChoice whole = with_details(regression, laws, named);
  BalanceModel best = to_model(regression, laws, whole, regression.count / correlation_length(regression, whole));
  take_details(model, best);
  widen(best, stated);
  double square = 0.0;
  for (std::size_t r = 0; r < records.size(); ++r) square += residual_of(regression, whole, r).squaredNorm();
  return {std::move(best), std::move(stated), named.is_physical, find_remainder(records, regression, whole, motor_angle), std::sqrt(square / regression.count)};
}

}  // namespace slewlab::diagnosis
