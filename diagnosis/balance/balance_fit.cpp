#include "diagnosis/balance/balance_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>

namespace slewlab::diagnosis {

namespace {

// Blocks left out in turn, each of several stretches spread over the record: what is left out is then no motion that the rest does not have.
constexpr int kBlocksPerRecord = 10;
constexpr int kStretchesPerBlock = 4;
constexpr double kSignificance = 2.0;      // [standard errors] by which an addition must help the left-out blocks
constexpr double kLeastShare = kLawDiscrepancy * kLawDiscrepancy;  // of the gap, below which an addition is what a known law leaves
constexpr double kLongestWindow = 0.5;       // of the time in which the axis changes its speed, in which laws are taken for constant; chosen
constexpr double kInertiaPrior = 0.5;        // of the file's inertia, one standard deviation: 20 to 50 % off is an ordinary machine; chosen
constexpr double kResolved = 2e-3;           // of top speed, below which no friction is judged; chosen
constexpr double kNoises = 3.0;              // standard deviations of the speed's noise, likewise
constexpr double kFrictionPrior = 0.3;     // odds of an ordinary friction more, its Occam factor included: learned likewise
constexpr double kLoadPrior = 0.15;        // of an ordinary load
constexpr double kRarePrior = 0.05;        // of any of the others, likewise
constexpr double kRestShare = 0.05;        // of the gap, that known laws may leave and be the answer; what it follows is said beside it
constexpr double kUnknownPrior = 0.02;     // of a law outside the catalogue, against the best of those in it
constexpr std::size_t kMostTerms = 6;      // beside the inertia
constexpr std::size_t kGrownPairs = 3;     // of the best, from which more grows
constexpr double kRatioDeviation = 0.1;    // of the logarithm of what two laws leave: learned on simulated axes, docs/axis.md
constexpr double kMedianShare = 0.2;       // of the likeliest model's probability, that the model of all likely laws has at least
// Lags that are tried, of the time in which the axis changes its speed; evenly in the logarithm.
constexpr double kLateShares[] = {0.01, 0.015, 0.022, 0.033, 0.05, 0.075, 0.11, 0.16, 0.24, 0.36, 0.5};
constexpr double kShortestLate = 1.5;      // [samples], below which a recorder's skew is as likely
constexpr double kSkewPrior = 0.5;         // [samples]: a torque is held, or read at once, or the mean since the last sample; chosen
constexpr double kMostSkews = 3.0;         // standard deviations of that, beyond which it is a law's
constexpr double kDriveLag = 0.005;        // of the time in which the axis changes its speed, that a drive's current control takes; chosen
constexpr double kLean = 0.3;              // of viscous friction, half the difference of its directions; chosen
constexpr double kDetail = 1.0;            // of the effort, what an ordinary law that is not named may make; chosen
constexpr double kParallel = 1e-4;         // smallest eigenvalue of the columns' products, from which records tell the laws of a model apart
constexpr double kNegligible = 1e-4;       // probability that is not told
constexpr int kBumps = 20;                 // of a smooth function of one variable
constexpr double kSmoothness = 1e-6;       // ridge, as a share of the columns' own square
constexpr double kLeastDetermined = 0.1;   // of the sizes by all records but one, against all of them, for that one to judge
constexpr double kFewestJudged = 50.0;     // samples that must move

// One column of the regression and where it belongs.
constexpr int kAcceleration = -1, kSkew = -2;  // of no law
constexpr Eigen::Index kSkewColumn = 1;        // behind the acceleration's
struct Column {
  int law = kAcceleration;
  std::size_t shape = 0;
};

// Sums over one block: everything that a least-squares fit and its error need.
struct Block {
  std::size_t record = 0;
  double count = 0.0, square = 0.0;
  Eigen::MatrixXd products;
  Eigen::VectorXd with_effort;
};

struct Regression {
  std::vector<Column> columns;
  Eigen::VectorXd ridge;                  // of each column: what its prior adds to the products
  double nominal_inertia = 0.0;           // about which the acceleration's prior is; those of the others are about 0
  std::vector<Block> blocks;
  std::vector<Eigen::MatrixXd> values;    // per record, judged samples
  std::vector<Eigen::VectorXd> efforts;
  std::vector<std::vector<std::size_t>> judged;  // indices into the record
  double count = 0.0, all = 0.0;
  bool is_skewed = false;  // the effort changes, so that a skew shows
  std::vector<bool> acts_late;  // of each law
};

std::vector<double> law_column(const BalanceRecord& record, const std::function<double(const LawMoment&)>& value) {
  std::vector<double> along(record.motion.time.size());
  for (std::size_t n = 0; n < along.size(); ++n) {
    const double* late = record.motion.late_count > 0 ? &record.motion.late[n * record.motion.late_count] : nullptr;
    along[n] = value({record.motion.time[n], record.motion.position[n], record.motion.speed[n], record.motion.effort_rate[n], late});
  }
  return balance_smoothed(along, record.half_window);
}

std::vector<std::size_t> moving_samples(const BalanceRecord& record, double resolved_speed) {
  std::vector<std::size_t> judged;
  for (std::size_t n = 0; n < record.speed.size(); ++n) {
    if (std::fabs(record.speed[n]) > resolved_speed) judged.push_back(n);
  }
  return judged;
}

void add_column(const std::vector<double>& series, const std::vector<std::size_t>& judged, Eigen::MatrixXd& values, Eigen::Index column) {
  for (std::size_t i = 0; i < judged.size(); ++i) values(static_cast<Eigen::Index>(i), column) = series[judged[i]];
}

// First row and number of rows of the stretches of a block.
std::vector<std::pair<Eigen::Index, Eigen::Index>> stretches_of(int block, Eigen::Index rows) {
  constexpr Eigen::Index kStretches = kBlocksPerRecord * kStretchesPerBlock;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> stretches;
  for (Eigen::Index s = block; s < kStretches; s += kBlocksPerRecord) {
    const Eigen::Index first = rows * s / kStretches, last = rows * (s + 1) / kStretches;
    if (last > first) stretches.emplace_back(first, last - first);
  }
  return stretches;
}

Regression make_regression(const std::vector<BalanceRecord>& records, const std::vector<BalanceLaw>& laws, double resolved_speed) {
  Regression regression;
  regression.columns.push_back({});
  regression.columns.push_back({kSkew});
  for (const BalanceLaw& law : laws) regression.acts_late.push_back(law.family == LawFamily::drive);
  for (std::size_t l = 0; l < laws.size(); ++l) {
    for (std::size_t s = 0; s < laws[l].shapes.size(); ++s) {
      for (std::size_t c = 0; c < laws[l].shapes[s].columns.size(); ++c) regression.columns.push_back({static_cast<int>(l), s});
    }
  }
  for (std::size_t r = 0; r < records.size(); ++r) {
    const BalanceRecord& record = records[r];
    const std::vector<std::size_t> judged = moving_samples(record, resolved_speed);
    Eigen::MatrixXd values(static_cast<Eigen::Index>(judged.size()), static_cast<Eigen::Index>(regression.columns.size()));
    add_column(record.acceleration, judged, values, 0);
    add_column(law_column(record, [](const LawMoment& m) { return m.effort_rate; }), judged, values, 1);
    Eigen::Index column = 2;
    for (const BalanceLaw& law : laws) {
      for (const LawShape& shape : law.shapes) {
        for (const auto& value : shape.columns) add_column(law_column(record, value), judged, values, column++);
      }
    }
    Eigen::VectorXd effort(values.rows());
    for (std::size_t i = 0; i < judged.size(); ++i) effort(static_cast<Eigen::Index>(i)) = record.effort[judged[i]];
    for (int b = 0; b < kBlocksPerRecord; ++b) {
      Block block{r, 0.0, 0.0, Eigen::MatrixXd::Zero(values.cols(), values.cols()), Eigen::VectorXd::Zero(values.cols())};
      for (const auto& [first, count] : stretches_of(b, values.rows())) {
        const auto rows = values.middleRows(first, count);
        const auto targets = effort.segment(first, count);
        block.count += static_cast<double>(count);
        block.square += targets.squaredNorm();
        block.products += rows.transpose() * rows;
        block.with_effort += rows.transpose() * targets;
      }
      if (block.count > 0.0) regression.blocks.push_back(std::move(block));
    }
    regression.count += static_cast<double>(judged.size());
    regression.all += static_cast<double>(record.speed.size());
    regression.values.push_back(std::move(values));
    regression.efforts.push_back(std::move(effort));
    regression.judged.push_back(judged);
  }
  if (regression.count < kFewestJudged) {
    throw std::invalid_argument("the records hold no motion that the positions resolve; a torque balance needs moves at several speeds");
  }
  regression.ridge = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(regression.columns.size()));
  return regression;
}

// Columns of a choice of laws in shapes.
struct Choice {
  std::vector<std::pair<int, std::size_t>> laws;  // law, shape
};

std::vector<Eigen::Index> columns_of(const Regression& regression, const Choice& choice) {
  // A drive that acts late shows as a skew does: one of them only.
  const bool is_skewed = regression.is_skewed && std::none_of(choice.laws.begin(), choice.laws.end(), [&](const auto& law) {
                           return regression.acts_late[static_cast<std::size_t>(law.first)];
                         });
  std::vector<Eigen::Index> chosen;
  for (std::size_t c = 0; c < regression.columns.size(); ++c) {
    const Column& column = regression.columns[c];
    const bool is_chosen = column.law == kAcceleration || (column.law == kSkew && is_skewed) || std::any_of(choice.laws.begin(), choice.laws.end(), [&](const auto& law) {
                             return law.first == column.law && law.second == column.shape;
                           });
    if (is_chosen) chosen.push_back(static_cast<Eigen::Index>(c));
  }
  return chosen;
}

struct Sums {
  Eigen::MatrixXd products;
  Eigen::VectorXd with_effort;
};

Sums sums_of(const Regression& regression, const std::vector<Eigen::Index>& columns, const std::function<bool(const Block&)>& is_in) {
  const auto size = static_cast<Eigen::Index>(columns.size());
  Sums sums{regression.ridge(columns).asDiagonal(), Eigen::VectorXd::Zero(size)};
  if (columns.front() == 0) sums.with_effort(0) = regression.ridge(0) * regression.nominal_inertia;
  for (const Block& block : regression.blocks) {
    if (!is_in(block)) continue;
    sums.products += block.products(columns, columns);
    sums.with_effort += block.with_effort(columns);
  }
  return sums;
}

// Least squares with columns brought to one size, so that units do not matter.
Eigen::VectorXd solve(const Sums& sums) {
  const Eigen::VectorXd scale = sums.products.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt();
  Eigen::MatrixXd scaled = scale.cwiseInverse().asDiagonal() * sums.products * scale.cwiseInverse().asDiagonal();
  constexpr double kRidge = 1e-10;  // [-] parallel columns share a size instead of running away
  scaled.diagonal().array() += kRidge;
  return scale.cwiseInverse().asDiagonal() * scaled.ldlt().solve(scale.cwiseInverse().asDiagonal() * sums.with_effort);
}

// Smallest eigenvalue of the products of columns brought to one size: 0 where some of them are parallel.
double least_determined(const Sums& sums) {
  const Eigen::VectorXd scale = sums.products.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt();
  const Eigen::MatrixXd scaled = scale.cwiseInverse().asDiagonal() * sums.products * scale.cwiseInverse().asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues()(0);
}

double squared_error(const Block& block, const std::vector<Eigen::Index>& columns, const Eigen::VectorXd& sizes) {
  return block.square - 2.0 * sizes.dot(block.with_effort(columns)) + sizes.dot(block.products(columns, columns) * sizes);
}

// Mean squares of what is left where it was not fitted.
struct LeftOut {
  std::vector<double> block_error;         // of each block, left out on its own
  std::vector<double> record_block_error;  // of each block, its whole record left out; empty where the others do not determine the sizes
};

// A choice of laws, judged.
struct Validated : LeftOut {
  Choice choice;
  Eigen::VectorXd sizes;              // fitted on everything
  std::vector<double> record_error;   // of each record, left out whole; empty where the others do not determine the sizes
  double of_blocks = 0.0, of_records = 0.0;  // mean squares; of_records only where record_error is there
  bool is_physical = true;  // no size has a sign that it cannot have, and all of them are determined
};

// Whether a law's sizes are such as its physics allows.
bool has_possible_sizes(const Regression& regression, const std::vector<BalanceLaw>& laws, const std::vector<Eigen::Index>& columns,
                        const std::pair<int, std::size_t>& chosen, const Eigen::VectorXd& sizes) {
  const BalanceLaw& law = laws[static_cast<std::size_t>(chosen.first)];
  if (!law.is_dissipative) return true;
  const auto first = std::find_if(columns.begin(), columns.end(), [&](Eigen::Index c) {
    const Column& column = regression.columns[static_cast<std::size_t>(c)];
    return column.law == chosen.first && column.shape == chosen.second;
  });
  const LawShape& shape = law.shapes[chosen.second];
  const double size = sizes(first - columns.begin());
  return size >= 0.0 && size <= shape.largest && !(shape.is_leaning && std::fabs(sizes(first - columns.begin() + 1)) > size);
}

// The columns whose sizes the records must tell: a difference of the directions has its prior, without which records of one direction would
// tell no viscous friction.
std::vector<Eigen::Index> told_by_records(const Regression& regression, const std::vector<BalanceLaw>& laws, const std::vector<Eigen::Index>& columns) {
  std::vector<Eigen::Index> told;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const Column& column = regression.columns[static_cast<std::size_t>(columns[k])];
    const bool is_second = k > 0 && column.law >= 0 && regression.columns[static_cast<std::size_t>(columns[k - 1])].law == column.law;
    if (is_second && laws[static_cast<std::size_t>(column.law)].shapes[column.shape].is_leaning) continue;
    told.push_back(columns[k]);
  }
  return told;
}

