// Draws the withheld machines: kind, effects and their sizes, unit-to-unit spread, manoeuvres. Everything follows
// from seed, number of cases and the case's number.
//
// Seeds below 1000 serve tuning, from 1000 on scoring. They never mix: who draws must say which purpose it is for.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "diagnosis/evaluation/law.h"
#include "sim/machine/description.h"

namespace slewlab::diagnosis::withheld {

enum class Purpose { kTune, kScore };
const char* name_of(Purpose purpose);
inline constexpr std::uint64_t kFirstScoringSeed = 1000;
// Throws std::invalid_argument where the seed serves the other purpose.
void check_seed(std::uint64_t seed, Purpose purpose);

enum class Kind { kNothing, kParameters, kOneEffect, kTwoEffects, kLeftOut, kNoCatalogue };
const char* name_of(Kind kind);
Kind kind_named(const std::string& name);

// The machine that the cases differ from.
struct NominalMachine {
  sim::MachineDescription description;
  controller::ControllerSettings controller;
  LawScales scales;
};
// Throws std::invalid_argument where the machine has no scales.
NominalMachine nominal_machine(const sim::MachineDescription& description, const controller::ControllerSettings& controller);

// When recorders are switched on: before anything moves, with the drives already on, or under way.
enum class Begin { kAtRest, kDrivesOn, kInMotion, kAny };
const char* name_of(Begin begin);
Begin begin_named(const std::string& name);  // throws std::invalid_argument

inline constexpr std::size_t kDiagnosedManoeuvres = 2;  // of the three, the first ones

struct DrawnLaw {
  std::string law;
  double size = 0.0;
};
struct DrawnCase {
  int number = 0;  // from 1
  Kind kind = Kind::kNothing;
  std::vector<DrawnLaw> laws;
  // Effects that the diagnosis is run without: the true one where it is left out, any other one in an eighth of the
  // other cases, so that leaving out says nothing.
  std::vector<std::string> without;
  std::vector<double> spread;  // factor per parameter of the nominal machine's description
  std::uint64_t law_seed = 0;  // of what the laws draw themselves
  std::array<Manoeuvre, 3> manoeuvres;  // a, b, unseen
  std::array<double, 3> record_from{};  // [s] when the recorder is switched on; unseen is recorded from the beginning
  std::array<std::uint64_t, 3> noise_seeds{};
};

// All cases of one set. Kinds in proportion: nothing 15 %, parameters 15 %, one effect 40 %, two 15 %, left out of
// the catalogue 7.5 %, in no catalogue 7.5 %; every effect that suits the machine is drawn equally often (within one).
// Sizes are multiples of the machine's scales (law_scales.h), speeds shares of its top speed, and times are stretched
// with its controller's ramp. Parameters spread evenly, with the deviation that the description gives them.
std::vector<DrawnCase> draw_cases(int count, std::uint64_t seed, const NominalMachine& nominal,
                                  Begin begin = Begin::kAtRest);

// The case with the sizes of its laws halved so many times, where they are drawn from a range.
DrawnCase halved(DrawnCase drawn, int times);

// The nominal crane with the case's spread.
sim::CraneParameters spread_crane(const DrawnCase& drawn, const NominalMachine& nominal);

// The machine of a case with those of its laws that are `on`, each as it is with all of them; true sizes, in their order, to `sizes`.
TruthMachine build(const DrawnCase& drawn, const NominalMachine& nominal, const std::vector<bool>& on,
                   std::vector<std::vector<TrueSize>>* sizes = nullptr);

}  // namespace slewlab::diagnosis::withheld
