// The diagnosis end to end on machines that the test itself makes: 20 boom elements where the diagnosis has 12,
// parameters off by up to 5 %, noise of ordinary sensors. The truth is known, so the expected answers are it.
#include "diagnosis/diagnose.h"
#include "diagnosis/judged_grid.h"

#include <Eigen/LU>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "controller/effects/catalogue.h"
#include "diagnosis/admit.h"
#include "diagnosis/nuisance.h"
#include "diagnosis/parameters_alone.h"
#include "diagnosis/prediction.h"
#include "diagnosis/stochastic.h"
#include "diagnosis/stochastic_fit.h"
#include "sim/effects/catalogue.h"
#include "sim/model/drive_line.h"
#include "tests/diagnosis/bench.h"
#include "tests/diagnosis/missing_torque.h"
#include "tests/diagnosis/simulated_log.h"
#include "tests/msgs/logged_log.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::diagnosis {
namespace {

// There and back, then inching.
Diagnosis diagnose_truth(const sim::MachineSettings& truth, const controller::ControllerSettings& controller, unsigned noise_seed,
                         const DiagnosisSettings& settings = {}, const Progress& progress = {},
                         const std::function<bool()>& is_stopped = {}) {
  std::vector<Record> records;
  records.push_back(make_record(simulated_log(truth, controller, kThereAndBack, kDuration, noise_seed), "a", bench().admission));
  records.push_back(make_record(simulated_log(truth, controller, kInching, kDuration, noise_seed + 1), "b", bench().admission));
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  return diagnose(nominal, bench().controller, std::move(records), settings, progress, is_stopped);
}

Diagnosis diagnose_machine(const std::vector<common::EffectInstance>& effects,
                           const controller::ControllerSettings& controller, unsigned seed,
                           const DiagnosisSettings& settings = {}) {
  sim::MachineSettings truth;
  truth.crane = spread_crane(seed);
  truth.effects = effects;
  return diagnose_truth(truth, controller, seed, settings);
}

constexpr double kThere = 13.0;  // [s] of kThereAndBack: begun, turned, braked; all that a controller does

// A ramp far from the settings' makes a replayed integral run away; its own times and shape are exact, so the fit must be.
TEST(FitController, FindsARampFarFromTheSettings) {
  const common::EffectInstance ramp{"other_ramp", {1.14, -0.05}};
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  std::vector<Record> records;
  records.push_back(make_record(simulated_log(truth, controller::with_effects(bench().controller, {ramp}), kThereAndBack, kThere, 5),
                                "a", bench().admission));
  const std::vector<ControllerCause> found = fit_controller(records, bench().controller, {});
  ASSERT_EQ(found.front().effects.size(), 1u);
  EXPECT_EQ(found.front().effects[0].name, "other_ramp");
  EXPECT_LT(found.front().share_left, 1e-3);
  EXPECT_NEAR(found.front().effects[0].values[0], 1.14, 1e-3);
  EXPECT_NEAR(found.front().effects[0].values[1], -0.05, 1e-3);
}

// Two settings of one controller: neither alone has no residual, and both together are exact.
TEST(FitController, FindsTwoEffectsOfOneController) {
  const std::vector<common::EffectInstance> both{{"droop", {2.4}}, {"speed_filter", {0.058}}};
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  std::vector<Record> records;
  records.push_back(make_record(simulated_log(truth, controller::with_effects(bench().controller, both), kThereAndBack, kThere, 7),
                                "a", bench().admission));
  const ControllerCause first = fit_controller(records, bench().controller, {}).front();
  EXPECT_LT(first.share_left, 1e-9);
  ASSERT_EQ(first.effects.size(), 2u);
  std::map<std::string, double> sizes;
  for (const common::EffectInstance& effect : first.effects) sizes[effect.name] = effect.values[0];
  EXPECT_NEAR(sizes["droop"], 2.4, 1e-3 * 2.4);
  EXPECT_NEAR(sizes["speed_filter"], 0.058, 1e-3 * 0.058);
}

// Of a recorder that was started after the drives: what the controller held by then is taken up anew for every effect that is tried, and all of
// them are compared over the same cycles, whatever they make of the filter's and the ramp's own times.
TEST(FitController, FindsAnEffectOfAControllerThatWasOnBefore) {
  const std::vector<common::EffectInstance> effects{{"speed_filter", {0.058}}, {"other_ramp", {1.14, -0.05}}};
  for (const common::EffectInstance& effect : effects) {
    sim::MachineSettings truth;
    truth.crane = bench().crane;
    msgs::RunLog log = simulated_log(truth, controller::with_effects(bench().controller, {effect}), kThereAndBack, kThere, 5);
    leave_out_beginning(log, 1500);
    const std::vector<Record> records{make_record(log, "a", bench().admission)};
    const ControllerCause first = fit_controller(records, bench().controller, {}).front();
    ASSERT_EQ(first.effects.size(), 1u);
    EXPECT_EQ(first.effects[0].name, effect.name);
    EXPECT_LT(first.share_left, 1e-3);
    EXPECT_NEAR(first.effects[0].values[0], effect.values[0], 1e-2 * effect.values[0]);
  }
}

// A delay of 40 ms in the observer's own feedback (its fastest pole is at 26 rad/s) would make it unstable. With the delay
// taken out of the record, the residual is that of a machine without any delay.
TEST(Shadow, FollowsEncodersThatReadLate) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  const Record on_time = make_record(simulated_log(truth, bench().controller, kThereAndBack, kDuration, 6), "a", bench().admission);
  Record late = on_time;
  const auto steps = static_cast<std::size_t>(std::lround(0.04 / late.step));
  for (int g = 0; g < late.group_count; ++g) {
    const auto i = static_cast<std::size_t>(g);
    for (std::size_t n = 0; n < late.size(); ++n) {
      late.shaft_position[i][n] = on_time.shaft_position[i][n >= steps ? n - steps : 0];
      late.position_rate[i][n] = on_time.position_rate[i][n >= steps ? n - steps : 0];
    }
  }
  const auto missing = [&](const sim::MachineSettings& machine, const Record& record) {
    double square = 0.0;
    // The last 40 ms are not known any more.
    const Shadow follower = shadow(machine, record, bench_gains());
    for (std::size_t n = 0; n + steps < record.size(); ++n) square += follower.missing_torque[0][n] * follower.missing_torque[0][n];
    return std::sqrt(square / static_cast<double>(record.size()));
  };
  sim::MachineSettings with_delay = truth;
  with_delay.effects = {{"encoder_delay", {0.04}}};
  EXPECT_NEAR(missing(with_delay, late), missing(truth, on_time), 1e-6 * missing(truth, on_time));
  EXPECT_GT(missing(truth, late), 2.0 * missing(truth, on_time));
}

// A ripple's order is multiplied by hundreds of turns of the motor: over the step that does for other parameters, a column of it says nothing. From one part
// in a thousand beside it the fit finds order and phase, and the residual is noise alone.
TEST(Fit, FindsTheOrderOfARippleOverHundredsOfTurns) {
  constexpr double kAmplitude = 20.0, kOrder = 2.0, kPhase = 0.7;
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.effects = {{"torque_ripple", {kAmplitude, kOrder, kPhase, kPhase, 0.0, 0.0, 0.0}}};
  BenchProblem problem;
  problem.add(make_record(simulated_log(truth, bench().controller, kThereAndBack, kDuration, 4), "log", bench().admission));
  Point start;
  start.nuisance.assign(nuisance_count(problem), 0.0);
  start.effects = {{"torque_ripple", {0.7 * kAmplitude, 1.001 * kOrder, kPhase - 0.5, kPhase - 0.5, 0.0, 0.0, 0.0}}};
  const auto nuisances = static_cast<Eigen::Index>(nuisance_count(problem));
  FitResult found = fit(problem, Eigen::MatrixXd::Zero(difference_count(problem), nuisances), start);
  settle(problem, found, 10);
  EXPECT_LT(mean_square(found.difference), 1.1);
  const std::vector<double>& values = found.point.effects[0].values;
  EXPECT_NEAR(values[0], kAmplitude, 0.02 * kAmplitude);
  EXPECT_NEAR(values[1], kOrder, 1e-4 * kOrder);
  EXPECT_NEAR(values[2], kPhase, 0.05);
}

// A ripple's phase grows over many turns, so full steps with the first columns diverge: with them alone this fit stops thousands above
// the noise. With its steps held back the fit's residual is no more than noise. The machine has other parameters than the nominal one, and a finer boom.
TEST(Fit, ArrivesWhereAFullStepIsTooBold) {
  sim::MachineSettings truth;
  truth.crane = spread_crane(43);
  truth.effects = {{"torque_ripple", {17.5, 3.0, 2.27, 2.27, -0.12, 0.275, 0.0}}};
  BenchProblem problem;
  problem.nominal = with_boom_elements(problem.nominal, kBoomElements);  // as every diagnosis has it
  for (const auto& [moves, seed] : {std::pair(kThereAndBack, 3U), std::pair(kInching, 4U)}) {
    problem.add(make_record(simulated_log(truth, bench().controller, moves, kDuration, seed), "a", bench().admission));
  }
  const FitResult base = fit_parameters_alone(problem, nominal_fit(problem));
  Point start;
  start.nuisance.assign(base.point.nuisance.size(), 0.0);
  start.effects = {{"torque_ripple", {17.21, 2.99992, 2.2504, 2.2504, -0.1124, 0.2783, 0.0}}};  // where undamped steps stand still
  FitResult result = fit(problem, base.columns, start);
  settle(problem, result, 5);
  EXPECT_LT(residual_power(result.difference, problem.settings), 0.0);
}

