#pragma once

// A test plan: requirements of a controller, the runs that show whether it meets them, and what was agreed to deviate
// (config/acceptance_plans). docs/accept.md has the form; DNV-ST-0373 (hardware in the loop testing) is its pattern: a plan
// before the test, normal operation and failures, every result traced to what it shows.
//
//   system: slewlab-controller with config/controllers/thesis.yaml
//   limits: ../acceptance/thesis.yaml
//   tests:
//     - name: slew
//       purpose: up to speed and an emergency stop
//       scenario: ../scenarios/thesis_slew.yaml       # one with `faults:` is a failure case, any other normal operation
//   requirements:
//     - name: R1
//       text: The crane turns as the operator asks.
//       source: "thesis 3.5"
//       shown_by: [{test: slew, check: direction}, {test: slew, check: settling}]
//   deviations:
//     - {requirement: R1, text: why it is accepted all the same, agreed_by: who}

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/yaml_reader.h"

namespace slewlab::tools {

struct PlannedTest {
  std::string name;
  std::string purpose;
  std::filesystem::path scenario;
};

struct ShownBy {
  std::string test;
  std::string check;  // of acceptance_check_names()
};

struct Requirement {
  std::string name;
  std::string text;
  std::string source;
  std::vector<ShownBy> shown_by;
};

struct Deviation {
  std::string requirement;
  std::string text;
  std::string agreed_by;
};

struct AcceptancePlan {
  std::string title;
  std::string system;  // what is tested, in words
  std::filesystem::path limits;
  std::vector<PlannedTest> tests;
  std::vector<Requirement> requirements;
  std::vector<Deviation> deviations;
};

// The plan of an opened file, but for finish(). Requirements that nothing shows, tests and checks that there are not, and
// names given twice are problems.
AcceptancePlan read_acceptance_plan(common::YamlReader& reader);

// Adds the problems, those of its limits and scenarios among them.
AcceptancePlan read_acceptance_plan_file(const std::filesystem::path& file, common::InputProblems& problems);

// Throws common::InputError with every problem found.
AcceptancePlan load_acceptance_plan(const std::filesystem::path& file);

}  // namespace slewlab::tools
