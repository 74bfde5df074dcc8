#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <string_view>

#include "diagnosis/evaluation/body.h"
#include "diagnosis/evaluation/law.h"
#include "sim/model/boom.h"

namespace slewlab::diagnosis::withheld {

namespace {

constexpr double kPi = std::numbers::pi;

std::vector<TrueSize> vessel_roll(TruthMachine& machine, double size, Random& random) {
  const double period = machine.scales.wave_time * random.between(3.36, 8.39);  // [s] thesis 1.1: 6 to 15 s, for a reach of 31 m
  const double phase = random.between(-kPi, kPi), second_phase = random.between(-kPi, kPi);
  const double direction = random.between(-kPi, kPi);
  const double height = machine.scales.machine.reach * random.between(0.319, 0.958);  // [m]
  // Two neighbouring periods, as in a swell; the second one with a quarter of the amplitude.
  const auto lateral = [=](double time, double z, double slew_angle) {
    double sum = 0.0;
    for (const auto& [amplitude, omega, at] :
         {std::array{size, 2.0 * kPi / period, phase}, std::array{0.25 * size, 2.6 * kPi / period, second_phase}}) {
      const double roll = amplitude * std::sin(omega * time + at);
      sum += sim::kGravity * std::sin(roll) + z * omega * omega * roll;
    }
    return sum * std::sin(direction - slew_angle);
  };
  const double rise = sim::boom_point(machine.crane.boom, 1.0).height;
  const double rope = machine.crane.load.rope_length;
  machine.forces.push_back({{}, {}, [=](const Scene& scene, const double*, sim::ReferenceForces& forces, double*) {
    const double t = scene.motion.time, angle = scene.motion.house_angle;
    add_body_force(scene, lateral(t, height + 0.5 * rise, angle), lateral(t, height + rise - rope, angle), forces);
  }});
  machine.sensors.emplace_back([=](double t, const SensorValues& truth, SensorValues& seen) {
    const double angle = truth.slew_angle;
    const auto share = [](std::string_view place) { return place == "middle" ? 0.5 : place == "tip" ? 1.0 : 0.0; };  // of the boom's rise
    for (const auto& sensor : kAccelerometers<SensorValues>) seen.*sensor.value -= lateral(t, height + share(sensor.place) * rise, angle);
  });
  return {{"amplitude", size}, {"period", period}, {"phase", phase, false}, {"direction", direction, false},
          {"height", height, false}};
}

// Kaimal's spectrum, S(n) ~ 1 / (1 + 1.5 n T)^(5/3), as a sum of sines at uneven frequencies.
std::vector<TrueSize> gusts(TruthMachine& machine, double size, Random& random) {
  constexpr int kSines = 60;
  const double mean = machine.scales.wind_speed * random.between(0.116, 0.348);  // [m/s]
  const double direction = random.between(-kPi, kPi);
  const double stretch = machine.scales.stretch;
  const double time_scale = stretch * random.log_between(3.0, 20.0);  // [s]
  const double boom_area = machine.scales.boom_area, load_area = machine.scales.load_area;  // [m^2]
  std::vector<std::array<double, 3>> sines;
  double square = 0.0;
  for (int k = 0; k < kSines; ++k) {
    const double width = std::pow(2.0 / 0.005, 1.0 / kSines);
    const double low = 0.005 / stretch * std::pow(width, k);  // [Hz]
    const double frequency = random.log_between(low, low * width);
    const double power = low * (width - 1.0) / std::pow(1.0 + 1.5 * frequency * time_scale, 5.0 / 3.0);
    square += power;
    sines.push_back({std::sqrt(2.0 * power), 2.0 * kPi * frequency, random.between(-kPi, kPi)});
  }
  for (auto& sine : sines) sine[0] *= size / std::sqrt(square);
  machine.forces.push_back({{}, {}, [=](const Scene& scene, const double*, sim::ReferenceForces& forces, double*) {
    double gust = 0.0;
    for (const auto& [amplitude, omega, phase] : sines) gust += amplitude * std::sin(omega * scene.motion.time + phase);
    const double wind = mean + gust;
    const double pressure = 0.5 * kAirDensity * (wind * std::fabs(wind) - mean * mean) *
                            std::sin(direction - scene.motion.house_angle);
    forces.uniform_force += boom_area / scene.crane.boom.length * pressure;
    forces.load_force += load_area * pressure;
  }});
  return {{"deviation", size},
          {"mean_speed", mean, false},
          {"direction", direction, false},
          {"correlation_time", time_scale, false},
          {"boom_drag_area", boom_area, false},
          {"load_drag_area", load_area, false}};
}

std::vector<TrueSize> encoder_quantisation(TruthMachine& machine, double size, Random& random) {
  machine.counting.resolution = size;
  machine.counting.window = kBaseStep * std::round(random.log_between(3.0, 12.0));
  return {{"resolution", size}, {"window", machine.counting.window, false}};
}

std::vector<TrueSize> encoder_ripple(TruthMachine& machine, double size, Random& random) {
  GroupArray phase{};
  for (double& p : phase) p = random.between(-kPi, kPi);
  machine.encoder.emplace_back([=](double, GroupArray& position) {
    for (std::size_t i = 0; i < position.size(); ++i) {
      const double turn = position[i] + phase[i];
      position[i] += size * (std::sin(turn) - std::sin(phase[i]) + 0.2 * std::sin(2.0 * turn));
    }
  });
  return {{"amplitude", size}, {"phase", phase[0], false}};
}

std::vector<TrueSize> encoder_scale(TruthMachine& machine, double size, Random& random) {
  const double error = size * random.sign();
  machine.encoder.emplace_back([error](double, GroupArray& position) {
    for (double& p : position) p *= 1.0 + error;
  });
  return {{"error", error}};
}

// Samples of one base step each, answered at any age between them.
template <class Sample>
class Past {
 public:
  explicit Past(std::size_t longest) : longest_(longest) {}
  void push(const Sample& sample) {
    samples_.push_front(sample);
    if (samples_.size() > longest_) samples_.pop_back();
  }
  const Sample& at(std::size_t age) const { return samples_[std::min(age, samples_.size() - 1)]; }

