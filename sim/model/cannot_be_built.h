// Thrown where parameters, each good by itself, make no machine: a boom that buckles, a house without inertia. Apart from
// other invalid arguments, so that a search over parameters can step back from it without hiding its own errors.
#pragma once

#include <stdexcept>

namespace slewlab::sim {

class CannotBeBuilt : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

}  // namespace slewlab::sim
