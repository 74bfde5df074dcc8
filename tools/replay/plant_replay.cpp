#include "tools/replay/plant_replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "diagnosis/loop/loop.h"
#include "msgs/codec.h"
#include "msgs/log_reader.h"
#include "sim/drive/crane_plant.h"
#include "sim/drive/fault_injector.h"
#include "sim/drive/scenario_run.h"

namespace slewlab::tools {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;

// Plant steps that a record may ask for: so many for each of its messages, and some to begin with. A damaged number that
// speaks of a far future must not be simulated.
constexpr double kStepsPerMessage = 2000.0;  // chosen: ten times a period of 20 ms over steps of 0.1 ms
constexpr double kStepsAtLeast = 1e6;        // chosen: a thousand seconds of 1 ms

bool gapless(const msgs::ChannelExtent& encoders) {
  return encoders.messages > 0 && encoders.last_key - encoders.first_key + 1 == encoders.messages;
}

// The k-th of `gap` steps from one TORQUE to another.
msgs::Torque on_line(const msgs::Torque& before, const msgs::Torque& after, std::int64_t k, std::int64_t gap) {
  const double share = static_cast<double>(k) / static_cast<double>(gap);
  msgs::Torque torque = before;
  torque.sequence += k;
  torque.alive_counter += k;
  torque.answered_sequence += k;
  torque.simulated_time += k * ((after.simulated_time - before.simulated_time) / gap);
  for (std::size_t i = 0; i < torque.motor_torque.size(); ++i) {
    torque.motor_torque[i] += share * (after.motor_torque[i] - before.motor_torque[i]);
  }
  return torque;
}

// TORQUE by the ENCODER that each answers, those that were sent and are not in the record on a line between their neighbours.
class ArrivalsByAnswer {
 public:
  explicit ArrivalsByAnswer(const msgs::RunStream& record)
      : torque_(record), most_(10 * msgs::extent_of<msgs::Torque>(record).messages + 1000) {}  // chosen: a record of this much hearsay is none

  bool next(Arrival& arrival) {
    arrival.messages.clear();
    const msgs::Torque* torque = torque_.current();
    if (torque == nullptr) return false;
    if (made_up_ < 0) {
      missing_ = before_ ? missing_before(*torque) : 0;
      made_up_ = 0;
    }
    if (made_up_ < missing_) {
      arrival.encoder = before_->answered_sequence + ++made_up_;
      if (made_up_in_all_++ == 0) first_made_up_ = arrival.encoder;
      msgs::encode(on_line(*before_, *torque, made_up_, torque->answered_sequence - before_->answered_sequence), arrival.messages.emplace_back());
      return true;
    }
    arrival.encoder = torque->answered_sequence;
    msgs::encode(*torque, arrival.messages.emplace_back());
    before_ = *torque;
    made_up_ = -1;
    torque_.advance();
    return true;
  }

  // Of what was given so far.
  std::vector<std::string> remarks() const {
    std::vector<std::string> remarks = too_many_;
    if (made_up_in_all_ > 0) {
      remarks.push_back(fmt::format(
          "{} TORQUE that were sent are missing in the record, the first answers ENCODER {}: put on a line between their "
          "neighbours", made_up_in_all_, first_made_up_));
    }
    return remarks;
  }

 private:
  // By the alive counter.
  std::int64_t missing_before(const msgs::Torque& torque) {
    if (torque.motor_torque.size() != before_->motor_torque.size()) return 0;
    const std::int64_t gap = torque.answered_sequence - before_->answered_sequence;
    if (gap < 1) return 0;
    const auto computed = static_cast<std::int64_t>(static_cast<std::uint64_t>(torque.alive_counter) - static_cast<std::uint64_t>(before_->alive_counter));
    const std::int64_t missing = std::clamp<std::int64_t>(computed, 1, gap) - 1;
    if (missing <= most_ - made_up_in_all_) return missing;
    too_many_.push_back(fmt::format("{} TORQUE seem to be missing behind that for ENCODER {}: too many to be put in", missing,
                                    before_->answered_sequence));
    return 0;
  }

