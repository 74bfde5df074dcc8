// Which effect of the controller explains that its answers differ from those of its settings. The controller is known to the bit and gets the
// recorded inputs, so this side of the wire has no noise: the residual of the right effect is nearly zero. Where that of one effect is not, two are
// tried.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/effect.h"
#include "controller/controller.h"
#include "diagnosis/controller_replay.h"
#include "diagnosis/record.h"

namespace slewlab::diagnosis {

struct ControllerCause {
  std::vector<common::EffectInstance> effects;  // one or two
  std::vector<double> deviation;  // of each value in order, from the curvature
  double share_left = 1.0;        // mean square of its residual over that of the torque difference, 0 ... 1
  double probability = 0.0;       // among the controller's effects
};

// Calls work(0) to work(count - 1), in any order or side by side, as share_out() of problem.h.
using ShareOut = std::function<void(std::size_t count, const std::function<void(std::size_t)>& work)>;
inline void one_after_the_other(std::size_t count, const std::function<void(std::size_t)>& work) {
  for (std::size_t i = 0; i < count; ++i) work(i);
}

// Falling probability. Effects named in `without` are left out. `is_stopped` is asked before every replay; where true, throws Interrupted.
std::vector<ControllerCause> fit_controller(std::span<const Record> records, const controller::ControllerSettings& nominal,
                                            std::span<const std::string> without, const std::function<bool()>& is_stopped = {},
                                            const ShareOut& share = one_after_the_other);

}  // namespace slewlab::diagnosis
