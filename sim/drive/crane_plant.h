#pragma once

// The crane behind the wire: the machine of sim/integrate/machine.h under the protection of its drive. Torque holds from answer
// to answer.

#include <array>

#include "sim/drive/drive_protection.h"
#include "sim/drive/driven_plant.h"
#include "sim/integrate/machine.h"

namespace slewlab::sim {

class CranePlant : public DrivenPlant {
 public:
  // Throws std::invalid_argument where the machine cannot be built.
  CranePlant(const MachineSettings& machine, const DriveRun& run);
  // A machine that exists, from the state it is in.
  CranePlant(Machine machine, const DriveProtectionSettings& protection, const DriveRun& run);

  void read_encoder(msgs::Encoder& message) override;
  void begin_cycle(std::int64_t encoder_sequence) override;
  void receive(msgs::DecodeStatus status, const msgs::Torque& message) override;
  void step(const PlantConditions& conditions) override;
  void read_sensors(msgs::Sensors& message) override;
  void read_truth(msgs::Truth& message) override;
  void read_status(msgs::PlantStatus& message) override;
  bool read_motion(msgs::Motion& message) override;
  std::optional<Divergence> divergence() const override;

  // Where the controller's period is not known before it begins: from the next answer on.
  void set_controller_period(std::int64_t period) { run_.controller_period = period; }  // [ns]

  const Machine& machine() const { return machine_; }
  bool switch_effect(std::string_view name, bool on) { return sim::switch_effect(machine_, name, on); }
  const DriveProtectionState& drive() const { return drive_; }

 private:
  static constexpr std::size_t kSensorCount = msgs::kSensorFields<PlantReadings>.size();

  DriveMoment moment() const;

  DriveProtectionSettings protection_;
  DriveRun run_;
  std::int64_t step_;  // [ns]
  Machine machine_;
  std::array<bool, kSensorCount> is_fitted_{};  // of SENSORS; what the machine has not is not a number
  DriveProtectionState drive_;
  PlantConditions conditions_;
};

}  // namespace slewlab::sim
