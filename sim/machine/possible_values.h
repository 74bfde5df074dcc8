#pragma once

#include <string>
#include <string_view>

#include "common/yaml_node.h"
#include "common/yaml_reader.h"

namespace slewlab::sim {

// What no machine has, whatever its scale: a slip of units or of the keyboard. In SI; 0 is left to the key's own range.
struct Possible {
  double least, most;
};
inline constexpr Possible kMass{1e-6, 1e9};          // [kg] a grain to a thousand thousand tonnes, more than any ship
inline constexpr Possible kLength{1e-4, 1e4};        // [m] a tenth of a millimetre to ten kilometres
inline constexpr Possible kInertia{1e-12, 1e15};     // [kg m^2] the smallest rotor to the greatest mass a kilometre out
inline constexpr Possible kStiffness{1e-6, 1e18};    // [Nm/rad]
inline constexpr Possible kRatio{1e-4, 1e6};         // [-]
inline constexpr Possible kModulus{1e3, 1e13};       // [Pa] jelly to ten times diamond
inline constexpr Possible kTorque{1e-9, 1e12};       // [Nm]
inline constexpr Possible kSpeed{1e-9, 1e6};         // [rad/s]
inline constexpr Possible kLinearStiffness{1e-6, 1e18};  // [N/m]
inline constexpr Possible kForce{1e-9, 1e12};            // [N]
inline constexpr Possible kLinearSpeed{1e-9, 1e5};       // [m/s]

// reader.number() within the possible; a value outside of it is a problem.
inline double sized(common::YamlReader& reader, std::string_view key, common::Unit unit, common::Range range, Possible possible) {
  const double value = reader.number(key, unit, range);
  if (value != 0.0 && (value < possible.least || value > possible.most)) {
    const std::string name(common::name_of(unit));
    reader.report(key, common::shortest(value) + ' ' + name + ", which no machine has",
                  "from " + common::shortest(possible.least) + " to " + common::shortest(possible.most) + ' ' + name);
  }
  return value;
}

}  // namespace slewlab::sim