// Sensors without noise leave so little open that difference quotients over the usual steps lead nowhere; over finer ones the fit arrives where the machine is.
TEST(Fit, ArrivesWhereQuietSensorsLeaveLittleOpen) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.crane.boom.element_count = kBoomElements;
  truth.effects = {{"torque_lag", {0.03, 0.2}}, {"load_mass", {1.3}}};
  BenchProblem problem;
  problem.nominal = with_boom_elements(problem.nominal, kBoomElements);
  problem.add(make_record(quiet_log(truth, bench().controller, kInching, kDuration, 0.01), "a", bench().admission));
  const FitResult base = fit_parameters_alone(problem, nominal_fit(problem));
  FitResult result = fit(problem, base.columns, {std::vector<double>(base.point.nuisance.size(), 0.0), {{"torque_lag", {0.0293, 0.18}}, {"load_mass", {1.13}}}, 0});
  settle(problem, result, 10);
  EXPECT_LT(mean_square(result.difference), 0.1);
  EXPECT_NEAR(result.point.effects[1].values[0], 1.3, 0.01);
}

// A heel across the boom, begun as one that is four times as steep and mostly along it, which does nearly the same where the axis turns little: by length and angle a descent stays in the valley between
// the two. Judge: the fit that begins at the truth.
TEST(Fit, FollowsAnArrowAcrossItsPlane) {
  constexpr double kPeriod = 1e-2;             // [s]
  constexpr double kHeel = 7.5e-3, kAcross = 1.3;  // [rad]
  BenchProblem problem;
  problem.gains = shadow_gains(bench().machine.scales, not_faster_than(bench().thresholds.shadow, kPeriod));
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.effects = {{"heel", {kHeel, kAcross}}};
  problem.add(make_record(simulated_log(truth, bench().controller, kThereAndBack, kDuration, 4, kPeriod), "a", bench().admission));
  const auto from = [&](const common::EffectInstance& heel) {
    Point start;
    start.nuisance.assign(nuisance_count(problem), 0.0);
    start.effects = {heel};
    FitResult fitted = fit(problem, Eigen::MatrixXd::Zero(difference_count(problem), static_cast<Eigen::Index>(start.nuisance.size())), start);
    settle(problem, fitted, 10);
    return fitted;
  };
  const FitResult from_truth = from({"heel", {kHeel, kAcross}}), from_afar = from({"heel", {0.0214, 0.33}});
  EXPECT_LT(from_afar.cost, from_truth.cost + problem.settings.settled);
  EXPECT_NEAR(from_afar.point.effects[0].values[1], from_truth.point.effects[0].values[1], 0.2);
}

// Judge: the same machine with all modes of its boom, at 12 elements up to 2 kHz, and one whose fly jib bends and twists it.
TEST(Fit, ModesThatAreLeftOutWouldChangeLessThanTheNoise) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  const Record record = make_record(simulated_log(truth, bench().controller, kInching, kDuration, 8), "a", bench().admission);
  const ShadowGains gains = bench_gains();
  const WhiteningSettings& settings = bench().thresholds.whitening;
  const Shadow follower = shadow(truth, record, gains);
  const NoiseResponse response = noise_response(truth, record, gains, transform_length(record.size()));
  const Whitening whitening = make_whitening(record, trusted_stretches(record, follower, settings), response, follower, settings);
  for (const std::vector<common::EffectInstance>& effects : {std::vector<common::EffectInstance>{}, {{"flyjib_torsion", {5000.0, 3.0}}}}) {
    Point point;
    point.effects = effects;
    const BenchProblem problem;
    const sim::MachineSettings fitted = with_boom_elements(machine_at(problem.nominal, problem.nuisances, point), kBoomElements);
    sim::MachineSettings whole = fitted;
    whole.crane.boom.highest_frequency = 0.0;
    EXPECT_LT(sim::make_machine(fitted).model.mode_count, sim::make_machine(whole).model.mode_count * 2 / 3);
    const Eigen::VectorXd change = whiten(whitening, shadow(fitted, record, gains)) - whiten(whitening, shadow(whole, record, gains));
    EXPECT_LT(change.squaredNorm() / static_cast<double>(change.size()), 0.01);
  }
}

// A recorder that is started between two moves finds a load that swings on from those before, farther than one does on a crane that has not moved, drives that hold against it and a boom that
// rings. Taken for one that stands, a sound machine would have a residual of several times the noise.
TEST(Fit, FindsTheSwingThatMovesBeforeTheRecordHaveLeft) {
  const std::vector<Move> moves{{2.0, -0.42}, {13.1, 0.0}, {28.4, -0.40}, {35.8, 0.0}, {52.2, -0.74}, {58.2, 0.0}, {73.1, 0.72}, {81.4, 0.0}};
  constexpr double kPeriod = 0.01;  // [s]
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  controller::ControllerSettings controller = bench().controller;
  controller.period = kPeriod;
  const msgs::RunLog log = simulated_log(truth, controller, moves, 100.0, 8, kPeriod);
  for (const double begun : {21.5, 39.5, 40.5}) {
    msgs::RunLog part = log;
    leave_out_beginning(part, std::lround(begun / kPeriod));
    std::vector<Record> records{make_record(part, "a", bench().admission)};
    ASSERT_FALSE(records[0].begins_in_motion) << begun;
    Problem problem;
    std::vector<std::string> remarks;
    set_machine(truth, records, problem);
    admit(std::move(records), whitening_for(problem.thresholds, false), problem, remarks);
    EXPECT_TRUE(problem.records[0].begins_bent || problem.records[0].load_may_swing) << begun;
    const FitResult fitted = fit_parameters_alone(problem, nominal_fit(problem));
    EXPECT_LT(fitted.mean_square, 1.1) << begun;
  }
}

// The gears of two pairs of groups, which are pressed against each other and of which one has more play, strike at different times and push the house. A bearing's friction stops it, and no motor tells of boom, load and rod
// that swing on behind it when a recorder is started. Taken for such as stand, they were answered with a friction that follows the angle.
TEST(Fit, FindsTheSwingBehindAHouseThatFrictionHolds) {
  constexpr double kPeriod = 0.01, kFrom = 2.06;  // [s]
  const std::vector<Move> moves{{2.23, 0.78}, {31.2, 0.0}, {46.0, -0.77}, {66.8, 0.0}};
  sim::MachineSettings nominal;
  nominal.crane = sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/offshore_900t.yaml").parameters;
  sim::MachineSettings truth = nominal;
  truth.effects = {{"uneven_play", {3e-4}}, {"bearing_coulomb", {7.8e5, 0.0, 5e-5}}};
  const controller::ControllerSettings controller = controller::load_controller_file(SLEWLAB_SOURCE_DIR "/config/controllers/offshore_900t.yaml").settings;
  msgs::RunLog log = simulated_log(truth, controller, moves, 82.0, 8, kPeriod);
  leave_out_beginning(log, std::lround(kFrom / kPeriod));
  log.sensors.clear();
  std::vector<Record> records{make_record(log, "a", thresholds_of(sim::describe(nominal.crane)).admission)};
  Problem problem;
  std::vector<std::string> remarks;
  set_machine(nominal, records, problem);
  admit(std::move(records), whitening_for(problem.thresholds, false), problem, remarks);
  Point start = nominal_fit(problem).point;
  start.effects = truth.effects;
  FitResult fitted = fit_at(problem, start);
  fit_beginnings(problem, fitted);
  settle(problem, fitted, 10);
  EXPECT_LT(mean_square(fitted.difference), 1.0);
  EXPECT_NEAR(fitted.point.effects[1].values[0], 7.8e5, 0.1 * 7.8e5);
}

// A log of slewlab's own that begins in mid-slew, without noise: the machine answers linearly to how it begins, as long as no tooth leaves its flank.
TEST(Fit, FindsHowALogWithoutNoiseBeginsInMotion) {
  constexpr double kPeriod = 0.01, kFrom = 18.0;  // [s]
  const std::vector<Move> moves{{2.0, 0.3}, {11.0, 0.0}, {17.0, 0.15}, {26.0, 0.0}, {32.0, -0.3}, {41.0, 0.0}};
  sim::MachineSettings truth;
  truth.crane = sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/harbour_5t.yaml").parameters;
  const controller::ControllerSettings controller = controller::load_controller_file(SLEWLAB_SOURCE_DIR "/config/controllers/harbour_5t.yaml").settings;
  msgs::RunLog log = quiet_log(truth, controller, moves, 55.0, kPeriod);
  leave_out_beginning(log, std::lround(kFrom / kPeriod));
  std::vector<Record> records{make_record(log, "a", thresholds_of(sim::describe(truth.crane)).admission)};
  Problem problem;
  std::vector<std::string> remarks;
  set_machine(truth, records, problem);
  admit(std::move(records), whitening_for(problem.thresholds, false), problem, remarks);
  const FitResult nominal = nominal_fit(problem), fitted = fit_parameters_alone(problem, nominal);
  const std::optional<FitResult> begun = nominal_with_beginnings(problem, fitted);
  ASSERT_TRUE(begun);
  EXPECT_GT(nominal.mean_square, 100.0);
  EXPECT_LT(begun->mean_square, 0.2);
  EXPECT_LE(fitted.cost, begun->cost);  // parameters beside it have no larger cost than none
}