Validated validate(const Regression& regression, const std::vector<BalanceLaw>& laws, const Choice& choice, std::size_t records) {
  Validated result;
  result.choice = choice;
  const std::vector<Eigen::Index> columns = columns_of(regression, choice);
  result.sizes = solve(sums_of(regression, columns, [](const Block&) { return true; }));
  for (const Block& left_out : regression.blocks) {
    const Eigen::VectorXd sizes = solve(sums_of(regression, columns, [&](const Block& block) { return &block != &left_out; }));
    const double error = squared_error(left_out, columns, sizes);
    result.block_error.push_back(error / left_out.count);
    result.of_blocks += error / regression.count;
  }
  const std::vector<Eigen::Index> told = told_by_records(regression, laws, columns);
  const double determined = least_determined(sums_of(regression, told, [](const Block&) { return true; }));
  for (std::size_t r = 0; r < records && records > 1; ++r) {
    const auto is_other = [&](const Block& block) { return block.record != r; };
    const Sums others = sums_of(regression, columns, is_other);
    if (least_determined(sums_of(regression, told, is_other)) < kLeastDetermined * determined) {
      result.record_error.clear();
      result.record_block_error.clear();
      break;
    }
    const Eigen::VectorXd sizes = solve(others);
    double error = 0.0, count = 0.0;
    for (const Block& block : regression.blocks) {
      if (block.record != r) continue;
      const double of_block = squared_error(block, columns, sizes);
      result.record_block_error.push_back(of_block / block.count);
      error += of_block;
      count += block.count;
    }
    result.record_error.push_back(count > 0.0 ? error / count : 0.0);
    result.of_records += error / regression.count;
  }
  result.is_physical = result.sizes(0) > 0.0 && (choice.laws.empty() || determined > kParallel);
  for (const auto& law : choice.laws) result.is_physical = result.is_physical && has_possible_sizes(regression, laws, columns, law, result.sizes);
  return result;
}

