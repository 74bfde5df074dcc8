// Where the gears lie near impacts. There a record's spectra are not judged (whitening.h), and a crane whose groups hold each other on opposite flanks
// crosses its play in such stretches alone: nothing else of the record tells how wide the play is. The observer holds each motor on its encoder, and
// where a gear of the model lies on a flank that the real one has not met, or the other way round, it needs a torque for that,
//
//   u_g - u_1 = K_i ratio (place of group g - place of group 1) + K_p (its rate),
//
// of which boom and load, which move all groups alike, know nothing. Its means over parts of the time between two impacts are differences like the
// whitened ones, divided by what a share of the play would need and by the noise of such a mean.
#pragma once

#include <cstddef>
#include <vector>

#include "diagnosis/record.h"

namespace slewlab::diagnosis {

struct Shadow;
struct Whitening;

// Part of a time between two impacts, in which all gears of the nominal machine touch.
struct FlankPart {
  std::size_t group = 0;         // the second or higher
  std::size_t from = 0, to = 0;  // grid points
  double weight = 0.0;           // [1/Nm]
};

// [Nm] mean of what a group misses more than the first one.
double beside_the_first(const Shadow& shadow, const FlankPart& part);

// Gives the whitening of a record its parts, `duration` [s] each, of what the nominal observer has between grid points `from` and `to` where it is not `trusted`,
// behind the record's beginning, of which nobody knows where in their play the gears stood. `play_torque` [Nm] is what holds a motor beside its flank by half of
// the play; none without play, or with one group.
void add_flanks(const Record& record, const Shadow& nominal, const std::vector<bool>& trusted, double duration, double play_torque, std::size_t from, std::size_t to,
                Whitening& whitening);

}  // namespace slewlab::diagnosis
