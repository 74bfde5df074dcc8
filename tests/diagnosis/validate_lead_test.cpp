#include "diagnosis/validate_lead.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/parameters_alone.h"
#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

const common::EffectInstance kFriction{"bearing_coulomb", {1e5, 0.0, 3e-5}}, kPlay{"larger_play", {5e-4}};

Cause cause_of(const std::vector<common::EffectInstance>& effects, double probability) {
  Cause cause;
  for (const common::EffectInstance& effect : effects) cause.effects.push_back(effect.name);
  cause.point.effects = effects;
  cause.probability = probability;
  return cause;
}

// A ranking by hand of a machine with such effects, of two manoeuvres, led by a play that is not wider.
struct Asked {
  explicit Asked(const std::vector<common::EffectInstance>& effects) : ranking{{cause_of({kPlay}, 0.5), cause_of({kFriction}, 0.4), cause_of({}, 0.1)}, 0.0} {
    sim::MachineSettings truth;
    truth.crane = bench().crane;
    truth.effects = effects;
    problem.add(make_record(simulated_log(truth, bench().controller, kThereAndBack, kDuration, 34), "a", bench().admission));
    problem.add(make_record(simulated_log(truth, bench().controller, kInching, kDuration, 35), "b", bench().admission));
    parameters = fit_parameters_alone(problem, nominal_fit(problem)).point;
    validate();
  }
  Validator validator() { return {problem, problem.thresholds.whitening, controller, parameters, true}; }
  void validate() { held_out = validator().validate_lead(ranking, remarks); }

  BenchProblem problem;
  std::optional<controller::ControllerSettings> controller = bench().controller;
  Point parameters;
  Ranking ranking;
  std::vector<std::string> remarks;
  std::optional<HeldOut> held_out;
};

// The likeliest cause does not predict what it was not fitted to, and loses all to what is not known; the next one does.
TEST(ValidateLead, PassesToTheFirstCauseThatPredicts) {
  const Asked asked({kFriction});
  const Cause& lead = asked.ranking.causes.front();
  EXPECT_EQ(lead.effects, std::vector<std::string>{kFriction.name});
  EXPECT_DOUBLE_EQ(lead.probability, 0.4);
  ASSERT_TRUE(lead.validation);
  EXPECT_TRUE(lead.validation->holds);
  EXPECT_LT(lead.validation->cause.residual_ratio, lead.validation->parameters.residual_ratio);
  EXPECT_DOUBLE_EQ(asked.ranking.unknown, 0.5);
  for (const Cause& cause : asked.ranking.causes) {
    if (cause.effects == std::vector<std::string>{kPlay.name}) {
      EXPECT_EQ(cause.probability, 0.0);
      ASSERT_TRUE(cause.validation);
      EXPECT_FALSE(cause.validation->holds);
    }
  }
  ASSERT_TRUE(asked.held_out);
  EXPECT_EQ(asked.held_out->record, "b");
}

// Nothing acts, and the residual of parameters on data that were not fitted is noise alone, so the cause that leads predicts no better. What it loses
// goes to nothing missing, which leads then.
TEST(ValidateLead, GivesBackToNothingWhereParametersLeaveNoise) {
  const Asked asked({});
  const Cause& lead = asked.ranking.causes.front();
  EXPECT_TRUE(lead.effects.empty());
  EXPECT_DOUBLE_EQ(lead.probability, 0.6);  // its own and what the play loses; the friction was not asked
  EXPECT_EQ(asked.ranking.unknown, 0.0);
  EXPECT_FALSE(asked.held_out);
}

// A cause that comes to lead by what is doubted of another one is asked as well; one that has been asked is not asked again.
TEST(ValidateLead, AsksWhatLeadsLater) {
  Asked asked({kFriction});
  const double residual = asked.ranking.causes.front().validation->cause.residual_ratio;
  asked.validate();
  EXPECT_EQ(asked.ranking.causes.front().validation->cause.residual_ratio, residual);
  EXPECT_FALSE(asked.held_out);
  asked.ranking.causes.push_back(cause_of({kFriction, kPlay}, 0.9));
  asked.validate();
  const auto later = std::find_if(asked.ranking.causes.begin(), asked.ranking.causes.end(), [](const Cause& cause) { return cause.effects.size() == 2; });
  ASSERT_NE(later, asked.ranking.causes.end());
  EXPECT_TRUE(later->validation);
}

// What stands behind the lead and is likely enough to be read is asked too, and keeps its probability.
TEST(ValidateLead, AsksTheOthersThatAreRead) {
  Asked asked({kFriction});
  asked.ranking.causes = {cause_of({kFriction}, 0.7), cause_of({kPlay}, 0.2), cause_of({}, 0.08), cause_of({kFriction, kPlay}, 0.02)};
  const std::int64_t before = asked.problem.simulations;
  asked.validator().validate_others(asked.ranking);
  const std::vector<Cause>& causes = asked.ranking.causes;
  ASSERT_TRUE(causes[0].validation && causes[1].validation);
  EXPECT_TRUE(causes[0].validation->holds);
  EXPECT_FALSE(causes[1].validation->holds);
  EXPECT_EQ(causes[1].probability, 0.2);
  EXPECT_FALSE(causes[2].validation);
  EXPECT_FALSE(causes[3].validation);
  EXPECT_GT(asked.problem.simulations, before);
}

}  // namespace
}  // namespace slewlab::diagnosis
