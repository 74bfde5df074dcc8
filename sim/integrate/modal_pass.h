// The two passes of a plant step over the modes, which are most of its cost. Before the gears' end torques are known:
//
//   q = qq q0 + qv v0 + q_torque T + q_rate T' + q_tip F + q_tip_rate F',    v likewise,
//
// T and F being the torque on the house and the force at the tip at the step's start, with the sums over the modes that the house's end
// follows from; and with the end torques: q += q_torque T + q_rate T', v likewise, with the sums for the tip.
//
// A third pass takes what the modes' accelerations -w^2 q - d v + (loads) are at the places that are measured and asked for by effects.
//
// What a pass reads stands in the order in which it reads it, in blocks of kLanes modes: term by term, the modes of a block side by side.
// The last block is filled up with modes at rest.
//
// Products are taken lane by lane, four at once where the processor can; each sum of the first two runs over pairs of modes in their
// order, its two halves added at the end, each of the third over the modes one by one. So every width gives the same bits, on every processor, as long as the compiler contracts no products and sums.
#pragma once

#include <vector>

namespace slewlab::sim {

inline constexpr int kLanes = 4;

namespace free_term {
enum : int { qq, qv, q_torque, q_rate, q_tip, q_tip_rate, vq, vv, v_torque, v_rate, v_tip, v_tip_rate, count };
}
namespace end_term {
enum : int { q_torque, q_rate, v_torque, v_rate, count };
}
// Held over the step: torques on the house, and forces along the boom.
namespace held_term {
enum : int { q_house, q_uniform, v_house, v_uniform, count };
}
namespace shape_term {
enum : int { house, house_acceleration_q, house_acceleration_v, tip, count };
}

// Of the modes' accelerations: w^2, d, and the shapes at what acts.
namespace sense_term {
enum : int { square, damping_rate, house, tip, uniform, count };
}
// What a mode's acceleration gives, mode by mode: as Accelerations.
namespace place_term {
enum : int { house, tip, boom, pivot, middle, tip_sensor, count };
}

inline int block_count(int modes) { return (modes + kLanes - 1) / kLanes; }
inline std::size_t place(int mode, int term, int terms) {
  const int number = (mode / kLanes * terms + term) * kLanes + mode % kLanes;
  return static_cast<std::size_t>(number);
}

struct FreeLoads {
  double torque, rate, tip, tip_rate;  // at the start
  double house, uniform;               // held
};
struct FreeSums {
  double angle, speed, acceleration_q, acceleration_v;  // of the house
};
struct EndLoads {
  double torque, rate;  // at the end
  double house;         // held
};
struct EndSums {
  double tip, tip_velocity, acceleration_q, acceleration_v;
};
struct SenseLoads {
  double house, tip, uniform;  // all that acts
};
struct Accelerations {
  double house = 0.0;       // [rad/s^2]
  double tip = 0.0;         // [m/s^2] where the rope hangs
  double boom = 0.0;        // [m^2/s^2] integral of the lateral acceleration along the boom
  double pivot = 0.0;       // [rad/s^2]
  double middle = 0.0;      // [m/s^2]
  double tip_sensor = 0.0;  // [m/s^2]
};

// Arrays of `blocks` blocks, each with its terms; q and v of `blocks` times kLanes modes. The held terms are read where a load of theirs is
// not 0. No two arrays overlap.
struct ModalPasses {
  FreeSums (*free)(int blocks, const double* terms, const double* held, const double* shapes, const FreeLoads& loads, const double* q0,
                   const double* v0, double* q, double* v);
  EndSums (*end)(int blocks, const double* terms, const double* held, const double* shapes, const EndLoads& loads, double* q, double* v);
  Accelerations (*sense)(int blocks, const double* terms, const double* places, const SenseLoads& loads, const double* q, const double* v);
};

// For every processor; for one with vectors of four doubles, nullptr where this is none; the wider one that this has.
const ModalPasses& portable_passes();
const ModalPasses* wide_passes();
const ModalPasses& modal_passes();

// The sum over the modes of the products of two of their numbers, in the order of the first two passes.
double mode_product(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace slewlab::sim
