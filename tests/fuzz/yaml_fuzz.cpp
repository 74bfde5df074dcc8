// Any text as YAML, its first line as a `--set`: a tree, or problems that say where. A tree written as YAML reads back
// as the same tree.

#include <cstring>

#include "common/yaml_file.h"
#include "common/yaml_text.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slewlab;
  using namespace slewlab::common;
  const std::string_view all(reinterpret_cast<const char*>(data), size);
  const std::size_t line_end = std::min(all.find('\n'), all.size());
  const std::string_view text = all.substr(std::min(line_end + 1, all.size()));
  std::vector<Override> overrides;
  try {
    overrides.push_back(parse_override(all.substr(0, line_end)));
  } catch (const InputError&) {
  }
  static const TemporaryFolder folder;
  static const std::filesystem::path path = folder.path() / "fuzz.yaml";
  fuzz::write_file(path, text.data(), text.size());

  InputProblems problems;
  const YamlNode tree = load_yaml_file(path, overrides, problems);
  for (const InputProblem& problem : problems) {
    fuzz::require(!to_text(problem).empty() && !problem.expected.empty(), "a problem says what would be right");
  }
  if (!problems.empty()) return 0;

  const std::string written = yaml_text(tree);
  const YamlNode again = parse_yaml_text(written, "written", problems);
  if (!problems.empty()) std::fprintf(stderr, "%s\n%s\n", written.c_str(), to_text(problems.front()).c_str());
  fuzz::require(problems.empty(), "a tree written as YAML is YAML");
  if (canonical_text(tree) != canonical_text(again)) {
    std::fprintf(stderr, "%s\nbecame\n%s\nby\n%s\n", canonical_text(tree).c_str(), canonical_text(again).c_str(),
                 written.c_str());
  }
  fuzz::require(canonical_text(tree) == canonical_text(again), "a tree written as YAML reads back as the same");
  return 0;
}
