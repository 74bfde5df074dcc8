// One machine in another size is judged alike: everything of the diagnosis is dimensionless numbers times the machine's scales.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "controller/effects/catalogue.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/plausibility.h"
#include "sim/effects/catalogue.h"
#include "tests/diagnosis/scaled_machine.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kPeriod = 5e-3;   // [s] of encoders, sensors, controller and model: 200 Hz
constexpr double kLength = 12.0;   // [s] of the manoeuvre
const std::vector<Move> kShort{{1.0, 0.4}, {5.0, 0.0}, {7.0, -0.4}};
const Scaling kOwnSize;

// Nominal machine and log of a manoeuvre in one size.
struct Case {
  Scaling scaling;
  sim::MachineSettings nominal;
  Thresholds thresholds;
  msgs::RunLog log;
  Record record;
};

Case make_case(const Scaling& scaling, const std::vector<common::EffectInstance>& missing) {
  Case made;
  made.scaling = scaling;
  made.nominal.crane = scaled(bench().crane, scaling);
  made.thresholds = thresholds_of(sim::describe(made.nominal.crane));
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.effects = missing;  // of the other size already
  made.log = scaled_log(truth, scaling, kPeriod, kShort, kLength);
  made.record = make_record(made.log, "log", made.thresholds.admission);
  return made;
}

void expect_same_series(const std::vector<double>& own, const std::vector<double>& other, double factor, double relative, const std::string& what) {
  ASSERT_EQ(own.size(), other.size()) << what;
  double largest = 0.0, apart = 0.0;
  for (std::size_t n = 0; n < own.size(); ++n) {
    largest = std::max(largest, std::fabs(own[n]));
    apart = std::max(apart, std::fabs(other[n] / factor - own[n]));
  }
  EXPECT_LE(apart, relative * largest) << what;
}

class InAnotherSize : public testing::TestWithParam<Scaling> {
 protected:
  const Scaling scaling = GetParam();
  const Case own = make_case(kOwnSize, {}), other = make_case(scaling, {});
  // Rounding, which lengths take through the modes' frequencies.
  const double same = scaling.root_time == 1.0 ? 1e-9 : 1e-6;
};

TEST_P(InAnotherSize, TheMotionIsTheSame) {
  for (std::size_t g = 0; g < 2; ++g) {
    expect_same_series(own.record.motor_torque[g], other.record.motor_torque[g], scaling.torque(), same, "torque");
    expect_same_series(own.record.shaft_speed[g], other.record.shaft_speed[g], scaling.speed(), same, "speed");
    expect_same_series(own.record.position_rate[g], other.record.position_rate[g], scaling.speed(), same, "rate of the position");
  }
  for (std::size_t a = 0; a < kAccelerometerCount; ++a) {
    expect_same_series(own.record.acceleration[a], other.record.acceleration[a], 1.0, same, "acceleration");
  }
}

Shadow follow(const Case& one) {
  const ShadowGains gains = shadow_gains(sim::scales_of(one.nominal.crane), one.thresholds.shadow);
  return shadow(one.nominal, one.record, gains);
}

TEST_P(InAnotherSize, TheObserverMissesTheSame) {
  const Shadow a = follow(own), b = follow(other);
  for (std::size_t g = 0; g < 2; ++g) expect_same_series(a.missing_torque[g], b.missing_torque[g], scaling.torque(), 100.0 * same, "missing torque");
  for (std::size_t i = 0; i < kAccelerometerCount; ++i) {
    expect_same_series(a.acceleration_difference[i], b.acceleration_difference[i], 1.0, 100.0 * same, "acceleration difference");
  }
  EXPECT_EQ(a.contact_lost, b.contact_lost);
}

