#include "diagnosis/admit.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "diagnosis/hidden_commands.h"
#include "diagnosis/judged_grid.h"
#include "diagnosis/plausibility.h"
#include "sim/effects/catalogue.h"
#include "sim/machine/effect_scales.h"
#include "sim/model/crane.h"
#include "sim/model/drive_line.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kAllTrusted = 0.999;      // share from which nothing is said of impacts
constexpr double kSlowFollower = 4.0;      // by which the observer is slower behind coarse counts, or they would shake its boom
constexpr double kModelStep = 1e-3;         // of the characteristic time, of the model where forces act between readings: that of config/scenarios, of the thesis's crane
constexpr double kCoarseDiscrepancy = 5.0;  // by which mesh and step miss more there
// Of half the play with the gears wound up by the rated torque: where a motor stands when the drives are off, or still swings just after
// they were switched on; chosen.
constexpr double kOffsetShare = 0.2;
constexpr double kBesideTheMiddle = 0.8;  // of half the play, chosen: within which a motor that stood beside the middle can be found from there
constexpr double kUnloaded = 0.03, kUnloadedFor = 0.25;  // of the largest torque; of the characteristic time; chosen
constexpr std::size_t kFirstReadings = 3;  // grid points, chosen: more than one, and too few for drives that were just switched on to move anything
constexpr double kSwingsOn = 3.0;  // deviations of a load's swing at rest, from which it swings on from moves before; chosen
constexpr double kKeptAtFirst = 0.4;  // of that time, for which a record's beginning must last before somebody moves the joystick
// Of the encoders' period, chosen: readings and commands of one cycle are taken to be of one instant; what a fieldbus adds beyond is a delay, and answered as one.
constexpr double kLatencyOfPeriod = 0.1;

void check_same_groups(const Record& record, const sim::CraneParameters& nominal) {
  if (record.group_count == nominal.drive.group_count) return;
  throw NotAdmitted(fmt::format("{}: the log has {} motor {}, the nominal crane {}: another crane?", record.name, record.group_count,
                                record.group_count == 1 ? "group" : "groups", nominal.drive.group_count));
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

// Whether the torques then push every motor across its play within the characteristic time, as they do on the average in the time that follows: no torque that
// is on its way to another flank, or nothing yet.
bool are_pushed(const Play& play, const Record& record, std::size_t from, double time) {
  const std::size_t to = std::min(record.size(), from + static_cast<std::size_t>(std::lround(time / record.step)));
  for (int g = 0; g < record.group_count; ++g) {
    const std::vector<double>& torque = record.motor_torque[static_cast<std::size_t>(g)];
    if (std::fabs(torque[from]) * play.way_per_torque < 2.0 * play.half) return false;
    double mean = 0.0;
    for (std::size_t n = from; n < to; ++n) mean += torque[n] / static_cast<double>(to - from);
    if (torque[from] * mean < 0.5 * mean * mean) return false;
  }
  return true;
}

// Whether the groups keep their places to each other from then on for a share of the characteristic time, within a quarter of where their torques would
// have moved free motors, or of the play; torques that would not have moved each motor through it tell nothing.
bool keep_their_places(const Play& play, const Record& record, std::size_t from, double time, double share) {
  const std::size_t to = from + static_cast<std::size_t>(std::lround(share * time / record.step));
  if (to > record.size()) return false;
  const double per_torque = 2.0 * play.way_per_torque / (time * time);  // [rad/s^2/Nm] slew axis
  const auto groups = static_cast<std::size_t>(record.group_count);
  GroupAngles speed{}, place{}, way{}, apart_way{}, low{}, high{};  // of free motors; of the recorded ones beside the first
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-std::numeric_limits<double>::infinity());
  for (std::size_t n = from; n < to; ++n) {
    for (std::size_t i = 0; i < groups; ++i) {
      speed[i] += record.step * per_torque * record.motor_torque[i][n];
      place[i] += record.step * speed[i];
      way[i] = std::max(way[i], std::fabs(place[i]));
      apart_way[i] = std::max(apart_way[i], std::fabs(place[i] - place[0]));
      const double apart = (record.shaft_position[i][n] - record.shaft_position[0][n]) / play.ratio;
      low[i] = std::min(low[i], apart);
      high[i] = std::max(high[i], apart);
    }
  }
  for (std::size_t i = 0; i < groups; ++i) {
    if (way[i] < 2.0 * play.half || high[i] - low[i] > 0.25 * std::clamp(apart_way[i], 2.0 * play.half, 4.0 * play.half)) return false;
  }
  return true;
}

