// Numbers of a machine's file with bounds beyond which no machine is, whatever its scale: a slip of units or of the keyboard. What is possible and
// yet unlikely is plausibility.h's.
#pragma once

#include <optional>
#include <string_view>

#include "common/unit.h"
#include "common/yaml_reader.h"

namespace slewlab::sim {

// Magnitudes in SI; 0 is left to the key's own range.
struct Possible {
  double least, most;
};
inline constexpr Possible kMass{1e-6, 1e9};        // [kg] a grain to a thousand thousand tonnes, more than any ship
inline constexpr Possible kLength{1e-4, 1e4};      // [m] a tenth of a millimetre to ten kilometres
inline constexpr Possible kTravel{1e-7, 1e4};      // [m] per turn of a motor: a tenth of a micrometre, finer than any screw, on
inline constexpr Possible kInertia{1e-12, 1e15};   // [kg m^2] the smallest rotor to the greatest mass a kilometre out
inline constexpr Possible kStiffness{1e-6, 1e18};  // [Nm/rad], [N/m]
inline constexpr Possible kRatio{1e-4, 1e6};       // [-]
inline constexpr Possible kModulus{1e3, 1e13};     // [Pa] jelly to ten times diamond
inline constexpr Possible kTorque{1e-9, 1e12};     // [Nm], [N]
inline constexpr Possible kSpeed{1e-9, 1e6};       // [rad/s], [m/s], and as much per second

// As YamlReader::number(), optional_number(); reports a value that is in the range and beyond what is possible.
double sized(common::YamlReader& reader, std::string_view key, common::Unit unit, common::Range range, Possible possible);
std::optional<double> optional_sized(common::YamlReader& reader, std::string_view key, common::Unit unit, common::Range range, Possible possible);

}  // namespace slewlab::sim