TEST_P(InAnotherSize, TheWhitenedDifferencesAreTheSame) {
  const auto whitened = [](const Case& one) {
    const Shadow follower = follow(one);
    WhiteningSettings settings = one.thresholds.whitening;
    settings.noise_corner /= one.scaling.root_time;  // a sensor of that size
    const ShadowGains gains = shadow_gains(sim::scales_of(one.nominal.crane), one.thresholds.shadow);
    const NoiseResponse response = noise_response(one.nominal, one.record, gains, transform_length(one.record.size()));
    const Whitening whitening = make_whitening(one.record, trusted_stretches(one.record, follower, settings), response, follower, settings);
    const Eigen::VectorXd all = whiten(whitening, follower);
    return std::vector<double>(all.begin(), all.end());
  };
  expect_same_series(whitened(own), whitened(other), 1.0, 1e3 * same, "whitened");
}

// What is refused in one size is refused in another, in the same words but for its numbers; so is what is admitted.
TEST_P(InAnotherSize, TheSameIsRefused) {
  const auto refusal = [](const Case& one, const auto& spoil) -> std::string {
    msgs::RunLog log = one.log;
    spoil(log, one.scaling);
    try {
      const Record record = make_record(log, "log", one.thresholds.admission);
      Case spoilt = one;
      spoilt.record = record;
      check_torques(record, follow(spoilt), one.nominal, one.thresholds.admission);
      return "admitted";
    } catch (const NotAdmitted& problem) {
      const std::string text = problem.what();
      std::string words;
      std::copy_if(text.begin(), text.end(), std::back_inserter(words), [](char c) { return c == ' ' || std::isalpha(static_cast<unsigned char>(c)); });
      return words.substr(0, 23);  // up to the first number
    }
  };
  const std::vector<std::function<void(msgs::RunLog&, const Scaling&)>> spoils{
      [](msgs::RunLog&, const Scaling&) {},
      [](msgs::RunLog& log, const Scaling&) { for (auto& m : log.torque) for (double& t : m.motor_torque) t *= 1000.0; },
      [](msgs::RunLog& log, const Scaling&) { for (auto& m : log.torque) for (double& t : m.motor_torque) t *= -1.0; },
      [](msgs::RunLog& log, const Scaling&) { for (auto& m : log.encoder) for (double& s : m.shaft_speed) s *= 9.55; },
      [](msgs::RunLog& log, const Scaling&) { for (std::size_t n = 800; n < log.encoder.size(); ++n) log.encoder[n].shaft_position[0] += 30.0; },
      [](msgs::RunLog& log, const Scaling&) { for (std::size_t n = 400; n < 800; ++n) log.sensors[n].tip_acceleration = 0.01; },
      [](msgs::RunLog& log, const Scaling&) { log.encoder.resize(900), log.torque.resize(900), log.sensors.resize(900); }};
  for (std::size_t k = 0; k < spoils.size(); ++k) {
    const std::string words = refusal(own, spoils[k]);
    EXPECT_EQ(refusal(other, spoils[k]), words) << k;
    EXPECT_EQ(words == "admitted", k == 0) << k << ": " << words;
  }
}

// With a few effects to choose from.
Diagnosis diagnose_case(const Case& one, bool knows_controller = true) {
  DiagnosisSettings settings;
  settings.search.joint_pairs = 0;
  settings.noise_corner = 50.0 / one.scaling.root_time;  // [Hz] of a sensor of that size
  const std::vector<std::string> known{"bearing_coulomb", "bearing_viscous", "torque_lag", "boom_stiffness"};
  controller::ControllerSettings controller = bench().controller;
  controller.period = kPeriod;
  const common::EffectCatalogue all = joined(sim::effects_for(one.nominal), controller::effects_for(controller));
  for (const common::EffectAbout& about : all.effects) {
    if (std::find(known.begin(), known.end(), about.name) == known.end()) settings.without.emplace_back(about.name);
  }
  if (!knows_controller) return diagnose(one.nominal, std::nullopt, {one.record}, settings);
  return diagnose(one.nominal, scaled(controller, one.scaling), {one.record}, settings);
}

