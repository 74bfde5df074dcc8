// How much noise the sensors of a record have, as its own readings show it.
//
// Motion is smooth over a few samples, noise is not: differences of order m of white noise have C(2 m, m) times its variance. What motion adds
// falls with the order, the more slowly the fewer samples it is given, so the least of several orders is taken. An encoder's noise is at least
// that of its counts, q^2 / 12 of a reading. Torques that were rounded when they were written down drove the machine as they were before.
#pragma once

#include <array>

#include "diagnosis/record.h"

namespace slewlab::diagnosis {

// Of every reading, as if white on the record's grid. A sensor that is sampled less often has its noise in fewer, longer pieces, one that is sampled
// more often in more of them.
SensorNoise sensor_noise(const Record& record);

}  // namespace slewlab::diagnosis
