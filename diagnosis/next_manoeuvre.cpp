#include "diagnosis/next_manoeuvre.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <span>
#include <stdexcept>

#include "diagnosis/evidence.h"
#include "diagnosis/fit.h"
#include "diagnosis/prediction.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kAsGood = 0.99;  // of the best gain

// Chosen: requests from an inching speed to full speed, held from a short touch to a slew with constant speed; the load is seen for a ramp's time
// at the end.
constexpr double kFirstRequest = 0.23, kLastStop = 5.45;  // [ramps]
constexpr double kShortest = 0.3, kLongest = 2.0;         // [ramps]
constexpr std::array<double, 4> kSpeeds{0.15, 0.3, 0.6, 1.0};

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : generator_(seed) {}
  double between(double low, double high) { return low + (high - low) * std::ldexp(static_cast<double>(generator_() >> 11), -53); }
  std::size_t below(std::size_t count) { return std::min(count - 1, static_cast<std::size_t>(between(0.0, static_cast<double>(count)))); }

 private:
  std::mt19937_64 generator_;
};

// Measured signals of two runs, by their difference.
double distance(const Record& one, const Record& other, const Record& like, const std::map<std::string, double, std::less<>>& floors) {
  const FitSettings fit;
  const WhiteningSettings whitening;
  double sum = 0.0;
  std::vector<SignalGap> gaps = signal_gaps(one, other);
  for (const SignalGap& gap : gaps) {
    const double floor = floors.at(gap.unit), share = whitening.discrepancy_share * gap.measured;
    sum += gap.gap * gap.gap / (floor * floor + share * share);
  }
  return fit.independent_share * static_cast<double>(like.size()) * sum;
}

// Without the accelerometers that the record has not.
Record as_recorded(Record run, const Record& like) {
  for (std::size_t a = 0; a < kAccelerometerCount; ++a) {
    if (like.acceleration[a].empty()) run.acceleration[a].clear();
  }
  return run;
}

}  // namespace

std::vector<Manoeuvre> candidate_manoeuvres(int random_ones, std::uint64_t seed) {
  std::vector<Manoeuvre> all = usual_manoeuvres();
  Draw draw(seed);
  for (int k = 0; k < random_ones; ++k) {
    Manoeuvre manoeuvre{fmt::format("drawn {}", k + 1), {}};
    double time = kFirstRequest, last = 0.0;
    while (time < kLastStop) {
      // Stops and moves to either side, a reversal under way among them.
      double speed = draw.between(0.0, 1.0) < 0.3 && last != 0.0 ? 0.0 : kSpeeds[draw.below(kSpeeds.size())] * (draw.between(0.0, 1.0) < 0.5 ? 1.0 : -1.0);
      if (speed == last) speed = -speed;
      manoeuvre.requests.push_back({time, speed});
      last = speed;
      time += draw.between(kShortest, kLongest);
    }
    if (last != 0.0) manoeuvre.requests.push_back({kLastStop, 0.0});
    all.push_back(std::move(manoeuvre));
  }
  return all;
}

double entropy(const std::vector<double>& probability) {
  double sum = 0.0, bits = 0.0;
  for (const double p : probability) sum += p;
  for (const double p : probability) bits -= p > 0.0 ? p / sum * std::log2(p / sum) : 0.0;
  return bits;
}

double expected_gain(const std::vector<double>& probability, const std::vector<std::vector<double>>& distance) {
  const double temper = EvidenceSettings{}.temper;
  double sum = 0.0, gain = 0.0;
  for (const double p : probability) sum += p;
  for (std::size_t i = 0; i < probability.size(); ++i) {
    double alike = 0.0;
    for (std::size_t j = 0; j < probability.size(); ++j) alike += probability[j] / sum * std::exp(-distance[i][j] / (8.0 * temper));
    if (probability[i] > 0.0) gain -= probability[i] / sum * std::log2(alike);
  }
  return gain;
}

