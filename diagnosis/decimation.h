// Every n-th value of a series, without what its new rate cannot carry.
//
// Zero-phase low-pass before the values are taken: a sinc of 0.8 of the new Nyquist frequency under Blackman's window, eight
// new samples to either side. Of what would fold into the lower 40 % of the new band (everything above 1.6 of its Nyquist
// frequency) less than 0.1 % stays; what lies in there already keeps its size to 1 %. At the ends, and beside values that
// are not finite, the window's weights over what there is. A value that is not finite itself stays so.
#pragma once

#include <cstddef>
#include <vector>

namespace slewlab::diagnosis {

// The values 0, stride, 2 stride, ... of the series; stride 1 is the series itself.
std::vector<double> decimated(const std::vector<double>& series, std::size_t stride);

}  // namespace slewlab::diagnosis
