#include "diagnosis/evaluation/draw.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/effects/catalogue.h"

namespace slewlab::diagnosis::withheld {

const char* name_of(Purpose purpose) { return purpose == Purpose::kTune ? "tune" : "score"; }

void check_seed(std::uint64_t seed, Purpose purpose) {
  const Purpose belongs = seed < kFirstScoringSeed ? Purpose::kTune : Purpose::kScore;
  if (belongs == purpose) return;
  throw std::invalid_argument("seed " + std::to_string(seed) + " is for \"" + name_of(belongs) + "\", not for \"" +
                              name_of(purpose) + "\": seeds below 1000 tune, from 1000 on they score");
}

namespace {

constexpr std::array<const char*, 6> kKindNames{"nothing", "parameters", "one effect", "two effects", "left out",
                                                "no catalogue"};
constexpr std::array<double, 6> kKindShares{0.15, 0.15, 0.40, 0.15, 0.075, 0.075};

bool is_of_every_machine(const std::string& effect) {
  const sim::EffectDescription* const description = sim::find_effect(effect);  // nothing of the controller's
  return description != nullptr && description->about.of_every_machine;
}

}  // namespace

const char* name_of(Kind kind) { return kKindNames[static_cast<std::size_t>(kind)]; }

Kind kind_named(const std::string& name) {
  for (std::size_t k = 0; k < kKindNames.size(); ++k) {
    if (name == kKindNames[k]) return static_cast<Kind>(k);
  }
  throw std::invalid_argument("no kind of case is called \"" + name + "\"");
}

NominalMachine nominal_machine(const sim::MachineDescription& description, const controller::ControllerSettings& controller) {
  return {description, controller, law_scales(description.machine, controller)};
}

namespace {

constexpr std::array<const char*, 4> kBeginNames{"rest", "on", "motion", "any"};

}  // namespace

const char* name_of(Begin begin) { return kBeginNames[static_cast<std::size_t>(begin)]; }

Begin begin_named(const std::string& name) {
  for (std::size_t k = 0; k < kBeginNames.size(); ++k) {
    if (name == kBeginNames[k]) return static_cast<Begin>(k);
  }
  throw std::invalid_argument("a record begins \"rest\", \"on\", \"motion\" or \"any\", not \"" + name + "\"");
}

namespace {

// The manoeuvres, with times for a ramp of kWrittenForRamp.

// Slew to one side and back, with a pause; 30 s.
Manoeuvre there_and_back(Random& random) {
  const double direction = random.sign();
  const double first = random.between(0.6, 1.0), second = random.between(0.6, 1.0);
  Manoeuvre manoeuvre;
  const double turn = random.between(10.5, 12.5);
  const double back = turn + random.between(5.0, 6.5);
  manoeuvre.requests = {{random.between(0.8, 1.5), direction * first},
                        {turn, 0.0},
                        {back, -direction * second},
                        {back + random.between(7.0, 8.5), 0.0}};
  manoeuvre.duration = 30.0;
  return manoeuvre;
}

// Inching: short moves to and fro; 30 s.
Manoeuvre inching(Random& random) {
  Manoeuvre manoeuvre;
  double time = random.between(0.8, 1.5);
  double direction = random.sign();
  while (time < 24.0) {
    manoeuvre.requests.push_back({time, direction * random.between(0.25, 0.7)});
    time += random.between(1.2, 2.6);
    manoeuvre.requests.push_back({time, 0.0});
    time += random.between(1.0, 2.8);
    if (random.uniform() < 0.6) direction = -direction;
  }
  manoeuvre.duration = 30.0;
  return manoeuvre;
}

// One longer slew with a change of speed on the way; 32 s.
Manoeuvre longer_slew(Random& random) {
  const double direction = random.sign();
  Manoeuvre manoeuvre;
  const double change = random.between(8.0, 11.0);
  manoeuvre.requests = {{random.between(0.8, 1.5), direction * random.between(0.4, 0.65)},
                        {change, direction * random.between(0.8, 1.0)},
                        {change + random.between(8.0, 10.0), 0.0}};
  manoeuvre.duration = 32.0;
  return manoeuvre;
}

// The same for a machine whose ramp is slower or faster.
Manoeuvre stretched(Manoeuvre manoeuvre, double stretch) {
  for (Request& request : manoeuvre.requests) request.time *= stretch;
  manoeuvre.duration *= stretch;
  return manoeuvre;
}

// When the recorder is switched on: with the drives on, late before the first request; in motion, up to a ramp after it.
double drawn_record_from(const Manoeuvre& manoeuvre, Begin begin, double ramp_time, Random& random) {
  const double first = manoeuvre.requests.front().time;
  const double share = random.uniform();
  const Begin one = begin == Begin::kAny ? static_cast<Begin>(random.below(3)) : begin;
  if (one == Begin::kDrivesOn) return first * (0.75 + 0.2 * share);
  if (one == Begin::kInMotion) return first + ramp_time * (0.2 + 0.8 * share);
  return 0.0;
}

// Names in equal numbers, in random order.
std::vector<std::string> dealt(std::vector<std::string> names, std::size_t count, Random& random) {
  std::vector<std::string> all;
  while (all.size() < count) {
    random.shuffle(names);
    all.insert(all.end(), names.begin(), names.end());
  }
  all.resize(count);
  return all;
}

// [SI] Evenly in the logarithm, from `from` of the range on.
double drawn_size(const Law& law, const LawScales& scales, double from, Random& random) {
  const double unit = law.unit(scales);
  if (law.low == law.high) return law.low * unit;
  return law.low * std::pow(law.high / law.low, random.between(from, 1.0)) * unit;
}

}  // namespace

std::vector<DrawnCase> draw_cases(int count, std::uint64_t seed, const NominalMachine& nominal, Begin begin) {
  // Kinds in proportion, largest remainders first, then shuffled.
  std::vector<Kind> kinds;
  std::array<double, 6> given{};
  for (int n = 1; n <= count; ++n) {
    std::size_t most = 0;
    for (std::size_t k = 1; k < given.size(); ++k) {
      if (kKindShares[k] * n - given[k] > kKindShares[most] * n - given[most] + 1e-12) most = k;
    }
    given[most] += 1.0;
    kinds.push_back(static_cast<Kind>(most));
  }
  Random order(seed, "order");
  order.shuffle(kinds);

  std::vector<std::string> in_catalogue, outside;
  for (const Law& law : laws()) {
    if (!suits(law, nominal.description.machine, nominal.controller)) continue;
    if (!law.effect.empty() && is_of_every_machine(law.effect)) continue;  // no cause
    (law.effect.empty() ? outside : in_catalogue).push_back(law.name);
  }
  const auto many = static_cast<std::size_t>(count);
  Random deal(seed, "deal");
  const std::vector<std::string> ones = dealt(in_catalogue, many, deal);
  const std::vector<std::string> pairs = dealt(in_catalogue, 2 * many, deal);
  const std::vector<std::string> left_out = dealt(in_catalogue, many, deal);
  const std::vector<std::string> others = dealt(outside, many, deal);
  std::size_t one = 0, pair = 0, left = 0, other = 0;

  std::vector<DrawnCase> cases;
  for (int n = 1; n <= count; ++n) {
    DrawnCase drawn;
    drawn.number = n;
    drawn.kind = kinds[static_cast<std::size_t>(n - 1)];
    Random sizes(seed, "size", static_cast<std::uint64_t>(n));
    const auto add = [&](const std::string& name, double from) {
      drawn.laws.push_back({name, drawn_size(law_named(name), nominal.scales, from, sizes)});
    };
    switch (drawn.kind) {
      case Kind::kNothing:
      case Kind::kParameters:
        break;
      case Kind::kOneEffect:
        add(ones[one++], 0.0);
        break;
      case Kind::kTwoEffects: {
        // Both from the larger half, so that neither drowns in the other.
        const std::string& first = pairs[pair++];
        add(first, 0.5);
        while (pairs[pair] == first) ++pair;
        add(pairs[pair++], 0.5);
        break;
      }
      case Kind::kLeftOut:
        add(left_out[left++], 0.3);
        break;
      case Kind::kNoCatalogue:
        add(others[other++], 0.3);
        break;
    }
    Random decoy(seed, "decoy", static_cast<std::uint64_t>(n));
    if (drawn.kind == Kind::kLeftOut) {
      drawn.without = {law_named(drawn.laws[0].law).effect};
    } else if (decoy.uniform() < 0.125) {
      const std::string& effect = law_named(in_catalogue[decoy.below(in_catalogue.size())]).effect;
      const bool is_true = std::any_of(drawn.laws.begin(), drawn.laws.end(),
                                       [&](const DrawnLaw& law) { return law_named(law.law).effect == effect; });
      if (!is_true) drawn.without = {effect};
    }
    Random spread(seed, "spread", static_cast<std::uint64_t>(n));
    for (const sim::Parameter& parameter : nominal.description.parameters) {
      const double half_range = std::sqrt(3.0) * parameter.spread;  // of an even distribution of this deviation
      double factor = spread.between(1.0 - half_range, 1.0 + half_range);
      for (const DrawnLaw& law : drawn.laws) {
        const std::vector<std::string>& own = law_named(law.law).own;
        if (std::find(own.begin(), own.end(), parameter.name) != own.end()) factor = 1.0;
      }
      drawn.spread.push_back(drawn.kind == Kind::kNothing ? 1.0 : factor);
    }
    Random moves(seed, "manoeuvre", static_cast<std::uint64_t>(n));
    drawn.manoeuvres = {there_and_back(moves), inching(moves), longer_slew(moves)};
    Random switched_on(seed, "begin", static_cast<std::uint64_t>(n));
    for (std::size_t m = 0; m < drawn.manoeuvres.size(); ++m) {
      drawn.manoeuvres[m] = stretched(std::move(drawn.manoeuvres[m]), nominal.scales.stretch);
      if (m < kDiagnosedManoeuvres) drawn.record_from[m] = drawn_record_from(drawn.manoeuvres[m], begin, nominal.scales.ramp_time, switched_on);
    }
    Random noise(seed, "noise", static_cast<std::uint64_t>(n));
    for (std::uint64_t& noise_seed : drawn.noise_seeds) noise_seed = noise.bits();
    drawn.law_seed = Random(seed, "law", static_cast<std::uint64_t>(n)).bits();
    cases.push_back(std::move(drawn));
  }
  return cases;
}

DrawnCase halved(DrawnCase drawn, int times) {
  for (DrawnLaw& one : drawn.laws) {
    const Law& law = law_named(one.law);
    if (law.low != law.high) one.size = std::ldexp(one.size, -times);
  }
  return drawn;
}

sim::CraneParameters spread_crane(const DrawnCase& drawn, const NominalMachine& nominal) {
  sim::CraneParameters crane = nominal.description.machine;
  const std::vector<sim::Parameter>& parameters = nominal.description.parameters;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    for (const sim::FileNumber& number : parameters[k].numbers) number.of(crane) *= drawn.spread[k];
  }
  return crane;
}

TruthMachine build(const DrawnCase& drawn, const NominalMachine& nominal, const std::vector<bool>& on,
                   std::vector<std::vector<TrueSize>>* sizes) {
  TruthMachine machine = make_truth_machine(spread_crane(drawn, nominal), nominal.controller);
  machine.scales = nominal.scales;
  for (std::size_t k = 0; k < drawn.laws.size(); ++k) {
    if (!on[k]) continue;
    Random random(drawn.law_seed, drawn.laws[k].law, k);
    std::vector<TrueSize> values = law_named(drawn.laws[k].law).apply(machine, drawn.laws[k].size, random);
    if (sizes != nullptr) sizes->push_back(std::move(values));
  }
  return machine;
}

}  // namespace slewlab::diagnosis::withheld