 private:
  std::size_t longest_;
  std::deque<Sample> samples_;
};

std::vector<TrueSize> encoder_delay(TruthMachine& machine, double size, Random&) {
  // 70 % latency, the rest the middle of a moving mean.
  struct Delay {
    double delay;
    Past<GroupArray> past{400};
    GroupArray between(double age) const {
      const double steps = age / kBaseStep;
      const auto whole = static_cast<std::size_t>(steps);
      const double share = steps - std::floor(steps);
      GroupArray mixed{};
      for (std::size_t i = 0; i < mixed.size(); ++i) {
        mixed[i] = past.at(whole)[i] + share * (past.at(whole + 1)[i] - past.at(whole)[i]);
      }
      return mixed;
    }
    void operator()(double, GroupArray& position) {
      constexpr int kPoints = 5;
      past.push(position);
      GroupArray sum{};
      for (int k = 0; k < kPoints; ++k) {
        const double age = delay * (0.7 + 0.6 * k / (kPoints - 1));
        const GroupArray one = between(age);
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += one[i] / kPoints;
      }
      position = sum;
    }
  };
  machine.encoder.emplace_back(Delay{.delay = size});
  return {{"delay", size}};
}

std::vector<TrueSize> clock_drift(TruthMachine& machine, double size, Random& random) {
  const double phase = random.between(-kPi, kPi);
  struct Drift {
    double drift, phase, stretch;
    Past<SensorValues> past{1100};
    void operator()(double time, const SensorValues&, SensorValues& seen) {
      past.push(seen);
      const double warmth = 40.0 * stretch;  // [s] the crystal's temperature goes up and down
      const double lag = std::min(1.0, drift * (time + stretch + 0.1 * warmth / (2.0 * kPi) *
                                                                (std::sin(2.0 * kPi * time / warmth + phase) - 1.0)));
      const double steps = std::max(0.0, lag) / kBaseStep;
      const auto whole = static_cast<std::size_t>(steps);
      const double share = steps - std::floor(steps);
      const SensorValues &newer = past.at(whole), &older = past.at(whole + 1);
      for (const auto& sensor : msgs::kSensorFields<SensorValues>) {
        seen.*sensor.value = newer.*sensor.value + share * (older.*sensor.value - newer.*sensor.value);
      }
    }
  };
  machine.sensors.emplace_back(Drift{.drift = size, .phase = phase, .stretch = machine.scales.stretch});
  return {{"drift", size}};
}

std::vector<TrueSize> command_delay(TruthMachine& machine, double size, Random& random) {
  const double phase = random.between(-kPi, kPi);
  struct Delay {
    double delay, phase;
    Past<GroupArray> past{400};
    void operator()(double time, std::int64_t, GroupArray& torque) {
      past.push(torque);
      // The bus's cycle beats against the controller's.
      const double steps = delay / kBaseStep * (1.0 + 0.1 * std::sin(2.0 * kPi * 0.3 * time + phase));
      const auto whole = static_cast<std::size_t>(steps);
      const double share = steps - std::floor(steps);
      for (std::size_t i = 0; i < torque.size(); ++i) {
        torque[i] = past.at(whole)[i] + share * (past.at(whole + 1)[i] - past.at(whole)[i]);
      }
    }
  };
  machine.wire.emplace_back(Delay{.delay = size, .phase = phase});
  return {{"delay", size}};
}

std::vector<TrueSize> command_jitter(TruthMachine& machine, double size, Random& random) {
  struct Jitter {
    double spread;
    Random random;
    std::deque<std::pair<double, GroupArray>> under_way{};
    std::int64_t newest = -1;
    GroupArray arrived{};
    void operator()(double time, std::int64_t sequence, GroupArray& torque) {
      if (sequence != newest) {
        newest = sequence;
        // Two hops of equal spread; a message does not overtake.
        double at = time + 0.5 * spread * (random.uniform() + random.uniform());
        if (!under_way.empty()) at = std::max(at, under_way.back().first);
        under_way.emplace_back(at, torque);
      }
      while (!under_way.empty() && under_way.front().first <= time) {
        arrived = under_way.front().second;
        under_way.pop_front();
      }
      torque = arrived;
    }
  };
  machine.wire.emplace_back(Jitter{.spread = size, .random = Random(random.bits(), "jitter")});
  return {{"spread", size, false}};
}

std::vector<TrueSize> command_loss(TruthMachine& machine, double size, Random& random) {
  // Gilbert's channel: good and bad stretches; in a bad one everything is lost.
  constexpr double kMeanBurst = 25.0;  // [messages]
  struct Loss {
    double into_bad, out_of_bad;
    Random random;
    bool bad = false;
    std::int64_t newest = -1;
    GroupArray held{};
    void operator()(double, std::int64_t sequence, GroupArray& torque) {
      if (sequence != newest) {
        newest = sequence;
        bad = bad ? random.uniform() >= out_of_bad : random.uniform() < into_bad;
      }
      if (!bad) held = torque;
      torque = held;
    }
  };
  const double out = 1.0 / kMeanBurst;
  machine.wire.emplace_back(Loss{
      .into_bad = out * size / (1.0 - size), .out_of_bad = out, .random = Random(random.bits(), "loss")});
  return {{"probability", size, false}};
}

double of_wind_speed(const LawScales& s) { return s.wind_speed; }

}  // namespace

std::vector<Law> wire_laws() {
  return {
      {"swell", "vessel_roll", "environment", "two neighbouring periods, sine of the roll", 2e-4, 0.03, pure_number,
       vessel_roll, {}, Needs::boom},
      {"kaimal_gusts", "gusts", "environment", "Kaimal's spectrum", 0.00387, 0.116, of_wind_speed, gusts, {}, Needs::boom},
      {"coarse_counts", "encoder_quantisation", "sensor", "edges at an unknown phase", 0.002, 0.05, pure_number,
       encoder_quantisation},
      {"eccentric_encoder", "encoder_ripple", "sensor", "a second harmonic of 20 %, each group its own phase", 5e-4,
       0.05, pure_number, encoder_ripple},
      {"wrong_scale", "encoder_scale", "sensor", "on the counts; the drive makes the speed of them", 0.001, 0.1,
       pure_number, encoder_scale},
      {"late_encoder", "encoder_delay", "sensor", "partly a moving mean", 0.00262, 0.0524, of_period, encoder_delay},
      {"warm_clock", "clock_drift", "sensor", "the drift itself wanders by 10 %", 3e-5, 6e-3, pure_number, clock_drift},
      {"beating_bus", "command_delay", "wire", "wanders by 10 %", 0.00393, 0.0524, of_period, command_delay},
      {"two_hops", "command_jitter", "wire", "two hops instead of one", 0.00787, 0.0787, of_period, command_jitter},
      {"bursts_of_loss", "command_loss", "wire", "lost in bursts of 25", 0.03, 0.8, pure_number, command_loss},
  };
}

}  // namespace slewlab::diagnosis::withheld
