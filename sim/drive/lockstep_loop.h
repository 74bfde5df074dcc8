#pragma once

// The plant's side of the lockstep: ENCODER k goes out, and the plant does not move until the TORQUE that answers
// it is here (with its CONTROLLER_STATE, where TORQUE says that one belongs to it). Simulated time alone rules. The
// wall clock decides only when an unanswered ENCODER is sent again; how often that happened is counted here and
// never reaches a message or the log.
//
// A controller that answers wrongly - bytes that are no TORQUE, another configuration, another sequence number - has
// answered: what came is handed to the drive (drive_protection.h), and simulated time goes on. An answer is wrong, and
// not the late repetition of an older one, if it is more than the answers still outstanding from repeated questions.
// A TORQUE of another run (run_identity) is no answer: it is counted and left alone.
//
// Faults on purpose (fault_injector.h) act on the messages at the loop's edge, keyed by sequence numbers: repeated questions
// change none of their decisions. An ENCODER that is lost on purpose is not sent, and its cycle is one of silence to
// the drive; a TORQUE that is lost on purpose was received and is kept from the drive.
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
#include <string>
#include <vector>

#include "msgs/bus.h"
#include "msgs/log_writer.h"
#include "sim/drive/driven_plant.h"
#include "sim/drive/fault_injector.h"
#include "sim/drive/operator_move.h"
#include "sim/drive/steering.h"

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
  std::int64_t run_identity = 0;
  // By rising time. A move takes effect at the first controller period that begins at its time or later.
  std::vector<OperatorMove> operator_moves;
  std::vector<Fault> faults;

  std::chrono::milliseconds first_resend{20};   // wall clock; doubles with every resend of the same ENCODER
  std::chrono::milliseconds longest_resend{500};
};

struct LockstepCounts {
  std::int64_t cycles = 0;          // controller periods completed
  std::int64_t resends = 0;         // of an ENCODER
  std::int64_t stale_answers = 0;   // TORQUE that repeats an answer already taken
  std::int64_t wrong_answers = 0;   // TORQUE that is no answer to the ENCODER asked, handed to the drive as it is
  std::int64_t foreign_answers = 0; // TORQUE of another run, left alone
  std::int64_t cut_answers = 0;     // on TORQUE, longer than kLargestAnswer: the rest is left out
  std::int64_t simulated_time = 0;  // [ns] reached
  bool ended_by_operator = false;   // of a run that is steered
};

// Where the loop stands, for whoever shows progress or wants it to end.
struct LockstepHooks {
  // Of a run that is steered: asked before every controller period begins, at its simulated time [ns]; may wait.
  std::function<SteeredPeriod(std::int64_t)> steer;
  std::function<bool()> stop;                                // asked in every cycle and every wait
  std::function<void(const LockstepCounts&)> after_cycle;
  std::function<void(const LockstepCounts&)> while_waiting;  // after every resend
  // A fault on purpose kills or starts the controller; it has happened when this returns.
  std::function<void(ControllerAction)> controller_action;
};

// Takes what belongs into the log.
using LogSink = std::function<void(const char* channel, std::int64_t timestamp_us, msgs::Bytes bytes)>;

// Throws std::invalid_argument where periods do not fit each other, PlantDiverged, msgs::LogError, msgs::BusError.
// Returns early, with simulated_time short of the duration, where `stop` said so. Does not finish the log.
LockstepCounts run_lockstep(const LockstepSettings& settings, DrivenPlant& plant, msgs::Bus& bus,
                            const LogSink& log, const LockstepHooks& hooks = {});
LockstepCounts run_lockstep(const LockstepSettings& settings, DrivenPlant& plant, msgs::Bus& bus,
                            msgs::LogWriter& log, const LockstepHooks& hooks = {});

}  // namespace slewlab::sim
