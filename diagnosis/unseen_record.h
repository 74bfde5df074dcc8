// The answer on records that had no part in it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "controller/controller.h"
#include "diagnosis/cause.h"
#include "diagnosis/problem.h"
#include "diagnosis/ranking.h"
#include "diagnosis/record.h"
#include "diagnosis/validate.h"
#include "diagnosis/whitening.h"

namespace slewlab::diagnosis {

// How the answer predicts a record that no fit has seen.
struct UnseenRecord {
  std::string record;
  std::string cause;      // that was tried, by name; empty where nothing is missing or no known effect is the answer: parameters alone
  Validation validation;
  double nominal_torque = 0.0, parameters_torque = 0.0, cause_torque = 0.0;  // [Nm per motor] RMS of the missing torque
};

// Records that no fit has seen, made ready once. The problem must outlive them.
class UnseenRecords {
 public:
  // Parameters alone predict from where `parameters_of_all` has them. A record that is not admitted is told in `remarks`.
  UnseenRecords(Problem& problem, const WhiteningSettings& whitening, const std::optional<controller::ControllerSettings>& controller, const Point& parameters_of_all, std::vector<Record> unseen,
                std::vector<std::string>& remarks);

  // How `cause` predicts each; nothing where the answer is no known effect: then parameters alone predict in its place. Throws Interrupted.
  std::vector<UnseenRecord> judge(const Cause* cause);

 private:
  struct One {
    HeldOutData data;
    UnseenRecord by_parameters;  // parameters alone in the cause's place
  };
  Problem& problem_;
  std::optional<controller::ControllerSettings> controller_;
  std::vector<One> records_;
  std::int64_t simulations_ = 0, simulation_time_ = 0;  // as far as they are counted
};

// Whether a cause leaves so much of an unseen record, and of the fitted ones so little, that what it says holds for those alone: shapes with which it follows them lead astray where the machine goes on. `parameters_mean_square`
// is what parameters alone leave of the fitted ones.
bool leads_astray(const Cause& cause, double parameters_mean_square, const UnseenRecord& unseen);

// A lead that is led astray so is not sure. One of those behind it that explains nearly as much of the fitted records, and predicts the unseen ones, leads in its place; where there is none, what the lead loses is not
// known. `judged` is the lead's, and becomes the new one's. It is told in `remarks`. Throws Interrupted.
void lead_by_what_is_unseen(UnseenRecords& records, double parameters_mean_square, std::vector<Cause>& causes, double& probability_unknown, std::vector<UnseenRecord>& judged, std::vector<std::string>& remarks);

}  // namespace slewlab::diagnosis
