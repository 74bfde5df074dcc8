#pragma once

// What a loop that drives the plant over the wire needs of it. Messages come with their head (sequence, simulated
// time, configuration) already set; the plant fills the rest. Arrays keep their memory from call to call.
//
// A controller period: read_encoder, begin_cycle, receive for whatever comes on TORQUE (nothing is silence), steps.

#include <array>
#include <optional>
#include <stdexcept>

#include "msgs/codec.h"
#include "sim/model/crane_parameters.h"

namespace slewlab::sim {

// What has failed on the crane itself.
struct PlantConditions {
  bool main_power = true;
  std::array<bool, kMaximumGroupCount> group_lost{};
};

// A quantity of the plant that no machine can have.
struct Divergence {
  const char* quantity = "";
  const char* unit = "";
  double value = 0.0;
};

// Ends a run whose plant diverged; says when, what and how far.
class PlantDiverged : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class DrivenPlant {
 public:
  virtual ~DrivenPlant() = default;

  virtual void read_encoder(msgs::Encoder& message) = 0;
  virtual void begin_cycle(std::int64_t encoder_sequence) = 0;
  virtual void receive(msgs::DecodeStatus status, const msgs::Torque& message) = 0;  // read only where ok
  virtual void step(const PlantConditions& conditions) = 0;                          // by one plant step
  virtual void read_sensors(msgs::Sensors& message) = 0;
  virtual void read_truth(msgs::Truth& message) = 0;
  virtual void read_status(msgs::PlantStatus& message) = 0;
  // False where the crane only slews: then no MOTION is sent.
  virtual bool read_motion(msgs::Motion&) { return false; }
  // Nothing while the plant's state is that of a machine. Asked once per controller period; allocates nothing.
  virtual std::optional<Divergence> divergence() const { return std::nullopt; }
};

}  // namespace slewlab::sim
