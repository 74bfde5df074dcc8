// A ring of past samples, one per step, that answers at a delay between two samples.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace slewlab::sim {

// Sample is a small struct; `mix(older, newer, share)` is the caller's. Everything before the first push
// is a default Sample.
template <class Sample>
class DelayLine {
 public:
  // `longest` [steps]
  explicit DelayLine(double longest) : samples_(static_cast<std::size_t>(std::ceil(longest)) + 2) {}

  void push(const Sample& sample) {
    newest_ = newest_ + 1 < samples_.size() ? newest_ + 1 : 0;
    samples_[newest_] = sample;
  }

  // The two samples around `delay` [steps], and the share of the older one; with a share of 0 the answer is
  // `newer` to the bit.
  struct Between {
    const Sample& older;
    const Sample& newer;
    double share;
  };
  Between at(double delay) const {
    const double whole = std::floor(delay);
    const auto steps = static_cast<std::size_t>(whole);
    return {samples_[back(steps + 1)], samples_[back(steps)], delay - whole};
  }

 private:
  std::size_t back(std::size_t steps) const {
    if (steps >= samples_.size()) steps %= samples_.size();  // a division takes as long as the rest
    return steps <= newest_ ? newest_ - steps : newest_ + samples_.size() - steps;
  }

  std::vector<Sample> samples_;
  std::size_t newest_ = 0;
};

// share of a, rest of b; exactly b where the share is 0.
inline double blend(double a, double b, double share) { return share == 0.0 ? b : b + share * (a - b); }

}  // namespace slewlab::sim