// The sizes that are torques multiplied by `torque`, the others by nothing: the first cause has no times or lengths.
void expect_same_answer(const Diagnosis& own, const Diagnosis& other, double torque, double relative) {
  EXPECT_EQ(own.verdict, other.verdict);
  EXPECT_NEAR(own.probability_unknown, other.probability_unknown, relative);
  ASSERT_EQ(own.causes.size(), other.causes.size());
  for (std::size_t c = 0; c < own.causes.size(); ++c) {
    EXPECT_EQ(own.causes[c].effects, other.causes[c].effects);
    EXPECT_NEAR(own.causes[c].probability, other.causes[c].probability, relative);
  }
  ASSERT_EQ(own.causes[0].sizes.size(), other.causes[0].sizes.size());
  for (std::size_t s = 0; s < own.causes[0].sizes.size(); ++s) {
    const Size& size = own.causes[0].sizes[s];
    const double factor = size.unit == "Nm" || size.unit == "N m" ? torque : 1.0;
    // A size that is nothing within its deviation is compared with that: its own digits are rounding's.
    EXPECT_NEAR(other.causes[0].sizes[s].value / factor, size.value, relative * std::max(std::fabs(size.value), size.deviation)) << size.parameter;
    EXPECT_NEAR(other.causes[0].sizes[s].deviation / factor, size.deviation, relative * size.deviation) << size.parameter;
  }
}

// Dry friction of 1e5 Nm on the thesis's crane, a fifth of what its motors give at rated torque.
std::vector<common::EffectInstance> friction(const Scaling& scaling) { return {{"bearing_coulomb", {1e5 * scaling.torque(), 0.0, 3e-5}}}; }

// What the machine of its own size is diagnosed to have, which is compared with that of every other size.
const Diagnosis& own_with_nothing() {
  static const Diagnosis kFound = diagnose_case(make_case(kOwnSize, {}));
  return kFound;
}
const Diagnosis& own_with_friction() {
  static const Diagnosis kFound = diagnose_case(make_case(kOwnSize, friction(kOwnSize)));
  return kFound;
}
const Diagnosis& own_with_friction_without_controller() {
  static const Diagnosis kFound = diagnose_case(make_case(kOwnSize, friction(kOwnSize)), false);
  return kFound;
}

TEST_P(InAnotherSize, TheAnswerIsTheSame) {
  const double relative = scaling.root_time == 1.0 ? 1e-6 : 1e-3;
  expect_same_answer(own_with_nothing(), diagnose_case(other), 1.0, relative);
  const Diagnosis& found = own_with_friction();
  EXPECT_EQ(found.verdict, "bearing_coulomb");
  expect_same_answer(found, diagnose_case(make_case(scaling, friction(scaling))), scaling.torque(), relative);
}

TEST_P(InAnotherSize, TheAnswerIsTheSameWithoutTheController) {
  const Diagnosis& found = own_with_friction_without_controller();
  EXPECT_EQ(found.verdict, "bearing_coulomb");
  expect_same_answer(found, diagnose_case(make_case(scaling, friction(scaling)), false), scaling.torque(), scaling.root_time == 1.0 ? 1e-6 : 1e-3);
}

const std::vector<std::string> kSizeNames{"MassesOfAMillionth", "MassesOfAThousandth", "MassesTimesAThousand", "LengthsOfATenth", "LengthsTimesFour"};

INSTANTIATE_TEST_SUITE_P(Sizes, InAnotherSize,
                         testing::Values(Scaling{1e-6, 1.0}, Scaling{1e-3, 1.0}, Scaling{1e3, 1.0}, Scaling{1.0, 0.316228}, Scaling{1.0, 2.0}),
                         [](const testing::TestParamInfo<Scaling>& size) { return kSizeNames.at(size.index); });

}  // namespace
}  // namespace slewlab::diagnosis
