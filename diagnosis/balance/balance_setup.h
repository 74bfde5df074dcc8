// What the balances of one diagnosis share: one window for all records, the speed from which friction is judged, the laws in the axis's units.
//
// The window is as long as the noise of the noisiest record asks for (balance_record.h), and
//
//   2 h step <= kLongestWindow * T,   T = rms(q') / rms(q'')                                          (1)
//
// with what noise makes of q'' taken out, T the time in which the axis changes its speed: within a window laws are taken for constant. Samples
// slower than the speed that the positions resolve are left out: what dry friction holds at rest is not determined.
//
// Units: those of the axis (balance_laws.h). Every threshold is a share of the record's own or the machine's scales.
#pragma once

#include <cstddef>
#include <vector>

#include "diagnosis/balance/balance_laws.h"

namespace slewlab::diagnosis {

struct Balance {
  std::size_t half_window = 0;  // [samples]
  double resolved_speed = 0.0;
  int direction = 0;  // BalanceScales::direction
  std::vector<Lateness> lateness;  // that is tried
  std::vector<BalanceLaw> laws;
};
// `inertia` and `top_speed` are the nominal axis's. Throws std::invalid_argument where a record is too short.
Balance balance_of(const std::vector<AxisRecord>& records, double inertia, double top_speed, bool is_rotary);
// Whether a record moves that way (1, -1) faster than the positions resolve, in more than a few of its samples.
bool moves_along(const BalanceRecord& record, int direction, double resolved_speed);
std::vector<BalanceRecord> smoothed(const std::vector<AxisRecord>& records, const Balance& balance);

}  // namespace slewlab::diagnosis
