// What an effect says about itself, whichever side of the wire it acts on: name, physics in one line, parameters with
// unit, bounds and prior, and the traits by which generic code knows it; no code knows an effect by its name.
// sim/effects and controller/effects add how it acts.
//
// An effect is described once, for machines of every size: the numbers of its parameters are multiples of scales of the
// machine. catalogue_for() makes of them the numbers of one machine, and those are what everything else reads.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/input_error.h"
#include "common/unit.h"

namespace slewlab::common {

struct YamlNode;

enum class Subsystem { drive, house, boom, load, environment, sensor, wire, controller };

std::string_view name_of(Subsystem subsystem);

enum class ParameterScale { linear, logarithmic };

// Of a machine, or of a controller: what the numbers of a parameter are multiples of. On a linear axis [rad] reads [m]
// and [Nm] reads [N]. Where a machine has no such scale, its value is 0.
enum class ScaleOf {
  one,                // [-] what is the same on every machine: shares, factors, angles round a circle
  time,               // [s] from rest to top speed with the rated torque
  swing_time,         // [s] sqrt(reach / g): of waves, gusts and pendulums
  motor_torque,       // [Nm] rated, of one motor
  drive_torque,       // [Nm] the most of motor_torque that the machine's own drive lets one motor have
  motor_speed,        // [rad/s] of a motor at the axis's top speed
  axis_torque,        // [Nm] rated, of all motors
  axis_speed,         // [rad/s] top speed
  axis_angle,         // [rad] axis_speed * time
  axis_damping,       // [Nm s/rad] axis_torque / axis_speed
  gear_stiffness,     // [Nm/rad] of all gearboxes together, on the axis
  gearbox_stiffness,  // [Nm/rad] of one gearbox on its outgoing shaft
  gear_windup,        // [rad] axis_torque / gear_stiffness
  length,             // [m] reach
  velocity,           // [m/s] reach * axis_speed
  wind_speed,         // [m/s] sqrt(g * reach): goes with lengths and times, not with the drive
  mass,               // [kg] axis_inertia / reach^2
  force,              // [N] axis_torque / reach
  lateral_stiffness,  // [N/m] mass / time^2
  lateral_damping,    // [N s/m] mass / time
  drag_area,          // [m^2] on which a wind of wind_speed makes the force
};
inline constexpr std::size_t kScaleCount = static_cast<std::size_t>(ScaleOf::drag_area) + 1;

// As a page names it: "axis torque".
std::string_view name_of(ScaleOf scale);

// The scales' values for one machine, in SI.
struct EffectScales {
  std::array<double, kScaleCount> value{1.0};
  double& operator[](ScaleOf scale) { return value[static_cast<std::size_t>(scale)]; }
  double operator[](ScaleOf scale) const { return value[static_cast<std::size_t>(scale)]; }
};

// One number of an effect: in a law's own description a multiple of the scale `per`, in a machine's catalogue in SI. Where the effect fades out as the number goes to some value, that value
// is `absent` (it may be infinite, outside the bounds); numbers that only shape the effect have none.
//
// Prior: Student's t with 2 degrees of freedom, (1 + x^2 / 3)^(-3/2), cut at the bounds; x is the distance over
// `prior_scale` from `absent`, or `typical` where there is no finite absent value. Logarithmic: of ln(value / centre).
struct EffectParameter {
  std::string_view name;
  Unit unit = Unit::none;
  ScaleOf per = ScaleOf::one;
  std::string_view meaning;
  double lower = 0.0;
  double upper = 0.0;
  double typical = 0.0;  // a size that is clearly visible
  double prior_scale = 0.0;
  ParameterScale scale = ParameterScale::linear;
  std::optional<double> absent;
  // Other values than `typical` from which a diagnosis starts to look, where a fit only converges from nearby.
  std::vector<double> tries = {};
  // A detail of the law that a diagnosis fits once the effect is found, but does not look for.
  bool detail = false;
  // An angle of the axis after which friction comes again: a diagnosis starts to look where the missing torque says so as well.
  bool recurs = false;
};

// An angle that may be any: a phase or a direction, -pi ... pi.
EffectParameter angle_parameter(std::string_view name, std::string_view meaning, double typical = 0.0);

// An effect that begins at its parameter `begin` and, fading within `fade`, ends `duration` later: to first order in
// its size it is one that begins there and never ends, less another one that begins `duration` - `fade` later.
struct Spell {
  std::string_view begin, duration, fade;
};

// Known by its statistics only: a law that draws numbers.
struct Stochastic {
  double power_exponent = 2.0;  // its power goes with its size to this power: amplitudes squared, a lost share as it is
};

// What acts late by a fixed time, the effect's size [s], and is otherwise unchanged.
enum class PureDelay { none, encoder, command };

// What a record itself shows to the digit, so that the size is read off it and never fitted.
enum class ReadOff { none, encoder_counts };

// Laws of one physics, of which a record may tell the family before it tells the member.
enum class Family { none, friction, delay, play, elasticity, mass, gravity, wind, ripple };

std::string_view name_of(Family family);

// What a machine has, and what an effect needs of it.
struct MachineParts {
  bool gears = false;          // elastic, with teeth that may have play
  bool boom = false;           // or anything that reaches out from a turning axis
  bool flexible_boom = false;
  bool load = false;           // on a rope
  bool pinion_teeth = false;   // their number is known
  bool gearbox_teeth = false;  // the same, of the gearboxes' first stage
  int groups = 1;              // motor groups, at least
};

// "" where `has` is all of `needs`, else what is not there: "a boom and a load".
std::string missing_parts(const MachineParts& needs, const MachineParts& has);

// An effect switched on, values in the order of its parameters, in SI.
struct EffectInstance {
  std::string name;
  std::vector<double> values;
};

class EffectValues;

struct EffectAbout {
  std::string_view name;
  Subsystem subsystem = Subsystem::drive;
  std::string_view physics;
  std::vector<EffectParameter> parameters = {};  // the first is the effect's size
  std::optional<Spell> spell = std::nullopt;
  // Its size and its one angle are an arrow's length and direction: what it does is smooth in the arrow's two components, of which an angle far off is no large step.
  bool is_arrow = false;
  // Two angles that may be any enter as two sines multiplied (a roll's phase and direction), not each in its own place.
  bool angles_multiply = false;
  MachineParts needs = {};
  Family family = Family::none;
  std::optional<Stochastic> stochastic = std::nullopt;
  bool acts_late = false;  // delays or lags what it acts on; a stochastic one does so on the average
  PureDelay pure_delay = PureDelay::none;
  ReadOff read_off = ReadOff::none;
  // Parameters of the machine (sim/machine/description.h, by name) of which the size is a factor: while the effect is
  // fitted they are not free as well.
  std::vector<std::string_view> stands_for = {};
  // Every machine does it, and a linear model leaves it out: no cause, but a part of the machine where the records show it.
  bool of_every_machine = false;
  // Between a command and the motor's torque: it does not show where that torque was measured.
  bool before_torque = false;
  // The effects that together are this one where it has nothing of its own, with their values by its.
  std::vector<EffectInstance> (*parts)(const EffectValues& values) = nullptr;
  // What it does grows with the motion, on a machine that stands as well as on one that turns: such an effect answers to the sensors' noise as the rest of the machine does.
  bool linear = false;
  // Has the load's swing outwards, of which the machine's state knows nothing: where a record begins on a machine that has moved, it swings already.
  bool swings_outwards = false;
};

inline constexpr std::size_t kSize = 0;  // index of an effect's size among its parameters

// Whether the effect acts the other way round with its size turned: on both sides of where it is absent.
bool size_turns_sign(const EffectAbout& about);

// Throws std::out_of_range where the effect has no such parameter: a slip in the program.
std::size_t index_of(const EffectAbout& about, std::string_view parameter);

// The effect with its numbers in SI.
EffectAbout in_units_of(const EffectAbout& law, const EffectScales& scales);

// Values by the names of their parameters: what a law is started with.
class EffectValues {
 public:
  EffectValues(const EffectAbout& about, const std::vector<double>& values) : about_(about), values_(values) {}
  double operator[](std::string_view parameter) const { return values_[index_of(about_, parameter)]; }

