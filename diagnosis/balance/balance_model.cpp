#include "diagnosis/balance/balance_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace slewlab::diagnosis {

std::vector<BalanceTerm> BalanceModel::acting() const {
  std::vector<BalanceTerm> all = terms;
  all.insert(all.end(), details.begin(), details.end());
  return all;
}

std::vector<BalanceTerm> BalanceModel::named() const {
  std::vector<BalanceTerm> all = terms;
  if (std::any_of(all.begin(), all.end(), [](const BalanceTerm& term) { return term.law == "spring"; })) {
    std::erase_if(all, [](const BalanceTerm& term) { return term.law == "offset"; });
  }
  return all;
}

std::string BalanceModel::words() const {
  const std::vector<BalanceTerm> all = named();
  if (all.empty()) return "the inertia alone";
  std::string text;
  for (std::size_t k = 0; k < all.size(); ++k) text += (k == 0 ? "" : k + 1 == all.size() ? " and " : ", ") + all[k].words;
  return text;
}

const LawShape& shape_of(const std::vector<BalanceLaw>& laws, const BalanceTerm& term) {
  const auto law = std::find_if(laws.begin(), laws.end(), [&](const BalanceLaw& one) { return one.name == term.law; });
  if (law == laws.end()) throw std::invalid_argument("the balance has no law called " + term.law);
  const auto shape = std::find_if(law->shapes.begin(), law->shapes.end(), [&](const LawShape& one) { return one.shape == term.shape; });
  if (shape == law->shapes.end()) throw std::invalid_argument("the law " + term.law + " has no such shape");
  return *shape;
}

std::vector<double> balance_residual(const BalanceRecord& record, const std::vector<BalanceLaw>& laws, const BalanceModel& model,
                                     double resolved_speed) {
  const std::vector<std::size_t> judged = moving_samples(record, resolved_speed);
  std::vector<double> residual(judged.size());
  for (std::size_t i = 0; i < judged.size(); ++i) residual[i] = record.effort[judged[i]] - model.inertia * record.acceleration[judged[i]];
  if (model.skew != 0.0) {
    const std::vector<double> rate = law_column(record, [](const LawMoment& m) { return m.effort_rate; });
    for (std::size_t i = 0; i < judged.size(); ++i) residual[i] -= model.skew * rate[judged[i]];
  }
  for (const BalanceTerm& term : model.acting()) {
    const LawShape& shape = shape_of(laws, term);
    for (std::size_t c = 0; c < shape.columns.size(); ++c) {
      const std::vector<double> column = law_column(record, shape.columns[c]);
      for (std::size_t i = 0; i < judged.size(); ++i) residual[i] -= term.size[c] * column[judged[i]];
    }
  }
  return residual;
}

double correlated_rms(const BalanceRecord& record, const std::vector<BalanceLaw>& laws, const BalanceModel& model, double resolved_speed) {
  const std::vector<double> judged = balance_residual(record, laws, model, resolved_speed);
  const std::vector<std::size_t> at = moving_samples(record, resolved_speed);
  std::vector<double> residual(record.speed.size(), 0.0);
  for (std::size_t i = 0; i < at.size(); ++i) residual[at[i]] = judged[i];
  const std::size_t length = 2 * record.half_window + 2;  // of the filter on an effort that acts with half of either side
  if (at.empty() || residual.size() < 3 * length) return 0.0;
  const auto product = [&](std::size_t lag) { return std::inner_product(residual.begin() + static_cast<std::ptrdiff_t>(lag), residual.end(), residual.begin(), 0.0); };
  const double square = product(0);
  if (!(square > 0.0)) return 0.0;
  double together = 1.0, largest = 0.0;
  for (std::size_t lag = 1; lag < length; ++lag) together += 2.0 * std::pow(product(lag) / square, 2);
  for (std::size_t lag = length; lag < 2 * length; ++lag) largest = std::max(largest, std::fabs(product(lag)) / square);
  const double count = static_cast<double>(at.size()), chance = 2.0 * std::sqrt(together / count);
  return std::sqrt(std::max(0.0, largest - chance) * square / count);
}

}  // namespace slewlab::diagnosis