  msgs::MessageReader<msgs::Torque> torque_;
  std::int64_t most_;
  std::optional<msgs::Torque> before_;
  std::int64_t missing_ = 0, made_up_ = -1;  // between the two; -1: not yet known
  std::int64_t made_up_in_all_ = 0, first_made_up_ = -1;
  std::vector<std::string> too_many_;
};

// TORQUE as they stand behind each ENCODER of the record in a lockstep log.
class ArrivalsInFile {
 public:
  ArrivalsInFile(const std::filesystem::path& log, const msgs::RunStream& record)
      : configuration_hash_(record.configuration_hash), run_identity_(record.run_identity), reader_(log), expected_(record) {}

  bool next(Arrival& arrival) {
    arrival.messages.clear();
    msgs::LogEvent event;
    while (is_lockstep_ && reader_.next(event)) {
      if (event.channel == msgs::kEncoderChannel) {
        const bool is_complete = !arrived_.messages.empty();
        if (is_complete) std::swap(arrival, arrived_);
        begin_cycle(event);
        if (is_complete) return true;
      } else if (event.channel == msgs::kTorqueChannel && is_of_record_) {
        arrived_.messages.emplace_back(event.data.begin(), event.data.end());
      }
    }
    std::swap(arrival, arrived_);
    arrived_.messages.clear();
    return !arrival.messages.empty();
  }

  // Behind the last: whether this is how the log is to be read.
  bool is_lockstep_of_record() const { return is_lockstep_ && expected_.current() == nullptr; }

 private:
  void begin_cycle(const msgs::LogEvent& event) {
    const msgs::Encoder* expected = expected_.current();
    is_of_record_ = msgs::decode(event.data, encoder_) == msgs::DecodeStatus::ok && encoder_.configuration_hash == configuration_hash_ &&
                    encoder_.run_identity == run_identity_ && expected != nullptr && encoder_.sequence == expected->sequence &&
                    encoder_.shaft_position == expected->shaft_position;
    if (!is_of_record_) return;
    is_lockstep_ = event.timestamp_us == encoder_.simulated_time / 1000;
    arrived_.encoder = encoder_.sequence;
    expected_.advance();
  }

  std::int64_t configuration_hash_, run_identity_;  // of the record
  msgs::LogReader reader_;
  msgs::MessageReader<msgs::Encoder> expected_;
  msgs::Encoder encoder_{};
  Arrival arrived_;           // behind the ENCODER at which the file stands
  bool is_of_record_ = false;  // that one
  bool is_lockstep_ = true;
};

// The crane of the record: under what failed on it, its ENCODER as the scenario's faults alter it and with the OPERATOR
// message that the record has before it.
class RecordedPlant : public sim::DrivenPlant {
 public:
  RecordedPlant(const sim::Scenario& scenario, const msgs::RunStream& record, const sim::DriveRun& drive)
      : plant_(sim::machine_settings(scenario), drive),
        faults_(scenario.faults, scenario.controller_period),
        step_(scenario.plant_step),
        moves_(record) {}

  void read_encoder(msgs::Encoder& message) override {
    for (; moves_.current() != nullptr && moves_.current()->simulated_time <= time_; moves_.advance()) {
      newest_move_ = std::max(newest_move_, moves_.current()->sequence);
    }
    message.operator_sequence = newest_move_;
    plant_.read_encoder(message);
    faults_.alter(time_, message);
  }
  void begin_cycle(std::int64_t encoder_sequence) override { plant_.begin_cycle(encoder_sequence); }
  void receive(msgs::DecodeStatus status, const msgs::Torque& message) override { plant_.receive(status, message); }
  void step(const sim::PlantConditions&) override {
    plant_.step(faults_.conditions(time_));
    time_ += step_;
  }
  void read_sensors(msgs::Sensors& message) override { plant_.read_sensors(message); }
  void read_truth(msgs::Truth& message) override { plant_.read_truth(message); }
  void read_status(msgs::PlantStatus& message) override { plant_.read_status(message); }

