#include "diagnosis/search_as_built.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "tests/diagnosis/admitted.h"
#include "tests/diagnosis/simulated_log.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kPeriod = 1e-2;    // [s] of a PLC
constexpr double kFriction = 5e6;   // [Nms/rad]

struct Search {
  explicit Search(const std::vector<msgs::RunLog>& logs) : admitted(logs) {
    const std::array<std::string_view, 3> kept{"bearing_viscous", "house_inertia", "large_angles"};
    found = search_as_built(admitted.problem, admitted.whitening, all_but(admitted.problem.catalogue, kept), {}, admitted.remarks, [](double, const std::string&) {});
  }
  int boom_elements() const { return admitted.problem.nominal.crane.boom.element_count; }

  Admitted admitted;
  Searched found;
};

sim::MachineSettings crane_with_friction() {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.effects = {{"bearing_viscous", {kFriction, 0.0}}};
  return truth;
}

// The boom is cut finer than the file cuts it where the nominal machine has a residual above the noise. A log of that very file, without noise, is
// followed far below the noise by the file's own boom with the friction that it had, and by no other's.
TEST(SearchAsBuilt, CutsTheBoomOfAnOwnLogAsItsFileHasIt) {
  const sim::MachineSettings truth = crane_with_friction();
  const Search search({quiet_log(truth, bench().controller, kThereAndBack, kDuration, kPeriod)});
  EXPECT_EQ(search.boom_elements(), truth.crane.boom.element_count);
  const FitResult& best = search.found.best(search.admitted.problem.catalogue);
  ASSERT_TRUE(has_effect(best.point.effects, "bearing_viscous"));
  EXPECT_NEAR(best.point.effects.front().values[0], kFriction, 0.03 * kFriction);
  EXPECT_LT(best.mean_square, 0.1);
  EXPECT_GT(search.found.nominal_machine.mean_square, 1.0);
  EXPECT_LE(best.cost, search.found.found.nothing.cost);
}

// Another machine's boom is not cut at all: one of twenty elements behind ordinary sensors is followed by the diagnosis's own.
TEST(SearchAsBuilt, CutsTheBoomOfAnotherMachineAsFineAsEveryDiagnosisDoes) {
  sim::MachineSettings truth = crane_with_friction();
  truth.crane.boom.element_count = 20;
  const Search search({simulated_log(truth, bench().controller, kThereAndBack, kDuration, 3, kPeriod)});
  EXPECT_EQ(search.boom_elements(), kBoomElements);
  EXPECT_TRUE(has_effect(search.found.best(search.admitted.problem.catalogue).point.effects, "bearing_viscous"));
  EXPECT_TRUE(search.found.of_every_machine.empty());
}

// Angles that are no small ones are what every machine has: where the records show them they are a part of this one. Left out, they are not taken for one.
TEST(SearchAsBuilt, TakesWhatEveryMachineDoesWhereTheRecordsShowIt) {
  Admitted admitted({quiet_log(crane_with_friction(), bench().controller, kThereAndBack, kDuration, kPeriod)});
  std::vector<std::string> of_all;
  for (const common::EffectAbout& about : admitted.problem.catalogue.effects) {
    if (about.of_every_machine) of_all.emplace_back(about.name);
  }
  ASSERT_FALSE(of_all.empty());
  sim::MachineSettings truth = crane_with_friction();
  for (const std::string& name : of_all) truth.effects.push_back(common::typical_instance(admitted.problem.catalogue.at(name)));
  // So fast and far that a load swings widely.
  const std::vector<Move> kHard{{2.0, 1.0}, {9.0, -1.0}, {16.0, 0.0}};
  const std::vector<msgs::RunLog> log{simulated_log(truth, bench().controller, kHard, kDuration, 5, kPeriod)};
  const auto taken = [&](const std::vector<std::string_view>& kept) {
    Admitted one(log);
    return search_as_built(one.problem, one.whitening, all_but(one.problem.catalogue, kept), {}, one.remarks, [](double, const std::string&) {}).of_every_machine;
  };
  std::vector<std::string_view> kept{"bearing_viscous"};
  EXPECT_TRUE(taken(kept).empty());
  kept.insert(kept.end(), of_all.begin(), of_all.end());
  EXPECT_EQ(taken(kept).size(), of_all.size());
}

// What mesh and step make wrong is not judged anew by an effect of next to no size, whose finer steps are all that follows an own log better.
TEST(SearchAsBuilt, IsNotLedBelowTheFloorByAnEffectThatDoesNotAct) {
  sim::MachineSettings truth;
  truth.crane = sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/harbour_5t.yaml").parameters;
  const controller::ControllerSettings controller = controller::load_controller_file(SLEWLAB_SOURCE_DIR "/config/controllers/harbour_5t.yaml").settings;
  Admitted admitted({quiet_log(truth, controller, kThereAndBack, 30.0, kPeriod)}, truth.crane);
  const std::array<std::string_view, 4> kept{"dead_time", "tag_line", "hoisting", "bearing_warming"};
  const double share = admitted.whitening.discrepancy_share;
  const Searched found = search_as_built(admitted.problem, admitted.whitening, all_but(admitted.problem.catalogue, kept), {}, admitted.remarks, [](double, const std::string&) {});
  EXPECT_EQ(admitted.whitening.discrepancy_share, share);
  EXPECT_LT(found.nominal_machine.mean_square, 1.0);
  EXPECT_LT(found.found.nothing.mean_square, 1.0);
}

}  // namespace
}  // namespace slewlab::diagnosis