// A pendulum let go from an angle, or passing its lowest point, while the crane stands and then moves.
TEST(Fit, FindsTheSwingThatALoadHasWhenTheRecordBegins) {
  const sim::LoadParameters& load = bench().crane.load;
  struct Swing {
    double angle, rate;  // [rad], [rad/s]
  };
  const std::array<Swing, 2> swings{{{8e-3, 0.0}, {-3e-3, 2e-3}}};
  BenchProblem problem;
  for (const Swing& swing : swings) {
    sim::MachineSettings truth;
    truth.crane = bench().crane;
    truth.step = kStep;
    sim::Machine machine = sim::make_machine(truth);
    const Eigen::Vector2d line(load.rope_length, 1.0);  // rope's end and rod's angle per angle of the line
    const Eigen::Vector2d shape = machine.model.load.modes.inverse() * line;
    for (int j = 0; j < 2; ++j) {
      machine.state.load_q[static_cast<std::size_t>(j)] = shape(j) * swing.angle;
      machine.state.load_v[static_cast<std::size_t>(j)] = shape(j) * swing.rate;
    }
    sim::refresh(machine.model, machine.state);
    sim::forget_past(machine);
    EXPECT_NEAR(sim::rope_angle(machine.model, machine.state), swing.angle, 1e-12);
    EXPECT_NEAR(sim::rod_angle(machine.model, machine.state), swing.angle, 1e-12);
    problem.add(make_record(simulated_log(machine, bench().controller, kThereAndBack, kDuration, 3), "a", bench().admission));
  }
  const FitResult nominal = nominal_fit(problem), fitted = fit_parameters_alone(problem, nominal);
  // Taken for a load that hangs still it is a gap many times an effect's cost.
  EXPECT_GT(residual_power(nominal.difference, problem.settings), fitted.residual_power + 1000.0);
  for (std::size_t r = 0; r < swings.size(); ++r) {
    const Beginning found = beginning_of(problem.nuisances, fitted.point.nuisance, r);
    EXPECT_NEAR(found.swing, swings[r].angle, 5e-4);
    EXPECT_NEAR(found.swing_rate, swings[r].rate, 2e-4);
  }
}

// Nothing stands for the jitter's mean here; the effect found beside it is not taken for that.
TEST(StochasticFits, NameTheSecondEffectWhereNoDelayWasFitted) {
  const std::vector<common::EffectInstance> both{{"command_jitter", {0.03}}, {"bearing_coulomb", {1e5, 0.0, 3e-5}}};
  sim::MachineSettings truth;
  truth.crane = spread_crane(18);
  truth.effects = both;
  truth.seed = 99;
  BenchProblem problem;
  problem.add(make_record(simulated_log(truth, bench().controller, kThereAndBack, kDuration, 18), "a", bench().admission));
  const FitResult nothing = fit_parameters_alone(problem, nominal_fit(problem));
  const Projector project(nothing.columns, prior_rows(problem, nothing.point), data_weight(nothing.difference, problem.settings));
  const Progress quiet = [](double, const std::string&) {};
  const Screening screening = screen(problem, nothing, project, both, quiet);
  std::set<std::vector<std::string>> named;
  for (const FitResult& result : stochastic_fits(problem, screening, nothing, {}, quiet)) {
    std::vector<std::string> names;
    for (const common::EffectInstance& effect : result.point.effects) names.push_back(effect.name);
    named.insert(names);
  }
  EXPECT_TRUE(named.contains({"command_jitter", "bearing_coulomb"}));
}

TEST(Diagnose, SaysNothingIsMissingWhereOnlyParametersAreOff) {
  const Diagnosis found = diagnose_machine({}, bench().controller, 11);
  EXPECT_FALSE(found.gap);
  EXPECT_FALSE(found.controller_differs);
  EXPECT_GT(found.probability_nothing, 0.5);
  // Four accelerometers at 1 kHz show dry friction of nearly every size; of encoders' scales and compression most sizes are within what parameters may be.
  EXPECT_GT(found.probability_hidden, 0.0);
  EXPECT_LT(found.probability_hidden, 0.2);
  const auto is_hidden = [&](const char* effect) { return std::find(found.hidden.begin(), found.hidden.end(), effect) != found.hidden.end(); };
  EXPECT_TRUE(is_hidden("encoder_scale"));
  EXPECT_FALSE(is_hidden("bearing_coulomb"));
  // Parameters off by 5 % are a gap until they are fitted.
  EXPECT_LT(found.mean_square_parameters, found.mean_square_nominal);
}

// A sound crane whose tip accelerometer has an offset that wanders by 20 mm/s^2 within 19 s, seen by no other sensor: a roll of the vessel would shake it so, and would not be sure.
TEST(Diagnose, IsNotSureOfWhatAnOffsetThatWandersDoes) {
  constexpr double kWanders = 0.02, kWithin = 19.0, kPeriod = 1e-2;  // [m/s^2], [s], [s]
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.crane.boom.element_count = kBoomElements;
  std::vector<Record> records;
  for (const auto& [moves, name, seed] : {std::tuple(kThereAndBack, "a", 4u), std::tuple(kInching, "b", 5u)}) {
    Record& record = records.emplace_back(make_record(simulated_log(truth, bench().controller, moves, kDuration, seed, kPeriod), name, bench().admission));
    for (std::size_t a = 0; a < kAccelerometerCount; ++a) {
      if (a != kTip) record.acceleration[a].clear();
    }
    for (std::size_t n = 0; n < record.size(); ++n) record.acceleration[kTip][n] += kWanders * std::sin(2.0 * std::numbers::pi * static_cast<double>(n) * record.step / kWithin + seed);
  }
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  const Diagnosis found = diagnose(nominal, bench().controller, std::move(records), {});
  EXPECT_FALSE(found.causes[0].probability > 0.7 && !found.causes[0].effects.empty()) << found.verdict << found.causes[0].probability;
}

// One accelerometer at the tip that reads 6 % too little beside others that do not is no scale of the encoders, and the machine is judged with it.
TEST(Diagnose, TakesAnAccelerometersGainForAPartOfTheMachine) {
  constexpr double kGain = 0.94;
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.crane.boom.element_count = kBoomElements;
  truth.crane.sensors.tip_gain = kGain;
  const Diagnosis found = diagnose_truth(truth, bench().controller, 5);
  EXPECT_FALSE(found.gap) << found.verdict;
  ASSERT_FALSE(found.causes.empty());
  ASSERT_TRUE(found.causes[0].effects.empty()) << found.verdict;
  EXPECT_GT(found.probability_nothing + found.probability_hidden, 0.95);
  const auto tip = std::find_if(found.gains.begin(), found.gains.end(), [](const AccelerometerGain& one) { return one.name == "tip accelerometer gain"; });
  ASSERT_NE(tip, found.gains.end());
  EXPECT_NEAR(tip->gain, kGain, 0.01);
}

// Beside an effect as well: no effect does what one of four accelerometers does that reads 6 % too much.
TEST(Diagnose, TakesAnAccelerometersGainBesideAnEffect) {
  constexpr double kGain = 1.06, kLag = 0.03;  // [-], [s]
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.crane.boom.element_count = kBoomElements;
  truth.crane.sensors.tip_gain = kGain;
  truth.effects = {{"torque_lag", {kLag, 0.0}}};
  const Diagnosis found = diagnose_truth(truth, bench().controller, 5);
  ASSERT_FALSE(found.causes.empty());
  ASSERT_EQ(found.causes[0].effects, std::vector<std::string>{"torque_lag"}) << found.verdict;
  EXPECT_GT(found.lead_acts, 0.95);
  EXPECT_NEAR(found.causes[0].point.effects[0].values[0], kLag, 0.02 * kLag);
  const auto tip = std::find_if(found.gains.begin(), found.gains.end(), [](const AccelerometerGain& one) { return one.name == "tip accelerometer gain"; });
  ASSERT_NE(tip, found.gains.end());
  EXPECT_NEAR(tip->gain, kGain, 0.01);
}

// With the tip's accelerometer alone nothing tells which of the two counts wrong, and none is sure, whichever it is.
TEST(Diagnose, IsNotSureWhetherEncodersOrAnAccelerometerCountWrong) {
  constexpr double kOff = 1.08, kPeriod = 1e-2;  // [-], [s]
  for (const bool is_accelerometer : {true, false}) {
    sim::MachineSettings truth;
    truth.crane = bench().crane;
    truth.crane.boom.element_count = kBoomElements;
    if (is_accelerometer) truth.crane.sensors.tip_gain = kOff;
    else truth.effects = {{"encoder_scale", {kOff - 1.0}}};
    std::vector<Record> records;
    for (const auto& [moves, name, seed] : {std::tuple(kThereAndBack, "a", 4u), std::tuple(kInching, "b", 5u)}) {
      Record& record = records.emplace_back(make_record(simulated_log(truth, bench().controller, moves, kDuration, seed, kPeriod), name, bench().admission));
      for (std::size_t a = 0; a < kAccelerometerCount; ++a) {
        if (a != kTip) record.acceleration[a].clear();
      }
    }
    sim::MachineSettings nominal;
    nominal.crane = bench().crane;
    const Diagnosis found = diagnose(nominal, std::nullopt, std::move(records), {});
    const bool is_scale = !found.causes.empty() && found.causes[0].effects == std::vector<std::string>{"encoder_scale"};
    EXPECT_FALSE(is_scale && found.causes[0].probability > 0.7) << is_accelerometer << " " << found.causes[0].probability;
    EXPECT_FALSE(!is_accelerometer && !found.gap && found.probability_nothing > 0.7) << found.probability_nothing;
    EXPECT_TRUE(std::any_of(found.remarks.begin(), found.remarks.end(), [](const std::string& remark) { return remark.find("tip accelerometer gain") != std::string::npos; })) << is_accelerometer << " " << found.verdict;
  }
}

// What the file says of the drive is no effect that is missing.
TEST(Diagnose, SaysNothingIsMissingWhereTheFilesOwnDriveLimitsTheTorque) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.drive_protection.torque_limit = 200.0;  // [Nm] of the 232 that play compensation asks of one half
  const Record record = make_record(simulated_log(truth, bench().controller, kThereAndBack, kDuration, 31), "own", bench().admission);
  const Diagnosis own = diagnose(truth, bench().controller, {record}, {});
  EXPECT_FALSE(own.gap) << own.verdict;
  EXPECT_GT(own.probability_nothing, 0.5);
  sim::MachineSettings forgetful = truth;
  forgetful.drive_protection = {};
  const Diagnosis other = diagnose(forgetful, bench().controller, {record}, {});
  ASSERT_FALSE(other.causes.empty());
  EXPECT_EQ(other.causes[0].effects, std::vector<std::string>{"torque_limit"}) << "the record must show the limit for the test to say anything";
}

