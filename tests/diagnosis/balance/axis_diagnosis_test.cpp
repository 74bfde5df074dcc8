// Axes integrated by simulated_axis.h, which shares nothing with the plant, logged as a drive's recorder would: what is found must be
// what they were given.
#include "diagnosis/balance/axis_diagnosis.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <numbers>
#include <random>
#include <sstream>
#include <string>

#include "sim/drive/scenario_run.h"
#include "sim/integrate/machine.h"
#include "tests/diagnosis/balance/simulated_axis.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kRatio = 10.0;
constexpr double kInertia = 2.0;  // [kg m^2] on the axis

// The same axis in another size: masses and forces times `mass`, times by `root_time`, lengths by its square.
struct Size {
  double mass = 1.0, root_time = 1.0;
  double torque() const { return mass * root_time * root_time; }
  double inertia() const { return torque() * root_time * root_time; }
};

// Nominal: a rigid rotary axis; `more` is laid below it.
sim::MachineFile axis_file(const std::string& more = "", const Size& size = {}) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "axis.yaml";
  std::ofstream(file) << std::setprecision(17) << "kind: axis\n"
                      << "coordinate: {value: rotary, source: test}\n"
                      << "inertia: {value: " << kInertia * size.inertia() << ", unit: kg m^2, source: test}\n"
                      << "ratio: {value: " << kRatio << ", unit: \"-\", source: test}\n"
                      << "rated_torque: {value: " << 2.0 * size.torque() << ", unit: N m, source: test}\n"
                      << "top_speed: {value: " << 3.0 / size.root_time << ", unit: rad/s, source: test}\n"
                      << more;
  return sim::load_machine_file(file);
}

// Back and forth at several speeds: torque switched between levels, as open-loop tests are made.
double switched(double time) {
  constexpr double kLevels[] = {8.0, -8.0, 5.0, -5.0, 9.0, -6.0, 4.0, -7.0};
  return kLevels[static_cast<int>(time / 1.3) % 8];
}

double friction(double, double, double speed) { return 1.5 * std::tanh(speed / 1e-3) + 0.8 * speed; }

NamedRun logged(const AxisRecord& record, const std::string& name, const Size& size = {}) {
  NamedRun named{name, {}};
  for (std::size_t n = 0; n < record.position.size(); ++n) {
    msgs::Encoder encoder{};
    encoder.sequence = static_cast<std::int64_t>(n);
    encoder.simulated_time = std::llround(record.step * size.root_time * static_cast<double>(n) * 1e9);
    encoder.group_count = 1;
    encoder.shaft_position = {record.position[n] * kRatio};
    encoder.shaft_speed = {0.0};
    named.run.encoder.push_back(encoder);
    msgs::Torque torque{};
    torque.sequence = torque.answered_sequence = encoder.sequence;
    torque.simulated_time = encoder.simulated_time;
    torque.group_count = 1;
    torque.motor_torque = {record.effort[n] / kRatio * size.torque()};
    named.run.torque.push_back(torque);
  }
  return named;
}

NamedRun logged(const SimulatedAxis& axis, const std::string& name, const Size& size = {}) { return logged(record_of(axis), name, size); }

std::vector<NamedRun> two_runs(const SimulatedAxis& axis, const Size& size = {}) {
  SimulatedAxis other = axis;
  other.seed = axis.seed + 1;
  const auto effort = axis.effort;
  other.effort = [effort](double time) { return -0.9 * effort(time + 2.1); };
  return {logged(axis, "a", size), logged(other, "b", size)};
}

// As if the torque were measured: white noise of so much [N m on the axis] in what is written down, none in what acts.
std::vector<NamedRun> with_noisy_torque(std::vector<NamedRun> runs, double deviation) {
  std::mt19937_64 generator(11);
  std::normal_distribution<double> noise(0.0, deviation / kRatio);
  for (NamedRun& named : runs) {
    for (msgs::Torque& torque : named.run.torque) torque.motor_torque[0] += noise(generator);
  }
  return runs;
}

SimulatedAxis noisy(std::function<double(double, double, double)> resistance) {
  return {.inertia = kInertia, .resistance = std::move(resistance), .effort = switched, .noise = 2e-5};
}

double size_of(const BalanceModel& model, const std::string& law) {
  for (const BalanceTerm& term : model.terms) {
    if (term.law == law) return term.size[0];
  }
  return 0.0;
}

TEST(AxisDiagnosis, SaysNothingIsMissingOfTheAxisOfTheFile) {
  const AxisDiagnosis found = diagnose_axis(axis_file(), two_runs(noisy([](double, double, double) { return 0.0; })));
  EXPECT_EQ(found.outcome, AxisOutcome::nothing_missing) << found.verdict;
  EXPECT_TRUE(found.effects.empty());
}

TEST(AxisDiagnosis, NamesFrictionWithItsSizesAndPredictsTheRecordThatItDidNotSee) {
  const AxisDiagnosis found = diagnose_axis(axis_file(), two_runs(noisy(friction)));
  ASSERT_EQ(found.outcome, AxisOutcome::stated) << found.verdict;
  EXPECT_EQ(found.validation.place, "b");
  EXPECT_NEAR(size_of(found.answer.best, "dry"), 1.5, 0.1 * 1.5);
  EXPECT_NEAR(size_of(found.answer.best, "viscous"), 0.8, 0.1 * 0.8);
  EXPECT_NEAR(found.answer.best.inertia, kInertia, 0.03 * kInertia);
  EXPECT_LT(found.validation.cause.forward, 0.1 * found.validation.nominal.forward);
  EXPECT_EQ(found.verdict.rfind("dry friction and viscous friction: 9", 0), 0u) << found.verdict;
  EXPECT_EQ(found.answer.models.front().words(), found.answer.best.words());
  ASSERT_EQ(found.effects.size(), 2u);
  EXPECT_EQ(found.effects[0].name, "bearing_coulomb");
  EXPECT_EQ(found.effects[1].name, "bearing_viscous");
}

// Noise of a torque that was measured is no effect: 3 % of what acts, white, which no law could explain.
TEST(AxisDiagnosis, NoiseOfAMeasuredTorqueIsNoEffect) {
  for (const double deviation : {0.2, 0.5, 1.0}) {
    const AxisDiagnosis found = diagnose_axis(axis_file(), with_noisy_torque(two_runs(noisy([](double, double, double) { return 0.0; })), deviation));
    EXPECT_EQ(found.outcome, AxisOutcome::nothing_missing) << found.verdict;
    EXPECT_LT(found.validation.nominal.balance, 1.2 * found.validation.noise);
    EXPECT_LT(found.validation.nominal_together, found.validation.floor);
  }
  // And it hides no torque of time that is larger than the floor of what laws are known by, though it is hardly larger than the noise.
  const auto load = [](double t, double, double) { return 1.5 * std::sin(0.8 * t); };
  EXPECT_EQ(diagnose_axis(axis_file(), with_noisy_torque(two_runs(noisy(load)), 1.5)).outcome, AxisOutcome::unknown);
}

