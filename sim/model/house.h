// The crane house as a thin-walled tube in torsion (thesis 2.7).
#pragma once

namespace slewlab::sim {

// (2.8) rotational inertia [kg m^2] of a thin tube of mass [kg] and mean diameter [m].
double house_inertia(double mass, double diameter);

// (2.9) as printed, with 8 in the denominator, which is the bending value of a thin tube: 34.9 GNm/rad.
// Kept for the reproduction row only; see house_stiffness and erratum E5.
double house_stiffness_as_printed(double shear_modulus, double diameter, double wall, double height);

// (2.9) corrected: a thin tube in torsion has I = pi D^3 t / 4 [Nm/rad].
double house_stiffness(double shear_modulus, double diameter, double wall, double height);

// (2.10), (2.18), (3.21): natural frequency [Hz] of one inertia [kg m^2] on one spring [Nm/rad].
double natural_frequency(double stiffness, double inertia);

}  // namespace slewlab::sim
