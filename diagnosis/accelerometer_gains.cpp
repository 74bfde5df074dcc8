#include "diagnosis/accelerometer_gains.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>

#include "diagnosis/coordinates.h"
#include "diagnosis/nuisance.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kWide = 2.0;  // deviations that the records leave open, within which a gain may as well be what the file has

bool is_read(const Records& records, sim::SensorPlace place) {
  return std::any_of(records.begin(), records.end(), [&](const Record& record) {
    for (std::size_t a = 0; a < kAccelerometerCount; ++a) {
      if (!record.acceleration[a].empty() && sim::place_named(kAccelerometers<msgs::Sensors>[a].place) == place) return true;
    }
    return false;
  });
}

}  // namespace

std::optional<GainsFit> fit_gains(Problem& problem, const FitResult& without) {
  const std::unique_ptr<Problem> with_gains = same_machine(problem);
  with_gains->records.look_at({problem.records.data(), problem.records.size()});
  with_gains->whitening = problem.whitening;
  std::vector<sim::Parameter>& parameters = with_gains->nuisances.parameters;
  const std::size_t first = parameters.size();
  for (const sim::AccelerometerGain& gain : sim::accelerometer_gains()) {
    if (is_read(problem.records, gain.place)) parameters.push_back(gain.parameter);
  }
  if (parameters.size() == first) return {};
  const auto fit_from = [&](Point start) {
    start.nuisance.insert(start.nuisance.begin() + static_cast<std::ptrdiff_t>(first), parameters.size() - first, 0.0);
    FitResult fit = fit_at(*with_gains, std::move(start));
    settle_to_the_floor(*with_gains, fit, with_gains->settings.rounds);
    conclude(*with_gains, fit);
    return fit;
  };
  Point as_filed = without.point;
  std::fill_n(as_filed.nuisance.begin(), first, 0.0);
  GainsFit result{fit_from(without.point), {}};
  FitResult from_the_file = fit_from(std::move(as_filed));
  if (!(result.fit.cost <= from_the_file.cost)) result.fit = std::move(from_the_file);
  problem.simulations += with_gains->simulations;
  problem.simulation_time += with_gains->simulation_time;
  if (!std::isfinite(result.fit.cost + result.fit.information.sum())) return {};  // beside it some machine could not follow the records at all
  for (std::size_t k = first; k < parameters.size(); ++k) {
    const double spread = parameters[k].spread;
    result.gains.push_back({std::string(parameters[k].name), parameters[k].numbers.front(), 1.0 + spread * result.fit.point.nuisance[k], spread * result.fit.nuisance_deviation[k]});
  }
  return result;
}

double chance_of_gains(const Problem& problem, const GainsFit& gains, const FitResult& other, const EvidenceSettings& settings) {
  const auto cost = [&](const FitResult& fit) {
    double of_sizes = 0.0;
    for (const double x : effect_coordinates(problem.catalogue, fit.point.effects)) of_sizes += effect_prior(x).cost;
    return fit.residual_power + fit.prior - of_sizes + (1.0 + settings.independent_share * fit.information.array()).log().sum();
  };
  return 1.0 / (1.0 + std::exp((cost(gains.fit) - cost(other)) / (2.0 * settings.temper)));
}

bool are_the_answer(const Problem& problem, const GainsFit& gains, std::span<const FitResult* const> others, const EvidenceSettings& settings) {
  constexpr double kSurely = 0.95;  // chance, chosen
  return gains.fit.mean_square <= 1.0 && chance_of_prior(gains.fit.prior, gains.fit.information, settings.independent_share) >= kFarTogether &&
         std::all_of(others.begin(), others.end(), [&](const FitResult* other) { return chance_of_gains(problem, gains, *other, settings) >= kSurely; });
}

sim::CraneParameters with_gains(sim::CraneParameters machine, const std::vector<AccelerometerGain>& gains) {
  for (const AccelerometerGain& one : gains) one.number.of(machine) *= one.gain;
  return machine;
}

std::string in_words(const std::vector<AccelerometerGain>& gains) {
  std::string words;
  for (const AccelerometerGain& one : gains) {
    if (std::fabs(one.gain - 1.0) <= kWide * one.deviation) continue;
    words += fmt::format("{}{} {:.3f} (+-{:.3f})", words.empty() ? "" : ", ", one.name, one.gain, one.deviation);
  }
  return words;
}

}  // namespace slewlab::diagnosis
