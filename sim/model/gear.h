// Gears, pinion and the torque through a gearbox with backlash (thesis 2.6 and 3.3.1).
#pragma once

namespace slewlab::sim {

// (2.2) mesh frequency [Hz] of a planetary stage whose sun turns at `sun_frequency` [Hz].
double planetary_mesh_frequency(int ring_teeth, int sun_teeth, double sun_frequency);

// (2.3) mesh frequency [Hz] of a pinion that turns at `pinion_frequency` [Hz].
double pinion_mesh_frequency(int pinion_teeth, double pinion_frequency);

// Section 2.6.1: rotational play [rad] of a pinion from its play as a share of the module [m] and its
// radius [m].
double pinion_play(double share_of_module, double module, double pinion_radius);

// The tooth of a pinion, thesis Table 2.2.
struct PinionTooth {
  double poisson_ratio;     // [-]
  double length;            // [m] L_t, along the shaft
  double pinion_radius;     // [m] r_p
  double height;            // [m] h_t
  double thickness;         // [m] b_t
  double youngs_modulus;    // [N/m^2]
  double teeth_in_contact;  // [-] 2.5 on average (section 2.6)
};

// (2.7) mesh stiffness [Nm/rad] of the pinion: Hertzian contact (2.4) and tooth bending (2.5) in series.
double pinion_mesh_stiffness(const PinionTooth& tooth);

// Contact of one motor group's gears, on the slew axis.
struct GearContact {
  double stiffness;  // [Nm/rad] k_gb of the group
  double damping;    // [Nms/rad] acts in contact only
  double half_play;  // [rad] Delta_b
};

// (3.5) with damping in contact: the torque [Nm] on the house from gears whose motor side leads the house by
// `deflection` [rad] at `deflection_rate` [rad/s]. Teeth push and never pull: on each flank the torque is
// k (|deflection| - Delta_b) + c rate where that pushes, and 0 otherwise. (The thesis damps inside the play
// too and calls it a numerical necessity; ours does not.)
double contact_torque(const GearContact& gear, double deflection, double deflection_rate);

// (3.7) the equivalent stiffness [Nm/rad] with T = k~ * deflection; 0 inside the play.
double backlash_stiffness(const GearContact& gear, double deflection);

}  // namespace slewlab::sim
