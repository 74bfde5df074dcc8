// Which stretch of a long log is fitted. A recorder that runs for hours writes down what tells nothing new: a machine that stands, or turns on as before.
// What a fit holds in memory grows with the record, and its time as well, while some minutes of starts and stops tell as much as the records of a
// measuring campaign do. So of logs that are longer together than is fitted each gives the stretch in which its motors change their speed most,
//
//   m(t) = sum over [t, t + L] of |v_k - v_(k-1)|                                                                     (1)
//
// with v_k the motors' mean speed over a quarter of the machine's characteristic time T, in which noise and counts of the encoders do not show. It begins
// where the machine has stood and stands for T before it moves, where it does so: there the state of gears, boom and load is known best. Nothing but the motion chooses: what
// the nominal machine misses has no say, or the choice would speak for a gap.
//
// Units: times of a run in [ns] of its clock, lengths in [s].
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "msgs/logged_run.h"

namespace slewlab::diagnosis {

struct Stretch {
  std::int64_t from = 0, to = 0;  // [ns] both belong to it
  double motion = 0.0;            // [rad/s] of the motors, m
};

// [s] of each log that is fitted, at most `most` of all: of those that are longer than their share equally much, the others whole.
std::vector<double> fitted_lengths(std::span<const double> lengths, double most);

// [s] from the first to the last reading of the encoders.
double length_of(const msgs::LoggedRun& run);
double length_of(const msgs::RunLog& run);

// Stretches of that `length` [s] that do not overlap, the one in which most moves (1) first, and behind all that begin at a rest those that begin in motion; none in which
// the machine stands throughout, whatever swings on. `time` [s]: T.
std::vector<Stretch> stretches_by_motion(const msgs::LoggedRun& run, double length, double time);

}  // namespace slewlab::diagnosis
