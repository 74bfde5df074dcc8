// What an effect says about itself, whichever side of the wire it acts on: name, physics in one line,
// parameters with unit, bounds and prior. sim/effects and controller/effects add how it acts.
#pragma once

#include <optional>
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

// One number of an effect, in SI. Where the effect fades out as the number goes to some value, that value
// is `absent` (it may be infinite, outside the bounds); numbers that only shape the effect have none.
//
// Prior: Student's t with 2 degrees of freedom, (1 + x^2 / 3)^(-3/2), cut at the bounds; x is the distance over
// `prior_scale` from `absent`, or `typical` where there is no finite absent value. Logarithmic: of ln(value / centre).
struct EffectParameter {
  std::string_view name;
  Unit unit = Unit::none;
  std::string_view meaning;
  double lower = 0.0;
  double upper = 0.0;
  double typical = 0.0;  // a size that is clearly visible on the thesis's crane
  double prior_scale = 0.0;
  ParameterScale scale = ParameterScale::linear;
  std::optional<double> absent;
  // Other values than `typical` from which a diagnosis starts to look, where a fit only converges from nearby.
  std::vector<double> tries = {};
  // A detail of the law that a diagnosis fits once the effect is found, but does not look for.
  bool detail = false;
};

// An angle that may be any: a phase or a direction, -pi ... pi.
EffectParameter angle_parameter(std::string_view name, std::string_view meaning, double typical = 0.0);

// Indices of the parameters of an effect that begins at `begin` and, fading within `fade`, ends `duration` later: to first order in
// its size it is one that begins there and never ends, less another one that begins `duration` - `fade` later.
struct Spell {
  std::size_t begin = 0, duration = 0, fade = 0;
};

struct EffectAbout {
  std::string_view name;
  Subsystem subsystem = Subsystem::drive;
  std::string_view physics;
  std::vector<EffectParameter> parameters;
  std::optional<Spell> spell = std::nullopt;
  // Two angles that may be any enter as two sines multiplied (a roll's phase and direction), not each in its own place.
  bool angles_multiply = false;
};

// An effect switched on, values in the order of its parameters.
struct EffectInstance {
  std::string name;
  std::vector<double> values;
};

// Row of the parameter's table on the effect's page: name, unit, bounds, typical, prior, absent, meaning.
std::string parameter_row(const EffectParameter& parameter);

EffectInstance typical_instance(const EffectAbout& about);

// Throws std::invalid_argument where a value is missing, not finite or out of bounds.
void check_instance(const EffectAbout& about, const EffectInstance& instance);

// What would be right where `name` is no effect of the catalogue: the name that is near, else all of them.
std::string expected_effect_name(const std::vector<const EffectAbout*>& catalogue, std::string_view name);

// A list of effects as a file holds it; a null node has none.
//   effects:
//     - effect: dead_time
//       delay: {value: 30, unit: ms, source: "..."}
// Every parameter of an effect is required. Problems (unknown effect or key, unit, bounds) are added to
// `problems` with file and line.
std::vector<EffectInstance> read_effects(const YamlNode& list,
                                         const std::vector<const EffectAbout*>& catalogue,
                                         InputProblems& problems);

// The same list as YAML text, ready to be pasted; `source` is written beside every value.
std::string effects_text(const std::vector<EffectInstance>& instances,
                         const std::vector<const EffectAbout*>& catalogue, std::string_view source);

}  // namespace slewlab::common