// Where the speeds are too few to tell the members of a family, the family leads, and each member has its own probability.
TEST(AxisDiagnosis, NamesTheFamilyWhereItsMembersCannotBeTold) {
  SimulatedAxis axis = noisy([](double, double, double speed) { return 1.5 * std::tanh(speed / 1e-3) + 0.1 * speed; });
  axis.noise = 2e-4;
  const AxisDiagnosis found = diagnose_axis(axis_file(), two_runs(axis));
  ASSERT_EQ(found.outcome, AxisOutcome::stated) << found.verdict;
  const FamilyProbability friction = family_probabilities(found.answer).front();
  EXPECT_EQ(friction.family, LawFamily::friction);
  EXPECT_GT(friction.probability, 0.99);
  for (const BalanceTerm& term : found.answer.best.terms) EXPECT_LE(term.probability, friction.probability + 1e-9) << term.words;
  const bool is_sure = std::all_of(found.answer.best.terms.begin(), found.answer.best.terms.end(), [](const BalanceTerm& term) { return term.probability >= 0.9; });
  EXPECT_EQ(found.verdict.rfind("friction (100 %), most likely ", 0) == 0, !is_sure) << found.verdict;
}

// A law that is left out is in no model, nor is what details it.
TEST(AxisDiagnosis, DoesWithoutTheLawsThatItIsTold) {
  const AxisDiagnosis found = diagnose_axis(axis_file(), two_runs(noisy(friction)), {"viscous"});
  ASSERT_FALSE(found.answer.models.empty());
  for (const BalanceModel& model : found.answer.models) {
    for (const BalanceTerm& term : model.terms) {
      EXPECT_NE(term.law, "viscous");
    }
  }
  EXPECT_NEAR(size_of(found.answer.best, "dry"), 1.5, 0.3 * 1.5);
  const std::vector<std::string> names = balance_law_names();
  for (const char* name : {"dry", "viscous", "stribeck", "rising", "gravity", "spring", "warming", "lag", "delay"}) {
    EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
  }
  EXPECT_TRUE(diagnose_axis(axis_file(), two_runs(noisy(friction)), names).answer.best.terms.empty());
}

// On a robot's joint the grease takes most of the rated torque at top speed; its effect can be written all the same.
TEST(AxisDiagnosis, WritesViscousFrictionThatTakesMostOfTheRatedTorque) {
  const auto thick = [](double, double, double speed) { return 1.0 * std::tanh(speed / 1e-3) + 6.0 * speed; };
  const AxisDiagnosis found = diagnose_axis(axis_file(), two_runs(noisy(thick)));
  ASSERT_EQ(found.outcome, AxisOutcome::stated) << found.verdict;
  EXPECT_TRUE(std::any_of(found.effects.begin(), found.effects.end(), [](const auto& effect) { return effect.name == "bearing_viscous"; }));
}

// One machine is ordinary where several things differ at once: the inertia is told beside the friction.
TEST(AxisDiagnosis, TellsAnInertiaThatIsOffBesideTheFriction) {
  SimulatedAxis axis = noisy(friction);
  axis.inertia = 1.4 * kInertia;
  const AxisDiagnosis found = diagnose_axis(axis_file(), two_runs(axis));
  ASSERT_EQ(found.outcome, AxisOutcome::stated) << found.verdict;
  EXPECT_NE(found.verdict.find("beside an inertia 4"), std::string::npos) << found.verdict;
  EXPECT_NE(found.verdict.find("% above the file's"), std::string::npos) << found.verdict;
}

// What was found and laid over the file leaves nothing to find.
TEST(AxisDiagnosis, TheFileWithTheFrictionHasNoGap) {
  const std::string effects =
      "effects:\n"
      "  - effect: bearing_coulomb\n    torque: {value: 1.5, unit: N m, source: test}\n"
      "    asymmetry: {value: 0, unit: \"-\", source: test}\n    give: {value: 0, unit: rad, source: test}\n"
      "  - effect: bearing_viscous\n    coefficient: {value: 0.8, unit: N m s/rad, source: test}\n"
      "    asymmetry: {value: 0, unit: \"-\", source: test}\n";
  const AxisDiagnosis found = diagnose_axis(axis_file(effects), two_runs(noisy(friction)));
  EXPECT_NE(found.outcome, AxisOutcome::stated) << found.verdict;
  EXPECT_NEAR(size_of(found.answer.best, "dry"), 0.0, 0.1);
  EXPECT_NEAR(size_of(found.answer.best, "viscous"), 0.0, 0.1);
}

class AxisInAnotherSize : public testing::TestWithParam<Size> {};

