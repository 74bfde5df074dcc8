#include "diagnosis/progress.h"

#include <algorithm>

namespace slewlab::diagnosis {

Progress within(const Progress& tell, const Stage& stage) {
  return [tell, stage](double share, const std::string& doing) {
    if (tell) tell(stage.from + (stage.to - stage.from) * share, doing);
  };
}

Progress shortened(const Progress& tell, double left) {
  return [tell, left](double share, const std::string& doing) {
    if (tell) tell(1.0 - left * (1.0 - share), doing);
  };
}

void Forecast::tell(double time, double share) {
  time_ = time;
  share_ = std::max(share_, share);
  if (from_time_ || share_ < kScreen.from) return;
  from_time_ = time;
  from_share_ = share_;
}

std::optional<double> Forecast::left() const {
  if (!from_time_ || share_ < kScreen.to || !(share_ > from_share_)) return std::nullopt;
  return (time_ - *from_time_) / (share_ - from_share_) * (1.0 - share_);
}

}  // namespace slewlab::diagnosis