// The validation mean squares of two models by what both were validated by: their geometric mean of blocks and records, or blocks alone.
std::pair<double, double> compared(const Validated& a, const Validated& b) {
  if (a.record_error.empty() || b.record_error.empty()) return {a.of_blocks, b.of_blocks};
  return {std::sqrt(a.of_blocks * a.of_records), std::sqrt(b.of_blocks * b.of_records)};
}

bool is_better(const Validated& a, const Validated& b) {
  const auto [left_a, left_b] = compared(a, b);
  return left_a < left_b;
}

// Whether `with` predicts left-out data better than `without`: block by block, and no whole record at the others' cost.
bool helps(const Validated& without, const Validated& with, double gap) {
  const auto [left_with, left_without] = compared(with, without);
  if (!with.is_physical || left_with > left_without - kLeastShare * gap) return false;
  const auto count = static_cast<double>(with.block_error.size());
  double mean = 0.0, square = 0.0;
  for (std::size_t b = 0; b < with.block_error.size(); ++b) {
    const double fall = without.block_error[b] - with.block_error[b];
    mean += fall / count;
    square += fall * fall / count;
  }
  const double error = std::sqrt(std::max(0.0, square - mean * mean) / std::max(1.0, count - 1.0));
  if (mean < kSignificance * error) return false;
  double gain = 0.0, loss = 0.0;
  const std::size_t records = std::min(with.record_error.size(), without.record_error.size());
  for (std::size_t r = 0; r < records; ++r) {
    const double fall = without.record_error[r] - with.record_error[r];
    (fall > 0.0 ? gain : loss) += std::fabs(fall);
  }
  return records == 0 || gain > kSignificance * loss;
}

// The choice with one law more, each law in the shape that validates best; nothing where none may be added.
std::vector<Validated> additions(const Regression& regression, const std::vector<BalanceLaw>& laws, const Choice& choice, std::size_t records,
                                 bool only_ordinary) {
  std::vector<Validated> found;
  const auto has = [&](const std::string& name) {
    return std::any_of(choice.laws.begin(), choice.laws.end(), [&](const auto& law) { return laws[static_cast<std::size_t>(law.first)].name == name; });
  };
  for (std::size_t l = 0; l < laws.size(); ++l) {
    if (only_ordinary && !laws[l].is_ordinary) continue;
    if (has(laws[l].name) || (!laws[l].needs.empty() && !has(laws[l].needs))) continue;
    std::optional<Validated> best;
    for (std::size_t s = 0; s < laws[l].shapes.size(); ++s) {
      Choice longer = choice;
      longer.laws.emplace_back(static_cast<int>(l), s);
      Validated validated = validate(regression, laws, longer, records);
      if (!validated.is_physical) continue;
      if (!best || is_better(validated, *best)) best = std::move(validated);
    }
    if (best) found.push_back(std::move(*best));
  }
  // By the blocks, which every model has.
  std::stable_sort(found.begin(), found.end(), [](const Validated& a, const Validated& b) { return a.of_blocks < b.of_blocks; });
  return found;
}

Choice without_law(Choice choice, std::size_t index) {
  choice.laws.erase(choice.laws.begin() + static_cast<std::ptrdiff_t>(index));
  return choice;
}

// Whether another law of the choice is a detail of this one.
bool is_needed(const std::vector<BalanceLaw>& laws, const Choice& choice, std::size_t index) {
  const std::string& name = laws[static_cast<std::size_t>(choice.laws[index].first)].name;
  return std::any_of(choice.laws.begin(), choice.laws.end(), [&](const auto& law) { return laws[static_cast<std::size_t>(law.first)].needs == name; });
}