// The first grid point in the record's first third at which the torques press every gear against a flank, and the groups keep their places to
// each other from then on; nothing where there is none.
std::optional<std::size_t> pressed_from(const Play& play, const Record& record, double time) {
  for (std::size_t from = 0; from < record.size() / 3; ++from) {
    if (are_pushed(play, record, from, time) && keep_their_places(play, record, from, time, from == 0 ? kKeptAtFirst : 1.0)) return from;
  }
  return {};
}

// Whether groups that are pressed at a grid point have gone as far beside each other by then as from the middle of their play, where nothing winds them up.
bool came_from_the_middle(const Problem& problem, const Play& play, const Record& record, std::size_t pressed) {
  const sim::Machine machine = follower_of(problem.nominal, grid_of(record)).machine;
  const GroupAngles places = places_on_flanks(machine.model, record, pressed, rigid_acceleration(machine.model, record, pressed));
  for (int g = 1; g < record.group_count; ++g) {
    const auto i = static_cast<std::size_t>(g);
    const double apart = (record.shaft_position[i][pressed] - record.shaft_position[0][pressed]) - (record.shaft_position[i][0] - record.shaft_position[0][0]);
    if (std::fabs(apart / play.ratio - (places[i] - places[0])) > kBesideTheMiddle * play.half) return false;
  }
  return true;
}

// Whether all groups together push with little when the record begins, so that nothing is bent.
bool begins_unloaded(const Record& record, double time) {
  const auto first = std::min(record.size(), static_cast<std::size_t>(kUnloadedFor * time / record.step) + 1);
  double largest = 0.0, largest_first = 0.0;
  for (std::size_t n = 0; n < record.size(); ++n) {
    const double torque = std::fabs(mean_torque(record, n));
    largest = std::max(largest, torque);
    if (n < first) largest_first = std::max(largest_first, torque);
  }
  return largest_first < kUnloaded * largest;
}

// Of two followers, from a grid point on, the sum over the groups of the mean of the product of what they miss.
double missing_product(const Shadow& one, const Shadow& other, std::size_t from) {
  double sum = 0.0;
  for (std::size_t g = 0; g < one.missing_torque.size(); ++g) {
    const std::vector<double>&a = one.missing_torque[g], &b = other.missing_torque[g];
    for (std::size_t n = from; n < a.size(); ++n) sum += a[n] * b[n] / static_cast<double>(a.size() - from);
  }
  return sum;
}

// What it misses more than another one.
Shadow missing_beside(Shadow one, const Shadow& other) {
  for (std::size_t g = 0; g < one.missing_torque.size(); ++g) {
    for (std::size_t n = 0; n < one.missing_torque[g].size(); ++n) one.missing_torque[g][n] -= other.missing_torque[g][n];
  }
  return one;
}

// What is missing beside the swing of the load at the beginning that best stands for it.
struct BesideSwing {
  double power = 0.0;  // [Nm^2] mean square, from a grid point on
  double swing = 0.0;  // [rad] how far the load would swing
};

BesideSwing beside_swing(const Problem& problem, const Record& record, const Shadow& follower, std::size_t from) {
  const double power = missing_product(follower, follower, from), natural = std::sqrt(sim::kGravity / problem.nuisances.rope_length);  // [rad/s]
  Beginning swung, swinging;
  swung.swing = kSwingDeviation;
  swinging.swing_rate = kSwingDeviation * natural;
  const std::array<Shadow, 2> columns{missing_beside(shadow(problem.nominal, record, problem.gains, 0.0, swung), follower),
                                      missing_beside(shadow(problem.nominal, record, problem.gains, 0.0, swinging), follower)};
  Eigen::Matrix2d gram;
  Eigen::Vector2d along;
  for (std::size_t a = 0; a < 2; ++a) {
    along(static_cast<Eigen::Index>(a)) = missing_product(columns[a], follower, from);
    for (std::size_t b = 0; b < 2; ++b) gram(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) = missing_product(columns[a], columns[b], from);
  }
  const Eigen::Vector2d amount = -gram.ldlt().solve(along);
  if (!amount.allFinite()) return {power, 0.0};
  return {power + along.dot(amount), kSwingDeviation * amount.norm()};
}

