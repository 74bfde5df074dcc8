#include "diagnosis/admit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "diagnosis/plausibility.h"
#include "sim/effects/catalogue.h"
#include "sim/machine/effect_scales.h"
#include "sim/model/crane.h"
#include "sim/model/drive_line.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kLeastTrusted = 0.3;      // share of a record that must lie away from impacts
constexpr double kAllTrusted = 0.999;      // share from which nothing is said of impacts
constexpr double kSlowFollower = 4.0;      // by which the observer is slower behind coarse counts, or they would shake its boom
constexpr double kCoarseDiscrepancy = 5.0;  // by which mesh and step miss more there
// Of half the play with the gears wound up by the rated torque: where a motor stands when the drives are off, or still swings just after
// they were switched on; chosen.
constexpr double kOffsetShare = 0.2;
// Of the encoders' period: what was read is as old as anything between two readings, a standard deviation of 1 / sqrt(12).
constexpr double kLatencyOfPeriod = 0.3;

void check_same_groups(const Record& record, const sim::CraneParameters& nominal) {
  if (record.group_count == nominal.drive.group_count) return;
  throw NotAdmitted(fmt::format("{}: the log has {} motor groups, the nominal crane {}: another crane?", record.name, record.group_count,
                                nominal.drive.group_count));
}

void check_followed(const Record& record, const Shadow& follower) {
  for (int g = 0; g < record.group_count; ++g) {
    const std::vector<double>& missing = follower.missing_torque[static_cast<std::size_t>(g)];
    if (std::all_of(missing.begin(), missing.end(), [](double torque) { return std::isfinite(torque); })) continue;
    throw NotAdmitted(fmt::format("{}: the nominal crane cannot follow this record at all; check its inertias, its gear ratios and the record's units",
                                  record.name));
  }
}

// Whether the record begins with the teeth on the flanks to which its first torques push: these would carry a free motor across its play
// within `time` [s], and the groups' places to each other change by what the torques wind the gears up and hardly anything more. (From the
// middle of their play they would move apart, or together, by twice half of it; slowly where a brake drags.)
bool begins_on_flanks(const sim::CraneParameters& nominal, const Record& record, double time) {
  constexpr double kKeptShare = 0.2;  // of half the play; chosen: the nominal gears' stiffness tells the windup no better
  const sim::DriveParameters& drive = nominal.drive;
  const sim::GearContact gear = sim::gear_contact(nominal);
  const double ratio = sim::total_ratio(drive);
  const double way_per_torque = 0.5 * time * time * drive.motors_per_group * ratio / sim::group_inertia(drive);
  const double windup_per_torque = drive.motors_per_group * ratio * ratio / gear.stiffness;  // motor's turn
  const auto count = std::min(record.size(), static_cast<std::size_t>(std::lround(time / record.step)));
  for (int g = 0; g < record.group_count; ++g) {
    const auto i = static_cast<std::size_t>(g);
    if (std::fabs(record.motor_torque[i][0]) * way_per_torque < 2.0 * gear.half_play) return false;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t n = 0; n < count; ++n) {
      const double apart = record.shaft_position[i][n] - record.shaft_position[0][n] -
                           windup_per_torque * (record.motor_torque[i][n] - record.motor_torque[0][n]);
      low = std::min(low, apart);
      high = std::max(high, apart);
    }
    if (high - low > kKeptShare * gear.half_play * ratio) return false;
  }
  return gear.half_play > 0.0;
}

}  // namespace

bool has_coarse_counts(const std::vector<Record>& records) {
  return std::any_of(records.begin(), records.end(), [](const Record& record) { return record.encoder_quantum >= kCoarseCount; });
}

WhiteningSettings whitening_for(const Thresholds& thresholds, bool is_coarse) {
  WhiteningSettings whitening = thresholds.whitening;
  if (is_coarse) whitening.discrepancy_share *= kCoarseDiscrepancy;
  return whitening;
}

void set_machine(const sim::MachineSettings& nominal, const std::vector<Record>& records, Problem& problem) {
  const sim::MachineDescription machine = sim::describe(nominal.crane);
  problem.thresholds = thresholds_of(machine);
  problem.nominal = nominal;
  if (!problem.nominal.scales) problem.nominal.scales = sim::effect_scales(nominal.crane, nominal.drive_protection);
  problem.catalogue = sim::effects_for(problem.nominal);
  problem.nominal.crane.boom.highest_frequency = problem.thresholds.highest_mode;
  double period = 0.0;
  for (const Record& record : records) period = std::max(period, record.encoder_period);
  const bool is_coarse = has_coarse_counts(records);
  const double latency = is_coarse ? problem.thresholds.coarse_latency : problem.thresholds.latency;
  problem.nuisances = nuisances_of(machine, std::max(latency, kLatencyOfPeriod * period));
  const sim::GearContact gear = sim::gear_contact(nominal.crane);
  if (gear.half_play > 0.0) {
    const sim::DriveParameters& drive = nominal.crane.drive;
    problem.nuisances.offset_groups = static_cast<std::size_t>(drive.group_count);
    problem.nuisances.offset_deviation =
        kOffsetShare * (gear.half_play + drive.rated_torque * drive.motors_per_group * sim::total_ratio(drive) / gear.stiffness);
  }
  ShadowSettings observer = not_faster_than(problem.thresholds.shadow, period);
  if (is_coarse) {
    observer.speed_rate /= kSlowFollower;
    observer.position_rate /= kSlowFollower * kSlowFollower;
  }
  problem.gains = shadow_gains(machine.scales, observer);
}

Followed admit(std::vector<Record> records, const WhiteningSettings& whitening, Problem& problem, std::vector<std::string>& remarks) {
  Followed followed;
  std::string not_judged;  // the records that are left out, with the reason
  for (Record& record : records) {
    check_same_groups(record, problem.nominal.crane);
    remarks.insert(remarks.end(), record.remarks.begin(), record.remarks.end());
    record.begins_pressed = begins_on_flanks(problem.nominal.crane, record, problem.thresholds.time);
    Shadow follower = shadow(problem.nominal, record, problem.gains);
    check_followed(record, follower);
    check_torques(record, follower, problem.nominal, problem.thresholds.admission);
    const std::vector<bool> trusted = trusted_stretches(record, follower, whitening);
    const double share = static_cast<double>(std::count(trusted.begin(), trusted.end(), true)) / static_cast<double>(record.size());
    if (share < kLeastTrusted) {
      not_judged += fmt::format("{}{}: only {:.0f} % of the record lies away from impacts of the gears, at least {:.0f} % are needed",
                                not_judged.empty() ? "" : "; ", record.name, 100.0 * share, 100.0 * kLeastTrusted);
      continue;
    }
    if (share < kAllTrusted) {
      remarks.push_back(fmt::format("{}: {:.0f} % of the record lie near impacts of the gears and are not judged", record.name,
                                    100.0 * (1.0 - share)));
    }
    problem.whitening.push_back(make_whitening(record, trusted, problem.gains, follower, whitening));
    followed = {record.name, std::move(follower), {}};  // the last one stays
    problem.records.push_back(std::move(record));
  }
  if (problem.records.empty()) throw NotAdmitted(not_judged + "; switch play compensation on, or accelerate more gently");
  if (!not_judged.empty()) remarks.push_back(not_judged + "; left out, the answer stands on the other records");
  return followed;
}

}  // namespace slewlab::diagnosis
