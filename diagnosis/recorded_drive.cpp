#include "diagnosis/recorded_drive.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/decimation.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;
constexpr double kStanding = 0.05;  // [-] of the record's largest speed; chosen: what a swinging load makes of a crane at rest

}  // namespace

bool says_tripped(const msgs::PlantStatus& status) {
  const auto state = static_cast<sim::DriveState>(status.drive_state);
  const bool braked_by_trip =
      state == sim::DriveState::braked && status.trip_cause != static_cast<std::int8_t>(sim::DriveFault::none);
  return state == sim::DriveState::tripped || braked_by_trip;
}

RecordedDrive::RecordedDrive(const Record& record, const sim::DriveProtectionSettings& protection)
    : record_(&record),
      protection_(protection),
      run_{record.group_count, 0, std::llround(record.encoder_period * kNanosecondsPerSecond)},
      step_(std::llround(command_step(record) * kNanosecondsPerSecond)) {
  protection_.alive_timeout = protection_.silence_timeout = sim::kNever;
  message_.group_count = record.group_count;
  message_.motor_torque.resize(static_cast<std::size_t>(record.group_count));
  if (begins_at_rest() || record.size() == 0) return;
  state_.state = sim::DriveState::running;
  for (int g = 0; g < record.group_count; ++g) {
    const double first = commands(record, static_cast<std::size_t>(g)).front();
    state_.motor_torque[g] = std::clamp(first, -protection_.torque_limit, protection_.torque_limit);
  }
}

bool RecordedDrive::begins_at_rest() const {
  if (record_->torque.empty() || record_->torque.front().answered_sequence > 0) return false;
  for (int g = 0; g < record_->group_count; ++g) {
    const std::vector<double>& speed = record_->position_rate[static_cast<std::size_t>(g)];
    double largest = 0.0;
    for (const double value : speed) largest = std::max(largest, std::fabs(value));
    if (!speed.empty() && std::fabs(speed.front()) > std::max(protection_.standstill_speed, kStanding * largest)) return false;
  }
  return true;
}

// Whether a message came since the last point.
bool RecordedDrive::look_at_messages(std::int64_t time) {
  bool is_new = false;
  for (; messages_ < record_->torque.size() && record_->torque[messages_].simulated_time <= time; ++messages_) {
    is_new = true;
    // After a trip the drive takes torque again once it is acknowledged.
    if (record_->torque[messages_].acknowledge) tripped_ = false;
  }
  for (; statuses_ < record_->plant_status.size() && record_->plant_status[statuses_].simulated_time <= time; ++statuses_) {
    const bool before = tripped_;
    tripped_ = says_tripped(record_->plant_status[statuses_]);
    is_new = is_new || tripped_ != before;
  }
  return is_new;
}

void RecordedDrive::command(std::int64_t time) {
  const std::int64_t periods = std::llround(static_cast<double>(time - last_command_) / static_cast<double>(run_.controller_period));
  message_.answered_sequence += point_ == 0 ? 1 : std::max<std::int64_t>(1, periods);
  last_command_ = time;
  for (int g = 0; g < record_->group_count; ++g) {
    message_.motor_torque[static_cast<std::size_t>(g)] = commands(*record_, static_cast<std::size_t>(g))[point_];
  }
  ++message_.alive_counter;
  message_.enable = true;
  message_.brake = false;
  if (messages_ > 0) {
    message_.enable = record_->torque[messages_ - 1].enable;
    message_.brake = record_->torque[messages_ - 1].brake;
  }
  if (tripped_) message_.brake = true;
  sim::begin_cycle(state_, message_.answered_sequence);
  sim::DriveMoment moment;
  moment.time = time;
  sim::receive(protection_, run_, state_, moment, msgs::DecodeStatus::ok, message_);
}

sim::DriveCommand RecordedDrive::next() {
  const auto time = static_cast<std::int64_t>(std::llround(time_of(point_) * kNanosecondsPerSecond));
  bool is_new = look_at_messages(time) || point_ == 0;
  for (int g = 0; g < record_->group_count && !is_new; ++g) {
    const std::vector<double>& torque = commands(*record_, static_cast<std::size_t>(g));
    is_new = torque[point_] != torque[point_ - 1];
  }
  if (is_new) command(time);
  ++point_;
  sim::DriveMoment moment;
  moment.time = time;
  return sim::drive_command(protection_, run_, state_, moment, step_);
}

double RecordedDrive::time_of(std::size_t point) const { return record_->start_time + command_step(*record_) * static_cast<double>(point); }

