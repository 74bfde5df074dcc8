// Loads a YAML file into a tree: `include:` files laid underneath, `--set` values laid on top.
//
//   include: base.yaml          # or a list; later files lie over earlier ones, this file over all
//   load: null                  # takes away what the base has
//
// A map is merged key by key, a value with unit and source and a list are replaced whole. Paths are
// relative to the file that names them. Duplicate keys, include cycles (with their chain), anchors, aliases, a second
// document and more than 32 MB or 1000 files with all includes are problems. Takes time in proportion to the text.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/input_error.h"
#include "common/yaml_node.h"

namespace slewlab::common {

// One `--set key.path=value`. The value is YAML. For a value with a unit it is a number with its unit (60 t) or
// {value: 60, unit: t}; a bare number only where the file's unit is the SI unit (s, m, -), which messages speak: 60000 for
// a load given in tonnes is a problem. The source becomes "command line". A list's entries count from 0: moves.0.time=5.
struct Override {
  std::string key;
  std::string value;
  std::string way = {};  // what stood before the key where the option was given: "crane." of a crane's key in a scenario's options
};

// Splits "key.path=value". Throws InputError where there is no '=' or no key.
Override parse_override(std::string_view option);

// Takes those whose keys begin with `way` out of `overrides`; it moves from their key to their `way`.
std::vector<Override> take_overrides(std::string_view way, std::vector<Override>& overrides);

// Problems of a file under these overrides, each with the key as the user knows it: that of an override with its way before it.
// Keys that have it already stay as they are.
InputProblems as_given(InputProblems problems, const std::vector<Override>& overrides);

// Loads the file. Problems are added to `problems`; the tree holds what could be read.
YamlNode load_yaml_file(const std::filesystem::path& file, const std::vector<Override>& overrides,
                        InputProblems& problems);

// Parses a text as if it stood in a file of that name; no includes.
YamlNode parse_yaml_text(std::string_view text, const std::string& file_name, InputProblems& problems);

}  // namespace slewlab::common
