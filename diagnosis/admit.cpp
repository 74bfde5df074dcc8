#include "diagnosis/admit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

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
// Of the machine's characteristic time from a record's beginning, at which its gears may have come to their flanks: drives that were switched
// on just before take about that long to press them apart. Chosen.
constexpr std::array<double, 6> kPressedAfter{0.0, 0.25, 0.5, 1.0, 1.5, 2.0};
constexpr double kKeptAtFirst = 0.4;  // of that time, for which a record's beginning must last before somebody moves the joystick
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

// What the machine's gears leave open where a record begins.
struct Play {
  double half = 0.0;            // [rad] slew axis
  double ratio = 1.0;           // motor turns per turn of the axis
  double way_per_torque = 0.0;  // [rad/Nm] slew axis, of a free motor within the machine's characteristic time
};

Play play_of(const sim::CraneParameters& nominal, double time) {
  const sim::DriveParameters& drive = nominal.drive;
  return {sim::gear_contact(nominal).half_play, sim::total_ratio(drive), 0.5 * time * time * drive.motors_per_group * sim::total_ratio(drive) / sim::group_inertia(drive)};
}

// Whether the torques then push every motor across its play within the characteristic time.
bool are_pushed(const Play& play, const Record& record, std::size_t from) {
  for (int g = 0; g < record.group_count; ++g) {
    if (std::fabs(record.motor_torque[static_cast<std::size_t>(g)][from]) * play.way_per_torque < 2.0 * play.half) return false;
  }
  return true;
}

// Whether the groups keep their places to each other from then on for a share of the characteristic time, within a quarter of what these
// torques would move free motors apart, or together.
bool keep_their_places(const Play& play, const Record& record, std::size_t from, double time, double share) {
  const std::size_t to = from + static_cast<std::size_t>(std::lround(share * time / record.step));
  if (to > record.size()) return false;
  for (int g = 1; g < record.group_count; ++g) {
    const auto i = static_cast<std::size_t>(g);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t n = from; n < to; ++n) {
      const double apart = record.shaft_position[i][n] - record.shaft_position[0][n];
      low = std::min(low, apart);
      high = std::max(high, apart);
    }
    const double torques = std::fabs(record.motor_torque[0][from]) + std::fabs(record.motor_torque[i][from]);
    const double free_way = std::min(4.0 * play.half, share * share * play.way_per_torque * torques);
    if (high - low > 0.25 * free_way * play.ratio) return false;
  }
  return true;
}

struct PossiblePlaces {
  FirstPlaces places;
  bool are_kept = false;  // the groups keep their places to each other from then on
};

// Where the gears may stand when the record begins, beside the middle of their play: on the flanks, or on their way to them, the house being
// held meanwhile or turning with the motors.
std::vector<PossiblePlaces> possible_first_places(const sim::CraneParameters& nominal, const Record& record, double time) {
  const Play play = play_of(nominal, time);
  if (play.half <= 0.0) return {};
  std::vector<PossiblePlaces> places;
  if (are_pushed(play, record, 0)) places.push_back({{0.0, 0.0}, keep_their_places(play, record, 0, time, kKeptAtFirst)});
  for (const double share : kPressedAfter) {
    const auto from = static_cast<std::size_t>(std::lround(share * time / record.step));
    if (from >= record.size() || !are_pushed(play, record, from) || !keep_their_places(play, record, from, time, 1.0)) continue;
    if (from == 0) break;
    double mean = 0.0;  // [rad] slew axis, that the motors turned
    for (int g = 0; g < record.group_count; ++g) {
      const std::vector<double>& position = record.shaft_position[static_cast<std::size_t>(g)];
      mean += (position[from] - position[0]) / (play.ratio * record.group_count);
    }
    const double at = record.step * static_cast<double>(from);
    if (!record.begins_in_motion) places.push_back({{at, 0.0}, true});
    places.push_back({{at, mean}, true});
    break;
  }
  return places;
}

// A record in motion begins where its gears can be told: where the torques press every group against a flank, and the groups keep their places
// to each other from then on. Nothing is taken off, and false, where that is nowhere in its first third.
bool begin_where_gears_are_known(const sim::CraneParameters& nominal, double time, Record& record) {
  const Play play = play_of(nominal, time);
  if (!record.begins_in_motion || play.half <= 0.0) return false;
  for (std::size_t from = 0; from < record.size() / 3; ++from) {
    if (!are_pushed(play, record, from) || !keep_their_places(play, record, from, time, from == 0 ? kKeptAtFirst : 1.0)) continue;
    leave_out_beginning(record, from);
    return true;
  }
  return false;
}

double missing_power(const Record& record, const Shadow& follower) {
  double square = 0.0;
  for (std::size_t g = 0; g < static_cast<std::size_t>(record.group_count); ++g) {
    for (const double missing : follower.missing_torque[g]) square += missing * missing;
  }
  return square;
}

// How the nominal machine follows a record, and where it may be judged.
struct Following {
  Shadow follower;
  std::vector<bool> trusted;
  double share = 0.0;
};

Following follow(const Problem& problem, const Record& record, const WhiteningSettings& whitening) {
  Following following{shadow(problem.nominal, record, problem.gains), {}, 0.0};
  following.trusted = trusted_stretches(record, following.follower, whitening);
  following.share = static_cast<double>(std::count(following.trusted.begin(), following.trusted.end(), true)) / static_cast<double>(record.size());
  return following;
}

// In motion on the flanks, as soon as they can be told. Else from the middle of the play, or where the record may begin elsewhere and is followed better from there, from there: one that begins
// elsewhere than the machine did knocks on, or is held off by a torque that never ends. Where the groups do not keep their places, that alone
// makes no record one that can be judged.
Following follow_from_its_beginning(const Problem& problem, Record& record, const WhiteningSettings& whitening) {
  if (begin_where_gears_are_known(problem.nominal.crane, problem.thresholds.time, record)) {
    record.first_places = FirstPlaces{};
    return follow(problem, record, whitening);
  }
  Following best = follow(problem, record, whitening);
  std::optional<FirstPlaces> best_places;
  for (const auto& [places, are_kept] : possible_first_places(problem.nominal.crane, record, problem.thresholds.time)) {
    record.first_places = places;
    Following other = follow(problem, record, whitening);
    const bool can_be_judged = best.share >= kLeastTrusted, other_can_be_judged = other.share >= kLeastTrusted;
    const bool is_better = can_be_judged != other_can_be_judged ? other_can_be_judged && are_kept
                                                                : missing_power(record, other.follower) < missing_power(record, best.follower);
    if (!is_better) continue;
    best = std::move(other);
    best_places = places;
  }
  record.first_places = best_places;
  return best;
}

}  // namespace

bool has_coarse_counts(std::span<const Record> records) {
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
    check_groups(record, problem.nominal.crane);
    remarks.insert(remarks.end(), record.remarks.begin(), record.remarks.end());
    Following following = follow_from_its_beginning(problem, record, whitening);
    Shadow& follower = following.follower;
    check_followed(record, follower);
    check_torques(record, follower, problem.nominal, problem.thresholds.admission);
    const std::vector<bool>& trusted = following.trusted;
    const double share = following.share;
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
    problem.nuisances.in_motion.push_back(record.begins_in_motion);
    problem.nuisances.has_motion |= record.begins_in_motion;
    problem.records.push_back(std::move(record));
  }
  if (problem.records.empty()) throw NotAdmitted(not_judged + "; switch play compensation on, or accelerate more gently");
  if (!not_judged.empty()) remarks.push_back(not_judged + "; left out, the answer stands on the other records");
  return followed;
}

}  // namespace slewlab::diagnosis
