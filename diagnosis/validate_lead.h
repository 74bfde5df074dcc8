// Validation decides which cause leads: one by one, the likeliest is asked to predict data that were not fitted (validate.h), until one does.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "controller/controller.h"
#include "diagnosis/problem.h"
#include "diagnosis/ranking.h"
#include "diagnosis/validate.h"
#include "diagnosis/whitening.h"

namespace slewlab::diagnosis {

// What causes are asked to predict, made once there is one to ask. `parameters_of_all` is where parameters alone stand, fitted to all records. Where they stand farther off
// than machines of one make do (not `are_parameters_likely`), they are no rival of an effect that is one of them grown: both predict the same. What it is made of must outlive it.
class Validator {
 public:
  Validator(Problem& problem, const WhiteningSettings& whitening, const std::optional<controller::ControllerSettings>& controller, Point parameters_of_all, bool are_parameters_likely);

  // A cause leads only if it predicts data that were not fitted better than the nominal machine and than parameters alone. Else its probability goes to
  // nothing missing where the residual of either is noise there, and otherwise to what is not known. That of a cause with stochastic effects beside
  // which an unknown power predicts as well goes to the causes that have its other effects. Gives the machine of the cause that leads, fitted without what it was asked to
  // predict; nothing where none was asked, or none predicted. Throws Interrupted.
  std::optional<HeldOut> validate_lead(Ranking& ranking, std::vector<std::string>& remarks);

  // Those behind the lead that are likely enough to be read are asked as well; it changes no probability. Throws Interrupted.
  void validate_others(Ranking& ranking);

 private:
  struct Predicted {
    Validation validation;
    std::vector<HeldOut> fitted;  // the cause's machine, without each part
  };
  Predicted predict(const Cause& cause, const Point& part);
  void make_parts();
  bool is_nothing_left() const;
  void count();

  Problem& problem_;
  const WhiteningSettings& whitening_;
  const std::optional<controller::ControllerSettings>& controller_;
  Point parameters_of_all_;
  bool are_parameters_likely_;
  std::vector<HeldOutData> parts_;    // held out each in its turn
  std::vector<Point> parameters_points_;              // of each part
  std::vector<ValidationError> nominal_, parameters_;  // on each part
  std::int64_t simulations_ = 0, simulation_time_ = 0;  // of the parts, as far as they are counted
};

}  // namespace slewlab::diagnosis
