#include "tests/diagnosis/balance/drawn_axis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <sstream>
#include <utility>

namespace slewlab::diagnosis {
namespace {

constexpr double kPi = std::numbers::pi;

// Everything in units of the axis: top speed 1, rated effort 1, seconds.
struct Physics {
  double inertia = 0.5;  // [s] to top speed with the rated effort
  std::function<double(double t, double q, double v)> dry = [](double, double, double) { return 0.0; };       // >= 0, against the motion
  std::function<double(double t, double q, double v)> smooth = [](double, double, double) { return 0.0; };    // against the motion where it is positive
  double dry_asymmetry = 0.0;
  double bristle_stiffness = 0.0;  // > 0: the dry part is a LuGre bristle of g(v) = dry
  std::function<double(double t)> inertia_factor = [](double) { return 1.0; };
  // Motor and load apart: share of the inertia at the load, frequency [Hz], play.
  double load_share = 0.0, frequency = 0.0, damping = 0.03, play = 0.0;
  double torque_lag = 0.0, torque_delay = 0.0;  // [s]
};

struct Recorder {
  double rate = 100.0;             // [Hz]
  double counts = 1e-5;            // position per count
  double noise = 0.0;
  double duration = 20.0, skip = 0.0;
  double torque_constant = 1.0;    // recorded over true
  bool is_measured = false;        // torque behind lag, with noise
  double torque_noise = 0.0;
};

enum class Excitation { switched, steps, chirp, multisine, positioning, speed_profile };
constexpr const char* kExcitationNames[] = {"switched", "steps", "chirp", "multisine", "positioning", "speed profile"};

class Numbers {
 public:
  explicit Numbers(unsigned seed) : generator_(seed) {}
  // Not of <random>'s distributions, whose numbers are the library's own.
  double uniform(double low, double high) { return low + (high - low) * (static_cast<double>(generator_() >> 11) * 0x1.0p-53); }
  double logarithmic(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
  double normal() { return std::sqrt(-2.0 * std::log(uniform(1e-300, 1.0))) * std::cos(uniform(0.0, 2.0 * kPi)); }
  bool chance(double share) { return uniform(0.0, 1.0) < share; }
  std::size_t below(std::size_t count) { return std::min(count - 1, static_cast<std::size_t>(uniform(0.0, static_cast<double>(count)))); }
  double sign() { return chance(0.5) ? 1.0 : -1.0; }

 private:
  std::mt19937_64 generator_;
};

// A driver of the axis: torque from time and what it measures, at 1 kHz.
struct Driver {
  std::function<double(double t, double q, double v)> torque;
};

Driver make_driver(Excitation excitation, const Physics& physics, double range, Numbers& draw, double duration) {
  const double J = physics.inertia;
  switch (excitation) {
    case Excitation::switched: {
      // Torque switched at random, turned where the axis gets too fast or too far.
      struct State { double until = -1.0, level = 0.0; int side = 1; };
      auto state = std::make_shared<State>();
      const double strength = draw.uniform(0.4, 0.9), dwell = draw.uniform(0.4, 1.5);
      auto numbers = std::make_shared<Numbers>(static_cast<unsigned>(draw.uniform(0.0, 4e9)));
      return {[=](double t, double q, double v) {
        if (t >= state->until) {
          state->side = -state->side;
          state->level = strength * numbers->uniform(0.4, 1.0) * state->side;
          state->until = t + dwell * numbers->uniform(0.5, 1.6);
        }
        if ((v > 0.9 && state->level > 0.0) || (v < -0.9 && state->level < 0.0) || (std::fabs(q) > range && q * state->level > 0.0)) {
          state->level = -state->level;
          state->side = state->level > 0 ? 1 : -1;
        }
        return state->level;
      }};
    }
    case Excitation::steps: {
      // From rest, a constant torque for some seconds, then another; open loop.
      std::vector<double> levels;
      for (int k = 0; k < 8; ++k) levels.push_back(draw.uniform(0.15, 0.7) * (k % 2 == 0 ? 1.0 : -1.0));
      auto turned = std::make_shared<double>(1.0);
      return {[=](double t, double, double v) {
        const double level = levels[static_cast<std::size_t>(t / (duration / 8.0)) % levels.size()];
        if (v * *turned * level > 0.95) *turned = -*turned;
        return level * *turned;
      }};
    }
    case Excitation::chirp: {
      const double amplitude = draw.uniform(0.5, 0.9), low = 0.15 / std::max(0.3, J), high = draw.uniform(2.0, 5.0) / std::max(0.3, J);
      return {[=](double t, double q, double v) {
        const double phase = 2.0 * kPi * (low * t + 0.5 * (high - low) * t * t / duration);
        return amplitude * std::cos(phase) - 0.05 * v - 0.02 * std::clamp(q / std::max(range, 1e-9), -3.0, 3.0);
      }};
    }
    case Excitation::multisine: {
      std::vector<std::array<double, 3>> waves;
      for (int k = 0; k < 5; ++k) waves.push_back({draw.uniform(0.1, 0.3), draw.logarithmic(0.1, 1.2) / std::max(0.3, J), draw.uniform(0.0, 2.0 * kPi)});
      return {[=](double t, double q, double) {
        double sum = -0.05 * std::clamp(q / std::max(range, 1e-9), -3.0, 3.0);
        for (const auto& [a, f, p] : waves) sum += a * std::sin(2.0 * kPi * f * t + p);
        return sum;
      }};
    }
    case Excitation::positioning:
    case Excitation::speed_profile: {
      // A reference of moves with trapezoidal speed, a cascade with a gain that nobody knows.
      struct State { double until = -1.0, from = 0.0, to = 0.0, start = 0.0, integral = 0.0, speed = 0.0; };
      auto state = std::make_shared<State>();
      auto numbers = std::make_shared<Numbers>(static_cast<unsigned>(draw.uniform(0.0, 4e9)));
      const double bandwidth = draw.uniform(8.0, 30.0), position_gain = 0.25 * bandwidth * draw.uniform(0.3, 0.8);
      const bool of_position = excitation == Excitation::positioning;
      const double hardest = draw.uniform(0.4, 0.8) / std::max(J, 1e-9), fastest = draw.uniform(0.4, 0.9);
      return {[=](double t, double q, double v) {
        constexpr double kPeriod = 1e-3;
        if (t >= state->until) {
          state->start = t;
          state->from = state->to;
          state->to = range * numbers->uniform(-1.0, 1.0);
          const double length = std::fabs(state->to - state->from);
          state->speed = fastest * numbers->uniform(0.1, 1.0);
          state->until = t + length / state->speed + state->speed / hardest + numbers->uniform(0.05, 0.5);
        }
        const double length = std::fabs(state->to - state->from), side = state->to > state->from ? 1.0 : -1.0;
        const double top = std::min(state->speed, std::sqrt(length * hardest)), ramp = top / hardest, cruise = std::max(0.0, length / std::max(top, 1e-12) - ramp);
        const double into = t - state->start;
        double wish = 0.0, place = length;
        if (into < ramp) { wish = hardest * into; place = 0.5 * hardest * into * into; }
        else if (into < ramp + cruise) { wish = top; place = 0.5 * top * ramp + top * (into - ramp); }
        else if (into < 2 * ramp + cruise) { const double left = 2 * ramp + cruise - into; wish = hardest * left; place = length - 0.5 * hardest * left * left; }
        const double speed = side * wish + (of_position ? position_gain * (state->from + side * place - q) : 0.5 * (state->from + side * place - q));
        const double error = speed - v;
        state->integral = std::clamp(state->integral + error * kPeriod * bandwidth * bandwidth * J * 0.3, -0.8, 0.8);
        return std::clamp(J * bandwidth * error + state->integral, -1.4, 1.4);
      }};
    }
  }
  return {};
}

struct Samples {
  std::vector<double> position, torque;
};

Samples integrate(const Physics& physics, const Driver& driver, const Recorder& recorder, unsigned seed) {
  Numbers noise(seed);
  const double h = std::min(1e-4, 0.1 / recorder.rate);
  const auto finer = static_cast<int>(std::lround(1.0 / (recorder.rate * h)));
  const double step = 1.0 / (recorder.rate * finer);
  const auto control = std::max(1, static_cast<int>(std::lround(1e-3 / step)));
  const bool is_two = physics.load_share > 0.0;
  const double w = 2.0 * kPi * physics.frequency;
  double q = 0.0, v = 0.0, ql = 0.0, vl = 0.0, z = 0.0, lagged = 0.0, command = 0.0;
  std::vector<double> history;
  const auto late = static_cast<std::size_t>(physics.torque_delay / step);
  Samples samples;
  const auto total = static_cast<long>((recorder.duration + recorder.skip) / step);
  for (long n = 0; n < total; ++n) {
    const double t = static_cast<double>(n) * step;
    if (n % control == 0) command = driver.torque(t, q, v);
    double arriving = command;
    if (late > 0) {
      history.push_back(command);
      arriving = history.size() > late ? history[history.size() - 1 - late] : 0.0;
    }
    lagged = physics.torque_lag > 0.0 ? lagged + (arriving - lagged) * (1.0 - std::exp(-step / physics.torque_lag)) : arriving;
    if (n % finer == 0 && t >= recorder.skip) {
      const double seen = q + recorder.noise * noise.normal();
      samples.position.push_back(recorder.counts > 0.0 ? recorder.counts * std::floor(seen / recorder.counts) : seen);
      samples.torque.push_back(recorder.torque_constant * ((recorder.is_measured ? lagged : command) + recorder.torque_noise * noise.normal()));
    }
    const double J = physics.inertia * physics.inertia_factor(t);
    const double Jm = is_two ? physics.inertia * (1.0 - physics.load_share) : J;
    double drive = lagged - physics.smooth(t, q, v), level = physics.dry(t, q, v);
    double shaft = 0.0;
    if (is_two) {
      const double Jl = J * physics.load_share, k = w * w * Jm * Jl / (Jm + Jl), d = 2.0 * physics.damping * std::sqrt(k * Jm * Jl / (Jm + Jl));
      const double twist = q - ql, gap = 0.5 * physics.play;
      if (twist > gap) shaft = std::max(0.0, k * (twist - gap) + d * (v - vl));
      else if (twist < -gap) shaft = std::min(0.0, k * (twist + gap) + d * (v - vl));
      vl += step * shaft / Jl;
      ql += step * vl;
      drive -= shaft;
    }
    level *= 1.0 + physics.dry_asymmetry * (v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : 0.0);
    if (physics.bristle_stiffness > 0.0 && level > 0.0) {
      const double rate = std::fabs(v) * physics.bristle_stiffness / level, steady = v != 0.0 ? std::copysign(level / physics.bristle_stiffness, v) : z;
      z = v != 0.0 ? steady + (z - steady) * std::exp(-rate * step) : z;
      v += step / Jm * (drive - physics.bristle_stiffness * z);
    } else {
      const double free = v + step / Jm * drive, hold = step / Jm * level;
      v = std::fabs(free) <= hold ? 0.0 : free - std::copysign(hold, free);
    }
    q += step * v;
  }
  return samples;
}

NamedRun run_of(const Samples& samples, const Recorder& recorder, const std::string& name, double length, double force) {
  NamedRun named{name, {}};
  for (std::size_t n = 0; n < samples.position.size(); ++n) {
    msgs::Encoder encoder{};
    encoder.sequence = static_cast<std::int64_t>(n);
    encoder.simulated_time = std::llround(static_cast<double>(n) / recorder.rate * 1e9);
    encoder.group_count = 1;
    encoder.shaft_position = {samples.position[n] * length};
    encoder.shaft_speed = {0.0};
    named.run.encoder.push_back(encoder);
    msgs::Torque torque{};
    torque.sequence = torque.answered_sequence = encoder.sequence;
    torque.simulated_time = encoder.simulated_time;
    torque.group_count = 1;
    torque.motor_torque = {samples.torque[n] * force};
    named.run.torque.push_back(torque);
  }
  return named;
}

// An axis on its way from its kind to its records.
struct Drawing {
  DrawnAxis axis;
  Physics physics;
  Recorder recorder;
  Excitation excitation = Excitation::switched;
  double nominal_error = 0.0;  // of the inertia, true over the file's, less 1
  double range = 0.0;          // that the motion covers either side
  double dry = 0.0, viscous = 0.0;
  bool is_linear = false;
  double length = 1.0, force = 1.0;  // units of position and effort
};

// Rate, duration, inertia, manoeuvre, and how far the file is off.
Drawing draw_excitation(const std::string& kind, Numbers& draw) {
  Drawing drawing;
  Recorder& recorder = drawing.recorder;
  constexpr double kRates[] = {50.0, 100.0, 150.0, 250.0, 500.0, 1000.0, 5000.0};
  recorder.rate = kRates[draw.below(7)];
  recorder.duration = recorder.rate > 2000.0 ? draw.uniform(6.0, 9.0) : draw.uniform(12.0, 25.0);
  drawing.physics.inertia = std::max(draw.logarithmic(0.15, 1.2), 15.0 / recorder.rate);
  drawing.excitation = static_cast<Excitation>(draw.below(6));
  const bool is_gravity = kind == "gravity" || kind == "spring";
  if (is_gravity && draw.chance(0.7)) drawing.excitation = draw.chance(0.5) ? Excitation::positioning : Excitation::speed_profile;
  const double inertia_off = draw.chance(0.6) ? draw.uniform(-0.05, 0.05) : draw.uniform(0.2, 0.5) * draw.sign();
  drawing.nominal_error = kind == "nothing" ? draw.uniform(-0.03, 0.03) : kind == "inertia" ? draw.uniform(0.25, 0.5) * draw.sign() : inertia_off;
  drawing.range = draw.uniform(0.5, 2.0) * drawing.physics.inertia + 0.3;
  return drawing;
}

// Dry and viscous friction, which most kinds have.
void take_both_frictions(Drawing& drawing) {
  drawing.physics.dry = [dry = drawing.dry](double, double, double) { return dry; };
  drawing.physics.smooth = [viscous = drawing.viscous](double, double, double v) { return viscous * v; };
  drawing.axis.laws = {"dry", "viscous"};
}

void draw_asymmetric(Numbers& draw, Drawing& drawing) {
  take_both_frictions(drawing);
  drawing.physics.dry_asymmetry = draw.uniform(0.1, 0.25) * draw.sign();
  const double lean = draw.uniform(0.1, 0.25) * draw.sign();
  drawing.physics.smooth = [=, viscous = drawing.viscous](double, double, double v) { return viscous * (1.0 + (v > 0 ? lean : -lean)) * v; };
  drawing.axis.alike.insert("offset");
}

void draw_offset(Numbers& draw, Drawing& drawing) {
  take_both_frictions(drawing);
  const double constant = draw.uniform(0.04, 0.15) * draw.sign();
  drawing.physics.smooth = [=, viscous = drawing.viscous](double, double, double v) { return viscous * v + constant; };
  drawing.axis.laws.insert("offset");
}

void draw_stribeck(Numbers& draw, Drawing& drawing) {
  take_both_frictions(drawing);
  const double excess = drawing.dry * draw.uniform(0.3, 1.0), speed = draw.logarithmic(0.02, 0.2), power = draw.chance(0.5) ? 2.0 : 1.0;
  drawing.physics.dry = [=, dry = drawing.dry](double, double, double v) { return dry + excess * std::exp(-std::pow(std::fabs(v) / speed, power)); };
  drawing.axis.laws.insert("stribeck");
}

void draw_rising(Numbers& draw, Drawing& drawing) {
  const double rise = draw.uniform(0.1, 0.3), speed = draw.logarithmic(0.05, 0.4), floor = draw.chance(0.5) ? 0.0 : 0.4 * drawing.dry;
  const bool is_arc = draw.chance(0.5);
  drawing.physics.dry = [=](double, double, double) { return floor; };
  drawing.physics.smooth = [=](double, double, double v) { return rise * (is_arc ? std::atan(v / speed) / (0.5 * kPi) : std::tanh(v / speed)); };
  drawing.axis.laws = {"rising"};
  drawing.axis.alike.insert({"dry", "viscous"});
}

// A power of speed between one and two, with dry friction.
void draw_drag(Numbers& draw, Drawing& drawing) {
  take_both_frictions(drawing);
  const double power = draw.uniform(1.3, 1.7);
  drawing.physics.smooth = [=, viscous = drawing.viscous](double, double, double v) { return viscous * std::copysign(std::pow(std::fabs(v), power), v); };
  drawing.axis.laws = {"dry"};
  drawing.axis.alike.insert({"viscous", "quadratic"});
}

void draw_warming(Numbers& draw, Drawing& drawing) {
  take_both_frictions(drawing);
  const double fall = drawing.dry * draw.uniform(0.5, 1.0), time = drawing.recorder.duration * draw.uniform(0.2, 1.0);
  drawing.physics.dry = [=, dry = drawing.dry](double t, double, double) { return dry + fall * std::exp(-t / time); };
  drawing.axis.laws.insert("warming");
}

void draw_spring(Numbers& draw, Drawing& drawing) {
  take_both_frictions(drawing);
  const double stiffness = draw.uniform(0.1, 0.3) / drawing.range;
  drawing.physics.smooth = [=, viscous = drawing.viscous](double, double q, double v) { return viscous * v + stiffness * q; };
  drawing.axis.laws.insert("spring");
  drawing.axis.alike.insert("offset");  // its middle is the axis's zero, the law's that of the range
}

void draw_uneven(Numbers& draw, Drawing& drawing) {
  take_both_frictions(drawing);
  const double lean = draw.uniform(0.3, 0.8) * draw.sign();
  drawing.physics.dry = [=, dry = drawing.dry, range = drawing.range](double, double q, double) { return dry * std::max(0.1, 1.0 + lean * q / range); };
  drawing.axis.laws.insert("position_friction");
}

void draw_three(Numbers& draw, Drawing& drawing) {
  take_both_frictions(drawing);
  const double constant = draw.uniform(0.04, 0.15) * draw.sign(), excess = drawing.dry * draw.uniform(0.5, 1.0), speed = draw.logarithmic(0.03, 0.2);
  drawing.physics.dry = [=, dry = drawing.dry](double, double, double v) { return dry + excess * std::exp(-std::pow(std::fabs(v) / speed, 2)); };
  drawing.physics.smooth = [=, viscous = drawing.viscous](double, double, double v) { return viscous * v + constant; };
  drawing.axis.laws.insert({"stribeck", "offset"});
  drawing.nominal_error = draw.uniform(0.2, 0.5) * draw.sign();
}

void draw_elastic(Numbers& draw, Drawing& drawing) {
  take_both_frictions(drawing);
  drawing.physics.load_share = draw.uniform(0.2, 0.6);
  drawing.physics.frequency = draw.logarithmic(8.0, 40.0);
}

void draw_cogging(Numbers& draw, Drawing& drawing) {
  take_both_frictions(drawing);
  const double size = draw.uniform(0.1, 0.25), waves = draw.uniform(3.0, 12.0) / drawing.range;
  drawing.physics.smooth = [=, viscous = drawing.viscous](double, double q, double v) { return viscous * v + size * std::sin(waves * q + 0.3); };
}

// What is in no catalogue: a torque of time alone that is another one in each record, a load that shifts, ...
constexpr const char* kUnknownKinds[] = {"cogging", "cam", "shift", "mass_shift"};

void draw_laws(const std::string& kind, Numbers& draw, Drawing& drawing) {
  drawing.dry = draw.uniform(0.05, 0.2);
  drawing.viscous = draw.uniform(0.08, 0.35);
  drawing.physics.dry_asymmetry = draw.uniform(-0.05, 0.05);
  using Law = std::function<void(Numbers&, Drawing&)>;
  static const std::map<std::string, Law> kLaws{
      {"nothing", [](Numbers&, Drawing& axis) { axis.physics.dry_asymmetry = 0.0; }},
      {"inertia", [](Numbers&, Drawing& axis) { axis.physics.dry_asymmetry = 0.0; }},
      {"dry", [](Numbers&, Drawing& axis) { take_both_frictions(axis); axis.physics.smooth = Physics{}.smooth; axis.axis.laws = {"dry"}; }},
      {"viscous", [](Numbers&, Drawing& axis) { take_both_frictions(axis); axis.physics.dry = Physics{}.dry; axis.axis.laws = {"viscous"}; }},
      {"asymmetric", draw_asymmetric}, {"offset", draw_offset}, {"stribeck", draw_stribeck},
      {"lugre", [](Numbers& numbers, Drawing& axis) { draw_stribeck(numbers, axis); axis.physics.bristle_stiffness = axis.dry / numbers.logarithmic(1e-4, 3e-3); }},
      {"rising", draw_rising}, {"drag", draw_drag},
      {"quadratic", [](Numbers&, Drawing& axis) {
         take_both_frictions(axis);
         axis.physics.smooth = [viscous = axis.viscous](double, double, double v) { return 1.3 * viscous * v * std::fabs(v); };
         axis.axis.laws = {"dry", "quadratic"};
       }},
      {"warming", draw_warming},
      {"gravity", [](Numbers&, Drawing& axis) { take_both_frictions(axis); axis.axis.laws.insert("gravity"); }},
      {"spring", draw_spring}, {"uneven", draw_uneven},
      {"late", [](Numbers& numbers, Drawing& axis) {
         take_both_frictions(axis);
         axis.physics.torque_lag = std::max(numbers.logarithmic(0.02, 0.08), 3.0 / axis.recorder.rate);
         axis.axis.laws.insert("lag");
       }},
      {"three", draw_three}, {"elastic", draw_elastic},
      {"play", [](Numbers& numbers, Drawing& axis) { draw_elastic(numbers, axis); axis.physics.play = numbers.logarithmic(1e-3, 1e-2) * axis.range; }},
      {"cogging", draw_cogging}};
  const auto law = kLaws.find(kind);
  if (law == kLaws.end()) take_both_frictions(drawing);
  else law->second(draw, drawing);
  std::set<std::string>& alike = drawing.axis.alike;
  // Dry friction with a value of its own in each direction is a constant torque as well.
  if (drawing.axis.laws.contains("dry") || kind == "shift") alike.insert("offset");
  drawing.axis.is_unknown = std::find(std::begin(kUnknownKinds), std::end(kUnknownKinds), kind) != std::end(kUnknownKinds);
  if (drawing.axis.is_unknown) alike.insert({"dry", "viscous"});
}

// Drives and recorders as they are, and the units.
void draw_recorder(const std::string& kind, Numbers& draw, Drawing& drawing) {
  Physics& physics = drawing.physics;
  Recorder& recorder = drawing.recorder;
  const double range = drawing.range;
  if (kind != "late" && draw.chance(0.5)) physics.torque_lag = draw.logarithmic(0.5e-3, 4e-3);
  if (draw.chance(0.2)) physics.torque_delay = draw.uniform(0.5, 2.0) * 1e-3;
  recorder.counts = draw.chance(0.3) ? range * draw.logarithmic(2e-4, 1e-3) : range * draw.logarithmic(1e-6, 5e-5);
  recorder.noise = draw.chance(0.4) ? recorder.counts * draw.uniform(0.2, 1.0) : 0.0;
  recorder.torque_constant = draw.chance(0.3) && kind != "nothing" && kind != "inertia" ? draw.uniform(0.9, 1.1) : 1.0;
  recorder.is_measured = kind != "late" && draw.chance(0.3);
  recorder.torque_noise = recorder.is_measured ? draw.uniform(0.003, 0.02) : 0.0;
  recorder.skip = draw.chance(0.3) ? draw.uniform(1.0, 3.0) : 0.0;
  drawing.is_linear = kind != "gravity" && draw.chance(0.4);
  drawing.length = drawing.is_linear ? draw.logarithmic(0.05, 2.0) : kind == "gravity" ? 1.5 / range * draw.uniform(0.7, 1.6) : draw.logarithmic(0.3, 300.0);
  drawing.force = draw.logarithmic(1e-2, 1e4);
  if (kind == "gravity") {
    const double weight = draw.uniform(0.15, 0.4), angle = draw.uniform(-kPi, kPi);
    physics.smooth = [=, viscous = drawing.viscous, length = drawing.length](double, double q, double v) { return viscous * v + weight * std::sin(q * length + angle); };
    drawing.axis.alike.insert("offset");
  }
}

// The axis as it is in one record.
Physics draw_in_one_record(const std::string& kind, Numbers& draw, const Drawing& drawing) {
  const Recorder& recorder = drawing.recorder;
  Physics own = drawing.physics;
  const auto base = drawing.physics.smooth;
  if (kind == "cam") {
    const double size = draw.uniform(0.15, 0.3), f = draw.uniform(0.2, 1.0), p = draw.uniform(0.0, 2.0 * kPi);
    own.smooth = [=](double t, double q, double v) { return base(t, q, v) + size * std::sin(2.0 * kPi * f * t + p); };
  }
  if (kind == "shift") {
    const double size = draw.uniform(0.15, 0.3) * draw.sign(), at = recorder.skip + recorder.duration * draw.uniform(0.25, 0.75);
    own.smooth = [=](double t, double q, double v) { return base(t, q, v) + (t > at ? size : 0.0); };
  }
  if (kind == "mass_shift") {
    const double more = draw.uniform(0.6, 1.0), at = recorder.skip + recorder.duration * draw.uniform(0.3, 0.7);
    own.inertia_factor = [=](double t) { return t > at ? 1.0 + more : 1.0; };
  }
  return own;
}

void draw_runs(const std::string& kind, Numbers& draw, Drawing& drawing) {
  const Recorder& recorder = drawing.recorder;
  constexpr int kFitted = 2;
  constexpr const char* kNames[] = {"a", "b", "unseen"};
  for (int r = 0; r < kFitted + 1; ++r) {
    const Physics own = draw_in_one_record(kind, draw, drawing);
    const Driver driver = make_driver(drawing.excitation, own, drawing.range, draw, recorder.duration + recorder.skip);
    const Samples samples = integrate(own, driver, recorder, static_cast<unsigned>(draw.uniform(1.0, 4e9)));
    NamedRun run = run_of(samples, recorder, kNames[r], drawing.length, drawing.force);
    (r < kFitted ? drawing.axis.runs : drawing.axis.unseen).push_back(std::move(run));
  }
}

std::string file_of(const Drawing& drawing) {
  const bool is_linear = drawing.is_linear;
  const double inertia = drawing.physics.inertia * drawing.force / drawing.length / (1.0 + drawing.nominal_error);
  std::ostringstream file;
  file.precision(17);
  file << "kind: axis\ncoordinate: {value: " << (is_linear ? "linear" : "rotary") << ", source: drawn}\n"
       << (is_linear ? "mass" : "inertia") << ": {value: " << inertia << ", unit: " << (is_linear ? "kg" : "kg m^2") << ", source: drawn}\n"
       << (is_linear ? "rated_force" : "rated_torque") << ": {value: " << drawing.force << ", unit: " << (is_linear ? "N" : "N m") << ", source: drawn}\n"
       << "top_speed: {value: " << drawing.length << ", unit: " << (is_linear ? "m/s" : "rad/s") << ", source: drawn}\n";
  return file.str();
}

std::string conditions_of(const Drawing& drawing) {
  const Recorder& recorder = drawing.recorder;
  std::ostringstream said;
  said.precision(3);
  said << recorder.rate << " Hz, " << kExcitationNames[static_cast<int>(drawing.excitation)] << (recorder.is_measured ? ", measured torque" : "")
       << (recorder.torque_constant != 1.0 ? ", torque constant off" : "") << ", lag " << 1e3 * drawing.physics.torque_lag << " ms, delay "
       << 1e3 * drawing.physics.torque_delay << " ms, inertia off " << 100 * drawing.nominal_error << " %, counts " << recorder.counts / drawing.range
       << " of the range" << (recorder.skip > 0 ? ", begun in motion" : "");
  return said.str();
}

}  // namespace

const std::vector<std::string>& drawn_kinds() {
  static const std::vector<std::string> kinds{"nothing",  "inertia",   "dry",       "dry_viscous", "asymmetric", "viscous",    "offset",
                                              "stribeck", "lugre",     "rising",    "drag",        "quadratic",  "warming",    "gravity",
                                              "spring",   "uneven",    "late",      "three",       "elastic",    "play",       "cogging",
                                              "cam",      "shift",     "mass_shift"};
  return kinds;
}

DrawnAxis drawn_axis(const std::string& kind, unsigned seed) {
  unsigned mixed = seed * 2654435761u;
  for (const char letter : kind) mixed = mixed * 31u + static_cast<unsigned>(letter);
  Numbers draw(mixed);
  Drawing drawing = draw_excitation(kind, draw);
  drawing.axis.kind = kind;
  draw_laws(kind, draw, drawing);
  draw_recorder(kind, draw, drawing);
  draw_runs(kind, draw, drawing);
  drawing.axis.machine = file_of(drawing);
  drawing.axis.conditions = conditions_of(drawing);
  return std::move(drawing.axis);
}

}  // namespace slewlab::diagnosis