 private:
  const EffectAbout& about_;
  const std::vector<double>& values_;
};

// The effects that suit one machine, or one controller, with their numbers in its units.
struct EffectCatalogue {
  struct Unsuited {
    std::string_view name;
    std::string missing;  // as missing_parts() says it
  };
  std::vector<EffectAbout> effects;
  std::vector<Unsuited> unsuited;

  const EffectAbout* find(std::string_view name) const;     // nullptr where it has none of the name
  const EffectAbout& at(std::string_view name) const;       // throws std::invalid_argument, with the reason
};

EffectCatalogue catalogue_for(const std::vector<const EffectAbout*>& laws, const EffectScales& scales, const MachineParts& has);

// What an effect holds whole (EffectAbout::parts), within their bounds; none where the catalogue has not all of them, or there are none.
std::vector<EffectInstance> parts_of(const EffectCatalogue& catalogue, const EffectInstance& whole);

// Whether these are all the parts of one law.
bool are_the_parts_of_one(const EffectCatalogue& catalogue, std::span<const std::string> effects);

// Both, the first one's effects first.
EffectCatalogue joined(EffectCatalogue first, const EffectCatalogue& second);

// Row of the parameter's table on the effect's page: name, unit, scale, bounds, typical, prior, absent, meaning; all numbers
// as multiples of the scale. `parameter` is the law's own.
std::string parameter_row(const EffectParameter& parameter);

EffectInstance typical_instance(const EffectAbout& about);

// Throws std::invalid_argument where a value is missing, not finite or out of bounds.
void check_instance(const EffectAbout& about, const EffectInstance& instance);

// What would be right where `name` is no effect of the catalogue: the machine's missing part, the name that is near, else
// all of them.
std::string expected_effect_name(const EffectCatalogue& catalogue, std::string_view name);

// A list of effects as a file holds it; a null node has none.
//   effects:
//     - effect: dead_time
//       delay: {value: 30, unit: ms, source: "..."}
// Every parameter of an effect is required. Problems (unknown or unsuited effect, key, unit, bounds) are added to
// `problems` with file and line.
std::vector<EffectInstance> read_effects(const YamlNode& list,
                                         const EffectCatalogue& catalogue, InputProblems& problems);

// The same list as YAML text, ready to be pasted; `source` is written beside every value, and what `notes` has of "effect.parameter".
std::string effects_text(const std::vector<EffectInstance>& instances, const EffectCatalogue& catalogue,
                         std::string_view source, const std::map<std::string, std::string>& notes = {});

}  // namespace slewlab::common
