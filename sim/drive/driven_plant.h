#pragma once

// What a loop that drives the plant over the wire needs of it. Messages come with their head (sequence, simulated
// time, configuration) already set; the plant fills the rest. Arrays keep their memory from call to call.

#include "msgs/messages.h"

namespace slewlab::sim {

class DrivenPlant {
 public:
  virtual ~DrivenPlant() = default;

  virtual void read_encoder(msgs::Encoder& message) = 0;
  virtual void command(const msgs::Torque& message) = 0;  // holds until the next command
  virtual void step() = 0;                                // by one plant step
  virtual void read_sensors(msgs::Sensors& message) = 0;
  virtual void read_truth(msgs::Truth& message) = 0;
  virtual void read_status(msgs::PlantStatus& message) = 0;
};

}  // namespace slewlab::sim
