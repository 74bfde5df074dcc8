#include "tools/commands/modes_command.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "common/input_error.h"

namespace slewlab::tools {
namespace {

const std::filesystem::path kCranes = std::filesystem::path(SLEWLAB_SOURCE_DIR) / "config" / "cranes";

TEST(ModesCommand, NamesTheModesOfTheThesis) {
  std::ostringstream out;
  EXPECT_EQ(show_modes({.crane = kCranes / "thesis.yaml", .elements = 16}, out), 0);
  const std::string text = out.str();
  // Table 4.1 to two digits, and the meshes of Figure 4.3.
  for (const char* word : {"bending 1", "bending 5", "torsion 1", "drive 1", "load 2", "16 boom element",
                           "Boom clamped at its pivot", "Convergence"}) {
    EXPECT_NE(text.find(word), std::string::npos) << word;
  }
  EXPECT_NE(text.find("1.31"), std::string::npos);
  EXPECT_NE(text.find("10.39"), std::string::npos);
}

TEST(ModesCommand, WritesTheBodePlotWholeWithItsPeakAtTheFirstMode) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "slewlab_bode.csv";
  std::ostringstream out;
  show_modes({.crane = kCranes / "thesis.yaml", .bode = file}, out);
  std::ifstream csv(file);
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line.substr(0, 26), "frequency_Hz,magnitude_dB,");
  double peak = -1e9, at = 0.0;
  int rows = 0;
  while (std::getline(csv, line)) {
    double frequency = 0.0, magnitude = 0.0;
    char comma = 0;
    std::istringstream(line) >> frequency >> comma >> magnitude;
    ++rows;
    if (frequency > 0.5 && magnitude > peak) {
      peak = magnitude;
      at = frequency;
    }
  }
  EXPECT_EQ(rows, 2000);
  EXPECT_NEAR(at, 1.31, 0.02);  // bending 1, Figure 4.2
  std::filesystem::remove(file);
}

// One group has no swing of group against group; a rigid boom leaves one mode, that of the gears.
TEST(ModesCommand, DegenerateMachinesAreShownToo) {
  const auto shown = [](const char* name) {
    std::ostringstream out;
    EXPECT_EQ(show_modes({.crane = kCranes / name, .elements = std::string(name) == "rigid_boom.yaml" ? 0 : 2}, out), 0);
    return out.str();
  };
  EXPECT_EQ(shown("no_load.yaml").find("load 1"), std::string::npos);
  EXPECT_EQ(shown("one_group.yaml").find("drive"), std::string::npos);
  const std::string rigid = shown("rigid_boom.yaml");
  EXPECT_NE(rigid.find("drive 1"), std::string::npos);
  EXPECT_EQ(rigid.find("bending 1"), std::string::npos);
}

// A knuckle lies on a node, so that its boom has two elements or more: the row of one is left out, the finest mesh is there.
TEST(ModesCommand, AMeshThatTheBoomDoesNotAdmitHasNoRow) {
  std::ostringstream out;
  EXPECT_EQ(show_modes({.crane = kCranes / "knuckle.yaml"}, out), 0);
  const std::string rows = out.str().substr(out.str().find("Convergence"));
  EXPECT_EQ(rows.find("\n         1  "), std::string::npos) << rows;
  EXPECT_NE(rows.find("\n         2  "), std::string::npos) << rows;
  EXPECT_NE(rows.find("\n       128  "), std::string::npos) << rows;
  EXPECT_THROW(show_modes({.crane = kCranes / "knuckle.yaml", .elements = 1}, out), common::InputError);
}

TEST(ModesCommand, WhatAnAxisHasNotIsAnInputError) {
  const std::filesystem::path axis = kCranes.parent_path() / "axes" / "example_axis.yaml";
  std::ostringstream out;
  EXPECT_THROW(show_modes({.crane = axis, .elements = 3}, out), common::InputError);
  EXPECT_THROW(show_modes({.crane = axis, .bode = "bode.csv"}, out), common::InputError);
  EXPECT_EQ(out.str(), "");
}

TEST(ModesCommand, ElementsWithoutABoomAreRefused) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "slewlab_no_boom.yaml";
  std::ifstream thesis(kCranes / "thesis.yaml");
  std::ofstream shortened(file);
  bool in_boom = false;
  for (std::string line; std::getline(thesis, line);) {
    if (!line.empty() && line[0] != ' ') in_boom = line == "boom:" || line == "load:";
    if (!in_boom) shortened << line << '\n';
  }
  shortened.close();
  std::ostringstream out;
  EXPECT_EQ(show_modes({.crane = file}, out), 0);
  EXPECT_THROW(show_modes({.crane = file, .elements = 3}, out), std::runtime_error);
  std::filesystem::remove(file);
}

TEST(ModesCommand, AMissingCraneIsAnInputError) {
  std::ostringstream out;
  EXPECT_THROW(show_modes({.crane = "/nowhere.yaml"}, out), common::InputError);
}

}  // namespace
}  // namespace slewlab::tools
