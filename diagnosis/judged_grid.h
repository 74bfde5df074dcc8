// The grid on which a record is judged.
//
// A record may hold far more than the band in which it is judged: 1 kHz holds every swing of 40 Hz 25 times, and each of its points costs every
// simulation a step. So as many points go into one as leave the grid
//
//   1 / step >= kGridPerBand highest,
//
// where a low-pass without delay (decimation.h) keeps what lies in the band to 0.1 % and lets nothing fold into it. Encoders that are read less often than
// the grid has points are taken where they are read. Commands are all kept in `recorded_torque`, for what works
// on single ones; `motor_torque` is the mean over the time to the next point. Noise is told from the readings as they were recorded, for on the grid it is not white.
//
// Left as they are: sensors that are not sampled on the grid, and counts so coarse that their error is not white.
#pragma once

#include "diagnosis/record.h"

namespace slewlab::diagnosis {

// Chosen: what folds back from there lies above 3.5 times the band, where the low-pass leaves 1e-4.
inline constexpr double kGridPerBand = 4.5;

// Points of the record's grid that go into one of the grid for a band up to `highest` [Hz].
std::size_t points_per_judged_point(const Record& record, double highest);

Record on_judged_grid(Record record, double highest);

}  // namespace slewlab::diagnosis