// Mean square of the missing torque from a grid point on. What a load swings from the moves before says nothing of where the gears began, and may be most of it.
double missing_power(const Problem& problem, const Record& record, const Shadow& follower, std::size_t from = 0) {
  return record.load_may_swing ? beside_swing(problem, record, follower, from).power : missing_product(follower, follower, from);
}

// How the nominal machine follows a record, and how much of it may be judged.
struct Following {
  Shadow follower;
  double share = 0.0;
};

Following follow(const Problem& problem, const Record& record, const WhiteningSettings& whitening) {
  Following following{shadow(problem.nominal, record, problem.gains), 0.0};
  const std::vector<bool> trusted = trusted_stretches(record, following.follower, whitening);
  following.share = static_cast<double>(std::count(trusted.begin(), trusted.end(), true)) / static_cast<double>(record.size());
  return following;
}

// From the middle of the play, or where the torques push from the first moment on, or there is no play, and the record is followed better from there, on the flanks, wound up: one
// that begins elsewhere than the machine did knocks on, or is held off by a torque that never ends. Where the groups do not keep their
// places, that alone makes no record one that can be judged.
Following follow_from_rest(const Problem& problem, const Play& play, Record& record, const WhiteningSettings& whitening) {
  Following best = follow(problem, record, whitening);
  if (play.half > 0.0 && !are_pushed(play, record, 0, problem.thresholds.time)) return best;
  const double best_power = missing_power(problem, record, best.follower);
  record.begins_on_flanks = true;
  Following other = follow(problem, record, whitening);
  const bool can_be_judged = best.share >= kLeastTrusted, other_can_be_judged = other.share >= kLeastTrusted;
  const bool are_kept = keep_their_places(play, record, 0, problem.thresholds.time, kKeptAtFirst);
  record.begins_on_flanks = can_be_judged != other_can_be_judged ? other_can_be_judged && are_kept
                                                                 : missing_power(problem, record, other.follower) < best_power;
  return record.begins_on_flanks ? std::move(other) : std::move(best);
}

// [rad] How far a load that is taken to hang still swings by what the machine misses that begins at rest.
double swing_at_rest(const Problem& problem, const Play& play, Record record, const WhiteningSettings& whitening) {
  const Following following = follow_from_rest(problem, play, record, whitening);
  return beside_swing(problem, record, following.follower, static_cast<std::size_t>(whitening.after_impact / record.step)).swing;
}

// Whether every motor stands when the record begins. What has just pressed the gears against each other lets boom and load swing, and the motors with them.
bool begins_at_rest(const Record& record, const AdmissionSettings& settings) {
  const std::size_t first = std::min<std::size_t>(record.size(), kFirstReadings);
  for (int g = 0; g < record.group_count; ++g) {
    const std::vector<double>& speed = record.shaft_speed[static_cast<std::size_t>(g)];
    const double mean = std::accumulate(speed.begin(), speed.begin() + static_cast<std::ptrdiff_t>(first), 0.0) / static_cast<double>(first);
    if (std::fabs(mean) > creeping_speed(settings)) return false;
  }
  return true;
}