// A PLC's recorder that was started after the drives: the teeth stand on their flanks, wound up, and every encoder has a zero of its own.
TEST(Diagnose, SaysNothingIsMissingOfALogThatBeginsWithTheDrivesOn) {
  sim::MachineSettings nominal, truth;
  nominal.crane = bench().crane;
  truth.crane = spread_crane(33);
  std::vector<Record> records;
  for (const auto* moves : {&kThereAndBack, &kInching}) {
    msgs::RunLog log = simulated_log(truth, bench().controller, *moves, kDuration, 33);
    leave_out_beginning(log, 1500);
    for (msgs::Encoder& encoder : log.encoder) encoder.shaft_position[1] += 0.4;  // [rad]
    records.push_back(make_record(log, moves == &kInching ? "b" : "a", bench().admission));
  }
  const Diagnosis found = diagnose(nominal, {}, records, {});
  EXPECT_FALSE(found.gap) << found.verdict;
  EXPECT_LT(found.mean_square_parameters, 1.2);
}

// A recorder that was started while the drives held a crane that had just come to rest: nothing pushes it on its way, but boom and load still swing, and the
// motors with them. Taken for one that stands, a sound machine would have a residual of many times the noise.
TEST(Diagnose, SaysNothingIsMissingOfALogThatBeginsWhileACraneAtRestStillSwings) {
  sim::MachineSettings nominal, truth;
  nominal.crane = bench().crane;
  truth.crane = spread_crane(33);
  msgs::RunLog log = simulated_log(truth, bench().controller, kThereAndBack, kDuration, 33);
  const double creeping = creeping_speed(bench().admission);
  std::optional<Record> record;
  for (std::size_t from = 4000; !record && from < 14000; from += 100) {
    msgs::RunLog rest = log;
    leave_out_beginning(rest, static_cast<std::ptrdiff_t>(from));
    const Record one = make_record(rest, "a", bench().admission);
    const bool swings = std::fabs(one.shaft_speed[0][0]) > 3.0 * creeping || std::fabs(one.shaft_speed[1][0]) > 3.0 * creeping;
    if (!one.begins_in_motion && swings) record = one;
  }
  ASSERT_TRUE(record) << "the manoeuvre must have such a moment for the test to say anything";
  const Diagnosis found = diagnose(nominal, {}, {*record}, {});
  EXPECT_FALSE(found.gap) << found.verdict;
  EXPECT_LT(found.mean_square_parameters, 1.2);
}

// The logs that slewlab itself writes at a PLC's rate of 10 ms: no noise to hide behind, the boom cut as its file has it, and a model that steps as coarsely.
Diagnosis diagnose_own_logs(const sim::MachineSettings& truth, const std::vector<std::vector<Move>>& manoeuvres, const DiagnosisSettings& diagnosis_settings = {},
                            const std::function<void(msgs::RunLog&)>& as_measured = {}, controller::ControllerSettings controller = bench().controller) {
  controller.period = 0.01;
  std::vector<Record> records;
  for (const std::vector<Move>& moves : manoeuvres) {
    msgs::RunLog log = quiet_log(truth, controller, moves, kDuration, controller.period);
    AdmissionSettings admission = bench().admission;
    admission.is_torque_measured = as_measured != nullptr;
    if (as_measured) as_measured(log);
    records.push_back(make_record(log, fmt::format("own {}", records.size()), admission));
  }
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  if (as_measured) return diagnose(nominal, std::nullopt, std::move(records), diagnosis_settings);
  return diagnose(nominal, controller, std::move(records), diagnosis_settings);
}

TEST(Diagnose, SaysNothingIsMissingOfTheNominalCraneAtThePlcsOwnRate) {
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  const Diagnosis found = diagnose_own_logs(nominal, {kThereAndBack});
  EXPECT_FALSE(found.gap) << found.verdict;
  EXPECT_GT(found.probability_nothing, 0.9);
}

// Friction makes a gap, so the boom is cut finer at first, and what the other mesh makes wrong shows as a house of another inertia.
// Where the residual with the file's own mesh is next to nothing, that mesh is the log's.
TEST(Diagnose, CutsTheBoomOfAnOwnLogAsItsFileHasIt) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.effects = {{"bearing_viscous", {5e6, 0.0}}};  // [Nms/rad]
  DiagnosisSettings settings;
  settings.hold_out = true;
  const Diagnosis found = diagnose_own_logs(truth, {kThereAndBack, kInching}, settings);
  EXPECT_EQ(found.boom_elements, truth.crane.boom.element_count);
  ASSERT_FALSE(found.causes.empty());
  EXPECT_EQ(found.causes[0].effects, std::vector<std::string>{"bearing_viscous"});
  EXPECT_GT(found.causes[0].probability, 0.8);
  EXPECT_NEAR(found.causes[0].sizes[0].value, 5e6, 0.03 * 5e6);  // its interval is 8 % either side
}

// Teeth that knock for half of the record, without noise. Where it is judged, parameters follow the numerical error behind impacts, far below the
// floor, and nothing is missing for that.
TEST(Diagnose, SaysNothingIsMissingOfAnOwnLogThatKnocks) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  controller::ControllerSettings pushing = bench().controller;
  pushing.play_compensation.enabled = false;
  const Diagnosis found = diagnose_own_logs(truth, {kThereAndBack}, {}, {}, pushing);
  EXPECT_FALSE(found.gap) << found.verdict;
  EXPECT_LE(found.mean_square_nominal, 1.0);
}

// An own log out of the midst of a slew, without noise: how load, motors and boom stood when it begins is no property of the machine. The whole log
// has no residual, and neither may its end have one.
TEST(Diagnose, SaysNothingIsMissingOfAnOwnLogCutOutOfASlew) {
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  controller::ControllerSettings controller = bench().controller;
  controller.period = 0.01;
  const msgs::RunLog whole = quiet_log(nominal, controller, kThereAndBack, 1.5 * kDuration, controller.period);
  constexpr std::int64_t kFrom = 7'000'000'000;  // [ns] in the midst of the first turn
  std::vector<Record> records;
  const TemporaryFolder folder;
  const msgs::LoggedRun logged = msgs::logged(whole, folder.path() / "run.lcmlog");
  records.push_back(make_record(msgs::read_run(logged, kFrom, whole.encoder.back().simulated_time), "its end", bench().admission));
  DiagnosisSettings settings;
  for (const common::EffectAbout& about : sim::effects_for(bench().crane).effects) {
    if (about.name != "hoisting" && about.name != "torque_offset" && about.name != "load_mass") settings.without.emplace_back(about.name);
  }
  const Diagnosis found = diagnose(nominal, controller, std::move(records), settings);
  EXPECT_FALSE(found.gap) << found.verdict;
  EXPECT_LE(found.mean_square_nominal, 1.0);
  EXPECT_EQ(found.boom_elements, nominal.crane.boom.element_count);
  EXPECT_GT(found.probability_nothing + found.probability_hidden, 0.99);
}

// A load a fifth heavier changes what the encoders show by less than mesh and step are taken to make wrong, and yet the record tells it.
TEST(Diagnose, SeesBelowTheFloorWhereAMachineFollowsFarBelowIt) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.crane.load.mass *= 1.2;
  const Diagnosis found = diagnose_own_logs(truth, {kThereAndBack});
  EXPECT_TRUE(found.gap) << found.verdict;
  ASSERT_FALSE(found.causes.empty());
  EXPECT_EQ(found.causes[0].effects, std::vector<std::string>{"load_mass"});
  EXPECT_GT(found.causes[0].probability, 0.7);
  EXPECT_NEAR(found.causes[0].sizes[0].value, 1.2, 0.01);
}

// Twice the play, crossed once, both groups together: what the impact starts shows afterwards, where parameters that follow the nominal machine's impact lead elsewhere.
TEST(Diagnose, FindsAWiderPlayThatIsCrossed) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  constexpr double kAdded = 5e-4;  // [rad] as much as there is
  truth.effects = {{"larger_play", {kAdded}}};
  std::vector<Record> records;
  controller::ControllerSettings pushing = bench().controller;
  pushing.play_compensation.enabled = false;
  records.push_back(make_record(simulated_log(truth, pushing, {{0.02, 1.0}, {4.0, -1.0}}, 14.0, 7), "a", bench().admission));
  records.push_back(make_record(simulated_log(truth, bench().controller, kAcrossThePlay, kDuration, 8), "b", bench().admission));
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  const Diagnosis found = diagnose(nominal, std::nullopt, std::move(records), {});
  ASSERT_FALSE(found.causes.empty());
  EXPECT_EQ(found.causes[0].effects, std::vector<std::string>{"larger_play"}) << found.verdict;
  EXPECT_GT(found.causes[0].probability, 0.6);
  EXPECT_NEAR(found.causes[0].sizes[0].value, kAdded, 0.05 * kAdded);
}

// Torques that were measured, with noise of 0.5 % of the rated one, encoders of 14 bits and nothing else: what the machine never had shakes the model. What lies before the torques is not named.
TEST(Diagnose, TakesWhatScattersInMeasuredTorquesForNoise) {
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  std::mt19937_64 engine(8);
  std::normal_distribution<double> normal(0.0, 0.005 * nominal.crane.drive.rated_torque);  // [Nm]
  const double count = 2.0 * std::numbers::pi / 16384.0;  // [rad]
  const Diagnosis found = diagnose_own_logs(nominal, {kThereAndBack, kInching}, {}, [&](msgs::RunLog& log) {
    log.sensors.clear();
    for (msgs::Torque& torque : log.torque) {
      for (double& one : torque.motor_torque) one += normal(engine);
    }
    for (msgs::Encoder& encoder : log.encoder) {
      for (double& one : encoder.shaft_position) one = count * std::round(one / count);
    }
  });
  EXPECT_FALSE(found.gap) << found.verdict;
  EXPECT_GT(found.probability_nothing + found.probability_hidden, 0.9);
  EXPECT_TRUE(std::any_of(found.remarks.begin(), found.remarks.end(), [](const std::string& remark) { return remark.find("torque_lag") != std::string::npos; }));
}

