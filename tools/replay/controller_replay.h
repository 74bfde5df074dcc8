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
#include "msgs/run_stream.h"

namespace slewlab::tools {

struct Question {
  msgs::Encoder encoder;
  bool made_up = false;    // not in the record
  bool is_first = false;   // of a start of the controller
};

// What the recorded controller was asked, question by question, sequence numbers rising.
struct Questions {
  using Next = std::function<const Question*()>;  // nullptr behind the last; valid until the next call
  std::function<Next()> open;                     // from the beginning
  std::int64_t starts = 0;                        // of the controller
  std::vector<std::string> remarks;
};

Questions recorded_questions(const msgs::RunStream& record);

struct AskSettings {
  std::chrono::milliseconds first_resend{20};  // wall clock; doubles up to the longest
  std::chrono::milliseconds longest_resend{500};
  std::function<bool()> stop;                  // asked in every wait; ends the asking early
};

// Takes the answers, message by message.
struct ControllerListener {
  std::function<void(const msgs::Torque&)> torque;
  std::function<void(const msgs::ControllerState&)> controller_state;
};

// Asks the questions of one start of the controller, `question` being the first of them and the next one's first or nullptr in
// the end, with the OPERATOR messages of the record. What the controller counts (sequence, alive counter) is moved so that the
// first answer counts as the recorded one did. False where `stop` ended it.
bool ask_controller(msgs::Bus& bus, const msgs::RunStream& record, const Question*& question, const Questions::Next& next,
                    const AskSettings& settings, const ControllerListener& listener);

}  // namespace slewlab::tools
