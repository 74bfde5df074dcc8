#include "diagnosis/live_observer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "msgs/codec.h"
#include "sim/machine/effect_scales.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;
constexpr double kBetweenLooks = 0.1;  // [-] of the characteristic time, chosen: quick enough to be watched
constexpr double kFirstStretch = 1.0;  // [-] of the characteristic time, chosen: enough messages to know their periods
constexpr double kLongestWait = 5.0;   // [-] of the characteristic time, chosen: for a PLANT_STATUS; some seconds of a crane, which says one each second
constexpr double kMargin = 4.0;        // [-] half windows of a position's rate that stay behind the newest point told

// What was found, without what is to be done with a log where it was: while a machine runs there is none to be cut.
std::string found_in(const NotAdmitted& refusal) {
  const std::string words = refusal.what();
  return words.substr(0, words.find(';'));
}

std::int64_t nanoseconds(double seconds) { return std::llround(seconds * kNanosecondsPerSecond); }

template <class Message>
void forget_before(std::vector<Message>& messages, std::int64_t time) {
  messages.erase(messages.begin(), std::find_if(messages.begin(), messages.end(), [&](const Message& message) { return message.simulated_time >= time; }));
}

}  // namespace

LiveObserver::LiveObserver(const sim::MachineSettings& nominal) : nominal_(nominal) {
  const sim::MachineDescription machine = sim::describe(nominal.crane);
  scales_ = machine.scales;
  thresholds_ = thresholds_of(machine);
  thresholds_.admission.shortest_record = 0.0;  // nothing is fitted here
  if (!nominal_.scales) nominal_.scales = sim::effect_scales(nominal.crane, nominal.drive_protection);
  nominal_.crane.boom.highest_frequency = thresholds_.highest_mode;
  static_cast<void>(follower_of(nominal_, {1e-3}));  // whether there is such a machine
}

template <class Message>
void LiveObserver::keep(msgs::Bytes bytes, std::vector<Message>& into) {
  Message message;
  if (msgs::decode(bytes, message) != msgs::DecodeStatus::ok) return;
  if (has_run_ && message.run_identity != run_.run_identity) return;
  run_.run_identity = message.run_identity;
  has_run_ = true;
  // A repeated or late message is none of a record.
  if (!into.empty() && message.simulated_time <= into.back().simulated_time) return;
  into.push_back(std::move(message));
}

void LiveObserver::take(const std::string& channel, msgs::Bytes bytes) {
  if (channel == msgs::kEncoderChannel) keep(bytes, run_.encoder);
  if (channel == msgs::kTorqueChannel) keep(bytes, run_.torque);
  if (channel == msgs::kSensorsChannel) keep(bytes, run_.sensors);
  if (channel == msgs::kPlantStatusChannel) {
    keep(bytes, run_.plant_status);
    if (!run_.plant_status.empty()) status_ = run_.plant_status.back();
  }
}

void LiveObserver::forget_until(std::int64_t time) {
  forget_before(run_.encoder, time);
  if (run_.encoder.empty()) return;
  const std::int64_t first = run_.encoder.front().simulated_time;
  // A command that came before still holds.
  const auto holds = std::find_if(run_.torque.rbegin(), run_.torque.rend(), [&](const msgs::Torque& message) { return message.simulated_time <= first; });
  if (holds != run_.torque.rend()) run_.torque.erase(run_.torque.begin(), holds.base() - 1);
  forget_before(run_.sensors, first);
  forget_before(run_.plant_status, first);
}

void LiveObserver::begin() {
  // The teeth of a machine that turns, or that play compensation holds, are pressed; one at the beginning of its run is at rest.
  if (run_.encoder.front().sequence > 0) record_.begins_on_flanks = true;
  observer_.emplace(follower_of(nominal_, grid_of(record_)), record_, shadow_gains(scales_, not_faster_than(thresholds_.shadow, record_.encoder_period)));
  drive_.emplace(record_, nominal_.drive_protection);
  began_ = nanoseconds(record_.start_time);
  told_ = began_ - 1;
}

