#include "tools/replay/plant_replay.h"

#include <fmt/format.h>

#include <deque>
#include <map>

#include "msgs/log_writer.h"
#include "sim/drive/crane_plant.h"
#include "sim/drive/lockstep_loop.h"
#include "sim/drive/scenario_run.h"

namespace slewlab::tools {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;

// In the controller's place: answers ENCODER k by the recorded TORQUE for k.
class RecordedController : public msgs::Bus {
 public:
  explicit RecordedController(const msgs::RunLog& record) {
    for (const msgs::Torque& torque : record.torque) answers_.emplace(torque.answered_sequence, &torque);
    if (!record.torque.empty()) {
      held_ = record.torque.front();
      held_.enable = 0;
      held_.brake = 0;
      held_.acknowledge = 0;
      std::fill(held_.motor_torque.begin(), held_.motor_torque.end(), 0.0);
    }
  }

  void publish(const char* channel, msgs::Bytes bytes) override {
    if (channel != std::string_view(msgs::kEncoderChannel)) return;
    msgs::Encoder encoder;
    if (msgs::decode(bytes, encoder) != msgs::DecodeStatus::ok) return;
    const auto answer = answers_.find(encoder.sequence);
    if (answer != answers_.end()) {
      held_ = *answer->second;
    } else {
      ++held_count;
      if (first_held_time < 0) first_held_time = encoder.simulated_time;
      held_.sequence = ++sequence_;
      ++held_.alive_counter;
      held_.simulated_time = encoder.simulated_time;
      held_.answered_sequence = encoder.sequence;
    }
    sequence_ = held_.sequence;
    held_.state_follows = 0;  // the state does nothing to the plant
    waiting_.emplace_back();
    msgs::encode(held_, waiting_.back());
  }
  void subscribe(const char* channel, Handler handler) override {
    if (channel == std::string_view(msgs::kTorqueChannel)) handler_ = std::move(handler);
  }
  bool handle_one(std::chrono::milliseconds) override {
    if (waiting_.empty()) return false;
    const std::vector<std::uint8_t> bytes = std::move(waiting_.front());
    waiting_.pop_front();
    handler_(bytes);
    return true;
  }

  std::int64_t held_count = 0;
  std::int64_t first_held_time = -1;  // [ns]

 private:
  std::map<std::int64_t, const msgs::Torque*> answers_;
  msgs::Torque held_{};
  std::int64_t sequence_ = -1;
  Handler handler_;
  std::deque<std::vector<std::uint8_t>> waiting_;
};

// With the numbering of the record: an OPERATOR message that is missing there is made up from the one before.
std::vector<sim::OperatorMove> recorded_moves(const msgs::RunLog& record, std::vector<std::string>& remarks) {
  std::vector<sim::OperatorMove> moves;
  std::int64_t made_up = 0;
  for (const msgs::Operator& message : record.operator_moves) {
    while (static_cast<std::int64_t>(moves.size()) < message.sequence) {
      sim::OperatorMove missing = moves.empty() ? sim::OperatorMove{} : moves.back();
      if (!moves.empty()) missing.time = message.simulated_time;
      moves.push_back(missing);
      ++made_up;
    }
    moves.push_back({message.simulated_time, message.speed_request, static_cast<bool>(message.emergency_stop),
                     static_cast<bool>(message.acknowledge)});
  }
  if (made_up > 0) remarks.push_back(fmt::format("{} OPERATOR messages are missing in the record", made_up));
  return moves;
}

}  // namespace

PlantReplay replay_plant(const sim::Scenario& scenario, const msgs::RunLog& record,
                         const std::filesystem::path& scratch) {
  PlantReplay result;
  if (record.torque.empty()) {
    result.remarks.push_back("no TORQUE in the record: nothing to feed the plant with");
    return result;
  }
  sim::LockstepSettings settings = sim::lockstep_settings(scenario);
  settings.live_period = scenario.controller_period;  // nobody listens
  // What happened to the messages is in the record already.
  std::erase_if(settings.faults, [](const sim::Fault& fault) { return fault.kind <= sim::FaultKind::message_corrupted; });
  settings.configuration_hash = record.configuration_hash;
  settings.operator_moves = recorded_moves(record, result.remarks);
  settings.duration = (record.torque.back().answered_sequence + 1) * scenario.controller_period;
  const int group_count = scenario.crane.parameters.drive.group_count;
  if (record.torque.back().group_count != group_count) {
    result.remarks.push_back(fmt::format("the record's torques are for {} motor groups, the crane has {}: not replayed",
                                         record.torque.back().group_count, group_count));
    return result;
  }

  sim::DriveRun drive = sim::drive_run(scenario);
  drive.configuration_hash = record.configuration_hash;
  sim::CranePlant plant(sim::machine_settings(scenario), scenario.crane.drive_protection, drive);
  RecordedController controller(record);
  const std::filesystem::path log = scratch / "plant_replay.lcmlog";
  {
    msgs::LogWriter writer(log);
    sim::run_lockstep(settings, plant, controller, writer);
    writer.finish();
  }
  result.run = msgs::read_run_logs(log).runs.at(0);
  std::filesystem::remove(log);
  if (controller.held_count > 0) {
    result.remarks.push_back(fmt::format(
        "{} ENCODER have no TORQUE in the record, the first at {:.3f} s: there the torque before was held",
        controller.held_count, static_cast<double>(controller.first_held_time) / kNanosecondsPerSecond));
  }
  return result;
}

}  // namespace slewlab::tools