// What several groups do beside each other tells where their gears are. A machine that stands in the middle of its play until the drives are on, or on its flanks
// and unloaded, begins there. Any other begins where its gears are pressed, boom and load as they may then swing; but at rest where its motors stand and it is followed better from
// there, for a brake that drags holds gears in the midst of their play as flanks would.
Following follow_from_its_beginning(const Problem& problem, Record& record, const WhiteningSettings& whitening) {
  const double time = problem.thresholds.time;
  const Play play = play_of(problem.nominal.crane, time);
  const bool can_be_told = record.group_count > 1 || record.begins_in_motion;
  std::optional<std::size_t> found;
  if (can_be_told) found = play.half > 0.0 ? pressed_from(play, record, time) : 0;  // gears without play are always pressed
  const bool is_pressed = found.has_value();
  const std::size_t pressed = found.value_or(0);  // from there on
  const bool is_at_rest = !record.begins_in_motion && begins_at_rest(record, problem.thresholds.admission);
  const bool is_unloaded = is_at_rest && begins_unloaded(record, time);
  // Drives that are on already, or motors that hold something, may have moved before: the load's swing tells.
  const bool may_have_moved = is_at_rest && ((is_pressed && pressed == 0) || !is_unloaded) && problem.nuisances.swing_amounts() > 0;
  record.load_may_swing = may_have_moved && swing_at_rest(problem, play, record, whitening) > kSwingsOn * kSwingDeviation;
  // Gears that are wound up from the first reading on are so by drives that were on before, and no motor tells what moved then: behind a house that a friction holds load, rod and boom swing on.
  const auto told_by_its_gears = [&](Following from_rest) {
    record.load_may_swing |= may_have_moved && record.begins_on_flanks;
    return from_rest;
  };
  if (!is_pressed || (is_unloaded && pressed == 0) || (!record.begins_in_motion && pressed > 0 && came_from_the_middle(problem, play, record, pressed))) {
    return told_by_its_gears(follow_from_rest(problem, play, record, whitening));
  }
  Record later = record;
  leave_out_beginning(later, pressed);
  later.begins_bent = later.begins_on_flanks = true;
  Following from_later = follow(problem, later, whitening);
  if (is_at_rest) {
    Following from_rest = follow_from_rest(problem, play, record, whitening);
    const auto forgotten = static_cast<std::size_t>(whitening.after_impact / record.step);
    if (missing_power(problem, record, from_rest.follower, pressed + forgotten) < missing_power(problem, later, from_later.follower, forgotten)) return told_by_its_gears(std::move(from_rest));
  }
  record = std::move(later);
  return from_later;
}

}  // namespace

Whitening whitening_between(const Problem& problem, const Record& record, const Shadow& nominal, const WhiteningSettings& settings, std::size_t from, std::size_t to) {
  std::optional<Shadow> with_impacts;
  if (!record.impacts_of_cause.empty()) {
    with_impacts = nominal;
    for (std::size_t n = 0; n < record.size(); ++n) with_impacts->contact_lost[n] = nominal.contact_lost[n] || record.impacts_of_cause[n];
  }
  const Shadow& follower = with_impacts ? *with_impacts : nominal;
  const std::vector<bool> trusted = trusted_stretches(record, follower, settings);
  std::vector<bool> judged(record.size(), false);
  std::copy(trusted.begin() + static_cast<std::ptrdiff_t>(from), trusted.begin() + static_cast<std::ptrdiff_t>(to), judged.begin() + static_cast<std::ptrdiff_t>(from));
  const NoiseResponse response = noise_response(problem.nominal, record, problem.gains, transform_length(record.size()));
  Whitening whitening = make_whitening(record, judged, response, follower, settings);
  // By which the observer holds a motor beside its flank.
  const double play_torque = problem.gains.position * sim::gear_contact(problem.nominal.crane).half_play * sim::total_ratio(problem.nominal.crane.drive);
  add_flanks(record, follower, trusted, settings.flank_part, play_torque, from, to, whitening);
  return whitening;
}

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
  problem.nominal.step = kModelStep * problem.thresholds.time;
  double period = 0.0;
  for (const Record& record : records) period = std::max(period, record.encoder_period);
  const bool is_coarse = has_coarse_counts(records);
  const double latency = is_coarse ? problem.thresholds.coarse_latency : problem.thresholds.latency;
  problem.nuisances = nuisances_of(machine, std::max(latency, kLatencyOfPeriod * period));
  const sim::GearContact gear = sim::gear_contact(nominal.crane);
  const sim::DriveParameters& drive = nominal.crane.drive;
  problem.nuisances.offset_groups = static_cast<std::size_t>(drive.group_count);
  problem.nuisances.offset_deviation = kOffsetShare * (gear.half_play + drive.rated_torque * drive.motors_per_group * sim::total_ratio(drive) / gear.stiffness);
  ShadowSettings observer = not_faster_than(problem.thresholds.shadow, period);
  if (is_coarse) {
    observer.speed_rate /= kSlowFollower;
    observer.position_rate /= kSlowFollower * kSlowFollower;
  }
  problem.gains = shadow_gains(machine.scales, observer);
}