// Friction that depends on the place has a valley for every length with which it may come again. Beside the pinions' mesh, by which the length of none stands out, a fit of both ends in one of
// the wrong ones, with plain friction before it; on the machine with that mesh the true length stands out.
TEST(Diagnose, FindsTheLengthWithWhichFrictionRecursBesideALargerEffect) {
  sim::MachineSettings truth, nominal;
  truth.crane = spread_crane(54);
  truth.effects = {{"pinion_mesh_variation", {0.16, -2.1, -2.1, 0.0, 0.0, 0.0}}, {"bearing_uneven", {3e5, 0.5, 0.18, -0.2, 0.0, 0.0, 0.0, 3e-5}}};
  nominal.crane = bench().crane;
  DiagnosisSettings settings;
  for (const common::EffectAbout& about : sim::effects_for(bench().crane).effects) {
    if (about.name != "pinion_mesh_variation" && about.name != "bearing_uneven" && about.name != "bearing_coulomb") settings.without.emplace_back(about.name);
  }
  std::vector<Record> records;
  unsigned noise = 54;
  for (const auto& [name, moves] : {std::pair("a", kThereAndBack), std::pair("b", kInching)}) {
    records.push_back(make_record(simulated_log(truth, bench().controller, moves, kDuration, noise++, 0.01), name, bench().admission));
  }
  const Diagnosis found = diagnose(nominal, std::nullopt, std::move(records), settings);
  ASSERT_FALSE(found.causes.empty());
  EXPECT_EQ(std::set<std::string>(found.causes[0].effects.begin(), found.causes[0].effects.end()), (std::set<std::string>{"bearing_uneven", "pinion_mesh_variation"})) << found.verdict;
  const auto length = std::find_if(found.causes[0].sizes.begin(), found.causes[0].sizes.end(), [](const Size& size) { return size.parameter == "bearing_uneven.wavelength"; });
  ASSERT_NE(length, found.causes[0].sizes.end());
  EXPECT_NEAR(length->value, 0.18, 0.03 * 0.18);
}

// Cables that wind up: a torque over the slew angle that is no law of the catalogue, and near to that of a tilted axis or a wind, alone or with
// another. The residual of each of them follows the angle, and so does that of nothing missing: a function of the angle alone explains it all.
TEST(Diagnose, KnowsALawOfTheAngleFromItsRelatives) {
  sim::MachineSettings truth, nominal;
  truth.crane = spread_crane(31);
  nominal.crane = bench().crane;
  const std::set<std::string_view> kept{"tilted_axis", "bearing_viscous", "bearing_coulomb", "torque_offset", "house_inertia", "load_mass", "air_drag", "bearing_rising", "heel", "wind", "encoder_scale"};
  DiagnosisSettings settings;
  settings.hold_out = true;
  for (const common::EffectAbout& about : sim::effects_for(bench().crane).effects) {
    if (!kept.contains(about.name)) settings.without.emplace_back(about.name);
  }
  std::vector<Record> records;
  unsigned noise = 31;
  // In a record the angle is a function of the time as well: it takes three to tell which one the residual follows.
  for (const auto& [name, moves] : {std::pair("a", kThereAndBack), std::pair("b", kInching), std::pair("c", kFarToTheOther)}) {
    msgs::RunLog log = simulated_log(truth, bench().controller, moves, kDuration, noise++, 0.01);
    const auto wound = [](const MotorState& state) { return -8.0 * (state.angle / 0.2 + std::pow(state.angle / 0.2, 3)); };  // [Nm], 0.2 rad being what is slewed
    take_off(wound, log);
    records.push_back(make_record(log, name, bench().admission));
  }
  const Diagnosis found = diagnose(nominal, std::nullopt, std::move(records), settings);
  EXPECT_TRUE(found.gap);
  EXPECT_TRUE(found.is_unknown) << found.verdict;
  EXPECT_GT(found.probability_unknown, 0.6);
  EXPECT_EQ(followed_variables(found.discrepancies), std::vector<std::string>{"angle"});
}

TEST(Diagnose, NamesBearingFrictionWithItsSize) {
  DiagnosisSettings settings;
  settings.hold_out = true;
  const Diagnosis found = diagnose_machine({{"bearing_coulomb", {1e5, 0.0, 3e-5}}}, bench().controller, 12, settings);
  ASSERT_FALSE(found.causes.empty());
  EXPECT_TRUE(found.gap);
  EXPECT_EQ(found.causes[0].effects, std::vector<std::string>{"bearing_coulomb"});
  ASSERT_FALSE(found.causes[0].sizes.empty());
  EXPECT_NEAR(found.causes[0].sizes[0].value, 1e5, 0.1 * 1e5);
  EXPECT_EQ(found.subsystems[0].first, "house");
  // The same size from the first record alone.
  ASSERT_TRUE(found.held_out);
  EXPECT_EQ(found.held_out->record, "b");
  EXPECT_FALSE(found.held_out->is_half);
  ASSERT_EQ(found.held_out->point.effects.size(), 1u);
  EXPECT_NE(found.held_out->point.effects[0].values[0], found.causes[0].point.effects[0].values[0]);
  EXPECT_NEAR(found.held_out->point.effects[0].values[0], 1e5, 0.1 * 1e5);
}

// Angles near half a turn, from which a descent that stops there does not come back.
TEST(Diagnose, FindsAnglesBeyondHalfATurn) {
  const Diagnosis found = diagnose_machine({{"encoder_ripple", {0.008, -3.0, 2.9, 0.1, 0.0}}}, bench().controller, 15);
  ASSERT_FALSE(found.causes.empty());
  EXPECT_EQ(found.causes[0].effects, std::vector<std::string>{"encoder_ripple"});
  ASSERT_EQ(found.causes[0].sizes.size(), 5u);
  EXPECT_NEAR(found.causes[0].sizes[0].value, 0.008, 0.05 * 0.008);
  // From where the motor stands as a record begins, which is fitted as well: either angle alone may be off by what the other one is.
  for (std::size_t record = 0; record < 2; ++record) {
    const Beginning beginning = beginning_of(found.nuisances, found.causes[0].point.nuisance, record);
    for (const auto& [group, phase] : {std::pair(0, -3.0), std::pair(1, 2.9)}) {
      const double stands = beginning.motor_offset[static_cast<std::size_t>(group)] * sim::total_ratio(bench().crane.drive);
      const double fitted = found.causes[0].sizes[static_cast<std::size_t>(1 + group)].value;
      EXPECT_NEAR(std::remainder(fitted + stands - phase, 2.0 * std::numbers::pi), 0.0, 0.005) << record << " " << group;
    }
  }
}

// A defect sits in one rotor: with one amplitude for all of them its ripple has no law but a stochastic one's power.
TEST(Diagnose, NamesARippleInOneHalfOfTheGroups) {
  constexpr double kMean = 7.5, kOrder = 6.0;  // [Nm], [-]
  DiagnosisSettings settings;
  for (const common::EffectAbout& about : sim::effects_for(bench().crane).effects) {
    if (about.name != "torque_ripple" && !is_stochastic(about)) settings.without.emplace_back(about.name);
  }
  const Diagnosis found = diagnose_machine({{"torque_ripple", {kMean, kOrder, 1.3, 0.0, 0.2, 0.0, 1.0}}}, bench().controller, 17, settings);
  ASSERT_FALSE(found.causes.empty());
  EXPECT_EQ(found.causes[0].effects, std::vector<std::string>{"torque_ripple"}) << found.verdict;
  ASSERT_EQ(found.causes[0].sizes.size(), 7u);
  EXPECT_NEAR(found.causes[0].sizes[0].value, kMean, 0.05 * kMean);
  EXPECT_NEAR(found.causes[0].sizes[6].value, 1.0, 0.05);
}

// The larger effect leaves a machine on which the smaller one looks otherwise than on the nominal one. On the way: simulations are the
// clock; what the progress forecasts from them once a fifth is done is right within a factor of 1.5.
TEST(Diagnose, FindsTheSmallerOfTwoEffectsAndForecastsItsEnd) {
  sim::MachineSettings truth;
  truth.crane = spread_crane(16);
  truth.effects = {{"gear_friction", {0.12, 0.001}}, {"uneven_gearbox_stiffness", {0.45, 0.0}}};
  DiagnosisSettings settings;
  settings.hold_out = true;
  std::atomic<int> simulations{0};
  std::vector<std::pair<double, int>> told;  // share, simulations until then
  const Diagnosis found = diagnose_truth(
      truth, bench().controller, 16, settings, [&](double share, const std::string&) { told.emplace_back(share, simulations); },
      [&] { return ++simulations, false; });
  ASSERT_FALSE(found.causes.empty());
  const std::set<std::string> named(found.causes[0].effects.begin(), found.causes[0].effects.end());
  std::string table;
  for (std::size_t i = 0; i < std::min<std::size_t>(6, found.causes.size()); ++i) {
    table += fmt::format(" | {} {:.3f} (residual variance ratio {:.3g}, residual_power {:.0f})", name_of(found.causes[i]), found.causes[i].probability, found.causes[i].mean_square, found.causes[i].residual_power);
  }
  EXPECT_EQ(named, (std::set<std::string>{"gear_friction", "uneven_gearbox_stiffness"})) << found.verdict << table;
  EXPECT_EQ(found.simulations, simulations);
  int forecasts = 0;
  for (const auto& [share, until] : told) {
    if (share < 0.2) continue;
    ++forecasts;
    EXPECT_GT(until / share, simulations / 1.5) << share;
    EXPECT_LT(until / share, simulations * 1.5) << share;
  }
  EXPECT_GT(forecasts, 20);
}