 private:
  sim::CranePlant plant_;
  sim::FaultInjector faults_;
  std::int64_t step_;      // [ns]
  std::int64_t time_ = 0;  // [ns]
  msgs::MessageReader<msgs::Operator> moves_;
  std::int64_t newest_move_ = 0;  // sequence number
};

// A channel that speaks every `period` [ns].
template <class Message>
class Series {
 public:
  Series(std::int64_t period, const std::function<void(const Message&)>& listener, void (sim::DrivenPlant::*read)(Message&))
      : period_(period), listener_(listener), read_(read) {}

  void say(std::int64_t time, const diagnosis::LoopCourse& course, sim::DrivenPlant& plant) {
    if (time % period_ != 0) return;
    Message message{};
    message.sequence = count_++;
    message.simulated_time = time;
    message.configuration_hash = course.configuration_hash;
    message.run_identity = course.run_identity;
    (plant.*read_)(message);
    listener_(message);
  }

 private:
  std::int64_t period_;
  const std::function<void(const Message&)>& listener_;
  void (sim::DrivenPlant::*read_)(Message&);
  std::int64_t count_ = 0;
};

void run_plant(const sim::Scenario& scenario, const msgs::RunStream& record, const Arrivals& arrivals, const sim::DriveRun& drive,
               std::int64_t cycles, const PlantListener& listener) {
  diagnosis::LoopCourse course;
  course.plant_step = static_cast<double>(scenario.plant_step) / kNanosecondsPerSecond;
  course.steps_per_period = scenario.controller_period / scenario.plant_step;
  course.steps = cycles * course.steps_per_period;
  course.configuration_hash = record.configuration_hash;
  course.run_identity = record.run_identity;
  RecordedPlant plant(scenario, record, drive);
  const Arrivals::Next next_arrival = arrivals.open();
  Arrival arrival;
  bool more = next_arrival(arrival);
  const diagnosis::Answer answer = [&, torque = msgs::Torque{}](const msgs::Encoder& encoder, const msgs::Operator&,
                                                                sim::DrivenPlant& driven) mutable {
    while (more && arrival.encoder < encoder.sequence) more = next_arrival(arrival);
    if (!more || arrival.encoder != encoder.sequence) return;
    for (const auto& bytes : arrival.messages) {
      const msgs::DecodeStatus status = msgs::decode(bytes, torque);
      driven.receive(status, torque);
    }
  };
  Series<msgs::Sensors> sensors(scenario.sensors_period, listener.sensors, &sim::DrivenPlant::read_sensors);
  Series<msgs::Truth> truth(scenario.truth_period, listener.truth, &sim::DrivenPlant::read_truth);
  Series<msgs::PlantStatus> status(scenario.status_period, listener.plant_status, &sim::DrivenPlant::read_status);
  const auto say_series = [&](std::int64_t time) {
    sensors.say(time, course, plant);
    truth.say(time, course, plant);
    status.say(time, course, plant);
  };
  say_series(0);
  diagnosis::LoopHooks hooks;
  hooks.answered = [&](const diagnosis::LoopMoment& moment) { listener.encoder(moment.encoder); };
  hooks.stepped = [&](const diagnosis::LoopMoment& moment) { say_series(moment.time); };
  diagnosis::run_loop(course, plant, answer, hooks);
}

// Which of a record's cycles have an arrival.
struct Heard {
  bool any = false;
  std::int64_t last = 0;          // ENCODER with an arrival
  std::int64_t count = 0;         // of those from the record's first ENCODER on
  std::int64_t count_to_end = 0;  // of those, up to its last
  std::int64_t first_silent = 0;  // ENCODER from the record's first on without one
};

Heard heard_in(const Arrivals& arrivals, std::int64_t from, std::int64_t to) {
  Heard heard;
  heard.first_silent = from;
  const Arrivals::Next next = arrivals.open();
  for (Arrival arrival; next(arrival);) {
    heard.any = true;
    heard.last = arrival.encoder;
    if (arrival.encoder < from) continue;
    ++heard.count;
    if (arrival.encoder <= to) ++heard.count_to_end;
    if (arrival.encoder == heard.first_silent) ++heard.first_silent;
  }
  return heard;
}

}  // namespace