Eigen::VectorXd residual_of(const Regression& regression, const Validated& model, std::size_t record) {
  const std::vector<Eigen::Index> columns = columns_of(regression, model.choice);
  return regression.efforts[record] - regression.values[record](Eigen::all, columns) * model.sizes;
}

// [samples] over which the residual of neighbours goes together: the integral of its autocorrelation up to where that first falls to 0.
double correlation_length(const Regression& regression, const Validated& model) {
  double longest = 1.0;
  for (std::size_t r = 0; r < regression.values.size(); ++r) {
    const Eigen::VectorXd residual = residual_of(regression, model, r);
    const double square = residual.squaredNorm();
    if (!(square > 0.0)) continue;
    double length = 1.0;
    const Eigen::Index count = residual.size();
    for (Eigen::Index lag = 1; lag < count / 4; ++lag) {
      const double together = residual.head(count - lag).dot(residual.tail(count - lag)) / square;
      if (together <= 0.0) break;
      length += 2.0 * together;
    }
    longest = std::max(longest, length);
  }
  return longest;
}

// Index of a law's choice in its first shape; nothing where it is not among the laws.
std::optional<std::pair<int, std::size_t>> chosen_law(const std::vector<BalanceLaw>& laws, std::string_view name) {
  const auto found = std::find_if(laws.begin(), laws.end(), [name](const BalanceLaw& law) { return law.name == name; });
  if (found == laws.end()) return std::nullopt;
  return std::pair(static_cast<int>(found - laws.begin()), std::size_t{0});
}

// Priors of what every machine and recorder has a little of: normal, about 0 but for the inertia, against the noise that the ordinary laws leave.
//   inertia                                         kInertiaPrior of the file's, about that
//   skew between the channels                       kSkewPrior of a sample and kDriveLag of the motion's time
//   viscous friction's difference of the directions kLean of it
void add_priors(const std::vector<BalanceRecord>& records, const std::vector<BalanceLaw>& laws, Regression& regression) {
  double speed = 0.0, acceleration = 0.0, rate = 0.0, step = 0.0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    for (const std::size_t n : regression.judged[r]) {
      speed += records[r].speed[n] * records[r].speed[n];
      acceleration += records[r].acceleration[n] * records[r].acceleration[n];
    }
    rate += regression.values[r].col(1).squaredNorm();
    step = std::max(step, records[r].step);
  }
  regression.is_skewed = rate > 0.0;
  Choice ordinary;
  for (std::size_t l = 0; l < laws.size(); ++l) {
    if (laws[l].is_ordinary) ordinary.laws.emplace_back(static_cast<int>(l), 0);
  }
  const std::vector<Eigen::Index> columns = columns_of(regression, ordinary);
  Validated base;
  base.choice = ordinary;
  base.sizes = solve(sums_of(regression, columns, [](const Block&) { return true; }));
  double square = 0.0;
  for (const Block& block : regression.blocks) square += std::max(0.0, squared_error(block, columns, base.sizes));
  const double noise = square / regression.count * correlation_length(regression, base);
  const double inertia_deviation = kInertiaPrior * regression.nominal_inertia;
  regression.ridge(0) = inertia_deviation > 0.0 ? noise / (inertia_deviation * inertia_deviation) : 0.0;
  if (regression.is_skewed) {
    const double prior = std::hypot(kSkewPrior * step, acceleration > 0.0 ? kDriveLag * std::sqrt(speed / acceleration) : 0.0);
    regression.ridge(kSkewColumn) = noise / (prior * prior);
    // Further apart than a few of that is no recorder's doing, and a law's to explain.
    constexpr double kTighter = 2.0;
    constexpr int kRounds = 40;
    for (int round = 0; round < kRounds && std::fabs(solve(sums_of(regression, columns, [](const Block&) { return true; }))(kSkewColumn)) > kMostSkews * prior; ++round) {
      regression.ridge(kSkewColumn) *= kTighter;
    }
  }
  const auto viscous = chosen_law(laws, "viscous");
  if (!viscous || !(speed > 0.0)) return;
  for (std::size_t c = 0; c < regression.columns.size(); ++c) {
    if (regression.columns[c].law != viscous->first) continue;
    const auto at = std::find(columns.begin(), columns.end(), static_cast<Eigen::Index>(c)) - columns.begin();
    const double size = std::max(base.sizes(at), std::sqrt(square / speed));  // at least what would hide in the residual
    regression.ridge(static_cast<Eigen::Index>(c) + 1) = noise / (kLean * kLean * size * size);
    break;
  }
}

// Bumps over the range of one variable, as functions of it.
Eigen::MatrixXd bumps(const Eigen::VectorXd& variable, double low, double high) {
  Eigen::MatrixXd values(variable.size(), kBumps);
  const double width = (high - low) / (kBumps - 1);
  for (Eigen::Index n = 0; n < variable.size(); ++n) {
    for (int b = 0; b < kBumps; ++b) {
      const double x = (variable(n) - (low + width * b)) / width;
      values(n, b) = std::exp(-0.5 * x * x);
    }
  }
  return values;
}