// Without sensors' noise what a finer boom does, and an impact that the nominal machine has not, outweigh a second effect.
TEST(Diagnose, NamesAHeavierLoadBesideALagWhereSensorsAreQuiet) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.crane.boom.element_count = 20;
  truth.effects = {{"torque_lag", {0.03, 0.2}}, {"load_mass", {1.3}}};
  std::vector<Record> records;
  for (const auto& [name, moves] : {std::pair("a", kThereAndBack), std::pair("b", kInching)}) {
    records.push_back(make_record(quiet_log(truth, bench().controller, moves, kDuration, kStep), name, bench().admission));
  }
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  DiagnosisSettings settings;
  settings.hold_out = false;
  settings.threads = 2;
  const Diagnosis found = diagnose(nominal, bench().controller, std::move(records), settings, [](double, const std::string&) {});
  ASSERT_FALSE(found.causes.empty());
  const std::set<std::string> named(found.causes[0].effects.begin(), found.causes[0].effects.end());
  EXPECT_EQ(named, (std::set<std::string>{"torque_lag", "load_mass"})) << found.verdict;
  EXPECT_GT(found.causes[0].probability, 0.9);
}

// Asked in the middle, it ends before the next simulation of each thread.
TEST(Diagnose, EndsWhereItIsAskedTo) {
  DiagnosisSettings settings;
  settings.threads = 2;
  std::atomic<int> asked{0};
  sim::MachineSettings truth;
  truth.crane = spread_crane(11);
  EXPECT_THROW(diagnose_truth(truth, bench().controller, 11, settings, {}, [&] { return ++asked > 100; }), Interrupted);
  EXPECT_LE(asked, 102);
}

// Which thread did what is nowhere in the answer. With five effects of the catalogue, to be short.
TEST(Diagnose, AnswersTheSameOnAnyNumberOfThreads) {
  DiagnosisSettings settings;
  const std::set<std::string_view> kept{"gear_friction", "bearing_viscous", "torque_lag", "command_jitter", "uneven_gearbox_stiffness"};
  for (const sim::EffectDescription* effect : sim::effect_catalogue()) {
    if (!kept.contains(effect->about.name)) settings.without.emplace_back(effect->about.name);
  }
  std::vector<Diagnosis> found;
  for (const int threads : {1, 3}) {
    settings.threads = threads;
    found.push_back(diagnose_machine({{"gear_friction", {0.12, 0.001}}}, bench().controller, 19, settings));
  }
  EXPECT_EQ(found[0].simulations, found[1].simulations);
  ASSERT_EQ(found[0].causes.size(), found[1].causes.size());
  for (std::size_t i = 0; i < found[0].causes.size(); ++i) {
    const Cause &one = found[0].causes[i], &other = found[1].causes[i];
    EXPECT_EQ(one.effects, other.effects);
    EXPECT_EQ(one.probability, other.probability);
    EXPECT_EQ(one.residual_power, other.residual_power);
    EXPECT_EQ(one.point.nuisance, other.point.nuisance);
    ASSERT_EQ(one.sizes.size(), other.sizes.size());
    for (std::size_t k = 0; k < one.sizes.size(); ++k) EXPECT_EQ(one.sizes[k].value, other.sizes[k].value);
  }
}

// A torque that waits on the wire and one that waits in the drive are indistinguishable, beside another effect as well.
TEST(Diagnose, GivesOneMotionBesideAnotherEffectBothItsNames) {
  const Diagnosis found = diagnose_machine({{"gear_friction", {0.12, 0.001}}, {"dead_time", {0.012}}}, bench().controller, 23);
  ASSERT_FALSE(found.causes.empty());
  const Cause& first = found.causes[0];
  ASSERT_EQ(first.effects.size(), 2u) << found.verdict;
  ASSERT_EQ(first.also.size(), 1u) << found.verdict;
  using Names = std::set<std::string>;
  const std::set<Names> both{Names(first.effects.begin(), first.effects.end()), Names(first.also[0].begin(), first.also[0].end())};
  EXPECT_EQ(both, (std::set<Names>{{"dead_time", "gear_friction"}, {"command_delay", "gear_friction"}})) << found.verdict;
}

// 1.3 Hz with 3 % damping, near which no start of the catalogue lies: the nominal machine's parameters go far to stand for it, and
// beside those it cannot be seen.
TEST(Diagnose, FindsAResonanceBetweenItsStarts) {
  const Diagnosis found = diagnose_machine({{"pedestal_flexibility", {4.4e7, 6e5, 0.033}}}, bench().controller, 19);
  ASSERT_FALSE(found.causes.empty());
  ASSERT_EQ(found.causes[0].effects, std::vector<std::string>{"pedestal_flexibility"}) << found.verdict;
  EXPECT_NEAR(found.causes[0].sizes[0].value, 4.4e7, 0.1 * 4.4e7);
}

// That one effect alone is the answer is never surer than that it acts: a second one may hide beside it.
TEST(Diagnose, IsSurerThatAnEffectActsThanThatItActsAlone) {
  const Diagnosis found = diagnose_machine({{"bearing_viscous", {6e6, 0.0}}}, bench().controller, 22);
  ASSERT_FALSE(found.causes.empty());
  ASSERT_EQ(found.causes[0].effects, std::vector<std::string>{"bearing_viscous"}) << found.verdict;
  EXPECT_GT(found.lead_acts, 0.9);
  EXPECT_LT(found.causes[0].probability, 0.9);
  double sum = found.probability_unknown + found.probability_hidden;
  for (const Cause& cause : found.causes) sum += cause.probability;
  EXPECT_NEAR(sum, 1.0, 1e-9);
}

// Half a minute of waves with a period that lies between the starts.
TEST(Diagnose, FindsARollOfAnyPeriod) {
  const Diagnosis found = diagnose_machine({{"vessel_roll", {5e-4, 8.05, 2.1, 1.3, 20.0}}}, bench().controller, 20);
  ASSERT_FALSE(found.causes.empty());
  ASSERT_EQ(found.causes[0].effects, std::vector<std::string>{"vessel_roll"}) << found.verdict;
  EXPECT_NEAR(found.causes[0].sizes[0].value, 5e-4, 0.1 * 5e-4);
  EXPECT_NEAR(found.causes[0].sizes[1].value, 8.05, 0.05 * 8.05);
}

// A cause that explains the records that were fitted, and not the one that nobody fitted, is not the answer: on another day the bearing runs freely.
TEST(Diagnose, GivesUpACauseThatAnUnseenRecordRefutes) {
  sim::MachineSettings nominal, dragging;
  nominal.crane = dragging.crane = bench().crane;
  dragging.effects = {{"bearing_coulomb", {1e5, 0.0, 3e-5}}};
  DiagnosisSettings settings;
  for (const common::EffectAbout& about : sim::effects_for(bench().crane).effects) {
    if (about.name != "bearing_coulomb") settings.without.emplace_back(about.name);
  }
  const auto record = [](const sim::MachineSettings& machine, const std::vector<Move>& moves, const char* name, unsigned seed) {
    return make_record(simulated_log(machine, bench().controller, moves, kDuration, seed), name, bench().admission);
  };
  const auto found_with = [&](Record unseen) {
    std::vector<Record> fitted, tried;
    fitted.push_back(record(dragging, kThereAndBack, "a", 51));
    fitted.push_back(record(dragging, kInching, "b", 52));
    tried.push_back(std::move(unseen));
    return diagnose(nominal, bench().controller, std::move(fitted), settings, {}, {}, std::move(tried));
  };
  const Diagnosis same = found_with(record(dragging, kThereAndBack, "c", 53)), other = found_with(record(nominal, kThereAndBack, "c", 53));
  EXPECT_EQ(same.verdict, "bearing_coulomb");
  EXPECT_FALSE(same.refuted);
  ASSERT_EQ(other.unseen.size(), 1U);
  EXPECT_EQ(other.unseen.front().cause, "bearing_coulomb");
  EXPECT_FALSE(other.unseen.front().validation.holds);
  ASSERT_TRUE(other.refuted);
  EXPECT_EQ(*other.refuted, same.causes.front().probability);
  EXPECT_TRUE(other.is_unknown);
  EXPECT_NEAR(other.probability_unknown, same.probability_unknown + *other.refuted, 1e-12);
}

// One log full of impacts tells nothing, and must not keep the other one from being judged; where there is no other, no answer.
// The knocking comes of commands that are 60 ms late on one day: the speed loop then swings from flank to flank all the time.
TEST(Diagnose, LeavesOutALogThatLiesNearImpacts) {
  sim::MachineSettings truth;
  truth.crane = spread_crane(21);
  truth.effects = {{"bearing_coulomb", {1e5, 0.0, 3e-5}}};
  sim::MachineSettings knocking = truth;
  knocking.effects.push_back({"command_delay", {0.06}});
  const Record knocked = make_record(simulated_log(knocking, bench().controller, kInching, kDuration, 21), "knocked", bench().admission);
  const Record sound = make_record(simulated_log(truth, bench().controller, kThereAndBack, kDuration, 22), "sound", bench().admission);
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  EXPECT_THROW(diagnose(nominal, bench().controller, {knocked}, {}), NotAdmitted);
  DiagnosisSettings settings;
  settings.search.joint_pairs = 0;
  settings.hold_out = true;
  const Diagnosis found = diagnose(nominal, bench().controller, {knocked, sound}, settings, {}, {}, {knocked});
  // One that the answer is to be tried on, and that cannot be judged, takes nothing from the answer.
  EXPECT_TRUE(found.unseen.empty());
  EXPECT_TRUE(std::any_of(found.remarks.begin(), found.remarks.end(), [](const std::string& remark) { return remark.rfind("knocked could not be predicted: ", 0) == 0; }));
  EXPECT_TRUE(std::any_of(found.remarks.begin(), found.remarks.end(), [](const std::string& remark) {
    return remark.rfind("knocked: only", 0) == 0 && remark.find("left out") != std::string::npos;
  }));
  EXPECT_EQ(found.verdict, "bearing_coulomb");
  // Of a single record that is judged, the second half is held out.
  ASSERT_TRUE(found.held_out);
  EXPECT_TRUE(found.held_out->is_half);
  EXPECT_EQ(found.held_out->record, "sound");
  EXPECT_NEAR(found.held_out->from_time, 0.5 * kDuration, 0.01 * kDuration);
  ASSERT_EQ(found.held_out->point.effects.size(), 1u);
  EXPECT_NEAR(found.held_out->point.effects[0].values[0], 1e5, 0.2 * 1e5);
}

