// The nominal crane's numbers that are never quite right on a real machine, each with its spread from unit to
// unit. A wrong one imitates a missing effect and the other way round, so every hypothesis is fitted with all
// of them free under their priors.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/effect.h"
#include "common/unit.h"
#include "diagnosis/shadow.h"
#include "sim/model/crane_parameters.h"

namespace slewlab::diagnosis {

// One number of a crane, and where it stands in a crane file.
struct CraneNumber {
  std::string_view section, key;
  common::Unit unit;
  double& (*of)(sim::CraneParameters&);
};

struct Nuisance {
  std::string_view name;
  double spread;                     // [-] one standard deviation of the factor on the nominal values
  std::vector<CraneNumber> numbers;  // that it multiplies
};

// 5 % either way with equal chance is a standard deviation of 5 % / sqrt(3).
inline constexpr double kUnitSpread = 0.05;                     // [-] half range from unit to unit (issue 4)
inline constexpr double kUnitDeviation = kUnitSpread / 1.7320508075688772;  // [-]

const std::vector<Nuisance>& nuisances();

// Behind these, one amount more: by how much the encoders read late, or early, which nobody knows to better than a third
// of a millisecond. Their noise goes through the controller into the torque, so a fit can take some of it away by moving
// one against the other in time (by 0.25 ms and more, docs/diagnosis/method.md); left free here, that favours no cause.
inline constexpr double kLatencyDeviation = 3e-4;        // [s]
inline constexpr double kCoarseLatencyDeviation = 3e-3;  // [s] where counts are coarse, and their noise goes far into the torque
double encoder_latency(const std::vector<double>& amount, double deviation);  // [s]

// Behind that, two amounts of each record: angle and rate of the swing that the load has when the record begins. A crane that
// is measured at work has some, and a swing that is not free is taken for a cause that pushes the load.
inline constexpr double kSwingDeviation = 5e-3;  // [rad], chosen: 0.3 m below 60 m of rope; of the rate as a pendulum's
inline constexpr std::size_t kSwingAmounts = 2;  // per record
Swing swing_at_start(const std::vector<double>& amount, std::size_t record, double rope_length);
// [rad] how far it swings from where the load would hang still.
double swing_reach(const std::vector<double>& amount, std::size_t record);

std::size_t common_nuisance_count();  // of all records together
std::size_t nuisance_count(std::size_t records);

// The nominal crane with every nuisance moved by `amount[k]` standard deviations.
sim::CraneParameters with_nuisances(sim::CraneParameters crane, const std::vector<double>& amount);

// The numbers that differ from the nominal crane's, as sections of a crane file that is laid over it.
std::string parameters_text(const sim::CraneParameters& nominal, const std::vector<double>& amount, std::string_view source);

// -2 ln of a prior, without its constant, and its part in Gauss-Newton steps: half its slope, and a curvature that
// never overshoots.
struct PriorTerm {
  double cost, slope, curvature;
};

// Of amount `z` of nuisance `k`: normal within the spread from unit to unit, with steep walls where that ends.
PriorTerm nuisance_prior(std::size_t k, double z);

// Whether nuisance `k` is what the effect itself says of the machine: beside "the rope is longer", the rope's length is not
// free as well.
bool is_said_by(const common::EffectAbout& effect, std::size_t k);

// Of an effect's parameter, `x` standard deviations from its centre: Student's with 2 degrees of freedom. How large an effect is
// on a machine is known by orders of magnitude at best.
PriorTerm effect_prior(double x);

}  // namespace slewlab::diagnosis