void RecordedDrive::go_on_in(const Record& record) {
  const auto until = std::llround((time_of(point_) - command_step(*record_)) * kNanosecondsPerSecond);  // what came by then has been looked at
  point_ = static_cast<std::size_t>(std::lround((time_of(point_) - record.start_time) / command_step(record)));
  const auto looked_at = [&](const auto& messages) {
    return static_cast<std::size_t>(std::count_if(messages.begin(), messages.end(), [&](const auto& message) { return message.simulated_time <= until; }));
  };
  messages_ = looked_at(record.torque);
  statuses_ = looked_at(record.plant_status);
  record_ = &record;
}

namespace {

// What holds from each point to the next.
void hold_on_grid(DriveCourse& course) {
  if (course.per_point == 1) return;
  const std::size_t points = course.per_point;
  DriveSeries& held = course.held;
  held.enable.clear();
  for (std::size_t n = 0; n < course.enable.size(); n += points) {
    held.enable.push_back(std::any_of(course.enable.begin() + static_cast<std::ptrdiff_t>(n), course.enable.begin() + static_cast<std::ptrdiff_t>(n + points),
                                      [](bool enable) { return enable; }));
  }
  for (std::size_t g = 0; g < course.motor_torque.size(); ++g) {
    std::vector<double> delivered = course.motor_torque[g];
    for (std::size_t n = 0; n < delivered.size(); ++n) {
      if (!course.enable[n]) delivered[n] = 0.0;
    }
    held.motor_torque[g] = course.is_filtered ? held_decimated(delivered, points) : means(delivered, points);
    held.brake_torque[g] = means(course.brake_torque[g], points);
  }
}

}  // namespace

MessageCycle message_cycle(const Record& record) {
  constexpr std::size_t kMostReadings = 50;  // of the encoders, that a controller may be slower; chosen
  constexpr double kTogether = 0.99;         // of all changes, that come a multiple of the cycle apart: a recorder's clock may slip now and then
  constexpr double kMoves = 0.2;             // of the cycles in a record, in which its commands change, or it does not show them
  const auto reading = static_cast<std::size_t>(std::max(1.0, std::round(record.encoder_period / command_step(record))));
  std::vector<std::size_t> changes;  // commands that differ from the one before
  const std::size_t count = commands(record, 0).size();
  for (std::size_t n = 1; n < count; ++n) {
    bool changes_here = false;
    for (std::size_t g = 0; g < static_cast<std::size_t>(record.group_count); ++g) changes_here = changes_here || commands(record, g)[n] != commands(record, g)[n - 1];
    if (changes_here) changes.push_back(n);
  }
  for (std::size_t readings = kMostReadings; readings > 1; --readings) {
    const std::size_t cycle = readings * reading;
    if (static_cast<double>(changes.size() * cycle) < kMoves * static_cast<double>(count)) continue;
    std::vector<std::size_t> at(cycle);
    for (const std::size_t n : changes) ++at[n % cycle];
    const auto most = std::max_element(at.begin(), at.end());
    if (static_cast<double>(*most) >= kTogether * static_cast<double>(changes.size())) return {cycle, static_cast<std::size_t>(most - at.begin())};
  }
  return {reading, 0};
}

DriveCourse drive_course(const Record& record, const sim::DriveProtectionSettings& protection) {
  DriveCourse course;
  course.per_point = record.recorded_per_point;
  course.is_filtered = is_filtered(record);
  course.messages = message_cycle(record);
  const std::size_t groups = static_cast<std::size_t>(record.group_count), count = record.size() * course.per_point;
  for (std::size_t g = 0; g < groups; ++g) {
    course.motor_torque[g].reserve(count);
    course.brake_torque[g].reserve(count);
  }
  course.enable.reserve(count);
  RecordedDrive drive(record, protection);
  for (std::size_t n = 0; n < count; ++n) {
    const sim::DriveCommand command = drive.next();
    for (std::size_t g = 0; g < groups; ++g) {
      course.motor_torque[g].push_back(command.motor_torque[g]);
      course.brake_torque[g].push_back(command.brake_torque[g]);
    }
    course.enable.push_back(command.enable);
  }
  hold_on_grid(course);
  return course;
}

double enabled_share(const DriveCourse& course, std::size_t point) {
  const auto first = course.enable.begin() + static_cast<std::ptrdiff_t>(point * course.per_point);
  return static_cast<double>(std::count(first, first + static_cast<std::ptrdiff_t>(course.per_point), true)) / static_cast<double>(course.per_point);
}

}  // namespace slewlab::diagnosis