// Its draw is another one than any that the diagnosis can make. Below the 40 Hz that are judged, bursts of a few messages and
// delays of a few milliseconds have one power, so the other one may be named, but then as one that cannot be told from it.
TEST(Diagnose, FindsJitterWithoutItsDraw) {
  sim::MachineSettings truth;
  truth.crane = spread_crane(17);
  truth.effects = {{"command_jitter", {0.03}}};
  truth.seed = 99;
  const Diagnosis found = diagnose_truth(truth, bench().controller, 17);
  ASSERT_FALSE(found.causes.empty());
  ASSERT_EQ(found.causes[0].effects.size(), 1u) << found.verdict;
  std::set<std::string> named{found.causes[0].effects[0]};
  for (const Alike& other : found.causes[0].group) named.insert(other.name);
  EXPECT_TRUE(named.contains("command_jitter")) << found.verdict;
}

// The jib is by far the larger one, and late messages have a mean that other delays have as well. Taken for
// one effect this pair is outside the catalogue.
TEST(Diagnose, FindsALargeSecondEffectBesideJitter) {
  sim::MachineSettings truth;
  truth.crane = spread_crane(67);
  truth.effects = {{"command_jitter", {0.0265}}, {"flyjib_torsion", {6717.0, 4.087}}};
  truth.seed = 99;
  const Diagnosis found = diagnose_truth(truth, bench().controller, 67);
  ASSERT_FALSE(found.causes.empty());
  ASSERT_EQ(found.causes[0].effects.size(), 2u) << found.verdict;
  const std::set<std::string> named(found.causes[0].effects.begin(), found.causes[0].effects.end());
  EXPECT_TRUE(named.contains("flyjib_torsion")) << found.verdict;
  // Beside so large an effect the held-out record may not tell a jitter from the delay that it is on the average; then no delay is sure.
  const bool is_jitter = named.contains("command_jitter") || named.contains("command_loss");  // FindsJitterWithoutItsDraw
  EXPECT_TRUE(is_jitter || found.causes[0].probability < 0.6) << found.verdict << " " << found.causes[0].probability;
  EXPECT_TRUE(is_jitter || named.contains("dead_time") || named.contains("command_delay")) << found.verdict;
}

// Beside the fitted gearboxes the roll is found; from where nothing is added the pair ends elsewhere.
TEST(Diagnose, FindsARollBesideUnevenGearboxes) {
  const Diagnosis found = diagnose_machine(
      {{"uneven_gearbox_stiffness", {0.49, 0.0}}, {"vessel_roll", {0.0031, 9.99, 0.87, -1.26, 20.0}}}, bench().controller, 31);
  ASSERT_FALSE(found.causes.empty());
  ASSERT_EQ(std::set<std::string>(found.causes[0].effects.begin(), found.causes[0].effects.end()),
            (std::set<std::string>{"uneven_gearbox_stiffness", "vessel_roll"}))
      << found.verdict;
}

// Another draw than any of the diagnosis's own, and a load that catches three times as much wind as the catalogue's.
TEST(Diagnose, FindsGustsWithoutTheirDraw) {
  sim::MachineSettings truth;
  truth.crane = spread_crane(25);
  truth.effects = {{"gusts", {2.0, 10.0, 1.0, 6.0, 80.0, 60.0}}};
  truth.seed = 99;
  const Diagnosis found = diagnose_truth(truth, bench().controller, 25);
  ASSERT_FALSE(found.causes.empty());
  EXPECT_EQ(found.causes[0].effects, std::vector<std::string>{"gusts"}) << found.verdict;
}

// Friction in the bearing, with all that brakes or blows left out of the catalogue: at low frequencies gusts turn the crane as any force
// does, and by their power alone they were named here with certainty. Other axes fit better than theirs.
TEST(Diagnose, NamesNoGustsForFriction) {
  common::EffectInstance friction = common::typical_instance(sim::effects_for(bench().crane).at("bearing_viscous"));
  friction.values[0] *= 0.5;
  DiagnosisSettings settings;
  settings.without = {"bearing_viscous", "bearing_coulomb", "bearing_stribeck", "dragging_brake", "gear_friction", "wind",       "heel",
                      "vessel_roll",     "tag_line",        "air_drag",         "hoisting",       "rope_length",   "offlead"};
  const Diagnosis found = diagnose_machine({friction}, bench().controller, 26, settings);
  for (const auto& [effect, probability] : found.effects) {
    if (effect == "gusts") {
      EXPECT_LT(probability, 0.05) << found.verdict;
    }
  }
}

// Bursts nearly twice as long as the longest of the catalogue, so that their power is not quite the catalogue's: a second effect that
// delays as well comes nearer to it, and must not be named for that.
// Bursts so long that one record holds two or three of them say little of the next one's: the answer is the loss, or none that is sure.
TEST(Diagnose, StatesNoOtherCauseOfLongBurstsOfLoss) {
  sim::MachineSettings truth;
  truth.crane = spread_crane(24);
  truth.effects = {{"command_loss", {0.3, 35.0}}};
  truth.seed = 99;
  const Diagnosis found = diagnose_truth(truth, bench().controller, 24);
  ASSERT_FALSE(found.causes.empty());
  EXPECT_TRUE(found.gap);
  EXPECT_LT(found.probability_unknown, 0.9);
  for (const Cause& cause : found.causes) {
    if (cause.effects == std::vector<std::string>{"command_loss"}) continue;
    EXPECT_LT(cause.probability, 0.5) << name_of(cause);
  }
}

// Dry and viscous friction together, as bearings have them: laws that hold both, and warm or flatten besides, fit as well and have shown nothing of that.
TEST(Diagnose, NamesTwoFrictionsBeforeALawThatHoldsBoth) {
  DiagnosisSettings settings;
  for (const sim::EffectDescription* effect : sim::effect_catalogue()) {
    if (effect->about.family != common::Family::friction) settings.without.emplace_back(effect->about.name);
  }
  const Diagnosis found = diagnose_machine({{"bearing_coulomb", {2e5, 0.0, 3e-5}}, {"bearing_viscous", {4e6, 0.0}}}, bench().controller, 27, settings);
  ASSERT_FALSE(found.causes.empty());
  const std::set<std::string> first(found.causes[0].effects.begin(), found.causes[0].effects.end());
  EXPECT_EQ(first, (std::set<std::string>{"bearing_coulomb", "bearing_viscous"})) << found.verdict;
  for (const auto& [effect, probability] : found.effects) {
    if (!first.contains(effect)) {
      EXPECT_LT(probability, 0.3) << effect;
    }
  }
}

// A law that holds one whole which the user left out does not bring it back.
TEST(Diagnose, NamesNothingThatWasLeftOut) {
  DiagnosisSettings settings;
  settings.without = {"bearing_coulomb"};
  for (const sim::EffectDescription* effect : sim::effect_catalogue()) {
    if (effect->about.family != common::Family::friction) settings.without.emplace_back(effect->about.name);
  }
  settings.hold_out = false;
  const Diagnosis found = diagnose_machine({{"bearing_coulomb", {1.5e5, 0.0, 3e-5}}}, bench().controller, 13, settings);
  ASSERT_FALSE(found.causes.empty());
  for (const Cause& cause : found.causes) {
    EXPECT_EQ(std::count(cause.effects.begin(), cause.effects.end(), "bearing_coulomb"), 0) << name_of(cause) << " " << cause.probability;
  }
}

TEST(Diagnose, SaysNotInTheCatalogueWhereTheCauseIsLeftOut) {
  DiagnosisSettings settings;
  // All frictions of drive and bearing: each of them is a relative of the one that acts.
  settings.without = {"bearing_coulomb", "bearing_rising", "bearing_stribeck", "bearing_uneven", "bearing_viscous",
                      "bearing_warming", "dragging_brake", "gear_friction"};
  settings.search.joint_pairs = 1;
  const Diagnosis found = diagnose_machine({{"bearing_coulomb", {1.5e5, 0.0, 0.0}}}, bench().controller, 13, settings);
  EXPECT_TRUE(found.gap);
  EXPECT_GT(found.probability_unknown, 0.5) << found.verdict;
}

TEST(Diagnose, FindsTheControllersOwnEffectWithoutAnyNoise) {
  const auto* droop = controller::find_effect("droop");
  ASSERT_NE(droop, nullptr);
  const common::EffectInstance effect = common::typical_instance(controller::effects_for(bench().controller).at("droop"));
  DiagnosisSettings settings;
  settings.search.singles_to_refine = 1;
  settings.search.joint_pairs = 0;
  const Diagnosis found = diagnose_machine({}, controller::with_effects(bench().controller, {effect}), 14, settings);
  EXPECT_TRUE(found.controller_differs);
  ASSERT_FALSE(found.causes.empty());
  EXPECT_EQ(found.causes[0].effects, std::vector<std::string>{"droop"});
  ASSERT_FALSE(found.causes[0].controller_effects.empty());
  EXPECT_NEAR(found.causes[0].controller_effects[0].values[0], effect.values[0], 1e-3 * effect.values[0]);
}