// What smooth functions of some variables leave of some targets.
LeftOut smooth_validation(const Regression& regression, const std::vector<std::vector<Eigen::VectorXd>>& variables,
                         const std::vector<Eigen::VectorXd>& targets, bool with_acceleration) {
  const std::size_t kinds = variables.size();
  std::vector<Eigen::MatrixXd> values;
  for (std::size_t r = 0; r < targets.size(); ++r) {
    Eigen::MatrixXd all(targets[r].size(), static_cast<Eigen::Index>(kinds) * kBumps + (with_acceleration ? 1 : 0));
    for (std::size_t k = 0; k < kinds; ++k) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const Eigen::VectorXd& one : variables[k]) {
        if (one.size() == 0) continue;
        low = std::min(low, one.minCoeff());
        high = std::max(high, one.maxCoeff());
      }
      all.middleCols(static_cast<Eigen::Index>(k) * kBumps, kBumps) = bumps(variables[k][r], low, high);
    }
    if (with_acceleration) all.rightCols(1) = regression.values[r].leftCols(1);
    values.push_back(std::move(all));
  }
  const Eigen::Index size = values.front().cols();
  struct Part {
    Eigen::MatrixXd products;
    Eigen::VectorXd with;
    double square, count;
    std::size_t record;
  };
  std::vector<Part> parts;
  Part sum{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), 0.0, 0.0, 0};
  for (std::size_t r = 0; r < targets.size(); ++r) {
    for (int b = 0; b < kBlocksPerRecord; ++b) {
      Part part{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), 0.0, 0.0, r};
      for (const auto& [first, count] : stretches_of(b, values[r].rows())) {
        const auto rows = values[r].middleRows(first, count);
        const auto target = targets[r].segment(first, count);
        part.products += rows.transpose() * rows;
        part.with += rows.transpose() * target;
        part.square += target.squaredNorm();
        part.count += static_cast<double>(count);
      }
      if (part.count == 0.0) continue;
      parts.push_back(std::move(part));
      sum.products += parts.back().products;
      sum.with += parts.back().with;
    }
  }
  // Of one part, from all that are fitted.
  const auto error_of = [](const Part& part, Eigen::MatrixXd products, const Eigen::VectorXd& with) {
    const Eigen::VectorXd scale = products.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt();
    products = scale.cwiseInverse().asDiagonal() * products * scale.cwiseInverse().asDiagonal();
    products.diagonal().array() += kSmoothness;
    const Eigen::VectorXd fit = scale.cwiseInverse().asDiagonal() * products.ldlt().solve(scale.cwiseInverse().asDiagonal() * with);
    return std::max(0.0, part.square - 2.0 * fit.dot(part.with) + fit.dot(part.products * fit)) / part.count;
  };
  LeftOut left;
  for (const Part& part : parts) {
    left.block_error.push_back(error_of(part, sum.products - part.products, sum.with - part.with));
    if (targets.size() < 2) continue;
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd with = Eigen::VectorXd::Zero(size);
    for (const Part& other : parts) {
      if (other.record == part.record) continue;
      products += other.products;
      with += other.with;
    }
    left.record_block_error.push_back(error_of(part, std::move(products), with));
  }
  return left;
}

std::vector<Eigen::VectorXd> variable_of(const std::vector<BalanceRecord>& records, const Regression& regression,
                                         std::vector<double> BalanceRecord::* series) {
  std::vector<Eigen::VectorXd> values;
  for (std::size_t r = 0; r < records.size(); ++r) {
    Eigen::VectorXd one(static_cast<Eigen::Index>(regression.judged[r].size()));
    for (std::size_t i = 0; i < regression.judged[r].size(); ++i) one(static_cast<Eigen::Index>(i)) = (records[r].*series)[regression.judged[r][i]];
    values.push_back(std::move(one));
  }
  return values;
}

// Over all samples, of what the blocks have each.
double mean_over(const Regression& regression, const std::vector<double>& block_error) {
  double sum = 0.0;
  for (std::size_t b = 0; b < block_error.size(); ++b) sum += block_error[b] * regression.blocks[b].count;
  return sum / regression.count;
}

Remainder find_remainder(const std::vector<BalanceRecord>& records, const Regression& regression, const Validated& best) {
  std::vector<Eigen::VectorXd> residuals;
  double square = 0.0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    residuals.push_back(residual_of(regression, best, r));
    square += residuals.back().squaredNorm();
  }
  const double mean = square / regression.count;
  Remainder remainder;
  const std::pair<const char*, std::vector<double> BalanceRecord::*> kVariables[] = {
      {"speed", &BalanceRecord::speed}, {"position", &BalanceRecord::position}, {"time", &BalanceRecord::time}, {"torque", &BalanceRecord::effort}};
  for (const auto& [name, series] : kVariables) {
    const double left = mean_over(regression, smooth_validation(regression, {variable_of(records, regression, series)}, residuals, false).block_error);
    const double share = mean > 0.0 ? 1.0 - left / mean : 0.0;
    if (share > remainder.share) remainder = {name, share};
  }
  constexpr double kWorthAWord = 0.1;  // of what is left
  return remainder.share > kWorthAWord ? remainder : Remainder{};
}

// The first of `candidates` that helps.
const Validated* first_help(const Validated& best, const std::vector<Validated>& candidates, double gap) {
  const auto found = std::find_if(candidates.begin(), candidates.end(), [&](const Validated& candidate) { return helps(best, candidate, gap); });
  return found == candidates.end() ? nullptr : &*found;
}

// Each law's shape chosen again beside the others.
Validated reshaped(const Regression& regression, const std::vector<BalanceLaw>& laws, Validated best, std::size_t records) {
  for (std::size_t k = 0; k < best.choice.laws.size(); ++k) {
    const std::size_t shapes = laws[static_cast<std::size_t>(best.choice.laws[k].first)].shapes.size();
    for (std::size_t s = 0; s < shapes; ++s) {
      Choice other = best.choice;
      if (other.laws[k].second == s) continue;
      other.laws[k].second = s;
      Validated validated = validate(regression, laws, other, records);
      if (validated.is_physical && is_better(validated, best)) best = std::move(validated);
    }
  }
  return best;
}

std::vector<int> names_of(const Choice& choice) {
  std::vector<int> names;
  for (const auto& [law, shape] : choice.laws) names.push_back(law);
  std::sort(names.begin(), names.end());
  return names;
}

// One law at a time while validation improves, two where no single one helps (in records of one direction each dry friction and a constant
// torque help only together); one that another has made needless goes again. `tried` gets everything that was validated.
Validated grow(const Regression& regression, const std::vector<BalanceLaw>& laws, Validated best, std::size_t records, bool only_ordinary, double gap,
               std::vector<Validated>& tried) {
  std::set<std::vector<int>> been;  // two laws may each make the other needless, in turn
  while (best.choice.laws.size() < kMostTerms && been.insert(names_of(best.choice)).second) {
    const std::vector<Validated> longer = additions(regression, laws, best.choice, records, only_ordinary);
    tried.insert(tried.end(), longer.begin(), longer.end());
    const Validated* found = first_help(best, longer, gap);
    std::vector<Validated> pairs;
    for (std::size_t k = 0; found == nullptr && only_ordinary && k < longer.size(); ++k) {
      const std::vector<Validated> beside = additions(regression, laws, longer[k].choice, records, only_ordinary);
      pairs.insert(pairs.end(), beside.begin(), beside.end());
    }
    if (found == nullptr) found = first_help(best, pairs, gap);
    if (found == nullptr) break;
    best = reshaped(regression, laws, *found, records);
    tried.push_back(best);
    for (std::size_t k = 0; k + 1 < best.choice.laws.size(); ++k) {
      if (is_needed(laws, best.choice, k)) continue;
      Validated shorter = validate(regression, laws, without_law(best.choice, k), records);
      if (!shorter.is_physical || helps(shorter, best, gap)) continue;
      best = std::move(shorter);
      break;
    }
  }
  return best;
}

