// The nominal machine's numbers that are never quite right on a real one: the parameters of its description, each with its spread
// from unit to unit, and what nobody knows of a record. A wrong one imitates a missing effect and the other way round, so every
// hypothesis is fitted with all of them free under their priors.
//
// A point's nuisance parameters, in standard deviations: the parameters; the encoders' latency; where commands came between the rows (hidden_commands.h), by how much they act ahead; of each record angle and rate of the load's
// swing at its beginning, where the machine has a load; where each motor stands between its flanks then; and where some record begins in
// motion, angle and rate of the load's rod, amplitudes and rates of the lowest modes of the boom, and for the effects that know of it (EffectAbout::swings_outwards)
// angle and rate of the load's swing along the boom. Those of a record that begins at rest
// change nothing. The encoders' noise goes through the controller into the torque, so a fit can
// take some of it away by moving one against the other in time; free here, that favours no cause. A swing that is not free is taken for
// a cause that pushes the load.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/effect.h"
#include "diagnosis/shadow.h"
#include "sim/machine/description.h"
#include "sim/model/crane_parameters.h"

namespace slewlab::diagnosis {

// What may swing and ring when a record begins: the load a little, of a machine that has not moved before; else load, rod and boom, at rest behind moves, or in motion and with the boom bent by what
// presses the gears.
enum class RecordBegins { unmoved, at_rest, in_motion };

struct Nuisances {
  std::vector<sim::Parameter> parameters;
  double latency_deviation = 0.0;  // [s] of the encoders: late, or early
  double lead_deviation = 0.0;     // [s] of commands between the rows: how much earlier they act; 0: none came
  double rope_length = 0.0;        // [m] of the nominal machine; 0: no load that swings
  std::size_t offset_groups = 0;   // motor groups whose place at a record's beginning is free
  double offset_deviation = 0.0;   // [rad] of it, on the slew axis
  double swing_behind_moves = 0.0;  // [rad] deviation of the load's swing where the machine has moved before
  double outward_swing = 0.0;  // [rad] of the load's swing along the boom there; 0: no effect of the diagnosis knows of it
  bool has_motion = false;         // the machine has moved before some record of the diagnosis
  std::vector<RecordBegins> begins;  // of these records; fewer than records: the others on an unmoved machine

  std::size_t common_count() const { return parameters.size() + 1 + (lead_deviation > 0.0 ? 1 : 0); }  // of all records together
  std::size_t swing_amounts() const { return rope_length > 0.0 ? 2 : 0; }  // per record
  std::size_t motion_amounts() const { return has_motion ? swing_amounts() + 2 * kBeginningBends + outward_amounts() : 0; }
  std::size_t outward_amounts() const { return outward_swing > 0.0 ? swing_amounts() : 0; }
  std::size_t per_record() const { return swing_amounts() + offset_groups + motion_amounts(); }
  // Whether the `part`-th of a record's is the load's swing along the boom: the last ones of motion.
  bool is_outward(std::size_t part) const { return has_motion && part + outward_amounts() >= per_record(); }
  RecordBegins begin_of(std::size_t record) const { return record < begins.size() ? begins[record] : RecordBegins::unmoved; }
  std::size_t count(std::size_t records) const { return common_count() + per_record() * records; }
};
Nuisances nuisances_of(const sim::MachineDescription& machine, double latency_deviation);

double encoder_latency(const Nuisances& nuisances, const std::vector<double>& amount);  // [s]
double command_lead(const Nuisances& nuisances, const std::vector<double>& amount);     // [s]

inline constexpr double kSwingDeviation = 5e-3;  // [rad], chosen: a two-hundredth of the rope's length; of the rate as a pendulum's
// Chosen: of the rod's angle where the machine has moved before the record, as of a swing at rest; of the bends, a fifth of what the rated torque bends.
inline constexpr double kBendDeviation = 0.2;  // [-]
Beginning beginning_of(const Nuisances& nuisances, const std::vector<double>& amount, std::size_t record);
// [rad] how far it swings from where the load would hang still.
double swing_reach(const Nuisances& nuisances, const std::vector<double>& amount, std::size_t record);

// The nominal machine with every parameter moved by `amount[k]` standard deviations.
sim::CraneParameters with_nuisances(const Nuisances& nuisances, sim::CraneParameters machine, const std::vector<double>& amount);

struct AmountInterval {
  double low = 0.0, high = 0.0;  // [standard deviations] 90 %
};

// The numbers that differ from the nominal machine's, as sections of a file that is laid over its own, each with its interval where there is one.
std::string parameters_text(const Nuisances& nuisances, const sim::CraneParameters& nominal, const std::vector<double>& amount,
                            std::span<const AmountInterval> intervals, std::string_view source);

// -2 ln of a prior, without its constant, and its part in Gauss-Newton steps: half its slope, and a curvature that
// never overshoots.
struct PriorTerm {
  double cost, slope, curvature;
};

// Where a parameter's spread from unit to unit ends: 1.73 standard deviations are the 5 %; a little more for what mesh and step make wrong.
inline constexpr double kSpreadEnds = 2.0;  // [standard deviations]

// Of amount `z` of nuisance `k`: normal; of a parameter within its spread from unit to unit, with a steep cost where that ends.
PriorTerm nuisance_prior(const Nuisances& nuisances, std::size_t k, double z);

// A parameter of the machine's file as a fit has it, beyond the range of machines of one make.
struct FarParameter {
  std::string name;
  double change = 0.0;  // [-] relative to the file's
};
// The farthest ones first, a few at most.
std::vector<FarParameter> far_parameters(const Nuisances& nuisances, const std::vector<double>& amount);
// "drive inertia +15 %, boom angle +6 %"
std::string in_words(const std::vector<FarParameter>& far);

// A parameter of the machine's file that the records put elsewhere.
struct MovedParameter {
  std::string name;
  double change = 0.0, low = 0.0, high = 0.0;  // [-] relative to the file's; 90 %
};
// Those at least 2 % off, by twice what the interval leaves open: of many parameters some are off by chance by as much as that, and another law or gain moves some by a per cent. The surest first.
std::vector<MovedParameter> moved_parameters(const Nuisances& nuisances, const std::vector<double>& amount, std::span<const AmountInterval> intervals);

// Whether nuisance `k` is what the effect itself says of the machine: beside "the rope is longer", the rope's length is not
// free as well.
bool is_said_by(const Nuisances& nuisances, const common::EffectAbout& effect, std::size_t k);

// Whether the effect says of the machine what some parameter stands for that has gone beyond its spread.
bool says_what_is_beyond(const Nuisances& nuisances, const common::EffectAbout& effect, const std::vector<double>& amount);

// Of an effect's parameter, `x` standard deviations from its centre: Student's with 2 degrees of freedom. How large an effect is
// on a machine is known by orders of magnitude at best.
PriorTerm effect_prior(double x);

}  // namespace slewlab::diagnosis
