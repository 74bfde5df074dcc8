#include "diagnosis/progress.h"

namespace slewlab::diagnosis {

Progress within(const Progress& tell, const Stage& stage) {
  return [tell, stage](double share, const std::string& doing) {
    if (tell) tell(stage.from + (stage.to - stage.from) * share, doing);
  };
}

}  // namespace slewlab::diagnosis