// What may be the answer: no law, each alone, each pair, and what grows from the ordinary laws, from none and from the best pairs; beside what
// has grown, that with one law less and with one law in another's place. Each set of laws once, in its best shapes.
std::vector<Validated> candidates_of(const Regression& regression, const std::vector<BalanceLaw>& laws, const Validated& alone, std::size_t records) {
  const double gap = alone.of_blocks;
  std::vector<Validated> tried{alone};
  const std::vector<Validated> singles = additions(regression, laws, {}, records, false);
  tried.insert(tried.end(), singles.begin(), singles.end());
  std::vector<Validated> pairs;
  for (const Validated& single : singles) {
    for (const Validated& pair : additions(regression, laws, single.choice, records, false)) pairs.push_back(reshaped(regression, laws, pair, records));
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Validated& a, const Validated& b) { return a.of_blocks < b.of_blocks; });
  tried.insert(tried.end(), pairs.begin(), pairs.end());
  std::vector<Validated> ends;
  Validated ordinary = alone;
  for (const bool only_ordinary : {true, false}) ordinary = grow(regression, laws, ordinary, records, only_ordinary, gap, tried);
  ends.push_back(ordinary);
  ends.push_back(grow(regression, laws, alone, records, false, gap, tried));
  for (std::size_t k = 0; k < std::min(kGrownPairs, pairs.size()); ++k) ends.push_back(grow(regression, laws, pairs[k], records, false, gap, tried));
  for (const Validated& end : ends) {
    tried.push_back(end);
    for (std::size_t k = 0; k < end.choice.laws.size(); ++k) {
      if (is_needed(laws, end.choice, k)) continue;
      const Choice shorter = without_law(end.choice, k);
      tried.push_back(validate(regression, laws, shorter, records));
      for (const Validated& swapped : additions(regression, laws, shorter, records, false)) tried.push_back(swapped);
    }
  }
  std::map<std::vector<int>, Validated> best_of;
  for (Validated& one : tried) {
    if (!one.is_physical && !one.choice.laws.empty()) continue;  // the inertia alone is told even where it is absurd
    std::sort(one.choice.laws.begin(), one.choice.laws.end());
    const auto [entry, is_new] = best_of.try_emplace(names_of(one.choice), one);
    if (!is_new && is_better(one, entry->second)) entry->second = std::move(one);
  }
  std::vector<Validated> candidates;
  for (auto& [names, one] : best_of) candidates.push_back(validate(regression, laws, one.choice, records));
  return candidates;
}

// ln of the odds of one model against another by what both leave of the blocks left out: of the mean logarithm of their ratio, whose spread
// from block to block is not known but shows in them, as Student's density has it, and from machine to machine is kRatioDeviation. What laws
// are known no better than (`floor`) is left by both.
double log_odds(const LeftOut& one, const LeftOut& other, double floor) {
  const auto ratio = [floor](double a, double b) { return std::log((std::max(0.0, a) + floor) / (std::max(0.0, b) + floor)); };
  const auto count = static_cast<double>(one.block_error.size());
  const bool has_records = !one.record_block_error.empty() && !other.record_block_error.empty();
  double mean = 0.0, square = 0.0;
  for (std::size_t b = 0; b < one.block_error.size(); ++b) {
    double more = ratio(one.block_error[b], other.block_error[b]);
    if (has_records) more = 0.5 * (more + ratio(one.record_block_error[b], other.record_block_error[b]));
    mean += more / count;
    square += more * more / count;
  }
  const double freedom = std::max(1.0, count - 1.0), variance = std::max(0.0, square - mean * mean) / freedom + kRatioDeviation * kRatioDeviation;
  return -std::copysign(0.5 * (freedom + 1.0) * std::log1p(mean * mean / variance / freedom), mean);
}

// The model of all laws that are likelier there than not, which of all single models predicts best (Barbieri, Berger 2004, Annals of Statistics
// 32, p. 870); the likeliest where that is no candidate, or one that is much less likely (of two laws that are one motion in these records each is
// half likely). `known`: probability of all candidates together.
std::size_t median_model(const std::vector<Validated>& candidates, const std::vector<double>& probability, const std::vector<double>& inclusion, double known) {
  std::vector<int> likely;
  for (std::size_t l = 0; l < inclusion.size(); ++l) {
    if (inclusion[l] > 0.5 * known) likely.push_back(static_cast<int>(l));
  }
  const auto likeliest = static_cast<std::size_t>(std::max_element(probability.begin(), probability.end()) - probability.begin());
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const auto& chosen = candidates[k].choice.laws;
    const bool is_median = std::equal(chosen.begin(), chosen.end(), likely.begin(), likely.end(), [](const auto& law, int name) { return law.first == name; });
    if (is_median && probability[k] > kMedianShare * probability[likeliest]) return k;
  }
  return likeliest;
}

// With the ordinary laws that are not named: every machine has a little of them. Those go again that would push.
Validated with_details(const Regression& regression, const std::vector<BalanceLaw>& laws, const Validated& named, std::size_t records) {
  Choice whole = named.choice;
  for (std::size_t l = 0; l < laws.size(); ++l) {
    const bool is_in = std::any_of(whole.laws.begin(), whole.laws.end(), [&](const auto& law) { return law.first == static_cast<int>(l); });
    if (laws[l].is_ordinary && !is_in) whole.laws.emplace_back(static_cast<int>(l), 0);
  }
  Regression shrunk = regression;
  double square = 0.0;
  for (const Block& block : regression.blocks) square += block.square;
  const double noise = named.of_blocks * correlation_length(regression, named), prior = kDetail * kDetail * square / regression.count;
  for (std::size_t k = named.choice.laws.size(); k < whole.laws.size(); ++k) {
    for (std::size_t c = 0; c < regression.columns.size(); ++c) {
      if (regression.columns[c].law != whole.laws[k].first) continue;
      double column = 0.0;
      for (const Block& block : regression.blocks) column += block.products(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(c));
      if (column > 0.0) shrunk.ridge(static_cast<Eigen::Index>(c)) += noise / prior * column / regression.count;
    }
  }
  while (whole.laws.size() > named.choice.laws.size()) {
    const Validated all = validate(shrunk, laws, whole, records);
    const std::vector<Eigen::Index> columns = columns_of(regression, whole);
    std::size_t pushes = whole.laws.size();
    for (std::size_t k = named.choice.laws.size(); k < whole.laws.size(); ++k) {
      if (!has_possible_sizes(regression, laws, columns, whole.laws[k], all.sizes)) pushes = k;
    }
    if (pushes == whole.laws.size()) return all;
    whole.laws.erase(whole.laws.begin() + static_cast<std::ptrdiff_t>(pushes));
  }
  return validate(regression, laws, whole, records);
}

