#include "diagnosis/unseen_record.h"

#include <fmt/format.h>

#include <utility>

#include "diagnosis/admit.h"

namespace slewlab::diagnosis {

std::vector<UnseenRecord> judge_unseen(Problem& problem, const WhiteningSettings& whitening, const std::optional<controller::ControllerSettings>& controller, const Point& parameters_of_all,
                                       const Cause* lead, std::vector<Record> unseen, std::vector<std::string>& remarks) {
  std::optional<Point> answer;
  if (lead != nullptr) answer = fitted_part(problem.catalogue, lead->point);
  const bool is_said_by_parameters = lead != nullptr && lead->validation && lead->validation->is_said_by_parameters;
  std::vector<UnseenRecord> all;
  for (Record& record : unseen) {
    const std::string name = record.name;
    record.effects_from = effects_from({problem.records.data(), problem.records.size()}, record);
    std::optional<HeldOutData> admitted;
    try {
      admitted.emplace(problem, whitening, std::move(record), remarks);
    } catch (const NotAdmitted& problem_of_it) {
      remarks.push_back(fmt::format("{} could not be predicted: {}", name, problem_of_it.what()));
      continue;
    }
    HeldOutData& data = *admitted;
    const HeldOut parameters = data.fit(parameters_of_all);
    const HeldOut cause = answer ? data.fit(*answer) : parameters;
    UnseenRecord judged{parameters.record, answer ? name_of(*lead) : "", {data.error({}, controller), data.error(parameters, controller), {}, {}, false},
                        data.missing_torque({}), data.missing_torque(parameters), 0.0};
    judged.validation.cause = answer ? data.error(cause, controller) : judged.validation.parameters;
    judged.validation.holds = answer && holds(judged.validation, is_said_by_parameters);
    judged.cause_torque = answer ? data.missing_torque(cause) : judged.parameters_torque;
    all.push_back(std::move(judged));
    problem.simulations += data.simulations();
    problem.simulation_time += data.simulation_time();
  }
  return all;
}

}  // namespace slewlab::diagnosis
