// What a diagnosis says about one withheld case, and what the case was: plain data with JSON forms. A result names
// no truth and an answer no diagnosis; score.h brings them together.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/evaluation/draw.h"

namespace slewlab::diagnosis::withheld {

struct NamedSize {
  std::string effect;
  std::string parameter;
  double value = 0.0;
  double low = 0.0, high = 0.0;  // 90 % interval
};

struct NamedCause {
  std::vector<std::string> effects;  // one or two; none: nothing but parameters
  double probability = 0.0;
  std::vector<std::string> group;    // declared as not to be told apart from it, itself left out
  std::vector<NamedSize> sizes;
  // As in evidence.h: probabilities can be weighed again from them.
  double residual_power = 0.0, prior = 0.0;
  std::vector<double> information;
  double residual_ratio = 0.0;                // residual variance ratio of the fit
  std::optional<double> held_out_ratio{};       // on what was held out, and of the nominal machine there; nothing where the cause was not asked
  std::optional<double> nominal_held_out_ratio{};
};

struct CaseResult {
  std::string name;                      // case_0001
  std::string refusal;                   // why it would not judge; empty where it did
  bool gap = false;                      // says that something is missing
  double probability_unknown = 0.0;      // of "outside the catalogue"
  std::vector<NamedCause> causes;        // falling probability
  std::vector<std::pair<std::string, double>> subsystems;  // falling probability
  // Size of the gap in the unseen manoeuvre, one number in any unit: the nominal crane, then with what was found.
  double unseen_before = 0.0, unseen_after = 0.0;
  std::vector<std::string> follows;  // variables that the residual follows and that cannot be told apart; empty: none
  // To drive next, times in the controller's ramps: the manoeuvre that would tell most, and one that is drawn, to compare it with; nothing where
  // the answer is sure.
  std::optional<Manoeuvre> next, drawn;
  double seconds = 0.0;  // wall clock
  long long simulations = 0;
};

struct TrueEffect {
  std::string law;
  std::string effect;  // the catalogue's; empty: in no catalogue
  std::string subsystem;
  std::vector<TrueSize> sizes;
  double visibility = 0.0;  // [-] noise floors, beside the case's other effect
  std::string follows;      // the variable that its missing torque follows; empty: of none alone, or the effect is in the catalogue
};

struct CaseAnswer {
  std::string name;
  Kind kind = Kind::kNothing;
  std::vector<TrueEffect> effects;
  double visibility = 0.0;  // [-] noise floors
  std::string most_visible;
};

nlohmann::json to_json(const CaseResult& result);
CaseResult result_from(const nlohmann::json& json);
CaseAnswer answer_from(const nlohmann::json& json);

}  // namespace slewlab::diagnosis::withheld