// What is stated of a law's size, fitted without the details, is known no better than these move it.
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

// Which of the terms of `other` are details, and how sure they are, as in `model`.
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

BalanceModel to_model(const Regression& regression, const std::vector<BalanceLaw>& laws, const Validated& validated, double independent) {
  BalanceModel model;
  const std::vector<Eigen::Index> columns = columns_of(regression, validated.choice);
  const Sums sums = sums_of(regression, columns, [](const Block&) { return true; });
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
      const Column& column = regression.columns[static_cast<std::size_t>(columns[k])];
      if (column.law != law || column.shape != shape) continue;
      term.size.push_back(validated.sizes(static_cast<Eigen::Index>(k)));
      term.deviation.push_back(deviation(static_cast<Eigen::Index>(k)));
    }
    model.terms.push_back(std::move(term));
  }
  return model;
}

// [s] in which the axis changes its speed: RMS of the speed over that of the acceleration, without what noise of the positions makes of it.
double motion_time(const AxisRecord& record, std::size_t half_window) {
  const BalanceRecord smooth = make_balance_record(record, half_window);
  double speed = 0.0, acceleration = 0.0;
  for (std::size_t n = 0; n < smooth.speed.size(); ++n) {
    speed += smooth.speed[n] * smooth.speed[n];
    acceleration += smooth.acceleration[n] * smooth.acceleration[n];
  }
  const double noise = acceleration_noise(record, half_window);
  acceleration -= noise * noise * static_cast<double>(smooth.speed.size());
  return acceleration > 0.0 ? std::sqrt(speed / acceleration) : std::numeric_limits<double>::infinity();
}

// As long as the noise asks for, unless the axis changes its speed faster than that.
std::size_t half_window_of(const AxisRecord& record, double inertia) {
  constexpr double kRoom = 0.2;  // of the record, that a window takes at most
  std::size_t half = balance_half_window(record, inertia, kRoom * record.step * static_cast<double>(record.position.size()));
  while (2.0 * static_cast<double>(half) * record.step > kLongestWindow * motion_time(record, half) && half > kFewestHalf) {
    half = std::max(kFewestHalf, half - std::max<std::size_t>(1, half / 5));
  }
  return half;
}

Regression prepared(const std::vector<BalanceRecord>& records, const std::vector<BalanceLaw>& laws, double nominal_inertia, double resolved_speed) {
  Regression regression = make_regression(records, laws, resolved_speed);
  regression.nominal_inertia = nominal_inertia;
  add_priors(records, laws, regression);
  return regression;
}

}  // namespace

std::vector<BalanceTerm> BalanceModel::acting() const {
  std::vector<BalanceTerm> all = terms;
  all.insert(all.end(), details.begin(), details.end());
  return all;
}

std::vector<FamilyProbability> family_probabilities(const BalanceAnswer& answer) {
  std::vector<FamilyProbability> families{{LawFamily::friction}, {LawFamily::load}, {LawFamily::drive}};
  for (const BalanceModel& model : answer.models) {
    for (FamilyProbability& one : families) {
      if (std::any_of(model.terms.begin(), model.terms.end(), [&](const BalanceTerm& term) { return term.family == one.family; })) one.probability += model.probability;
    }
  }
  return families;
}

std::vector<LawProbability> law_probabilities(const BalanceAnswer& answer) {
  std::vector<LawProbability> all = answer.laws;
  for (LawProbability& one : all) {
    for (const BalanceTerm& term : answer.best.terms) {
      if (term.law == one.law) one.probability = term.probability;
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const LawProbability& a, const LawProbability& b) { return a.probability > b.probability; });
  return all;
}

std::string words_of(LawFamily family) {
  switch (family) {
    case LawFamily::friction: return "friction";
    case LawFamily::load: return "a load";
    case LawFamily::drive: return "a drive that acts late";
  }
  return "";
}

std::string BalanceModel::words() const {
  if (terms.empty()) return "the inertia alone";
  std::string text;
  for (std::size_t k = 0; k < terms.size(); ++k) text += (k == 0 ? "" : k + 1 == terms.size() ? " and " : ", ") + terms[k].words;
  return text;
}

