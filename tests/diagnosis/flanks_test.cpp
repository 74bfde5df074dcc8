#include "diagnosis/flanks.h"

#include <gtest/gtest.h>

#include "diagnosis/admit.h"
#include "tests/diagnosis/bench.h"
#include "tests/diagnosis/simulated_log.h"

namespace slewlab::diagnosis {
namespace {

sim::MachineSettings machine_with(std::vector<common::EffectInstance> effects) {
  sim::MachineSettings machine;
  machine.crane = bench().crane;
  machine.effects = std::move(effects);
  return machine;
}

// What `truth` recorded, admitted to a problem of the bench's crane.
struct Admitted : Problem {
  Admitted(const sim::MachineSettings& truth, const std::vector<Move>& moves) {
    std::vector<Record> of_truth;
    of_truth.push_back(make_record(simulated_log(truth, bench().controller, moves, kDuration, 3), "a", bench().admission));
    set_machine(machine_with({}), of_truth, *this);
    std::vector<std::string> remarks;
    admit(std::move(of_truth), thresholds.whitening, *this, remarks);
  }
  const std::vector<FlankPart>& parts() const { return whitening.front().flanks; }
  // Sum of the squares of what the parts say of a machine.
  double square_of(const Point& point) {
    const auto count = static_cast<Eigen::Index>(parts().size());
    return differences(*this, point).tail(count).squaredNorm();
  }
};

TEST(Flanks, SayHowFarAGroupIsHeldBesideTheFirst) {
  Shadow shadow;
  shadow.missing_torque[0] = {1.0, 2.0, 3.0, 4.0};
  shadow.missing_torque[1] = {5.0, 5.0, 8.0, 9.0};
  EXPECT_DOUBLE_EQ(beside_the_first(shadow, {1, 1, 3, 1.0}), 4.0);  // mean of 3 and 5
}

// Twice the play: the nominal machine's second group is held beside its flank wherever that of the record has crossed more. The machine of the truth is not.
TEST(Flanks, TellAWiderPlay) {
  constexpr double kAdded = 5e-4;  // [rad] as much as the nominal crane has
  Admitted problem(machine_with({{"larger_play", {kAdded}}}), kAcrossThePlay);
  ASSERT_FALSE(problem.parts().empty());
  EXPECT_EQ(problem.parts().size() % 2, 0U);
  const auto at = [&](double added) {
    Point point;
    point.nuisance.assign(nuisance_count(problem), 0.0);
    if (added > 0.0) point.effects = {{"larger_play", {added}}};
    return problem.square_of(point) / static_cast<double>(problem.parts().size());
  };
  EXPECT_LT(at(kAdded), 1.5);  // its load does not yet swing as that of the record, whose beginning is left out
  EXPECT_GT(at(0.0), 5.0);
  EXPECT_GT(at(0.0), at(0.5 * kAdded));
  EXPECT_GT(at(0.5 * kAdded), at(kAdded));
}

TEST(Flanks, SayNothingOfTheNominalMachine) {
  Admitted problem(machine_with({}), kAcrossThePlay);
  ASSERT_FALSE(problem.parts().empty());
  EXPECT_LT(problem.square_of({}), 0.1 * static_cast<double>(problem.parts().size()));
}

// From where in its play a gear was pressed when the drives came on, nobody knows.
TEST(Flanks, LeaveOutTheBeginningAndWhatIsJudgedAnyway) {
  const Admitted gentle(machine_with({}), kThereAndBack);
  EXPECT_TRUE(gentle.parts().empty());
  const Admitted problem(machine_with({}), kAcrossThePlay);
  for (const FlankPart& part : problem.parts()) {
    EXPECT_GT(problem.records[0].time(part.from), 2.0);
    EXPECT_LT(part.from, part.to);
    for (std::size_t n = part.from; n < part.to; ++n) EXPECT_EQ(problem.whitening[0].window[n], 0.0);
  }
}

}  // namespace
}  // namespace slewlab::diagnosis
