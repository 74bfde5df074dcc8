// The axis as its file describes it, along a record: the load that it carries there, and where the recorded efforts alone bring it, transmission and
// play included, on which the one inertia of a torque balance knows nothing.
//
// Units: those of the axis; [rad, Nm] of a rotary, [m, N] of a linear one. The position is the motor's.
#pragma once

#include <vector>

#include "diagnosis/balance/balance_record.h"
#include "sim/machine/machine_file.h"

namespace slewlab::diagnosis {

// What a speed is at each sample, from the positions two samples apart to either side; rough, good for its sign.
std::vector<double> rough_speed(const std::vector<double>& position, double step);

// Loads, forces and frictions of the axis's file along a motion, each held from its sample to the next: what goes with the motion is that of the middle
// between them, or it would be late by half a sample.
std::vector<double> described_load(const sim::MachineFile& axis, const std::vector<double>& position, double step);

// Where a gear that gives begins: in contact on the side on which it carries, as a machine that stands, or in the middle of its play and relaxed.
enum class GearBeginning { carrying, middle };

// The record that the described axis makes of what the motors give in this one (effort without load), from its first position and speed on. Brakes, trips
// and delays of the drive are not simulated.
//
// By its efforts alone an axis leaves a record's motion, and where a load goes with the position as fast as sqrt(|load'| / J): of hours, or of an arm that stands on its
// head, nothing comes of that. With the speeds of the record [samples] it is led along it, far more slowly than its transmission swings,
//
//   u = J (2 w (q'_measured - q') + w^2 (q_measured - q)),   w = 1 / T,                                              (1)
//
// J all that moves, T the axis's characteristic time (scales.h). What leads is a part of the described record's effort: its balance is that of
// its own motion.
AxisRecord described_record(const sim::MachineFile& axis, const AxisRecord& record, GearBeginning beginning = GearBeginning::carrying,
                            const std::vector<double>& led_by_speed = {});

}  // namespace slewlab::diagnosis
