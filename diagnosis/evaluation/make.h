// Writes a set of withheld cases:
//
//   DIR/about.json              seed, purpose, number of cases, controller period; crane.yaml, controller.yaml beside
//   DIR/case_0001/a.lcmlog      to diagnose; ENCODER, TORQUE, OPERATOR, SENSORS only
//   DIR/case_0001/b.lcmlog      to diagnose
//   DIR/case_0001/unseen.lcmlog for the score alone
//   DIR/case_0001/given.json    effects that the diagnosis must not know (--without)
//   DIR/sealed/answers.json     what the machines were; never given to the diagnosis
//   DIR/digest.txt              SHA-256 of answers.json
//
// Visibility of an effect: the same machine with the same noise runs without it; the largest of all signals' RMS
// difference in the manoeuvres a and b over the signal's noise floor; of a case, without all its effects; of each of two,
// without that one. Two seconds from every meeting or parting of
// teeth in either run are left out: an impact a little earlier or later is a large difference that means little. Floors: accelerometers their noise; encoder
// speeds what counting does to them (counting_noise()); torques that times the proportional gain.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "diagnosis/evaluation/draw.h"

namespace slewlab::diagnosis::withheld {

struct MakeSettings {
  int cases = 0;
  std::uint64_t seed = 0;
  Purpose purpose = Purpose::kTune;
  std::filesystem::path directory;
  std::filesystem::path crane, controller;  // nominal, YAML
  double controller_period = 1e-3;          // [s]
  int threads = 2;
};

struct Visibility {
  double largest = 0.0;  // [-] noise floors
  std::string signal;
};
Visibility visibility(const TruthRun& with, const TruthRun& without, const TruthMachine& machine);

// The log as a run's: messages in the order of the wire.
void write_log(const TruthRun& run, std::int64_t configuration_hash, const std::filesystem::path& file);

std::string case_name(int number);  // case_0001

// Called from any thread, one at a time: cases done, of all, and a line about the last.
using MakeProgress = std::function<void(int done, int all, const std::string& line)>;

// Skips cases that are complete. False where `is_stopped` said so first: call again to go on. Throws
// std::invalid_argument where the seed does not serve the purpose or DIR holds another set, std::runtime_error,
// common::InputError.
bool make_cases(const MakeSettings& settings, const MakeProgress& progress = {},
                const std::function<bool()>& is_stopped = {});

}  // namespace slewlab::diagnosis::withheld
