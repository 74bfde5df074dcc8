#include "tools/replay/plant_replay.h"

#include <fmt/format.h>

#include <algorithm>

#include "diagnosis/loop/loop_log.h"
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

bool gapless(const std::vector<msgs::Encoder>& encoders) {
  return !encoders.empty() &&
         encoders.back().sequence - encoders.front().sequence + 1 == static_cast<std::int64_t>(encoders.size());
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

// The OPERATOR message that belonged before each ENCODER.
std::int64_t operator_sequence(const msgs::RunLog& record, std::int64_t time) {
  std::int64_t newest = 0;
  for (const msgs::Operator& move : record.operator_moves) {
    if (move.simulated_time <= time) newest = std::max(newest, move.sequence);
  }
  return newest;
}

// The crane of the record: under what failed on it, its ENCODER as the scenario's faults alter it and with the OPERATOR
// message that the record has before it.
class RecordedPlant : public sim::DrivenPlant {
 public:
  RecordedPlant(const sim::Scenario& scenario, const msgs::RunLog& record, const sim::DriveRun& drive)
      : plant_(sim::machine_settings(scenario), drive),
        faults_(scenario.faults, scenario.controller_period),
        step_(scenario.plant_step),
        record_(record) {}

  void read_encoder(msgs::Encoder& message) override {
    message.operator_sequence = operator_sequence(record_, time_);
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
  const msgs::RunLog& record_;
};

msgs::RunLog replayed(const sim::Scenario& scenario, const msgs::RunLog& record, const Arrivals& arrivals,
                      const sim::DriveRun& drive, std::int64_t cycles) {
  diagnosis::LoopCourse course;
  course.plant_step = static_cast<double>(scenario.plant_step) / kNanosecondsPerSecond;
  course.steps_per_period = scenario.controller_period / scenario.plant_step;
  course.steps = cycles * course.steps_per_period;
  course.configuration_hash = record.configuration_hash;
  course.run_identity = record.run_identity;
  RecordedPlant plant(scenario, record, drive);
  const diagnosis::Answer answer = [&, torque = msgs::Torque{}](const msgs::Encoder& encoder, const msgs::Operator&,
                                                                sim::DrivenPlant& driven) mutable {
    const auto arrived = arrivals.messages.find(encoder.sequence);
    if (arrived == arrivals.messages.end()) return;
    for (const auto& bytes : arrived->second) {
      const msgs::DecodeStatus status = msgs::decode(bytes, torque);
      driven.receive(status, torque);
    }
  };
  diagnosis::LoopLog log(course, plant, {scenario.sensors_period, scenario.truth_period, scenario.status_period});
  diagnosis::run_loop(course, plant, answer, log.hooks());
  log.log.operator_moves.clear();  // the record's, not this run's
  return std::move(log.log);
}

}  // namespace

Arrivals arrivals_by_answer(const msgs::RunLog& record) {
  Arrivals arrivals;
  std::int64_t made_up = 0;
  std::int64_t first_made_up = -1;
  const auto most = static_cast<std::int64_t>(10 * record.torque.size() + 1000);  // chosen: a record of this much hearsay is none
  const msgs::Torque* before = nullptr;
  for (const msgs::Torque& torque : record.torque) {
    if (before != nullptr && torque.motor_torque.size() == before->motor_torque.size()) {
      const std::int64_t gap = torque.answered_sequence - before->answered_sequence;
      std::int64_t sent = gap < 1 ? 0 : std::clamp<std::int64_t>(static_cast<std::int64_t>(static_cast<std::uint64_t>(torque.alive_counter) - static_cast<std::uint64_t>(before->alive_counter)), 1, gap) - 1;
      if (sent > most - made_up) {
        arrivals.remarks.push_back(fmt::format("{} TORQUE seem to be missing behind that for ENCODER {}: too many to be put in", sent,
                                               before->answered_sequence));
        sent = 0;
      }
      for (std::int64_t k = 1; k <= sent; ++k) {
        if (made_up++ == 0) first_made_up = before->answered_sequence + k;
        msgs::encode(on_line(*before, torque, k, gap), arrivals.messages[before->answered_sequence + k].emplace_back());
      }
    }
    msgs::encode(torque, arrivals.messages[torque.answered_sequence].emplace_back());
    before = &torque;
  }
  if (made_up > 0) {
    arrivals.remarks.push_back(fmt::format(
        "{} TORQUE that were sent are missing in the record, the first answers ENCODER {}: put on a line between their "
        "neighbours", made_up, first_made_up));
  }
  return arrivals;
}

Arrivals recorded_arrivals(const std::filesystem::path& log, const msgs::RunLog& record) {
  if (!gapless(record.encoder)) return arrivals_by_answer(record);
  Arrivals arrivals;
  msgs::LogReader reader(log);
  msgs::LogEvent event;
  msgs::Encoder encoder;
  auto expected = record.encoder.begin();
  std::int64_t current = -1;  // the ENCODER behind which the file stands, -1: one of another run
  while (reader.next(event)) {
    if (event.channel == msgs::kEncoderChannel) {
      current = -1;
      if (msgs::decode(event.data, encoder) != msgs::DecodeStatus::ok ||
          encoder.configuration_hash != record.configuration_hash || encoder.run_identity != record.run_identity || expected == record.encoder.end() ||
          encoder.sequence != expected->sequence || encoder.shaft_position != expected->shaft_position) {
        continue;
      }
      if (event.timestamp_us != encoder.simulated_time / 1000) return arrivals_by_answer(record);  // no lockstep log
      current = encoder.sequence;
      ++expected;
    } else if (event.channel == msgs::kTorqueChannel && current >= 0) {
      arrivals.messages[current].emplace_back(event.data.begin(), event.data.end());
    }
  }
  return expected == record.encoder.end() ? arrivals : arrivals_by_answer(record);
}

PlantReplay replay_plant(const sim::Scenario& scenario, const msgs::RunLog& record, const Arrivals& arrivals) {
  PlantReplay result;
  result.remarks = arrivals.remarks;
  if (arrivals.messages.empty()) {
    result.remarks.push_back("no TORQUE in the record: nothing to feed the plant with");
    return result;
  }
  sim::DriveRun drive = sim::drive_run(scenario);
  drive.configuration_hash = record.configuration_hash;
  drive.run_identity = record.run_identity;
  const int recorded_groups = record.encoder.empty() ? drive.group_count : record.encoder.front().group_count;
  if (recorded_groups != drive.group_count) {
    result.remarks.push_back(fmt::format("the record is of {} motor groups, the crane has {}: not replayed",
                                         recorded_groups, drive.group_count));
    return result;
  }
  const std::int64_t first = record.encoder.empty() ? 0 : record.encoder.front().sequence;
  if (first > 0) {
    result.remarks.push_back(
        fmt::format("the record begins at ENCODER {} ({:.3f} s): how the crane stood then is not known, it starts at rest "
                    "at 0 s and hears nothing until there",
                    first, static_cast<double>(record.encoder.front().simulated_time) / kNanosecondsPerSecond));
  }
  // A log that was cut off behind an ENCODER does not tell what arrived then; silence that was part of the run does.
  std::int64_t last = arrivals.messages.rbegin()->first;
  if (!record.encoder.empty() && (last > record.encoder.back().sequence ||
                                  (!record.sensors.empty() && record.sensors.back().simulated_time >
                                                                  record.encoder.back().simulated_time))) {
    last = record.encoder.back().sequence;
  }
  const double steps = (static_cast<double>(last) + 1.0) * static_cast<double>(scenario.controller_period / scenario.plant_step);
  const double messages = static_cast<double>(record.encoder.size() + record.torque.size());
  if (first < 0 || steps > kStepsPerMessage * messages + kStepsAtLeast) {
    result.remarks.push_back(
        fmt::format("the record's {} ENCODER and {} TORQUE speak of ENCODER {} to {}, {:.3g} plant steps: too far for a record of that "
                    "size, a number in it must be damaged; not replayed",
                    record.encoder.size(), record.torque.size(), first, last, steps));
    return result;
  }
  std::int64_t silent = 0;
  std::int64_t first_silent = -1;
  for (std::int64_t cycle = first; cycle <= last; ++cycle) {
    if (arrivals.messages.contains(cycle)) continue;
    ++silent;
    if (first_silent < 0) first_silent = cycle;
  }
  if (silent > 0) {
    result.remarks.push_back(fmt::format(
        "{} ENCODER have no TORQUE in the record, the first at {:.3f} s: there the drive hears nothing", silent,
        static_cast<double>(first_silent * scenario.controller_period) / kNanosecondsPerSecond));
  }
  result.run = replayed(scenario, record, arrivals, drive, last + 1);
  return result;
}

}  // namespace slewlab::tools
