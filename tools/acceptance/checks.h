#pragma once

// The acceptance checks on a recorded run. A pure function of log, limits and the machine's ratio.
//
// The slewing speed is the mean shaft speed of the groups over the ratio (ENCODER: what a crane can measure). A request
// is an OPERATOR message that changes what is asked for; before the first one zero is asked for. The emergency stop asks
// for zero. "Before the stop" is before the first emergency stop, or the whole run.
//
//   direction          speed against the asked direction, in stretches that begin at rest or in that direction
//   overshoot          speed past the asked one, in stretches that begin on this side of it; the emergency stop apart
//   settling           time from a request until the speed stays within the band to the stretch's end
//   play crossings     before the stop, all gearboxes together (TRUTH)
//   play offset        half the torque of the first half of the groups less that of the second: least value from
//                      the first request to the stop while the mean torque is small; shows which half leads
//   sidelead           largest rope angle before the stop (TRUTH)
//   torque share       largest torque before the stop, of T100
//   stop distance      angle slewed from the emergency stop on, largest
//   stop time          from the emergency stop until the speed stays within the band
//   stop overshoot     speed past zero after the emergency stop
//   tip acceleration   largest after the emergency stop (SENSORS)
//   trips              of the drive, where the scenario has no faults on purpose (PLANT_STATUS)
//   reaction           where it has: if the drive trips, the crane stands still in time and stays so,
//                      until the drive runs again
//   dead time          from a reading to the first torque that it moves (dead_time.h), where the scenario puts noise on the
//                      encoders: while it does, until another fault on purpose or a trip
//
// A trip is dated by trip_time of PLANT_STATUS, that is when it happened, and not by when it was told.
// The other checks look at the run up to the drive's trip or the first fault on purpose, whichever comes first.
// A check whose channel is not in the log, or whose occasion is not in the run, is not applicable.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "msgs/run_log.h"
#include "tools/acceptance/limits.h"

namespace slewlab::tools {

struct AcceptedMachine {
  double total_ratio = 1.0;     // [-] turns of a motor per turn of the crane
  std::optional<double> first_fault;  // [s] of a fault on purpose
  struct Noise {
    double from = 0.0, until = 0.0;  // [s]
  };
  std::optional<Noise> encoder_noise{};  // on purpose and with no other fault
  double controller_period = 0.0;        // [s]
};

enum class Verdict { pass, fail, not_applicable };

// "pass", "fail", "not applicable"
const char* verdict_name(Verdict verdict);

struct CheckResult {
  std::string name;      // "overshoot"
  Verdict verdict = Verdict::not_applicable;
  double measured = 0.0; // in `unit`
  double limit = 0.0;    // in `unit`
  std::string unit;      // as people read it: "%", "s", "deg"
  double time = -1.0;    // [s] of the worst moment; negative where there is none
  std::string reason;    // one sentence
};

std::vector<CheckResult> acceptance_checks(const msgs::RunLog& run, const AcceptanceLimits& limits,
                                           const AcceptedMachine& machine);

// No check failed, and at least one passed.
bool accepted(const std::vector<CheckResult>& results);
// Names of the checks for which the run had nothing to judge, commas between.
std::string not_judged(const std::vector<CheckResult>& results);

// Why a run must not be judged: its log is cut off, damaged or has a hole; empty where it may. Its numbers are in
// nanoseconds, the scenario's and the machine's.
struct ExpectedRun {
  std::int64_t duration = 0;
  std::int64_t controller_period = 0;
  std::int64_t sensors_period = 0;
  std::int64_t longest_hole = 0;  // of ENCODER: what happens in it nobody judges
};
std::string why_no_verdict(const msgs::RunLogs& logs, const ExpectedRun& expected);

// Every name that a check of acceptance_checks() may have, and those that judge_log() (judgement.h) adds.
const std::vector<std::string>& acceptance_check_names();

// A suite of a JUnit file, without the file's head.
std::string junit_suite(const std::string& suite, const std::vector<CheckResult>& results,
                        const std::vector<std::pair<std::string, std::string>>& properties);

// JUnit XML: one test suite, a test case per check; what is not applicable counts as skipped.
std::string junit_xml(const std::string& suite, const std::vector<CheckResult>& results);

// One line per check.
std::string check_table(const std::vector<CheckResult>& results);

// The results for whoever draws them. `log_digest`: of the log that was judged, empty where there was none.
std::string checks_json(const std::vector<CheckResult>& results, const AcceptanceLimits& limits,
                        const AcceptedMachine& machine, const std::string& log_digest);

}  // namespace slewlab::tools