Arrivals arrivals_by_answer(const msgs::RunStream& record) {
  Arrivals arrivals;
  ArrivalsByAnswer all(record);
  for (Arrival arrival; all.next(arrival);) {
  }
  arrivals.remarks = all.remarks();
  arrivals.open = [record]() -> Arrivals::Next {
    return [each = std::make_shared<ArrivalsByAnswer>(record)](Arrival& arrival) { return each->next(arrival); };
  };
  return arrivals;
}

Arrivals recorded_arrivals(const std::filesystem::path& log, const msgs::RunStream& record) {
  if (!gapless(msgs::extent_of<msgs::Encoder>(record))) return arrivals_by_answer(record);
  ArrivalsInFile all(log, record);
  for (Arrival arrival; all.next(arrival);) {
  }
  if (!all.is_lockstep_of_record()) return arrivals_by_answer(record);
  Arrivals arrivals;
  arrivals.open = [log, record]() -> Arrivals::Next {
    return [each = std::make_shared<ArrivalsInFile>(log, record)](Arrival& arrival) { return each->next(arrival); };
  };
  return arrivals;
}

std::vector<std::string> replay_plant(const sim::Scenario& scenario, const msgs::RunStream& record, const Arrivals& arrivals,
                                      const PlantListener& listener) {
  std::vector<std::string> remarks = arrivals.remarks;
  const msgs::ChannelExtent& encoders = msgs::extent_of<msgs::Encoder>(record);
  const msgs::ChannelExtent& sensors = msgs::extent_of<msgs::Sensors>(record);
  const std::int64_t first = encoders.messages == 0 ? 0 : encoders.first_key;
  const Heard heard = heard_in(arrivals, first, encoders.last_key);
  if (!heard.any) {
    remarks.push_back("no TORQUE in the record: nothing to feed the plant with");
    return remarks;
  }
  sim::DriveRun drive = sim::drive_run(scenario);
  drive.configuration_hash = record.configuration_hash;
  drive.run_identity = record.run_identity;
  const int recorded_groups =
      encoders.messages == 0 ? drive.group_count : msgs::MessageReader<msgs::Encoder>(record).current()->group_count;
  if (recorded_groups != drive.group_count) {
    remarks.push_back(fmt::format("the record is of {} motor groups, the crane has {}: not replayed", recorded_groups, drive.group_count));
    return remarks;
  }
  if (first > 0) {
    remarks.push_back(
        fmt::format("the record begins at ENCODER {} ({:.3f} s): how the crane stood then is not known, it starts at rest "
                    "at 0 s and hears nothing until there",
                    first, static_cast<double>(encoders.first_time) / kNanosecondsPerSecond));
  }
  // A log that was cut off behind an ENCODER does not tell what arrived then; silence that was part of the run does.
  const bool ends_with_record = encoders.messages > 0 && (heard.last > encoders.last_key || (sensors.messages > 0 && sensors.last_time > encoders.last_time));
  const std::int64_t last = ends_with_record ? encoders.last_key : heard.last;
  const std::int64_t steps_per_message = scenario.controller_period / scenario.plant_step;
  const double steps = (static_cast<double>(last) + 1.0) * static_cast<double>(steps_per_message);
  const std::int64_t torques = msgs::extent_of<msgs::Torque>(record).messages;
  if (first < 0 || steps > kStepsPerMessage * static_cast<double>(encoders.messages + torques) + kStepsAtLeast) {
    remarks.push_back(
        fmt::format("the record's {} ENCODER and {} TORQUE speak of ENCODER {} to {}, {:.3g} plant steps: too far for a record of that "
                    "size, a number in it must be damaged; not replayed",
                    encoders.messages, torques, first, last, steps));
    return remarks;
  }
  const std::int64_t silent = last - first + 1 - (ends_with_record ? heard.count_to_end : heard.count);
  if (silent > 0) {
    remarks.push_back(fmt::format(
        "{} ENCODER have no TORQUE in the record, the first at {:.3f} s: there the drive hears nothing", silent,
        static_cast<double>(heard.first_silent * scenario.controller_period) / kNanosecondsPerSecond));
  }
  run_plant(scenario, record, arrivals, drive, last + 1, listener);
  return remarks;
}

}  // namespace slewlab::tools
