#include "sim/drive/plant_output.h"

#include <cstdio>

namespace slewlab::sim {

void PlantOutput::send_operator_moves(std::int64_t simulated_time) {
  const std::vector<OperatorMove>& moves = settings_.operator_moves;
  while (next_move_ < moves.size() && moves[next_move_].time <= simulated_time) send_operator(moves[next_move_++], simulated_time);
  if (operator_sequence_ < 0) send_operator(OperatorMove{}, simulated_time);
}

void PlantOutput::send_operator(const OperatorMove& move, std::int64_t simulated_time) {
  set_head(operator_, ++operator_sequence_, simulated_time);
  operator_.speed_request = move.speed_request;
  operator_.emergency_stop = move.emergency_stop;
  operator_.acknowledge = move.acknowledge;
  msgs::encode(operator_, operator_bytes_);
  log(msgs::kOperatorChannel, simulated_time, operator_bytes_);
  repeat_operator();
}

void PlantOutput::send_series(std::int64_t simulated_time, const std::function<void(msgs::PlantStatus&)>& complete) {
  if (simulated_time % settings_.sensors_period == 0) {
    set_head(sensors_, sensors_sequence_++, simulated_time);
    plant_.read_sensors(sensors_);
    send(msgs::kSensorsChannel, simulated_time, sensors_);
  }
  if (simulated_time % settings_.truth_period == 0) {
    set_head(truth_, truth_sequence_++, simulated_time);
    plant_.read_truth(truth_);
    send(msgs::kTruthChannel, simulated_time, truth_);
    if (plant_.read_motion(motion_)) {
      set_head(motion_, motion_sequence_++, simulated_time);
      send(msgs::kMotionChannel, simulated_time, motion_);
    }
  }
  if (simulated_time % settings_.status_period == 0) {
    set_head(status_, status_sequence_++, simulated_time);
    plant_.read_status(status_);
    if (complete) complete(status_);
    send(msgs::kPlantStatusChannel, simulated_time, status_);
  }
}

void PlantOutput::check_plant(std::int64_t simulated_time) const {
  const std::optional<Divergence> found = plant_.divergence();
  if (!found) return;
  char text[256];
  std::snprintf(text, sizeof text,
                "the simulation left what a machine can do by %.3f s of simulated time: %s is %.3g %s; a value of the crane "
                "does not fit the others or the plant step (slewlab check names what it can)",
                static_cast<double>(simulated_time) * 1e-9, found->quantity, found->value, found->unit);
  throw PlantDiverged(text);
}

template <class Message>
void PlantOutput::send(const char* channel, std::int64_t simulated_time, const Message& message) {
  msgs::encode(message, bytes_);
  log(channel, simulated_time, bytes_);
  if (simulated_time % settings_.live_period == 0) bus_.publish(channel, bytes_);
}

void take(const SteeredPeriod& period, std::int64_t simulated_time, PlantOutput& output, FaultInjector& faults) {
  for (const FaultSwitch& change : period.faults) {
    if (change.begins) {
      faults.add(*change.begins);
    } else {
      faults.end(change.ends, simulated_time);
    }
  }
  if (period.move) output.send_operator(*period.move, simulated_time);
}

}  // namespace slewlab::sim