// Friction and gravity on a tilted axis: the same laws with the same probabilities, sizes multiplied alike.
TEST_P(AxisInAnotherSize, TheAnswerIsTheSame) {
  const Size size = GetParam();
  const auto resistance = [](double, double position, double speed) { return friction(0.0, position, speed) + 1.2 * std::sin(position); };
  const AxisDiagnosis one = diagnose_axis(axis_file(), two_runs(noisy(resistance)));
  const AxisDiagnosis other = diagnose_axis(axis_file("", size), two_runs(noisy(resistance), size));
  EXPECT_EQ(other.verdict, one.verdict);
  EXPECT_EQ(other.outcome, one.outcome);
  EXPECT_NEAR(other.answer.probability_unknown, one.answer.probability_unknown, 1e-6);
  EXPECT_NEAR(other.answer.best.inertia / size.inertia(), one.answer.best.inertia, 1e-6 * kInertia);
  ASSERT_EQ(other.answer.models.size(), one.answer.models.size());
  for (std::size_t m = 0; m < one.answer.models.size(); ++m) {
    EXPECT_EQ(other.answer.models[m].words(), one.answer.models[m].words());
    EXPECT_NEAR(other.answer.models[m].probability, one.answer.models[m].probability, 1e-6);
  }
  EXPECT_NEAR(size_of(other.answer.best, "dry") / size.torque(), size_of(one.answer.best, "dry"), 1e-6);
  EXPECT_NEAR(size_of(other.answer.best, "viscous") / (size.torque() * size.root_time), size_of(one.answer.best, "viscous"), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Sizes, AxisInAnotherSize, testing::Values(Size{1e-6, 1.0}, Size{1e-3, 1.0}, Size{1e3, 1.0}, Size{1.0, 0.5}, Size{1.0, 2.0}));

// A torque that has nothing to do with the motion, another one in each record: nothing may be stated of it.
TEST(AxisDiagnosis, StatesNothingThatDoesNotPredict) {
  SimulatedAxis axis = noisy([](double time, double, double) { return 3.0 * std::sin(7.0 * time) * std::sin(1.7 * time); });
  std::vector<NamedRun> runs = two_runs(axis);
  SimulatedAxis other = axis;
  other.resistance = [](double time, double, double) { return 3.0 * std::cos(3.1 * time) * std::sin(0.9 * time); };
  runs[1] = logged(other, "b");
  const AxisDiagnosis found = diagnose_axis(axis_file(), runs);
  EXPECT_NE(found.outcome, AxisOutcome::stated) << found.verdict;
  EXPECT_TRUE(found.effects.empty());
}

// What is known of the records is no more than that something is missing: that is unknown, not "cannot tell"; and where one cannot tell, nothing
// unknown is claimed.
TEST(AxisDiagnosis, AGapThatNoLawPredictsIsUnknown) {
  SimulatedAxis axis = noisy([](double time, double, double) { return 3.0 * std::sin(7.0 * time) * std::sin(1.7 * time); });
  SimulatedAxis other = axis;
  other.effort = [](double time) { return -0.9 * switched(time + 2.1); };
  other.resistance = [](double, double, double speed) { return 2.0 * std::tanh(speed / 1e-3) * std::cos(3.0 * speed); };
  const AxisDiagnosis found = diagnose_axis(axis_file(), {logged(axis, "a"), logged(other, "b")});
  EXPECT_EQ(found.outcome, AxisOutcome::unknown) << found.verdict;
  EXPECT_GE(found.answer.probability_unknown, 0.5);
}

// A controller moves the axis over cogging, teeth of 0.03 rad, to and fro at up to 1.2 rad/s, and holds it between its moves: sample by sample it answers position and speed.
AxisRecord over_teeth(double cogging, double frequency, unsigned seed) {
  constexpr double kStep = 4e-3, kNoise = 1e-3, kTop = 1.2;  // [s], [rad], [rad/s]
  constexpr int kFiner = 100;
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> noise(0.0, kNoise);
  AxisRecord record{"in a loop", kStep, {}, {}};
  double position = 0.0, speed = 0.0, wanted = 0.0;
  for (int n = 0; n < 5000; ++n) {
    const double sine = std::sin(2.0 * std::numbers::pi * frequency * n * kStep), wanted_speed = kTop * std::copysign(std::max(0.0, std::fabs(sine) - 0.6) / 0.4, sine);
    const double effort = 30.0 * (wanted_speed - speed) + 150.0 * (wanted - position);
    wanted += kStep * wanted_speed;
    record.position.push_back(position + noise(generator));
    record.effort.push_back(effort);
    for (int i = 0; i < kFiner; ++i) {
      speed += kStep / kFiner * (effort - cogging * std::sin(200.0 * position)) / kInertia;
      position += kStep / kFiner * speed;
    }
  }
  return record;
}

// The balance's window, long for the positions' noise, averages fine cogging away, and it is drawn of what moves: next to no residual is left, but the effort that holds the axis in a tooth drives the
// axis of the file away.
TEST(AxisDiagnosis, WhatTheWindowHidesIsNotNothing) {
  const auto found = [](double cogging) { return diagnose_axis(axis_file(), {logged(over_teeth(cogging, 0.11, 1), "a"), logged(over_teeth(cogging, 0.07, 2), "b")}); };
  const AxisDiagnosis without = found(0.0), with = found(0.5);
  EXPECT_EQ(without.outcome, AxisOutcome::nothing_missing) << without.verdict;
  EXPECT_LT(without.validation.nominal.tenths, without.validation.drift);
  EXPECT_LT(with.validation.nominal.balance, 3.0 * with.validation.noise);
  EXPECT_EQ(with.outcome, AxisOutcome::unknown) << with.verdict;
  EXPECT_NE(with.verdict.find("within a tenth of"), std::string::npos) << with.verdict;
}

// A motor that saturates, F - s F |F|, asks for more effort as another inertia would. Under a sine of amplitude A, 8 / (3 pi) s A^2 of it is one: up to 17 % here.
// The residual is a fifth of that and goes together, so the inertia is no answer.
TEST(AxisDiagnosis, AMotorThatSaturatesIsNoInertia) {
  constexpr double kAmplitude = 9.0, kSaturation = 0.2 / kAmplitude;  // [N m], [1 / (N m)]
  const auto saturating = [](double frequency, unsigned seed, bool rubs) {
    const auto effort = [frequency](double t) { return kAmplitude * std::cos(frequency * t) * (0.6 + 0.4 * std::cos(0.5 * t)); };
    SimulatedAxis axis = noisy([effort, rubs](double t, double q, double v) { return kSaturation * effort(t) * std::fabs(effort(t)) + (rubs ? friction(t, q, v) : 0.0); });
    axis.effort = effort;
    axis.seed = seed;
    return axis;
  };
  const AxisDiagnosis alone = diagnose_axis(axis_file(), {logged(saturating(3.0, 1, false), "a"), logged(saturating(4.3, 2, false), "b")});
  EXPECT_EQ(alone.outcome, AxisOutcome::unknown) << alone.verdict;
  const double low = alone.answer.best.inertia - 1.645 * alone.answer.best.inertia_deviation;
  EXPECT_LT(low, kInertia) << alone.answer.best.inertia;
  const AxisDiagnosis rubbing = diagnose_axis(axis_file(), {logged(saturating(3.0, 1, true), "a"), logged(saturating(4.3, 2, true), "b")});
  EXPECT_EQ(rubbing.verdict.find(", beside an inertia"), std::string::npos) << rubbing.verdict;
}

// A spring that rests outside the middle of the range is one law, with its stiffness and its place of rest; no constant torque beside it.
TEST(AxisDiagnosis, ASpringRestsWhereItRests) {
  constexpr double kStiffness = 1.8, kRest = 0.7;  // [N m / rad], [rad]
  const auto sprung = [](double frequency, unsigned seed) {
    SimulatedAxis axis = noisy([](double t, double q, double v) { return friction(t, q, v) + kStiffness * (q - kRest); });
    axis.effort = [frequency](double t) { return 3.0 + 7.0 * std::cos(frequency * t) + 2.0 * std::sin(0.3 * t); };
    axis.seed = seed;
    return axis;
  };
  const AxisDiagnosis found = diagnose_axis(axis_file(), {logged(sprung(1.7, 1), "a"), logged(sprung(2.3, 2), "b")});
  ASSERT_EQ(found.outcome, AxisOutcome::stated) << found.verdict;
  EXPECT_NE(size_of(found.answer.best, "spring"), 0.0) << found.verdict;
  EXPECT_EQ(found.verdict.find("constant torque"), std::string::npos) << found.verdict;
  const std::string about = "load that changes with the position: ";
  const auto remark = std::find_if(found.remarks.begin(), found.remarks.end(), [&](const std::string& one) { return one.rfind(about, 0) == 0; });
  ASSERT_NE(remark, found.remarks.end());
  std::istringstream words(remark->substr(about.size()));
  double stiffness = 0.0, rest = 0.0;
  std::string unit, towards;
  ASSERT_TRUE(words >> stiffness >> unit >> towards >> rest) << *remark;
  EXPECT_EQ(unit + " " + towards, "Nm/rad towards") << *remark;
  EXPECT_NEAR(stiffness, kStiffness, 0.05 * kStiffness);
  EXPECT_NEAR(rest, kRest, 0.05);
}

// Logs at 50 Hz hold the mean of what the drive did in between: half a sample of skew is the recorder's, and no effect.
TEST(AxisDiagnosis, ASkewOfTheRecorderIsNoEffect) {
  std::vector<NamedRun> runs = two_runs(noisy([](double, double, double) { return 0.0; }));
  for (NamedRun& named : runs) {
    for (std::size_t n = named.run.torque.size(); n-- > 1;) {
      named.run.torque[n].motor_torque[0] = 0.5 * (named.run.torque[n].motor_torque[0] + named.run.torque[n - 1].motor_torque[0]);
    }
  }
  const AxisDiagnosis found = diagnose_axis(axis_file(), runs);
  EXPECT_EQ(found.outcome, AxisOutcome::nothing_missing) << found.verdict;
  EXPECT_NEAR(found.validation.nominal.balance, 0.0, found.validation.noise * 3.0);
}

// One run as two logs.
std::vector<NamedRun> halves(NamedRun first) {
  NamedRun second = first;
  second.name = "b";
  second.run.encoder.erase(second.run.encoder.begin(), second.run.encoder.begin() + static_cast<std::ptrdiff_t>(second.run.encoder.size() / 2));
  first.run.encoder.resize(first.run.encoder.size() / 2);
  return {std::move(first), std::move(second)};
}

// A drive that lags by 50 ms, integrated here: named with its time, and no skew of the recorder in its place.
TEST(AxisDiagnosis, NamesADriveThatLags) {
  constexpr double kLag = 0.05, kFine = 1e-4;  // [s]
  std::vector<double> late{0.0};
  for (int n = 0; n < 600000; ++n) late.push_back(late.back() + kFine / kLag * (switched(kFine * n) - late.back()));
  const auto withheld = [&](double t) { return switched(t) - late[static_cast<std::size_t>(t / kFine)]; };
  SimulatedAxis axis = noisy([&](double t, double q, double v) { return friction(t, q, v) + withheld(t); });
  axis.duration = 40.0;
  const AxisDiagnosis found = diagnose_axis(axis_file(), halves(logged(axis, "a")));
  ASSERT_EQ(found.outcome, AxisOutcome::stated) << found.verdict;
  EXPECT_NEAR(size_of(found.answer.best, "lag"), kLag, 0.2 * kLag) << found.verdict;
  EXPECT_TRUE(std::any_of(found.effects.begin(), found.effects.end(), [](const auto& effect) { return effect.name == "torque_lag"; }));
}

// All of the torque 40 ms after its command, as over a bus: named with its time, and written as a dead time.
TEST(AxisDiagnosis, NamesADriveThatActsAFixedTimeLate) {
  constexpr double kDelay = 0.04;  // [s]
  SimulatedAxis axis = noisy([](double t, double q, double v) { return friction(t, q, v) + switched(t) - (t > kDelay ? switched(t - kDelay) : 0.0); });
  axis.duration = 40.0;
  const AxisDiagnosis found = diagnose_axis(axis_file(), halves(logged(axis, "a")));
  ASSERT_EQ(found.outcome, AxisOutcome::stated) << found.verdict;
  EXPECT_NEAR(size_of(found.answer.best, "delay"), kDelay, 0.1 * kDelay) << found.verdict;
  EXPECT_EQ(size_of(found.answer.best, "lag"), 0.0);
  EXPECT_TRUE(std::any_of(found.effects.begin(), found.effects.end(), [](const auto& effect) { return effect.name == "dead_time"; })) << fmt::format("{}", fmt::join(found.remarks, "; "));
}

// Beside friction that is named, a torque of time alone is said to be unknown, with the size of its residual.
TEST(AxisDiagnosis, SaysThatWhatIsLeftIsOfNoKnownLaw) {
  const AxisDiagnosis found =
      diagnose_axis(axis_file(), two_runs(noisy([](double t, double q, double v) { return friction(t, q, v) + 1.2 * std::sin(2.3 * t) * std::sin(0.7 * t); })));
  ASSERT_NE(found.outcome, AxisOutcome::nothing_missing) << found.verdict;
  EXPECT_NE(found.verdict.find("unknown"), std::string::npos) << found.verdict;
  if (found.outcome == AxisOutcome::stated) {
    EXPECT_TRUE(found.has_remainder);
    EXPECT_GT(found.unexplained, 0.0);
  }
}

// A ripple over the position, and a load of time alone: no law of the balance. That something is missing is said all the same.
TEST(AxisDiagnosis, SaysUnknownWhereNoKnownLawExplainsMostOfTheGap) {
  for (const auto& law : {std::function<double(double, double, double)>([](double, double q, double) { return 2.0 * std::sin(7.0 * q); }),
                          std::function<double(double, double, double)>([](double t, double, double) { return 2.0 * std::sin(0.8 * t); })}) {
    const AxisDiagnosis found = diagnose_axis(axis_file(), two_runs(noisy(law)));
    EXPECT_EQ(found.outcome, AxisOutcome::unknown) << found.verdict;
    EXPECT_GT(found.validation.nominal.balance, 3.0 * found.validation.noise);
    EXPECT_GT(found.answer.probability_unknown, 0.5);
  }
}

TEST(AxisDiagnosis, RefusesWhatCannotBeBalanced) {
  const std::vector<NamedRun> runs = two_runs(noisy(friction));
  const auto refusal = [&](const auto& spoil) -> std::string {
    std::vector<NamedRun> spoilt = runs;
    spoil(spoilt[0].run);
    try {
      diagnose_axis(axis_file(), spoilt);
    } catch (const NoBalance& problem) {
      return problem.what();
    }
    return "";
  };
  EXPECT_NE(refusal([](msgs::RunLog& run) { run.torque.clear(); }).find("no TORQUE"), std::string::npos);
  EXPECT_NE(refusal([](msgs::RunLog& run) { run.encoder.erase(run.encoder.begin() + 100, run.encoder.begin() + 300); }).find("even grid"),
            std::string::npos);
  EXPECT_NE(refusal([](msgs::RunLog& run) { run.encoder[50].shaft_position[0] = std::nan(""); }).find("no number"), std::string::npos);
  EXPECT_NE(refusal([](msgs::RunLog& run) { run.encoder.resize(20); }).find("too short"), std::string::npos);
  EXPECT_NE(refusal([](msgs::RunLog& run) {
              for (msgs::Torque& torque : run.torque) torque.motor_torque[0] = 0.0;
            }).find("zero throughout"),
            std::string::npos);
}

// Torques in mN m or on the wrong side of the gears, positions in degrees or turns, a turned sign: all of it fits some inertia, and
// none of it may be answered with one.
TEST(AxisDiagnosis, RefusesASlipOfUnit) {
  const auto refusal = [](double torque_factor, double position_factor) -> std::string {
    std::vector<NamedRun> runs = two_runs(noisy(friction));
    for (NamedRun& one : runs) {
      for (msgs::Torque& torque : one.run.torque) torque.motor_torque[0] *= torque_factor;
      for (msgs::Encoder& encoder : one.run.encoder) encoder.shaft_position[0] *= position_factor;
    }
    try {
      return "answered: " + diagnose_axis(axis_file(), runs).verdict;
    } catch (const NoBalance& problem) {
      return problem.what();
    }
  };
  constexpr double kTurn = 2.0 * std::numbers::pi;
  for (const double factor : {1e3, 1e-3, kRatio, 1.0 / kRatio}) EXPECT_NE(refusal(factor, 1.0).find("check the units"), std::string::npos) << factor << " " << refusal(factor, 1.0);
  for (const double factor : {360.0 / kTurn, 1.0 / kTurn, 1e3}) EXPECT_NE(refusal(1.0, factor).find("check the units"), std::string::npos) << factor << " " << refusal(1.0, factor);
  EXPECT_NE(refusal(-1.0, 1.0).find("check the signs"), std::string::npos) << refusal(-1.0, 1.0);
}

// Far from what the file says of the motor: told with the column's likely slip.
TEST(AxisDiagnosis, TellsWhatIsFarFromTheMotorsRatings) {
  const auto refusal = [](double torque_factor, double time_factor) -> std::string {
    std::vector<NamedRun> runs = two_runs(noisy(friction));
    for (NamedRun& one : runs) {
      for (msgs::Torque& torque : one.run.torque) torque.motor_torque[0] *= torque_factor;
      for (msgs::Encoder& encoder : one.run.encoder) encoder.simulated_time = std::llround(static_cast<double>(encoder.simulated_time) * time_factor);
    }
    try {
      return "answered: " + diagnose_axis(axis_file(), runs).verdict;
    } catch (const NoBalance& problem) {
      return problem.what();
    }
  };
  EXPECT_NE(refusal(1e3, 1.0).find("times the rated 2 N m of the axis's file: check the units of the torque"), std::string::npos) << refusal(1e3, 1.0);
  EXPECT_NE(refusal(1.0, 1e3).find("check the units of time (ms)"), std::string::npos) << refusal(1.0, 1e3);
  EXPECT_NE(refusal(1.0, 1e-3).find("times the top speed of 3 rad/s of its file: check the units of position (deg, mm) and time"), std::string::npos) << refusal(1.0, 1e-3);
}

// Moves at steady speeds tell frictions and no inertia: the file's stays, and friction is found beside it.
TEST(AxisDiagnosis, SteadySpeedsLeaveTheInertiaOfTheFile) {
  // The torque that holds each speed; the axis has reached it when the record begins, and changes are slow.
  const auto held = [](double time) {
    const double speed = 1.5 * std::sin(0.05 * time) + 0.6 * std::sin(0.13 * time + 1.0);
    return 1.5 * std::tanh(speed / 0.02) + 4.0 * speed;
  };
  SimulatedAxis axis = noisy([](double, double, double speed) { return 1.5 * std::tanh(speed / 1e-3) + 4.0 * speed; });
  axis.effort = held;
  axis.duration = 120.0;
  const AxisDiagnosis found = diagnose_axis(axis_file(), two_runs(axis));
  ASSERT_EQ(found.outcome, AxisOutcome::stated) << found.verdict;
  EXPECT_NEAR(size_of(found.answer.best, "viscous"), 4.0, 0.4);
  EXPECT_GT(found.answer.best.inertia, 0.3 * kInertia) << found.verdict;
  EXPECT_LT(found.answer.best.inertia, 1.7 * kInertia) << found.verdict;
}

// Two runs, each under two efforts [N m] in turn: the first one's for two seconds of four, the second one's for two of five.
std::vector<NamedRun> one_way_runs(SimulatedAxis axis, std::array<double, 2> first, std::array<double, 2> second) {
  SimulatedAxis other = axis;
  other.seed = 2;
  axis.effort = [first](double time) { return std::fmod(time, 4.0) < 2.0 ? first[0] : first[1]; };
  other.effort = [second](double time) { return std::fmod(time, 5.0) < 2.0 ? second[0] : second[1]; };
  return {logged(axis, "a"), logged(other, "b")};
}

// A spindle that turns one way only: its viscous friction is told, though the difference of its directions is not.
TEST(AxisDiagnosis, OneDirectionTellsViscousFriction) {
  const SimulatedAxis axis = noisy([](double, double, double speed) { return 2.5 * speed; });
  const AxisDiagnosis found = diagnose_axis(axis_file(), one_way_runs(axis, {6.0, 3.0}, {5.0, 2.0}));
  ASSERT_EQ(found.outcome, AxisOutcome::stated) << found.verdict;
  EXPECT_NEAR(size_of(found.answer.best, "viscous"), 2.5, 0.4) << found.verdict;
}

// Where all logs move one way a constant torque is dry friction: none is carried along beside it, and what is written is the friction that there is.
TEST(AxisDiagnosis, OneDirectionCarriesNoConstantTorqueAlongDryFriction) {
  const SimulatedAxis axis = noisy([](double, double, double speed) { return 3.0 * std::tanh(speed / 1e-3) + 1.0 * speed; });
  const AxisDiagnosis found = diagnose_axis(axis_file(), one_way_runs(axis, {7.0, 2.0}, {6.0, 2.5}));
  ASSERT_EQ(found.outcome, AxisOutcome::stated) << found.verdict;
  double against = 0.0;  // [N m] of the motion, of what does not depend on its speed
  for (const BalanceTerm& term : found.answer.best.acting()) {
    if (term.law == "dry" || term.law == "offset") against += term.size[0];
    EXPECT_FALSE(term.law == "offset" && size_of(found.answer.best, "dry") != 0.0) << term.size[0];
  }
  EXPECT_NEAR(against, 3.0, 0.3) << found.verdict;
  EXPECT_TRUE(std::any_of(found.remarks.begin(), found.remarks.end(), [](const std::string& remark) { return remark.rfind("all logs move in one direction", 0) == 0; }));
}

// What dry friction holds stands still in forward simulation, however long.
// A conveyor that turns one way and stands between its moves: how it starts and stops tells no difference of directions and no constant torque, and the one law
// has both names.
TEST(AxisDiagnosis, OneDirectionWithStopsIsOneLawOfTwoNames) {
  for (const double count : {1e-5, 5e-4}) {
    SimulatedAxis axis = noisy([](double, double, double speed) { return 1.5 * std::tanh(speed / 1e-3) + 2.0 * speed; });
    axis.noise = count;
    SimulatedAxis other = axis;
    other.seed = 2;
    const auto moves = [](double time, double fast, double slow) { return time < 1.0 ? fast : time < 2.5 ? slow : 0.0; };
    axis.effort = [moves](double time) { return moves(std::fmod(time, 4.0), 6.0, 3.5); };
    other.effort = [moves](double time) { return moves(std::fmod(time, 5.0), 4.0, 5.0); };
    const AxisDiagnosis found = diagnose_axis(axis_file(), {logged(axis, "a"), logged(other, "b")});
    ASSERT_EQ(found.outcome, AxisOutcome::stated) << found.verdict;
    EXPECT_EQ(found.answer.best.words(), "dry friction or a constant torque against the motion and viscous friction") << found.verdict;
    EXPECT_NEAR(size_of(found.answer.best, "dry"), 1.5, 0.15);
    EXPECT_NEAR(size_of(found.answer.best, "viscous"), 2.0, 0.2);
    EXPECT_EQ(size_of(found.answer.best, "offset"), 0.0);
    for (const BalanceTerm& term : found.answer.best.acting()) EXPECT_EQ(term.size.size(), 1u) << term.law;
  }
}

// What helps the motion in the one direction there is, is no friction.
TEST(AxisDiagnosis, OneDirectionTellsATorqueThatHelps) {
  const SimulatedAxis axis = noisy([](double, double, double speed) { return -2.0 + 2.5 * speed; });
  const AxisDiagnosis found = diagnose_axis(axis_file(), one_way_runs(axis, {4.0, 1.0}, {3.0, 0.5}));
  ASSERT_EQ(found.outcome, AxisOutcome::stated) << found.verdict;
  EXPECT_NEAR(size_of(found.answer.best, "offset"), -2.0, 0.2) << found.verdict;
  EXPECT_EQ(size_of(found.answer.best, "dry"), 0.0);
}

TEST(AxisDiagnosis, DryFrictionHoldsInForwardSimulation) {
  AxisRecord record{"held", 0.01, std::vector<double>(3000, 0.2), std::vector<double>(3000, 1.0), 0.0, {}};
  const BalanceRecord smooth = make_balance_record(record, 3);
  const std::vector<BalanceLaw> laws = balance_laws({3.0, 6e-3, 30.0, 0.0, 1.0, true, {}});
  BalanceModel model;
  model.inertia = kInertia;
  model.terms = {{"dry", "", LawFamily::friction, 0.0, true, {1.5}, {}, 0.0}};
  for (const double speed : forward_speed(record, smooth.motion, laws, model)) ASSERT_NEAR(speed, 0.0, 1e-9);
}

// A log that has no part in the answer is predicted by it; the same log of an axis that rubs no more is not, and the first sentence says so.
TEST(AxisDiagnosis, TheAnswerIsTriedOnLogsThatHadNoPartInIt) {
  SimulatedAxis third = noisy(friction), free = noisy([](double, double, double) { return 0.0; });
  third.seed = free.seed = 5;
  third.effort = free.effort = [](double time) { return 0.8 * switched(1.3 * time + 0.7); };
  const AxisDiagnosis plain = diagnose_axis(axis_file(), two_runs(noisy(friction)));
  const AxisDiagnosis found = diagnose_axis(axis_file(), two_runs(noisy(friction)), {}, {logged(third, "c")});
  EXPECT_EQ(found.verdict, plain.verdict);
  ASSERT_EQ(found.unseen.size(), 1u);
  EXPECT_EQ(found.unseen.front().place, "c");
  EXPECT_TRUE(found.unseen.front().holds);
  EXPECT_LT(found.unseen.front().cause.balance, 0.1 * found.unseen.front().nominal.balance);
  const AxisDiagnosis refuted = diagnose_axis(axis_file(), two_runs(noisy(friction)), {}, {logged(free, "d")});
  EXPECT_FALSE(refuted.unseen.front().holds);
  EXPECT_EQ(refuted.verdict.rfind("Not sure: ", 0), 0u) << refuted.verdict;
  EXPECT_NE(refuted.verdict.find("does not predict d better"), std::string::npos) << refuted.verdict;
}

// A fast sweep and steps of 1.0 N m of dry friction beside viscous friction: the sweep, a tenth as fast, tells little of what is viscous, the steps do. Which log
// comes first is no information.
TEST(AxisDiagnosis, TheOrderOfTheLogsIsNoInformation) {
  const auto resistance = [](double, double, double speed) { return 1.0 * std::tanh(speed / 2e-3) + 0.3 * speed; };
  SimulatedAxis sweep{.inertia = 1.05 * kInertia, .resistance = resistance, .duration = 6.0, .step = 1e-3, .noise = 3e-6}, steps = sweep;
  sweep.effort = [](double time) { return 6.0 * std::sin(2.0 * std::numbers::pi * (0.5 * time + (20.0 - 0.5) * time * time / 12.0)); };
  steps.effort = [](double time) { return (static_cast<int>(time / 0.7) % 2 == 0 ? 5.0 : -5.0) * (static_cast<int>(time / 1.4) % 2 == 0 ? 0.6 : 1.0); };
  steps.seed = 2;
  const NamedRun swept = logged(sweep, "sweep"), stepped = logged(steps, "steps");
  const AxisDiagnosis one = diagnose_axis(axis_file(), {swept, stepped}), other = diagnose_axis(axis_file(), {stepped, swept});
  for (const AxisDiagnosis* found : {&one, &other}) {
    ASSERT_EQ(found->outcome, AxisOutcome::stated) << found->verdict;
    EXPECT_NEAR(size_of(found->answer.best, "dry"), 1.0, 0.1) << found->verdict;
    EXPECT_NEAR(size_of(found->answer.best, "viscous"), 0.3, 0.1) << found->verdict;
    EXPECT_FALSE(found->has_remainder) << found->verdict;
    EXPECT_EQ(found->validation.place, "sweep") << "of which the steps tell more than it of them";
  }
  EXPECT_EQ(one.verdict, other.verdict);
  EXPECT_EQ(one.answer.models.front().words(), other.answer.models.front().words());
  EXPECT_NEAR(one.answer.probability_unknown, other.answer.probability_unknown, 0.01);
  ASSERT_EQ(one.answer.laws.size(), other.answer.laws.size());
  for (std::size_t l = 0; l < one.answer.laws.size(); ++l) EXPECT_NEAR(one.answer.laws[l].probability, other.answer.laws[l].probability, 0.01) << one.answer.laws[l].law;
}

// What to do stands in one sentence behind the answer.
TEST(AxisDiagnosis, SaysWhatToDo) {
  EXPECT_EQ(diagnose_axis(axis_file(), two_runs(noisy([](double, double, double) { return 0.0; }))).action, "Keep the axis's file: it describes this axis.");
  EXPECT_EQ(diagnose_axis(axis_file(), two_runs(noisy(friction))).action.rfind("Use axis_with_effect.yaml in place of the axis's file", 0), 0u);
}

// Forward simulation against the finer integration that made the record.
TEST(AxisDiagnosis, ForwardSpeedIsTheIntegratedOne) {
  SimulatedAxis axis = noisy(friction);
  axis.noise = 0.0;
  const AxisRecord record = record_of(axis);
  const BalanceRecord smooth = make_balance_record(record, 3);
  const std::vector<BalanceLaw> laws = balance_laws({3.0, 1e-3, 20.0, 0.0, 1.0, true, {}});
  BalanceModel model;
  model.inertia = kInertia;
  model.terms = {{"dry", "", LawFamily::friction, 0.0, true, {1.5}, {}, 0.0}, {"viscous", "", LawFamily::friction, 0.0, true, {0.8, 0.0}, {}, 0.0}};
  const std::vector<double> forward = forward_speed(record, smooth.motion, laws, model);
  const std::size_t first = (record.position.size() - smooth.motion.speed.size()) / 2;
  double largest = 0.0;
  for (std::size_t n = 10; n < smooth.motion.speed.size(); ++n) largest = std::max(largest, std::fabs(forward[first + n] - smooth.motion.speed[n]));
  EXPECT_LT(largest, 0.08);  // [rad/s] of 3: a sample's smoothing at the switches of the torque
}

// A tilting table: 40 kg m^2 behind a gear of 80, of the size of a machine tool's.
sim::MachineFile table(double gravity, const std::string& more = "") {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "table.yaml";
  std::ofstream(file) << "kind: axis\ncoordinate: {value: rotary, source: test}\ninertia: {value: 40, unit: kg m^2, spread: 10 %, source: test}\n"
                      << "motor_inertia: {value: 0.0015, unit: kg m^2, source: test}\nratio: {value: 80, unit: \"-\", source: test}\n"
                      << "load:\n  gravity: {value: " << gravity << ", unit: N m, source: test}\n  gravity_angle: {value: 0, unit: deg, source: test}\n"
                      << "rated_torque: {value: 6, unit: N m, source: test}\ntop_speed: {value: 1, unit: rad/s, source: test}\n" << more;
  return sim::load_machine_file(file);
}

std::string transmission(double stiffness, double play) {
  return "transmission:\n  stiffness: {value: " + std::to_string(stiffness) + ", unit: N m/rad, source: test}\n" +
         "  damping_ratio: {value: 5, unit: \"%\", source: test}\n  play: {value: " + std::to_string(play) + ", unit: mrad, source: test}\n";
}

const std::string kDryBearing =
    "effects:\n  - effect: bearing_coulomb\n    torque: {value: 30, unit: N m, source: test}\n"
    "    asymmetry: {value: 0, unit: \"-\", source: test}\n    give: {value: 0, unit: rad, source: test}\n";

// What a machine makes of a speed controller that goes there and back, without any noise; from `braked` [s] on with the brakes.
NamedRun own_run(const sim::MachineFile& axis, double speed, double braked = 1e9, double end = 12.0) {
  constexpr double kPeriod = 2e-3, kAcceleration = 5.0;                       // [s], [rad/s^2]
  constexpr double kProportional = 0.2, kIntegral = 2.0, kBrakeTorque = 10.0;  // [Nm s/rad], [Nm/rad], [Nm] of the motor
  sim::MachineSettings settings = sim::machine_settings(axis);
  settings.step = 0.5 * kPeriod;
  sim::Machine machine = sim::make_machine(settings);
  NamedRun named{"own", {}};
  double wanted = 0.0, sum = 0.0;
  for (int n = 0; n * kPeriod < end; ++n) {
    const double time = n * kPeriod, target = time < 1.0 ? 0.0 : std::fmod(time, 4.0) < 2.0 ? speed : -speed;
    wanted += std::clamp(target - wanted, -kAcceleration * kPeriod, kAcceleration * kPeriod);
    const sim::MachineReadings readings = sim::read(machine);
    msgs::Encoder encoder{};
    encoder.sequence = n;
    encoder.simulated_time = std::llround(time * 1e9);
    encoder.group_count = 1;
    encoder.shaft_position = {readings.shaft_position[0]};
    encoder.shaft_speed = {readings.shaft_speed[0]};
    const double error = 80.0 * wanted - encoder.shaft_speed[0];
    sum += error * kPeriod;
    msgs::Torque torque{};
    torque.sequence = torque.answered_sequence = n;
    torque.simulated_time = encoder.simulated_time;
    torque.brake = time >= braked;
    torque.group_count = 1;
    torque.motor_torque = {torque.brake ? 0.0 : kProportional * error + kIntegral * sum};
    sim::DriveCommand command{.sequence = n, .enable = !torque.brake};
    command.motor_torque[0] = torque.motor_torque[0];
    command.brake_torque[0] = torque.brake ? kBrakeTorque : 0.0;
    for (int i = 0; i < 2; ++i) sim::step(machine, command);
    named.run.encoder.push_back(std::move(encoder));
    named.run.torque.push_back(std::move(torque));
  }
  return named;
}

// Without noise anything may be fitted to the residual of the record's step: gravity that is taken half a sample late looks like a friction over the position.
// The plant holds a load over its step of 1 ms; the residual of that is 1e-5 of the load.
TEST(AxisDiagnosis, AnAxisAgainstItsOwnRecordMissesNothing) {
  for (const double gravity : {-30.0, -120.0, -300.0}) {
    const sim::MachineFile axis = table(gravity);
    for (const std::vector<NamedRun>& runs : {std::vector<NamedRun>{own_run(axis, 0.3)}, std::vector<NamedRun>{own_run(axis, 0.3), own_run(axis, 0.5)}}) {
      const AxisDiagnosis found = diagnose_axis(axis, runs);
      EXPECT_EQ(found.outcome, AxisOutcome::nothing_missing) << gravity << ": " << found.verdict;
      EXPECT_TRUE(found.answer.best.terms.empty());
      EXPECT_EQ(found.answer.probability_unknown, 0.0);
      EXPECT_LT(found.validation.nominal.balance, 1e-5 * std::fabs(gravity));
    }
  }
}

// A fraction of what the motors give is no longer what a record makes wrong: dry friction of 30 N m beside 120 N m of gravity.
TEST(AxisDiagnosis, FrictionIsFoundWithoutNoise) {
  const sim::MachineFile real = table(-120.0, kDryBearing);
  const AxisDiagnosis found = diagnose_axis(table(-120.0), {own_run(real, 0.3), own_run(real, 0.5)});
  ASSERT_EQ(found.outcome, AxisOutcome::stated) << found.verdict;
  EXPECT_NEAR(size_of(found.answer.best, "dry"), 30.0, 1.0);
}

// What swings behind a gear with play is no law of one inertia; what a brake does, nobody records.
TEST(AxisDiagnosis, AnElasticAxisAgainstItsOwnRecordMissesNothing) {
  const sim::MachineFile axis = table(-120.0, transmission(150e3, 0.6));
  for (const double braked : {1e9, 9.0}) {
    const AxisDiagnosis found = diagnose_axis(axis, {own_run(axis, 0.3, braked)});
    EXPECT_EQ(found.outcome, AxisOutcome::nothing_missing) << found.verdict;
    EXPECT_EQ(found.answer.probability_unknown, 0.0);
    EXPECT_NE(found.verdict.find("simulated with its transmission"), std::string::npos) << found.verdict;
    const bool is_cut = std::any_of(found.remarks.begin(), found.remarks.end(), [](const std::string& remark) { return remark.find("stretch without brakes, 9 s from 0 s on") != std::string::npos; });
    EXPECT_EQ(is_cut, braked < 12.0);
  }
}

// By the recorded efforts alone a table that is turned through where its workpiece hangs over the other side of the teeth leaves its record within a minute.
TEST(AxisDiagnosis, AnElasticAxisAgainstItsOwnRecordOfMinutesMissesNothing) {
  const sim::MachineFile axis = table(-120.0, transmission(150e3, 0.6));
  const AxisDiagnosis found = diagnose_axis(axis, {own_run(axis, 0.9, 1e9, 120.0)});
  EXPECT_EQ(found.outcome, AxisOutcome::nothing_missing) << found.verdict;
  EXPECT_NE(found.verdict.find("simulated with its transmission"), std::string::npos) << found.verdict;
}

// Where another transmission than the file's swings as much as the file's would, the balance of one inertia cannot tell what is missing.
TEST(AxisDiagnosis, ADescribedTransmissionThatMakesMostOfTheGapLeavesItOpen) {
  const AxisDiagnosis found = diagnose_axis(table(-120.0, transmission(150e3, 0.6)), {own_run(table(-120.0, transmission(110e3, 0.9)), 0.3)});
  EXPECT_EQ(found.outcome, AxisOutcome::not_identifiable) << found.verdict;
  EXPECT_NE(found.verdict.find("for the transmission of the file alone its residual is"), std::string::npos) << found.verdict;
  EXPECT_EQ(found.action.rfind("Compare stiffness and play", 0), 0u) << found.action;
}

// A load that swings behind a soft transmission follows its motor late, as under a drive that lags; no drive is that slow.
TEST(AxisDiagnosis, WhatSwingsBehindADescribedTransmissionIsNoDriveThatLags) {
  const std::string soft = transmission(14e3, 0.0);
  const sim::MachineFile real = table(-1.0, soft + kDryBearing);
  const AxisDiagnosis found = diagnose_axis(table(-1.0, soft), {own_run(real, 0.3), own_run(real, 0.5)});
  EXPECT_FALSE(found.outcome == AxisOutcome::stated && size_of(found.answer.best, "lag") != 0.0) << found.verdict;
}

// Friction that is much more than what the gears make is found behind them.
TEST(AxisDiagnosis, FrictionIsFoundBehindADescribedTransmission) {
  const sim::MachineFile real = table(-120.0, transmission(150e3, 0.6) + kDryBearing);
  const AxisDiagnosis found = diagnose_axis(table(-120.0, transmission(150e3, 0.6)), {own_run(real, 0.3), own_run(real, 0.5)});
  ASSERT_EQ(found.outcome, AxisOutcome::stated) << found.verdict;
  EXPECT_NEAR(size_of(found.answer.best, "dry"), 30.0, 3.0) << found.verdict;
}

TEST(AxisDiagnosis, ARecordThatIsBrakedThroughoutIsRefused) {
  const sim::MachineFile axis = table(-120.0);
  try {
    diagnose_axis(axis, {own_run(axis, 0.3, 0.0)});
    ADD_FAILURE() << "answered";
  } catch (const NoBalance& problem) {
    EXPECT_NE(std::string(problem.what()).find("own: TORQUE applies the brakes throughout"), std::string::npos) << problem.what();
  }
}

}  // namespace
}  // namespace slewlab::diagnosis
