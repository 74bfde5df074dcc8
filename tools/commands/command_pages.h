// Pages about the commands, out of what --help knows: manual pages, and completion for shells.
#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace slewlab::tools {

struct CommandPage {
  std::string name;  // of the file: slewlab-run.1
  std::string text;  // roff
};

// What a command takes whose command line another program reads (tools/python), by the command's name.
struct ForeignOption {
  std::string name;  // "--out", "-h,--help", RUN
  std::string description;
  bool is_positional = false;
  std::vector<std::string> choices = {};  // of its value, where it is one of a few words
};
// What a command takes behind its first word is that of "COMMAND WORD".
using ForeignOptions = std::map<std::string, std::vector<ForeignOption>>;

// As tools/python/describe_commands.py writes them; none where there is no such file, as of a build without Python.
// Throws std::runtime_error where it is none of its.
ForeignOptions read_foreign_options(const std::filesystem::path& file);

// slewlab(1), and one page for every command. `version`: "0.2.0".
std::vector<CommandPage> manual_pages(const CLI::App& app, const std::string& version, const ForeignOptions& foreign = {});

// A page of what `NAME --help` says: its first line the description, the usage, the rest as it stands.
CommandPage page_of_help(const std::string& name, const std::string& help, const std::string& version);

// By an option's name the words that its value may be beside those that it is checked against.
using OptionWords = std::map<std::string, std::vector<std::string>>;

// For bash, and for zsh by bashcompinit: commands, their options, values that are one of a few words, and files.
std::string completion_script(const CLI::App& app, const ForeignOptions& foreign = {}, const OptionWords& words = {});

}  // namespace slewlab::tools
