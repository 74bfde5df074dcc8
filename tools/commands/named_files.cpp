#include "tools/commands/named_files.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <sstream>
#include <string_view>

#include "diagnosis/evaluation/seal.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

struct Word {
  std::string text;
  bool begins_command = false;
};

constexpr std::string_view kBlank = " \t\n";
constexpr std::string_view kSeparators = ";&|()<>\n";

// As a shell splits, but for what it would substitute.
std::vector<Word> words_of(const std::string& command) {
  std::vector<Word> words;
  bool in_word = false;
  bool begins = true;
  char quote = 0;
  for (std::size_t i = 0; i < command.size(); ++i) {
    const char c = command[i];
    const bool ends = quote == 0 && (kBlank.find(c) != std::string_view::npos || kSeparators.find(c) != std::string_view::npos);
    if (ends) {
      in_word = false;
      if (kSeparators.find(c) != std::string_view::npos) begins = c != '<' && c != '>';
      continue;
    }
    if (!in_word) words.push_back({"", begins});
    in_word = true;
    begins = false;
    if (quote != 0 ? c == quote : c == '\'' || c == '"') {
      quote = quote == 0 ? c : 0;
    } else if (c == '\\' && quote != '\'' && i + 1 < command.size()) {
      words.back().text += command[++i];
    } else {
      words.back().text += c;
    }
  }
  return words;
}

bool is_file(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored);
}

fs::path found_in_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path file = fs::path(folder.empty() ? "." : folder) / program;
    if (is_file(file) && ::access(file.c_str(), X_OK) == 0) return file;
  }
  return {};
}

// NAME=value before a program.
bool is_assignment(const std::string& word) {
  const std::size_t equal = word.find('=');
  return equal != std::string::npos && equal > 0 &&
         word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") == equal;
}

// Words behind which another program stands.
bool starts_another(const std::string& word) {
  constexpr std::array kStarters{"exec", "env", "command", "nice", "nohup", "time"};
  return std::find(kStarters.begin(), kStarters.end(), word) != kStarters.end();
}

}  // namespace

std::vector<fs::path> files_named_by(const std::string& command) {
  std::vector<fs::path> files;
  const auto add = [&](const fs::path& file) {
    const fs::path whole = fs::absolute(file).lexically_normal();
    if (std::find(files.begin(), files.end(), whole) == files.end()) files.push_back(whole);
  };
  bool expects_program = false;
  for (const Word& word : words_of(command)) {
    const bool is_program = word.begins_command || expects_program;
    expects_program = is_program && (is_assignment(word.text) || starts_another(word.text));
    if (is_program && is_assignment(word.text)) continue;
    const std::size_t equal = word.text.find('=');
    if (is_program && word.text.find('/') == std::string::npos) {
      if (const fs::path program = found_in_path(word.text); !program.empty()) add(program);
    } else if (is_file(word.text)) {
      add(word.text);
    } else if (equal != std::string::npos && is_file(word.text.substr(equal + 1))) {  // --config=FILE
      add(word.text.substr(equal + 1));
    } else if (word.text.find_first_of(kBlank) != std::string::npos) {  // sh -c '...'
      for (const fs::path& file : files_named_by(word.text)) add(file);
    }
  }
  return files;
}

std::string sha256_of_file(const fs::path& file) { return diagnosis::withheld::sha256(diagnosis::withheld::read_whole(file)); }

}  // namespace slewlab::tools