NextManoeuvre next_manoeuvre(const std::vector<Hypothesis>& hypotheses, const std::vector<Manoeuvre>& candidates, const Record& like,
                             const std::function<bool()>& is_stopped) {
  if (hypotheses.size() < 2) throw std::invalid_argument("a manoeuvre tells two hypotheses apart, or more");
  std::vector<double> probability;
  for (const Hypothesis& hypothesis : hypotheses) probability.push_back(hypothesis.probability);
  const auto floors = noise_floors(sim::describe(hypotheses[0].machine.crane), hypotheses[0].controller);
  struct Tried {
    double gain = 0.0, apart = 0.0;
    Separation separation;
  };
  std::vector<Tried> tried;
  for (const Manoeuvre& candidate : candidates) {
    std::vector<Record> runs;
    for (const Hypothesis& hypothesis : hypotheses) {
      if (is_stopped && is_stopped()) throw Interrupted{};
      const Record blank = blank_record(candidate, hypothesis.controller, hypothesis.machine.step);
      runs.push_back(as_recorded(predict(hypothesis.machine, hypothesis.controller, blank).series, like));
    }
    std::vector<std::vector<double>> distances(runs.size(), std::vector<double>(runs.size(), 0.0));
    Tried one;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        distances[i][j] = distances[j][i] = distance(runs[i], runs[j], runs[i], floors);
        one.apart += probability[i] * probability[j] * distances[i][j];
      }
    }
    one.gain = expected_gain(probability, distances);
    for (const SignalGap& gap : signal_gaps(runs[0], runs[1])) {
      const double in_floors = gap.gap / floors.at(gap.unit);
      if (in_floors >= one.separation.noise_floors) one.separation = {candidate.name, gap.signal, gap.unit, gap.gap, in_floors};
    }
    tried.push_back(one);
  }
  double best_gain = 0.0;
  for (const Tried& one : tried) best_gain = std::max(best_gain, one.gain);
  std::size_t best = 0;
  for (std::size_t k = 0; k < tried.size(); ++k) {
    const bool is_as_good = tried[k].gain >= kAsGood * best_gain;
    const bool best_is = tried[best].gain >= kAsGood * best_gain;
    if (is_as_good && (!best_is || tried[k].apart > tried[best].apart)) best = k;
  }
  return {candidates[best], tried[best].gain, entropy(probability), hypotheses[0].name, hypotheses[1].name, tried[best].separation};
}

std::string scenario_text(const NextManoeuvre& next, const std::string& crane, const std::string& controller, const controller::ControllerSettings& settings, double plant_step) {
  const double ramp = settings.ramp.acceleration_time;
  const auto quantity = [](double value, const char* unit) { return fmt::format("{{value: {:.4g}, unit: {}, source: slewlab diagnose}}", value, unit); };
  std::string text = fmt::format(
      "kind: scenario\ndescription: >-\n  What tells most about the cause: {:.2f} bits of {:.2f} that are open; {} and {} differ most in the {}.\n\n"
      "crane: {}\ncontroller: {}\n\nduration: {}\nplant_step: {}\ncontroller_period: {}\nseed: {{value: 1, unit: \"-\", source: \"chosen: any\"}}\n\n"
      "telemetry:\n  sensors_period: {}\n  truth_period: {}\n  status_period: {{value: 1, unit: s, source: slewlab diagnose}}\n\noperator:\n",
      next.gain, next.open, next.first, next.second, next.separation.signal, crane, controller, quantity(kManoeuvreDuration * ramp, "s"),
      quantity(1e3 * plant_step, "ms"), quantity(1e3 * settings.period, "ms"), quantity(1e3 * settings.period, "ms"), quantity(1e3 * settings.period, "ms"));
  for (const SpeedRequest& request : next.manoeuvre.requests) {
    text += fmt::format("  - time: {}\n    speed_request: {}\n", quantity(request.time * ramp, "s"), quantity(request.speed, "\"-\""));
  }
  return text;
}

}  // namespace slewlab::diagnosis
