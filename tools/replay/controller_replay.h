#pragma once

// The controller's half of a recorded run once more: a controller on a bus - ours in this process, or any process
// over LCM - is asked the recorded ENCODER and OPERATOR messages in lockstep, and its answers are kept. The motion it
// sees is the recorded one, whatever it answers.
//
// Which ENCODER were computed by the recorded controller, its alive counter tells: those that it never answered (too
// slow, or the message was lost on its way) are not asked; those whose TORQUE is merely missing in the record are. An
// ENCODER that is missing in the record although it was answered is put in between its neighbours, on a straight
// line, and its answer is not compared. Where alive counter and sequence number both fall, the controller was
// started anew: each such stretch is a replay of its own, with a fresh controller.

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "msgs/bus.h"
#include "msgs/run_log.h"

namespace slewlab::tools {

// What one start of the recorded controller was asked.
struct Question {
  msgs::Encoder encoder;
  bool made_up = false;  // not in the record
};

struct Questions {
  std::vector<std::vector<Question>> starts;  // one list for every start of the controller
  std::vector<std::string> remarks;
};

Questions recorded_questions(const msgs::RunLog& record);

struct ControllerReplay {
  std::vector<msgs::Torque> torque;
  std::vector<msgs::ControllerState> controller_state;
};

struct AskSettings {
  std::chrono::milliseconds first_resend{20};  // wall clock; doubles up to the longest
  std::chrono::milliseconds longest_resend{500};
  std::function<bool()> stop;                  // asked in every wait; ends the asking early
};

// Asks one list of questions, with the OPERATOR messages of the record, and appends the answers to `replay`. What the
// controller counts (sequence, alive counter) is moved so that the first answer counts as the recorded one did. False
// where `stop` ended it.
bool ask_controller(msgs::Bus& bus, const msgs::RunLog& record, const std::vector<Question>& questions,
                    const AskSettings& settings, ControllerReplay& replay);

}  // namespace slewlab::tools