void LiveObserver::advance(std::size_t point, LiveGap& gap) {
  const auto groups = static_cast<std::size_t>(record_.group_count);
  Observer::Measured measured;
  for (std::size_t g = 0; g < groups; ++g) {
    measured.position[g] = record_.shaft_position[g][point];
  }
  if (!record_.acceleration[kTip].empty()) measured.tip_acceleration = &record_.acceleration[kTip][point];
  const Observer::Moment moment = observer_->advance(drive_->next(), measured);
  gap.time.push_back(record_.time(point));
  for (std::size_t g = 0; g < groups; ++g) gap.missing_torque[g].push_back(moment.missing_torque[g]);
  for (std::size_t a = 0; a < kAccelerometerCount; ++a) {
    gap.acceleration_difference[a].push_back(record_.acceleration[a].empty() ? std::numeric_limits<double>::quiet_NaN()
                                                                             : record_.acceleration[a][point] - moment.acceleration[a]);
  }
}

LiveGap LiveObserver::begin_again(std::string why) {
  const std::int64_t newest = run_.encoder.back().simulated_time;
  observer_.reset();
  drive_.reset();
  forget_until(newest);
  forget_before(run_.torque, newest);  // a command from before holds no more
  LiveGap gap;
  gap.begins_again = std::move(why);
  return gap;
}

// One that came and went between two PLANT_STATUS included.
bool LiveObserver::is_tripped() const {
  return status_ && (says_tripped(*status_) || (observer_ && status_->trip_time > began_));
}

std::optional<LiveGap> LiveObserver::wait_behind_trip() {
  const Drive before = drive_does_;
  if (is_tripped()) {
    drive_does_ = Drive::is_tripped;
    LiveGap stopped = begin_again("the drive is tripped, and nothing is compared until it runs again");
    if (before == Drive::is_tripped) return std::nullopt;
    return stopped;
  }
  if (before == Drive::is_tripped) {
    drive_does_ = Drive::presses_teeth;
    next_look_ = run_.encoder.back().simulated_time + nanoseconds(kFirstStretch * thresholds_.time);
    return std::nullopt;
  }
  drive_does_ = Drive::runs;
  return begin_again("the drive runs again");
}

std::optional<LiveGap> LiveObserver::look() {
  if (run_.encoder.empty() || run_.encoder.back().simulated_time < next_look_) return std::nullopt;
  const std::int64_t newest = run_.encoder.back().simulated_time;
  if (is_tripped() || drive_does_ != Drive::runs) return wait_behind_trip();
  if (run_.torque.empty()) return std::nullopt;
  if (!observer_ && newest - run_.encoder.front().simulated_time < nanoseconds(kFirstStretch * thresholds_.time)) return std::nullopt;
  next_look_ = newest + nanoseconds(kBetweenLooks * thresholds_.time);
  LiveGap gap;
  try {
    Record stretch = unchecked_record(run_, "live", thresholds_.admission);
    if (stretch.group_count != nominal_.crane.drive.group_count) throw NotAdmitted("the machine has another number of motor groups than the nominal one");
    if (observer_ && stretch.step != record_.step) throw NotAdmitted("the period of the messages has changed");
    if (drive_) drive_->go_on_in(stretch);
    record_ = std::move(stretch);
    if (drive_) drive_->go_on_in(record_);
  } catch (const NotAdmitted& reason) {
    return begin_again(found_in(reason));
  }
  if (!observer_) begin();
  std::int64_t known = std::min(newest, run_.torque.back().simulated_time);  // sensors and commands come when they come
  if (!run_.sensors.empty()) known = std::min(known, run_.sensors.back().simulated_time);
  // A trip is told with the next PLANT_STATUS, which is not waited for without end.
  const bool is_status_due = status_ && newest - status_->simulated_time < nanoseconds(kLongestWait * thresholds_.time);
  if (is_status_due) known = std::min(known, status_->simulated_time);
  for (std::size_t n = 0; n < record_.size(); ++n) {
    const std::int64_t time = nanoseconds(record_.time(n));
    if (time <= told_) continue;
    if (time > known) break;
    advance(n, gap);
    told_ = time;
  }
  forget_until(told_ - nanoseconds(kMargin * std::max(thresholds_.admission.rate_half_width, 2.0 * record_.encoder_period)));
  if (gap.time.empty()) return std::nullopt;
  return gap;
}

}  // namespace slewlab::diagnosis
