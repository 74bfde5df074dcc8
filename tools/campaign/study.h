#pragma once

// What a campaign runs (config/campaigns): scenarios, which of their values vary and how, and the limits that every run is
// judged by. Values are drawn and runs made by the package slewlab (tools/python/package/slewlab/campaign.py).
//
//   scenarios: [{file: ../scenarios/thesis_slew.yaml}]
//   limits: ../acceptance/thesis.yaml                      # absent: no run is judged
//   draw: {value: latin_hypercube, source: "..."}          # grid, random or latin_hypercube
//   runs: {value: 64, unit: "-", source: "..."}            # of each scenario; a grid has as many as it has
//   seed: {value: 1, unit: "-", source: "..."}             # of the draw
//   vary:                                                  # keys as of `slewlab run --set`, `seed` of a scenario among them
//     - key: crane.load.mass
//       range: {value: [10, 40], unit: t, source: "..."}   # or values, log_range, normal: [mean, standard deviation]
//     - key: seed
//       range: {value: [1, 1000], unit: "-", source: "..."}
//       whole: {value: true, source: "..."}                # rounded to whole numbers
//
// A key that a scenario, its machine or its controller does not have is a problem at its line here.
//
// In place of scenarios, limits, draw and vary: `runs` tasks of a soak (docs/soak.md), numbered from 0 on, or `runs` withheld
// cases (docs/withheld.md), numbered from 1 on, drawn from `seed`:
//
//   soak: {settings: ../soak/thesis.yaml, crane: ../cranes/thesis.yaml, controller: ../controllers/thesis.yaml,
//          faults: {value: true, source: "..."}}
//   withheld: {crane: ../cranes/thesis.yaml, controller: ../controllers/thesis.yaml, rate: {value: 100, unit: Hz, source: "..."},
//              sensors: {value: none, source: "..."}, begin: {value: any, source: "..."}}      # of these three each may be absent

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/yaml_file.h"
#include "common/yaml_reader.h"

namespace slewlab::tools {

enum class Draw { grid, random, latin_hypercube };
enum class Spread { values, range, log_range, normal };

std::string_view name_of(Draw draw);
std::string_view name_of(Spread spread);

struct VariedKey {
  std::string key;
  Spread spread = Spread::values;
  std::vector<std::string> values;  // as written: the choices; lowest and highest; mean and standard deviation
  std::string unit = "-";           // of all of them, as written
  bool whole = false;
};

struct SoakOfStudy {
  std::filesystem::path settings, crane, controller;
  bool faults = false;
};

struct WithheldOfStudy {
  std::filesystem::path crane, controller;
  double rate = 1000.0;       // [Hz] of the record
  std::string sensors = "all";  // all, tip or none
  std::string begin = "rest";   // rest, on, motion or any
};

struct Study {
  std::vector<std::filesystem::path> scenarios;
  std::filesystem::path limits;  // empty: none
  Draw draw = Draw::grid;
  int runs = 0;  // of each scenario; 0 of a grid
  int seed = 0;
  std::vector<VariedKey> vary;
  std::optional<SoakOfStudy> soak;
  std::optional<WithheldOfStudy> withheld;
};

// A value as `--set` takes it: "30 t".
std::string value_text(const VariedKey& varied, const std::string& value);

// The study of an opened file, but for finish().
void read_study(common::YamlReader& reader, Study& study);

// For a check: adds the problems, those of the files that it names and of every value among them, and answers with what could be read.
Study read_study_file(const std::filesystem::path& file, const std::vector<common::Override>& overrides,
                      common::InputProblems& problems);

// For a campaign, of which a run with values that make no machine is a row: of the values the first of each key is tried. Throws
// common::InputError with every problem found.
Study load_study_file(const std::filesystem::path& file, const std::vector<common::Override>& overrides = {});

}  // namespace slewlab::tools
