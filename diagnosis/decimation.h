// Every n-th value of a series, without what its new rate cannot carry.
//
// Zero-phase low-pass before the values are taken: a sinc of 0.8 of the new Nyquist frequency under Blackman's window, eight
// new samples to either side; towards the ends as long as there are samples on both sides. Of what would fold into the lower 40 % of the new band (everything above 1.6 of its Nyquist
// frequency) less than 0.1 % stays; what lies in there already keeps its size to 1 %. Beside values that
// are not finite, the window's weights over what there is. A value that is not finite itself stays so.
#pragma once

#include <cstddef>
#include <vector>

namespace slewlab::diagnosis {

// The values 0, stride, 2 stride, ... of the series; stride 1 is the series itself.
std::vector<double> decimated(const std::vector<double>& series, std::size_t stride);

// The means over so many values at a time. What stays the same keeps its bits.
std::vector<double> means(const std::vector<double>& values, std::size_t stride);

// As decimated(), of what is held from each value to the next (a command): what must be held over `stride` of them at a time to bring an inertia to the
// same places at the new samples, in the lower 45 % of the new band. Held over T values u bring it to T^2 / 2 (z + 1) / (z - 1)^2 u where the same torque, not held,
// brings it to -1 / w^2; with x = w T / 2 that asks for (sin(x) / x)^2 / cos(x) of each frequency, which the low-pass has on top. The last new value goes beyond the end
// where the stride does not divide the series.
std::vector<double> held_decimated(const std::vector<double>& held, std::size_t stride);

}  // namespace slewlab::diagnosis
