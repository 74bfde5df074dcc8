#include "tools/acceptance/run_summary.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/input_error.h"

namespace slewlab::tools {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kShown = 40;         // [bytes] of a value that is told
constexpr std::size_t kDigestDigits = 16;  // of 64 bits

// A value as the file has it, without what a terminal would obey: dump() writes such characters as \uNNNN.
std::string shown(const Json& value) {
  const std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  return text.size() <= kShown ? text : text.substr(0, kShown) + "...";
}

bool is_digest(const Json& value) {
  if (!value.is_string()) return false;
  const auto& text = value.get_ref<const std::string&>();
  return text.size() == kDigestDigits && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

}  // namespace

RunSummary read_run_summary(const std::filesystem::path& folder) {
  RunSummary result;
  const std::filesystem::path path = folder / "summary.json";
  std::error_code error;
  result.is_there = std::filesystem::symlink_status(path, error).type() != std::filesystem::file_type::not_found;
  if (!result.is_there) return result;
  const auto wrong = [&](const std::string& key, const std::string& found, const std::string& expected) {
    result.problem = common::to_text({{path.string(), 0, 0}, key, found, expected}) + ", as slewlab run writes it";
    return result;
  };
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) return wrong("", "a file that cannot be read, or an empty one", "a JSON object with outcome and run");
  const Json summary = Json::parse(text.str(), nullptr, false);
  if (summary.is_discarded()) return wrong("", "text that is no JSON, or a part of it", "a JSON object with outcome and run");
  if (!summary.is_object()) return wrong("", shown(summary), "a JSON object with outcome and run");
  if (!summary.contains("outcome")) return wrong("outcome", "nothing", "\"complete\", or in a word how the run ended");
  const Json& outcome = summary["outcome"];
  if (!outcome.is_string() || outcome.get_ref<const std::string&>().empty()) return wrong("outcome", shown(outcome), "\"complete\", or in a word how the run ended");
  if (outcome != "complete") {
    const Json reason = summary.value("reason", Json());
    result.why_incomplete = reason.is_string() && !reason.get_ref<const std::string&>().empty() ? reason.get<std::string>() : outcome.get<std::string>();
    return result;
  }
  if (!summary.contains("run") || !summary["run"].is_object()) return wrong("run", summary.contains("run") ? shown(summary["run"]) : "nothing", "an object with log_digest");
  const Json& run = summary["run"];
  for (const auto& [key, value] : {std::pair{"log_digest", &result.log_digest}, std::pair{"configuration_hash", &result.configuration_hash}}) {
    if (!run.contains(key)) return wrong(std::string("run.") + key, "nothing", "16 hexadecimal digits");
    if (!is_digest(run[key])) return wrong(std::string("run.") + key, shown(run[key]), "16 hexadecimal digits");
    *value = run[key].get<std::string>();
  }
  return result;
}

}  // namespace slewlab::tools
