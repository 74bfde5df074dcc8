#pragma once

// A piece of one run of a log: the messages of a stretch of simulated time as they stand in the file, byte by byte and with their time stamps, and what still
// held when it began, the last OPERATOR and PLANT_STATUS before it. What is no message of the run, or repeated, is left behind.

#include <array>
#include <cstdint>
#include <filesystem>

#include "msgs/log_writer.h"
#include "msgs/run_order.h"

namespace slewlab::msgs {

// Channels whose messages hold until the next one: a part of a run takes the last one before it along.
inline constexpr std::array<std::size_t, 2> kHeld{kOperatorIndex, kPlantIndices[3]};

struct LogPiece {
  std::int64_t from = 0, to = 0;  // [ns] of simulated time, both belong to it
};

// From the first to the last message of the run's plant: ENCODER, or where there is none any other.
LogPiece whole_run(const OrderedRun& run);

// Writes a piece of a run that order_runs() found in the file `path` and gives how many messages of each channel it holds. Throws LogError.
std::array<std::int64_t, kChannels> write_piece(const std::filesystem::path& path, const OrderedRun& run, const LogPiece& piece, LogWriter& writer);

}  // namespace slewlab::msgs
