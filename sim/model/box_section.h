// A hollow rectangular section of plates: two side plates that stand and two flange plates that lie, closed.
#pragma once

namespace slewlab::sim {

struct BoxSection {
  double width = 0.0;         // [m] outer, across the boom
  double height = 0.0;        // [m] outer, in the luffing plane
  double side_plate = 0.0;    // [m] thickness of each side plate
  double flange_plate = 0.0;  // [m] thickness of each flange plate
};

// [m^2]
double area(const BoxSection& box);
// [m^4] for bending across the boom, (h w^3 - (h - 2 t_f) (w - 2 t_s)^3) / 12, and in the luffing plane, with the two swapped.
double lateral_second_moment(const BoxSection& box);
double vertical_second_moment(const BoxSection& box);
// [m^4] Bredt's second formula for a thin-walled closed section, 4 A_m^2 / (sum of s / t), on the middle lines of the plates.
double torsion_constant(const BoxSection& box);
// [m^2] square of the polar radius of gyration of the section's area.
double polar_radius_square(const BoxSection& box);

}  // namespace slewlab::sim
