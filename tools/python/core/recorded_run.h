// A scenario run in this process with its wire, as `slewlab run` runs it in two: the same messages, to the byte, kept as rows
// of a table per channel and, where asked for, as the log.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "controller/process/answer_loop.h"
#include "diagnosis/loop/wire_loop.h"
#include "msgs/row_layout.h"
#include "sim/drive/lockstep_loop.h"
#include "sim/drive/scenario_file.h"

namespace slewlab::tools {

// The messages of one channel; the layout is that of its first message. One of another shape (a controller's own, with
// another number of groups) is counted and left out.
struct RecordedChannel {
  msgs::RowLayout layout;
  msgs::ArrayCounts counts{};
  std::vector<std::uint8_t> rows;
  std::int64_t row_count = 0;
  std::int64_t left_out = 0;
};

struct RecordedRun {
  std::array<RecordedChannel, msgs::kChannels> channels;  // as wire_messages() has them
  sim::LockstepCounts counts;
  bool controller_is_dead = false;  // it stopped answering, and the run ended there
};

struct RecordedRunOptions {
  std::array<bool, msgs::kChannels> keep{};  // channels whose rows are wanted
  std::filesystem::path log;                 // to be written, NAME.partial where the run ends early; empty: none
  std::function<bool()> stop;                // asked once a controller period; may be empty
};

// The scenario's own controller. Throws common::InputError where its file is wrong or made for another number of groups.
controller::Compute scenario_controller(const sim::Scenario& scenario);

// `controller` makes one anew at every start: a fault that kills the controller takes its state.
RecordedRun record_run(const sim::Scenario& scenario, const diagnosis::NewController& controller, const RecordedRunOptions& options);

}  // namespace slewlab::tools