namespace {

Following checked_following(const Problem& problem, Record& record, const WhiteningSettings& whitening) {
  check_same_groups(record, problem.nominal.crane);
  check_groups(record, problem.nominal.crane);
  Following following = follow_from_its_beginning(problem, record, whitening);
  check_followed(record, following.follower);
  check_torques(record, following.follower, problem.nominal, problem.thresholds.admission);
  return following;
}

// Why nothing is judged behind a moment of a record that begins in motion; nothing where all is that lies away from impacts.
std::string told_let_go(const Record& record, const Shadow& follower, const char* before, const char* after) {
  const auto let_go = std::find(follower.house_let_go.begin(), follower.house_let_go.end(), true);
  if (!record.begins_bent || let_go == follower.house_let_go.end()) return "";
  return fmt::format("{}it begins in motion, and nothing is judged behind {:.2f} s, where no gear holds the house: how it swings from there on no fit would find{}", before,
                     record.time(static_cast<std::size_t>(let_go - follower.house_let_go.begin())), after);
}

}  // namespace

RecordBegins begin_of(const Record& record) {
  if (record.begins_bent) return RecordBegins::in_motion;
  return record.load_may_swing ? RecordBegins::at_rest : RecordBegins::unmoved;
}

double judged_share(const sim::MachineSettings& nominal, Record record) {
  Problem problem;
  set_machine(nominal, {record}, problem);
  return checked_following(problem, record, whitening_for(problem.thresholds, record.encoder_quantum >= kCoarseCount)).share;
}

Followed admit(std::vector<Record> records, const WhiteningSettings& whitening, Problem& problem, std::vector<std::string>& remarks) {
  Followed followed;
  std::string not_judged;  // the records that are left out, with the reason
  for (Record& record : records) {
    Following following = checked_following(problem, record, whitening);
    remarks.insert(remarks.end(), record.remarks.begin(), record.remarks.end());
    Shadow& follower = following.follower;
    const double share = following.share;
    if (share < kLeastTrusted) {
      not_judged += fmt::format("{}{}: only {:.0f} % of the record lies away from impacts of the gears, at least {:.0f} % are needed{}",
                                not_judged.empty() ? "" : "; ", record.name, 100.0 * share, 100.0 * kLeastTrusted, told_let_go(record, follower, " (", ")"));
      continue;
    }
    if (share < kAllTrusted) {
      remarks.push_back(fmt::format("{}: {:.0f} % of the record lie near impacts of the gears and are not judged", record.name,
                                    100.0 * (1.0 - share)) + told_let_go(record, follower, "; ", ""));
    }
    if (points_per_judged_point(record, whitening.highest_frequency) > 1) {
      record = on_judged_grid(std::move(record), whitening.highest_frequency);
      following = follow(problem, record, whitening);
    } else if (problem.commands_per_row > 1) {
      if (can_have_commands_between(record)) problem.nuisances.lead_deviation = std::max(problem.nuisances.lead_deviation, kLeadDeviation * record.step);
      record = with_commands_between(std::move(record), problem.commands_per_row);
      following = follow(problem, record, whitening);
    }
    problem.whitening.push_back(whitening_between(problem, record, following.follower, whitening, 0, record.size()));
    followed = {record.name, record.begins_bent, record.start_time, record.step, std::move(follower), {}};  // the last one stays
    problem.nuisances.begins.push_back(begin_of(record));
    problem.nuisances.has_motion |= begin_of(record) != RecordBegins::unmoved;
    problem.records.push_back(std::move(record));
  }
  if (problem.records.empty()) throw NotAdmitted(not_judged + "; begin the record at rest, switch play compensation on, or accelerate more gently");
  if (!not_judged.empty()) remarks.push_back(not_judged + "; left out, the answer stands on the other records");
  return followed;
}

void whiten_again(Problem& problem, const WhiteningSettings& whitening) {
  for (std::size_t r = 0; r < problem.records.size(); ++r) {
    const Record& record = problem.records[r];
    problem.whitening[r] = whitening_between(problem, record, shadow(problem.nominal, record, problem.gains), whitening, 0, record.size());
  }
}

}  // namespace slewlab::diagnosis