BalanceAnswer fit_balance(const std::vector<BalanceRecord>& records, const std::vector<BalanceLaw>& laws, double nominal_inertia,
                          double resolved_speed) {
  const Regression regression = prepared(records, laws, nominal_inertia, resolved_speed);
  BalanceAnswer answer;
  answer.judged_share = regression.count / regression.all;
  for (const Block& block : regression.blocks) {
    answer.nominal += (block.square - 2.0 * nominal_inertia * block.with_effort(0) + nominal_inertia * nominal_inertia * block.products(0, 0)) / regression.count;
  }
  const Validated alone = validate(regression, laws, {}, records.size());
  const double floor = kLeastShare * alone.of_blocks;
  const std::vector<Validated> candidates = candidates_of(regression, laws, alone, records.size());
  // Against that which leaves least, each law more with its prior cost.
  const Validated& least = *std::min_element(candidates.begin(), candidates.end(), [](const Validated& a, const Validated& b) { return a.of_blocks < b.of_blocks; });
  const double independent = regression.count / correlation_length(regression, least);
  // Every machine has friction, many a constant torque as well; the others share what one of them has.
  const auto others = static_cast<double>(std::count_if(laws.begin(), laws.end(), [](const BalanceLaw& law) { return !law.is_ordinary; }));
  const auto prior_cost = [&](const Validated& one) {
    double sum = 0.0;
    for (const auto& [law, shape] : one.choice.laws) {
      const BalanceLaw& chosen = laws[static_cast<std::size_t>(law)];
      sum += std::log(!chosen.is_ordinary ? kRarePrior / others : chosen.family == LawFamily::friction ? kFrictionPrior : kLoadPrior);
    }
    return sum;
  };
  const auto cost = [&](const Validated& one) { return 0.5 * independent * std::log(one.of_blocks + floor) - prior_cost(one); };
  const Validated& reference = *std::min_element(candidates.begin(), candidates.end(), [&](const Validated& a, const Validated& b) { return cost(a) < cost(b); });
  std::vector<double> odds;  // ln
  for (const Validated& one : candidates) {
    odds.push_back(log_odds(one, reference, floor) + prior_cost(one));
  }
  const LeftOut smooth = smooth_validation(
      regression, {variable_of(records, regression, &BalanceRecord::speed), variable_of(records, regression, &BalanceRecord::position)}, regression.efforts, true);
  const double odds_unknown = std::log(kUnknownPrior) + prior_cost(reference) + log_odds(smooth, reference, kRestShare * alone.of_blocks);
  const double top_odds = std::max(odds_unknown, *std::max_element(odds.begin(), odds.end()));
  double sum = std::exp(odds_unknown - top_odds);
  for (const double one : odds) sum += std::exp(one - top_odds);
  std::vector<double> probability;
  std::vector<double> inclusion(laws.size(), 0.0);  // of each law, over all candidates
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    probability.push_back(std::exp(odds[k] - top_odds) / sum);
    for (const auto& [law, shape] : candidates[k].choice.laws) inclusion[static_cast<std::size_t>(law)] += probability.back();
  }
  answer.probability_unknown = std::exp(odds_unknown - top_odds) / sum;
  const std::size_t top = median_model(candidates, probability, inclusion, 1.0 - answer.probability_unknown);
  const Validated& best = candidates[top];
  const auto [left, gap] = compared(best, alone);
  answer.parameters = gap;
  answer.explained = gap > 0.0 ? 1.0 - left / gap : 0.0;
  answer.independent_count = regression.count / correlation_length(regression, best);
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (k != top && probability[k] < kNegligible) continue;
    BalanceModel model = to_model(regression, laws, candidates[k], answer.independent_count);
    model.probability = probability[k];
    for (std::size_t t = 0; t < model.terms.size(); ++t) model.terms[t].probability = inclusion[static_cast<std::size_t>(candidates[k].choice.laws[t].first)];
    if (k == top) answer.best = model;
    answer.models.push_back(std::move(model));
  }
  for (std::size_t k = 0; k < best.choice.laws.size(); ++k) {
    const auto [without, with] = compared(validate(regression, laws, without_law(best.choice, k), records.size()), best);
    answer.best.terms[k].share = gap > 0.0 ? std::max(0.0, (without - with) / gap) : 0.0;
  }
  BalanceModel stated = answer.best;
  const Validated whole = with_details(regression, laws, best, records.size());
  BalanceModel with = to_model(regression, laws, whole, answer.independent_count);
  take_details(answer.best, with);
  for (BalanceTerm& term : with.details) term.probability = inclusion[static_cast<std::size_t>(chosen_law(laws, term.law)->first)];
  answer.best = std::move(with);
  widen(answer.best, stated);
  // The answer first, though another may be a little likelier than it.
  const auto is_best = [&](const BalanceModel& model) { return model.words() == answer.best.words(); };
  std::stable_sort(answer.models.begin(), answer.models.end(), [&](const BalanceModel& a, const BalanceModel& b) {
    return is_best(a) != is_best(b) ? is_best(a) : a.probability > b.probability;
  });
  answer.models.front() = std::move(stated);
  for (std::size_t l = 0; l < laws.size(); ++l) answer.laws.push_back({laws[l].name, laws[l].words, laws[l].family, inclusion[l]});
  answer.remainder = find_remainder(records, regression, best);
  return answer;
}

Balance balance_of(const std::vector<AxisRecord>& records, double inertia, double top_speed, bool is_rotary) {
  Balance balance;
  for (const AxisRecord& record : records) balance.half_window = std::max(balance.half_window, half_window_of(record, inertia));
  balance.resolved_speed = kResolved * top_speed;
  BalanceScales scales;
  double low = std::numeric_limits<double>::infinity(), high = -low, speed = 0.0, acceleration = 0.0, step = 0.0;
  for (const AxisRecord& record : records) {
    const BalanceRecord one = make_balance_record(record, balance.half_window);
    balance.resolved_speed = std::max(balance.resolved_speed, kNoises * one.speed_noise);
    for (std::size_t n = 0; n < one.speed.size(); ++n) {
      speed += one.speed[n] * one.speed[n];
      acceleration += one.acceleration[n] * one.acceleration[n];
    }
    step = std::max(step, one.step);
    scales.duration = std::max(scales.duration, one.time.back());
    low = std::min(low, *std::min_element(one.position.begin(), one.position.end()));
    high = std::max(high, *std::max_element(one.position.begin(), one.position.end()));
  }
  scales.top_speed = top_speed;
  scales.resolved_speed = balance.resolved_speed;
  scales.middle_position = 0.5 * (low + high);
  scales.half_range = 0.5 * (high - low);
  scales.is_rotary = is_rotary;
  const double motion_time = acceleration > 0.0 ? std::sqrt(speed / acceleration) : 0.0;
  for (const double share : kLateShares) {
    if (share * motion_time > kShortestLate * step) balance.late_times.push_back(share * motion_time);
  }
  scales.late_times = balance.late_times;
  balance.laws = balance_laws(scales);
  return balance;
}

std::vector<BalanceRecord> smoothed(const std::vector<AxisRecord>& records, const Balance& balance) {
  std::vector<BalanceRecord> all;
  for (const AxisRecord& record : records) all.push_back(make_balance_record(record, balance.half_window, balance.late_times));
  return all;
}

FittedSizes refitted(const std::vector<BalanceRecord>& records, const std::vector<BalanceLaw>& laws, const BalanceModel& model,
                      double nominal_inertia, double resolved_speed) {
  const Regression regression = prepared(records, laws, nominal_inertia, resolved_speed);
  Choice choice;
  for (std::size_t l = 0; l < laws.size(); ++l) {
    for (const BalanceTerm& term : model.terms) {
      if (term.law == laws[l].name) choice.laws.emplace_back(static_cast<int>(l), static_cast<std::size_t>(&shape_of(laws, term) - laws[l].shapes.data()));
    }
  }
  const Validated named = validate(regression, laws, choice, records.size());
  const double independent = regression.count / correlation_length(regression, named);
  BalanceModel stated = to_model(regression, laws, named, independent);
  take_details(model, stated);
  const Validated whole = with_details(regression, laws, named, records.size());
  BalanceModel best = to_model(regression, laws, whole, regression.count / correlation_length(regression, whole));
  take_details(model, best);
  widen(best, stated);
  return {std::move(best), std::move(stated), named.is_physical};
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

}  // namespace slewlab::diagnosis