TEST(Predict, TheTrueMachinePredictsItsOwnLogDownToTheNoise) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  const Record record =
      make_record(simulated_log(truth, bench().controller, kThereAndBack, kDuration, 5), "own", bench().admission);
  const Prediction prediction = predict(truth, bench().controller, record);
  for (const SignalGap& gap : prediction.gaps) {
    // 5 mm/s^2 is the accelerometers' noise here; the torque's is the speed noise times the gain of 40 Nms/rad.
    if (gap.unit == "m/s^2") {
      EXPECT_LT(gap.gap, 1.5 * 5e-3) << gap.signal;
    }
    if (gap.unit == "Nm") {
      EXPECT_LT(gap.gap, 2.0 * 40.0 * 2e-3) << gap.signal;
    }
  }
}

// What lies before `from_time` does not count.
TEST(Predict, CountsTheGapFromWhereItIsAskedTo) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  Record record = make_record(simulated_log(truth, bench().controller, kThereAndBack, kDuration, 5), "own", bench().admission);
  const double half = record.time(record.size() / 2);
  const double whole_gap = predict(truth, bench().controller, record, half).gaps[0].gap;
  for (std::size_t n = 0; n < record.size() / 2; ++n) record.motor_torque[0][n] += 100.0;
  EXPECT_DOUBLE_EQ(predict(truth, bench().controller, record, half).gaps[0].gap, whole_gap);
  EXPECT_GT(predict(truth, bench().controller, record).gaps[0].gap, 50.0);
}

// Counts are a fact of the log, whatever else is missing: found to the count, with nothing fitted.
TEST(Diagnose, SeesCoarseCountsInThePositionsThemselves) {
  constexpr double kCount = 2.0 * std::numbers::pi / 1000.0;  // [rad]
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  msgs::RunLog log = simulated_log(truth, bench().controller, kThereAndBack, kDuration, 6);
  for (auto& encoder : log.encoder) {
    for (double& position : encoder.shaft_position) position = kCount * std::floor(position / kCount);
  }
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  const Diagnosis found = diagnose(nominal, std::nullopt, {make_record(log, "counts", bench().admission)}, {});
  EXPECT_TRUE(found.gap);
  ASSERT_FALSE(found.causes.empty());
  const Cause& first = found.causes[0];
  EXPECT_EQ(std::count(first.effects.begin(), first.effects.end(), "encoder_quantisation"), 1);
  const auto size = std::find_if(first.sizes.begin(), first.sizes.end(), [](const Size& one) {
    return one.parameter == "encoder_quantisation.resolution";
  });
  ASSERT_NE(size, first.sizes.end());
  EXPECT_NEAR(size->value, kCount, 1e-6 * kCount);
}

// The same log by a clock that began long before: a roll has its phase from the log's beginning on, so that it is found with the same sizes, but for what so late a time rounds.
TEST(Diagnose, FindsARollByAClockThatBeganLongBefore) {
  sim::MachineSettings nominal, truth;
  nominal.crane = truth.crane = bench().crane;
  truth.effects = {{"vessel_roll", {0.005, 9.0, 0.7, 1.5, 15.0}}};
  DiagnosisSettings settings;
  settings.hold_out = false;
  for (const common::EffectAbout& about : sim::effects_for(bench().crane).effects) {
    if (about.name != truth.effects[0].name) settings.without.emplace_back(about.name);
  }
  const auto sizes_where = [&](std::int64_t later) {  // [ns]
    msgs::RunLog log = simulated_log(truth, bench().controller, kThereAndBack, kDuration, 5);
    const auto shift = [&](auto& messages) {
      for (auto& message : messages) message.simulated_time += later;
    };
    shift(log.encoder);
    shift(log.torque);
    shift(log.sensors);
    shift(log.operator_moves);
    const Diagnosis found = diagnose(nominal, std::nullopt, {make_record(log, "log", bench().admission)}, settings);
    EXPECT_EQ(found.causes.at(0).effects, std::vector<std::string>{truth.effects[0].name});
    return found.causes.at(0).point.effects.at(0).values;
  };
  const std::vector<double> own = sizes_where(0), later = sizes_where(1'000'000'000'000'000);
  for (std::size_t p = 0; p < own.size(); ++p) EXPECT_NEAR(later[p], own[p], 0.02 * std::fabs(own[p])) << p;
}

// A crawl with the load still excites neither load nor boom: it says so of what acts through them. To say that nothing is missing would
// be wrong, for these machines miss it; a slew there and back tells. Of the boom's damping alone the noise in the torques says a little (three times as much is known to a sixth): not enough to be named.
TEST(Diagnose, ACrawlTellsNothingAboutTheBoom) {
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  const std::vector<Move> crawl{{2.0, 0.004}};
  for (const common::EffectInstance& missing : {common::EffectInstance{"boom_damping", {3.0}}, common::typical_instance(sim::effects_for(bench().crane).at("bearing_viscous"))}) {
    sim::MachineSettings truth;
    truth.crane = bench().crane;
    truth.crane.boom.element_count = 12;
    truth.effects = {missing};
    const auto diagnosed = [&](const std::vector<Move>& moves) {
      return diagnose(nominal, bench().controller,
                      {make_record(simulated_log(truth, bench().controller, moves, kDuration, 8), "log", bench().admission)}, {});
    };
    const Diagnosis found = diagnosed(crawl);
    EXPECT_FALSE(found.gap) << found.verdict;
    for (const char* name : {"compression_softening", "house_inertia", "bearing_viscous", "offlead", "air_drag", "load_mass"}) {
      EXPECT_TRUE(std::find(found.not_excited.begin(), found.not_excited.end(), name) != found.not_excited.end()) << name;
    }
    if (missing.name == "boom_damping") continue;  // which a gentle slew does not tell either
    const Diagnosis told = diagnosed(kThereAndBack);
    EXPECT_TRUE(told.gap) << told.verdict;
    EXPECT_TRUE(std::find(told.not_excited.begin(), told.not_excited.end(), missing.name) == told.not_excited.end());
  }
}

// A load that swings far follows the pendulum's law, as every machine's does, and the model a linear one: that is a part of the machine and no cause, and is
// said. A log that was made with the linear law is not said to have it.
TEST(Diagnose, TakesWhatEveryMachineDoesForAPartOfThisOne) {
  // To and fro in the load's own time, so that it swings far.
  const std::vector<Move> to_and_fro{{2.0, 1.0}, {9.8, -1.0}, {17.5, 1.0}, {25.3, 0.0}};
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  for (const bool is_real : {true, false}) {
    sim::MachineSettings truth;
    truth.crane = bench().crane;
    truth.crane.boom.element_count = kBoomElements;
    if (is_real) truth.effects = {common::typical_instance(sim::effects_for(bench().crane).at("large_angles"))};
    const msgs::RunLog log = simulated_log(truth, bench().controller, to_and_fro, 36.0, 12);
    DiagnosisSettings settings;
    settings.search.singles_to_refine = 3;
    settings.search.joint_pairs = 0;
    const Diagnosis found = diagnose(nominal, {}, {make_record(log, "log", bench().admission)}, settings);
    std::string remarks;
    for (const std::string& remark : found.remarks) remarks += "\n" + remark;
    EXPECT_FALSE(found.gap) << is_real << ' ' << found.verdict << remarks;
    EXPECT_LT(found.mean_square_parameters, 1.1);
    EXPECT_EQ(found.of_every_machine.size(), is_real ? 1u : 0u) << found.verdict;
    const sim::MachineSettings fitted = as_fitted(nominal, found);
    EXPECT_EQ(fitted.effects.size(), found.of_every_machine.size());
    EXPECT_EQ(fitted.crane.boom.element_count, found.boom_elements);
  }
}

// The only log of a machine with the nominal one's controller.
Diagnosis diagnose_one_log_of(const sim::CraneParameters& crane) {
  sim::MachineSettings truth;
  truth.crane = crane;
  DiagnosisSettings settings;
  settings.hold_out = true;
  settings.threads = 2;
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  return diagnose(nominal, bench().controller, {make_record(simulated_log(truth, bench().controller, kThereAndBack, kDuration, 9), "other", bench().admission)}, settings);
}

// Motors and gearboxes of another make, which no effect of the catalogue says.
TEST(Diagnose, DoubtsThatAnotherCraneIsTheNominalOne) {
  sim::CraneParameters other = bench().crane;
  other.drive.motor_inertia *= 1.6;
  other.drive.gearbox_stiffness *= 0.5;
  const Diagnosis found = diagnose_one_log_of(other);
  EXPECT_TRUE(found.gap);
  // Rightly no cause: nothing was missing in that crane, so whatever it named would have been wrong.
  EXPECT_TRUE(found.probability_unknown > 0.5 || found.causes.at(0).effects.empty()) << found.verdict;
  EXPECT_TRUE(std::any_of(found.remarks.begin(), found.remarks.end(), [](const std::string& remark) {
    return remark.find("cannot tell whether this is another crane") != std::string::npos;
  })) << found.verdict;
}

// A crane with half the load again and a boom 0.1 rad lower than the file says.
TEST(Diagnose, NamesTheBoomsAngleBesideTheLoad) {
  constexpr double kLowered = 0.1, kLoad = 1.5;  // [rad], [-]
  sim::CraneParameters other = bench().crane;
  other.boom.angle -= kLowered;
  other.load.mass *= kLoad;
  const Diagnosis found = diagnose_one_log_of(other);
  ASSERT_FALSE(found.causes.empty());
  ASSERT_EQ(found.causes[0].effects.size(), 2u) << found.verdict;
  std::map<std::string, double> sizes;
  for (const common::EffectInstance& effect : found.causes[0].point.effects) sizes[effect.name] = effect.values[0];
  EXPECT_NEAR(sizes["boom_angle"], 1.0 - kLowered / bench().crane.boom.angle, 0.01) << found.verdict;
  EXPECT_NEAR(sizes["load_mass"], kLoad, 0.02 * kLoad) << found.verdict;
}

}  // namespace
}  // namespace slewlab::diagnosis
