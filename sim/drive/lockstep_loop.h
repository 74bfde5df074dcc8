#pragma once

// The plant's side of the lockstep: ENCODER k goes out, and the plant does not move until the TORQUE that answers
// it is here (with its CONTROLLER_STATE, where TORQUE says that one belongs to it). Simulated time alone rules. The
// wall clock decides only when an unanswered ENCODER is sent again; how often that happened is counted here and
// never reaches a message or the log.
//
// The log, in this order, whatever the order of arrival:
//   at the start             SENSORS, TRUTH, PLANT_STATUS
//   every controller period  OPERATOR (where it changes), ENCODER, CONTROLLER_STATE (where there is one), TORQUE,
//   every step behind it     SENSORS, TRUTH and PLANT_STATUS where due.
// Events are stamped with the simulated time [us], so two runs give the same bytes. The message's own bytes are
// logged as they were received.
//
// On the bus SENSORS, TRUTH and PLANT_STATUS are thinned out to `live_period`: whoever needs all of them reads the
// log.

#include <chrono>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "msgs/bus.h"
#include "msgs/log_writer.h"
#include "sim/drive/driven_plant.h"
#include "sim/operator_move.h"

namespace slewlab::sim {

struct LockstepSettings {
  std::int64_t plant_step = 1'000'000;          // [ns]
  std::int64_t controller_period = 10'000'000;  // [ns] a multiple of the plant step
  std::int64_t duration = 0;                    // [ns] rounded up to whole controller periods
  std::int64_t sensors_period = 1'000'000;      // [ns] these three: multiples of the plant step
  std::int64_t truth_period = 10'000'000;       // [ns]
  std::int64_t status_period = 100'000'000;     // [ns]
  std::int64_t live_period = 100'000'000;       // [ns] of the three on the bus
  std::int64_t configuration_hash = 0;
  int group_count = 0;
  // By rising time. A move takes effect at the first controller period that begins at its time or later.
  std::vector<OperatorMove> operator_moves;

  std::chrono::milliseconds first_resend{20};   // wall clock; doubles with every resend of the same ENCODER
  std::chrono::milliseconds longest_resend{500};
};

struct LockstepCounts {
  std::int64_t cycles = 0;          // controller periods completed
  std::int64_t resends = 0;         // of an ENCODER
  std::int64_t stale_answers = 0;   // TORQUE that answers another ENCODER than the one asked (repeated answers)
  std::int64_t foreign_answers = 0; // TORQUE of another configuration
  std::int64_t undecodable = 0;     // TORQUE or CONTROLLER_STATE that was truncated, of another version or garbage
  std::int64_t simulated_time = 0;  // [ns] reached
};

// Where the loop stands, for whoever shows progress or wants it to end.
struct LockstepHooks {
  std::function<bool()> stop;                                // asked in every cycle and every wait
  std::function<void(const LockstepCounts&)> after_cycle;
  std::function<void(const LockstepCounts&)> while_waiting;  // after every resend
};

// The controller answers in a way that no lockstep can go on with.
class LockstepError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Throws std::invalid_argument where periods do not fit each other, LockstepError, msgs::LogError, msgs::BusError.
// Returns early, with simulated_time short of the duration, where `stop` said so. Does not finish the log. The bus
// must not be handled any more after it.
LockstepCounts run_lockstep(const LockstepSettings& settings, DrivenPlant& plant, msgs::Bus& bus,
                            msgs::LogWriter& log, const LockstepHooks& hooks = {});

}  // namespace slewlab::sim
