#include "tools/acceptance/judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "msgs/configuration_hash.h"
#include "msgs/log_reader.h"
#include "msgs/run_log.h"
#include "sim/drive/fault_expectation.h"
#include "sim/machine/scales.h"
#include "sim/model/drive_line.h"
#include "tools/acceptance/whole_record.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

constexpr double kNanosecondsPerSecond = 1e9;

// Why the log is not the one that the run wrote; empty where it is, or where nothing tells.
std::string why_another_log(const fs::path& log, const std::string& written) {
  if (written.empty()) return {};
  const std::string found = msgs::hash_text(msgs::log_digest(log));
  if (found == written) return {};
  return fmt::format("{} is not as the run wrote it: {} bytes with digest {}, summary.json says digest {}", log.filename().string(),
                     fs::file_size(log), found, written);
}

// What the scenario itself says must happen.
CheckResult expected_reaction(const sim::FaultExpectation& expectation, const msgs::RunLog& run) {
  CheckResult result;
  result.name = "expectation";
  const std::vector<std::string> broken = sim::broken_expectations(expectation, run);
  result.verdict = broken.empty() ? Verdict::pass : Verdict::fail;
  result.reason = broken.empty() ? "everything under expect: of the scenario came about" : "";
  for (const std::string& line : broken) result.reason += (result.reason.empty() ? "" : "; ") + line;
  return result;
}

// [ns] Chosen: the machine's characteristic time, in which it gathers or loses its speed; and no hole are ten periods, which faults on
// purpose may take from the wire.
std::int64_t longest_hole(const sim::Scenario& scenario) {
  const double time = sim::characteristic_time(scenario.crane.parameters);
  return std::max(std::int64_t{10} * scenario.controller_period, static_cast<std::int64_t>(std::llround(time * kNanosecondsPerSecond)));
}

}  // namespace

CheckResult failed_check(const char* name, const std::string& reason) {
  CheckResult result;
  result.name = name;
  result.verdict = Verdict::fail;
  result.reason = reason;
  return result;
}

std::string why_of_another_machine(const sim::Scenario& scenario, const AcceptanceLimits& limits) {
  constexpr double kSame = 1.1;  // chosen: a tenth is within what a machine is commissioned for
  const sim::DriveParameters& drive = scenario.crane.parameters.drive;
  const auto differs = [](double a, double b) { return a > 0.0 && b > 0.0 && std::max(a, b) > kSame * std::min(a, b); };
  if (!differs(drive.top_speed, limits.top_speed) && !differs(drive.rated_torque, limits.rated_torque)) return {};
  const auto text = [](double speed, double torque) { return fmt::format("{:.3g} rad/s and {:.3g} N m per motor", speed, torque); };
  return fmt::format("the limits are for a machine of {} (top_speed, motor_torque_rated); this one has {}", text(limits.top_speed, limits.rated_torque),
                     text(drive.top_speed, drive.rated_torque));
}

AcceptedMachine accepted_machine(const sim::Scenario& scenario) {
  AcceptedMachine machine;
  machine.controller_period = static_cast<double>(scenario.controller_period) / kNanosecondsPerSecond;
  machine.total_ratio = sim::total_ratio(scenario.crane.parameters.drive);
  for (const sim::Fault& fault : scenario.faults) {
    const double from = static_cast<double>(fault.from) / kNanosecondsPerSecond;
    machine.first_fault = std::min(machine.first_fault.value_or(from), from);
    if (fault.kind == sim::FaultKind::encoder_noisy && !machine.encoder_noise) {
      machine.encoder_noise = {from, static_cast<double>(fault.until) / kNanosecondsPerSecond};
    }
  }
  for (const sim::Fault& fault : scenario.faults) {
    if (fault.kind == sim::FaultKind::encoder_noisy || !machine.encoder_noise) continue;
    machine.encoder_noise->until = std::min(machine.encoder_noise->until, static_cast<double>(fault.from) / kNanosecondsPerSecond);
  }
  return machine;
}

Judgement judge_log(const sim::Scenario& scenario, const fs::path& log, const AcceptanceLimits& limits, const LogOrigin& origin) {
  Judgement judgement;
  judgement.machine = accepted_machine(scenario);
  const msgs::RunLogs logs = msgs::read_run_logs(log);
  judgement.remarks = logs.remarks;
  judgement.no_verdict = why_no_verdict(logs, {scenario.duration, scenario.controller_period, scenario.sensors_period, longest_hole(scenario)});
  if (judgement.no_verdict.empty() && origin.written_digest.empty()) {
    judgement.no_verdict = why_not_whole(logs.runs.front(), scenario, origin.of_own_plant);
  }
  if (judgement.no_verdict.empty()) judgement.no_verdict = why_another_log(log, origin.written_digest);
  if (!judgement.no_verdict.empty()) {
    judgement.checks.push_back(failed_check("log", judgement.no_verdict));
    return judgement;
  }
  judgement.checks = acceptance_checks(logs.runs.front(), limits, judgement.machine);
  if (judgement.machine.first_fault) judgement.checks.push_back(expected_reaction(scenario.expectation, logs.runs.front()));
  const bool any_judged = std::any_of(judgement.checks.begin(), judgement.checks.end(),
                                      [](const CheckResult& result) { return result.verdict != Verdict::not_applicable; });
  if (!any_judged) judgement.no_verdict = "no check applies to this run";
  return judgement;
}

}  // namespace slewlab::tools
