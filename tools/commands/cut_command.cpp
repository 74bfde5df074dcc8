#include "tools/commands/cut_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <ostream>
#include <string>
#include <system_error>

#include "common/input_error.h"
#include "msgs/log_piece.h"
#include "tools/commands/log_path.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

constexpr double kNanosecond = 1e-9;  // [s]

common::InputError refused(const std::string& option, const std::string& found, const std::string& expected) {
  return common::InputError({{{option, 0, 0}, "", found, expected}});
}

msgs::RunOrder runs_of(const fs::path& log) {
  try {
    return msgs::order_runs(log);
  } catch (const msgs::LogError& error) {
    throw no_log(log, error);
  }
}

double seconds(std::int64_t time) { return kNanosecond * static_cast<double>(time); }

std::string stretch_text(const msgs::LogPiece& piece) {
  return fmt::format("{:.3f} s to {:.3f} s", seconds(piece.from), seconds(piece.to));
}

const msgs::OrderedRun& chosen_run(const msgs::RunOrder& order, int run, const fs::path& log) {
  const auto count = static_cast<int>(order.runs.size());
  if (run == 0 && count == 1) return order.runs.front();
  if (run >= 1 && run <= count) return order.runs[static_cast<std::size_t>(run - 1)];
  std::string runs;
  for (int n = 0; n < count; ++n) runs += fmt::format("{}{} ({})", n == 0 ? "" : ", ", n + 1, stretch_text(msgs::whole_run(order.runs[static_cast<std::size_t>(n)])));
  throw refused("--run", run == 0 ? "none, and " + log.string() + " holds several runs" : std::to_string(run), "one of the runs " + runs);
}

// What is left out of the two times holds all that there is, also behind the last ENCODER.
msgs::LogPiece piece_of(const CutOptions& options, const msgs::LogPiece& whole) {
  const std::string within = "a time [s] within the run, which goes from " + stretch_text(whole);
  if (options.from && !(*options.from < seconds(whole.to))) throw refused("--from", fmt::format("{:.6g}", *options.from), within);
  if (options.until && !(*options.until > seconds(whole.from))) throw refused("--until", fmt::format("{:.6g}", *options.until), within);
  if (options.from && options.until && !(*options.from < *options.until)) {
    throw refused("--from", fmt::format("{:.6g}, not before --until {:.6g}", *options.from, *options.until), within);
  }
  msgs::LogPiece piece{std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()};
  if (options.from && *options.from > seconds(whole.from)) piece.from = std::llround(*options.from / kNanosecond);
  if (options.until && *options.until < seconds(whole.to)) piece.to = std::llround(*options.until / kNanosecond);
  return piece;
}

}  // namespace

int cut(const CutOptions& options, std::ostream& out) {
  if (fs::is_directory(options.out)) throw refused("--out", "'" + options.out.string() + "', which is a folder", "the name of a file");
  const fs::path log = log_in(options.log);
  std::error_code none;
  if (fs::equivalent(log, options.out, none)) throw refused("--out", "'" + options.out.string() + "', which is the log itself", "another file");
  const msgs::RunOrder order = runs_of(log);
  for (const std::string& remark : order.remarks) out << log.string() << ": " << remark << '\n';
  const msgs::OrderedRun& run = chosen_run(order, options.run, log);
  const msgs::LogPiece whole = msgs::whole_run(run), piece = piece_of(options, whole);

  msgs::LogWriter writer(options.out);
  const std::array<std::int64_t, msgs::kChannels> counts = msgs::write_piece(log, run, piece, writer);
  writer.finish();
  std::string held;
  for (std::size_t channel = 0; channel < msgs::kChannels; ++channel) {
    if (counts[channel] > 0) held += fmt::format("{}{} {}", held.empty() ? "" : ", ", counts[channel], msgs::wire_messages()[channel].channel);
  }
  out << fmt::format("{}: {} of {}: {}\n", options.out.string(), stretch_text({std::max(piece.from, whole.from), std::min(piece.to, whole.to)}), log.string(), held);
  return 0;
}

}  // namespace slewlab::tools
