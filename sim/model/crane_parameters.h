// What a crane is made of, as plain numbers in SI units. The YAML of config/cranes maps onto this one to one.
//
// Every angle of the drive is kept at the shaft where it is measured or specified; sim/model/drive_line.h
// refers it to the slew axis. Valid machines include a rigid boom (element_count 0), no load (mass 0) and a
// single motor group.
#pragma once

#include <vector>

#include "sim/model/motion.h"

namespace slewlab::sim {

inline constexpr double kGravity = 9.81;  // [m/s^2], thesis Table 4.2
inline constexpr int kMaximumGroupCount = 8;

struct DriveParameters {
  int group_count = 2;              // motor groups, each with its own encoder and torque command
  int motors_per_group = 3;         // motors, brakes and gearboxes merged in one group
  double motor_inertia = 0.0;       // [kg m^2] of one motor, on the fast axis
  double brake_inertia = 0.0;       // [kg m^2] of one brake, on the fast axis
  double gearbox_inertia = 0.0;     // [kg m^2] of one gearbox, on the fast axis
  double gearbox_ratio = 1.0;       // motor turns per turn of the gearbox's outgoing shaft
  double pinion_ratio = 1.0;        // turns of the pinion per turn of the slew ring
  double gearbox_stiffness = 0.0;   // [Nm/rad] of one gearbox, on its outgoing shaft
  double gear_damping_ratio = 0.0;  // share of critical damping, in contact only, see drive_line.h
  double gearbox_play = 0.0;        // [rad] whole play of one gearbox, on its outgoing shaft
  double pinion_play = 0.0;         // [rad] whole play between pinion and ring, as rotation of the pinion
  double rated_torque = 0.0;        // [Nm] that one motor may deliver all the time, T100
  double top_speed = 0.0;           // [rad/s] on the slew axis, that the machine is built for
  int pinion_teeth = 0;             // of one pinion; 0 is not known
  int gearbox_ring_teeth = 0;       // of the gearbox's first planetary stage; 0 is not known, then sun_teeth is 0 too
  int gearbox_sun_teeth = 0;
  bool is_rigid = false;            // nothing gives between the motors and what they drive: all of it is one inertia
};

// What acts on the axis wherever it stands: a weight on a lift, an arm that gravity turns. A crane's slew axis has none.
struct AxisForceParameters {
  double constant = 0.0;       // [Nm] in the positive direction; [N] of a linear axis
  double gravity = 0.0;        // [Nm] at gravity_angle, where it is greatest; gravity * cos(angle - gravity_angle) elsewhere
  double gravity_angle = 0.0;  // [rad]
};

struct HouseParameters {
  double inertia = 0.0;        // [kg m^2] about the slew axis
  double sensor_radius = 0.0;  // [m] of the lateral accelerometer on the house, from the slew axis
  double stiffness = 0.0;      // [Nm/rad] torsion between the slew ring and the rest of the house; 0 is rigid
  bool has_encoder = true;     // on the slew ring, behind the gears
  double ring_share = 0.0;     // share of the inertia that turns with the slew ring, where the house is not rigid
};

struct BoomStation {
  double position = 0.0;     // share of the boom's length from the pivot, 0 ... 1
  double half_width = 0.0;   // [m] from the centre line to the middle of the chords, across (w_y); of a box to its outside
  double half_height = 0.0;  // [m] the same in the luffing plane (w_z); of chords it enters the polar inertia only
};

// What carries the boom.
enum class BoomType {
  lattice,     // four chords
  box_girder,  // a hollow rectangular section of plates
  a_frame,     // two chords that run together from the pivot's pins to the tip, luffed by cylinders
  knuckle,     // a box girder that is bent in the luffing plane
};

// Cylinders between house and boom, in planes along the boom; their ends are ball joints.
struct LuffingCylinders {
  double stiffness = 0.0;    // [N/m] of each, along itself, at the boom's angle; 0: there are none
  double position = 0.0;     // share of the boom's length where they carry it
  double spacing = 0.0;      // [m] between the two; 0 of a single one
  double base_radius = 0.0;  // [m] of the lower ends from the slew axis
  double base_height = 0.0;  // [m] of the lower ends above the boom's pivot
  double oil_column = 0.0;   // [m] that gives them their stiffness, at the boom's angle; 0: the stiffness does not change with their length
  double force = 0.0;        // [N] that all of them carry at the boom's angle, positive in compression
};

struct BoomParameters {
  int element_count = 6;              // beam elements; 0 is a rigid boom
  double length = 0.0;                // [m]
  double mass = 0.0;                  // [kg] spread evenly over the length
  double angle = 0.0;                 // [rad] above the horizontal
  double pivot_radius = 0.0;          // [m] from the slew axis to the pivot
  double chord_outer_diameter = 0.0;  // [m]
  double chord_inner_diameter = 0.0;  // [m]
  double youngs_modulus = 0.0;        // [N/m^2]
  double shear_modulus = 0.0;         // [N/m^2]
  double torsion_constant = 0.0;      // [m^4] I_t of the whole section
  double damping_ratio = 0.0;         // share of critical damping at the clamped boom's first two bending modes
  double jib_mass = 0.0;              // [kg] of a fly jib on the tip; 0 is none
  double jib_eccentricity = 0.0;      // [m] of the jib's centre and sheave, in front of the boom's axis
  double highest_frequency = 0.0;     // [Hz] above which modes on the free house are left out; 0 keeps them all
  std::vector<BoomStation> profile;   // rising positions, first 0, last 1; linear in between
  BoomType type = BoomType::lattice;
  double side_plate = 0.0;            // [m] thickness, of a box
  double flange_plate = 0.0;          // [m] thickness, of a box
  double knuckle_position = 0.0;      // share of the length at which the boom is bent; 0 is straight
  double knuckle_angle = 0.0;         // [rad] above the horizontal, of the part behind the knuckle
  LuffingCylinders cylinders{};
};

struct LoadParameters {
  double mass = 0.0;           // [kg]; 0 is no load
  double rope_length = 0.0;    // [m] from the tip to the top of the rod
  double rod_length = 0.0;     // [m] of the load as a uniform rod; 0 is a point load
  double damping_ratio = 0.0;  // share of critical damping of each swinging mode
};

// The crane's motions beside slewing; a top speed of 0 is a motion that it has not.
struct MotionParameters {
  MotionRates hoisting;           // [m/s], [m/s^2] of the hook, positive up
  double shortest_rope = 0.0;     // [m] from the tip to the top of the load, the hook's highest place
  MotionRates luffing;            // [rad/s], [rad/s^2] of the boom angle, positive up
  double lowest_angle = 0.0;      // [rad] of the boom
  double highest_angle = 0.0;     // [rad]
  MotionRates travelling;         // [m/s], [m/s^2] of the pedestal along its track
  double travel_direction = 0.0;  // [rad] of the track, from the boom's direction at the slew angle 0
};

// What the machine's sensors are known to be; 0 is an ordinary sensor of its kind (sim/machine/description.h).
struct SensorParameters {
  double motor_speed_noise = 0.0;          // [rad/s] standard deviation of a reading, as all of these
  double slew_angle_noise = 0.0;           // [rad]
  double acceleration_noise = 0.0;         // [m/s^2]
  double acceleration_noise_corner = 0.0;  // [Hz] below which it rises as 1/f
  // [-] what an accelerometer reads of what moves it; of the house's, the sensor's radius says the same.
  double pivot_gain = 1.0, middle_gain = 1.0, tip_gain = 1.0;
};

// A plain axis (`kind: axis`) is a crane without boom and load: one motor group, and a house that is what the axis
// moves. On a linear axis angles read [m], inertias [kg], torques [N]; the ratio is motor radians per metre.
struct CraneParameters {
  DriveParameters drive;
  HouseParameters house;
  BoomParameters boom;
  LoadParameters load;
  AxisForceParameters axis_force;
  MotionParameters motions{};
  SensorParameters sensors{};
};

}  // namespace slewlab::sim
