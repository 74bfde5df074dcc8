// How records of cranes begin that are built otherwise than the bench's: their own logs, without noise, of which nothing is missing.
#include "diagnosis/admit.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/parameters_alone.h"
#include "tests/diagnosis/admitted.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kPeriod = 1e-2;  // [s] of a PLC

struct OwnCrane {
  OwnCrane(const std::string& crane_file, const std::string& controller_file)
      : crane(sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/" + crane_file).parameters),
        controller(controller::load_controller_file(SLEWLAB_SOURCE_DIR "/config/controllers/" + controller_file).settings) {}

  // Of a recorder that was switched on so many readings after the run began.
  msgs::RunLog log_from(std::ptrdiff_t left_out) const {
    sim::MachineSettings machine;
    machine.crane = crane;
    msgs::RunLog log = quiet_log(machine, controller, kThereAndBack, kDuration, kPeriod);
    leave_out_beginning(log, left_out);
    return log;
  }

  sim::CraneParameters crane;
  controller::ControllerSettings controller;
};

// Gears without play touch always, and what presses them against each other has wound them up: by tens of Nm that would else be missing.
TEST(Admit, GearsWithoutPlayBeginWoundUp) {
  const OwnCrane own("no_play.yaml", "thesis.yaml");
  for (const std::ptrdiff_t left_out : {0, 150, 500}) {  // at rest, with the drives on, in motion
    Admitted record({own.log_from(left_out)}, own.crane);
    FitResult found = nominal_fit(record.problem);
    if (!all_begin_unmoved(record.problem)) found = *nominal_with_beginnings(record.problem, found);
    EXPECT_LT(found.mean_square, 1.0) << left_out;
  }
}

// With one group of motors nothing holds the house while the teeth cross their play. Of a record from rest that is known, and it is followed through; of one that begins in motion, with boom and load as nobody knows, nothing is
// judged behind that moment.
TEST(Admit, NothingIsJudgedBehindAMomentInWhichNothingHoldsTheHouse) {
  const OwnCrane own("one_group.yaml", "one_group.yaml");
  Admitted at_rest({own.log_from(0)}, own.crane);
  EXPECT_LT(nominal_fit(at_rest.problem).mean_square, 1.0);
  try {
    const Admitted in_motion({own.log_from(500)}, own.crane);
    FAIL() << "was taken";
  } catch (const NotAdmitted& problem) {
    EXPECT_NE(std::string(problem.what()).find("where no gear holds the house"), std::string::npos) << problem.what();
  }
}

}  // namespace
}  // namespace slewlab::diagnosis
