// SUNDIALS' serial vector with the operations that its integrators spend their time in replaced by packed
// loops: Debian builds the library for no particular speed, and at some hundred entries these loops are 80 % of
// a step.
#pragma once

#include <sundials/sundials_nvector.h>

namespace slewlab::sim {

// Its clones have the same operations. nullptr where memory is short.
N_Vector make_fast_vector(int size, SUNContext context);

}  // namespace slewlab::sim
