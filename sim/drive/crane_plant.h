#pragma once

// The crane behind the wire: the fixed-step plant of sim/integrate as a DrivenPlant. Torque is taken over only while
// the command enables the drives and every torque is a finite number; otherwise the drives deliver none. The torque
// holds over a controller period.
//
// Assumption: the disk brakes (thesis 2.5) have no torque here; a controller that asks for them gets drives without
// torque.

#include "sim/drive/driven_plant.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

class CranePlant : public DrivenPlant {
 public:
  // `step` in [s]. Throws std::invalid_argument where the crane cannot be built.
  CranePlant(const CraneParameters& crane, double step);

  void read_encoder(msgs::Encoder& message) override;
  void command(const msgs::Torque& message) override;
  void step() override;
  void read_sensors(msgs::Sensors& message) override;
  void read_truth(msgs::Truth& message) override;
  void read_status(msgs::PlantStatus& message) override;

  const PlantState& state() const { return state_; }

 private:
  PlantModel model_;
  PlantWorkspace workspace_;
  PlantState state_;
  PlantInput input_;
  bool enabled_ = false;
};

}  // namespace slewlab::sim
