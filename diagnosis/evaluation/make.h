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
// difference in the manoeuvres a and b over the signal's noise floor, of the signals and the time that are recorded; of a case, without all its effects; of each of two,
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

// What the record has beside motor encoders and torques: accelerometers at house, pivot, middle and tip and an encoder on
// the slew ring; the tip's accelerometer alone; nothing. What is not there is NaN in SENSORS, as `slewlab import` writes it.
enum class Sensors { kAll, kTip, kNone };
const char* name_of(Sensors sensors);
Sensors sensors_named(const std::string& name);  // throws std::invalid_argument

// Of what the machines are made: laws that the diagnosis does not have, or its own (known_laws.h), for what can be reached at best.
enum class Laws { kWithheld, kKnown };
const char* name_of(Laws laws);
Laws laws_named(const std::string& name);  // throws std::invalid_argument

struct MakeSettings {
  int cases = 0;
  std::uint64_t seed = 0;
  Purpose purpose = Purpose::kTune;
  std::filesystem::path directory;
  std::filesystem::path crane, controller;  // nominal, YAML
  double controller_period = 1e-3;          // [s]
  double record_period = 1e-3;              // [s] of SENSORS; ENCODER and TORQUE come with the controller
  Sensors sensors = Sensors::kAll;
  Begin begin = Begin::kAtRest;
  Laws laws = Laws::kWithheld;
  int threads = 2;
};

struct Visibility {
  double largest = 0.0;  // [-] noise floors
  std::string signal;
};
// `from` [s]: when the recorder is switched on.
Visibility visibility(const TruthRun& with, const TruthRun& without, const TruthMachine& machine, Sensors sensors = Sensors::kAll, double from = 0.0);

// The log as a run's: messages in the order of the wire, from `from` [s] on, as a recorder writes it that is switched on
// then: it begins with the operator's request of that moment; times and numbers are those of the run.
struct LogSettings {
  std::int64_t configuration_hash = 0;
  std::int64_t sensor_steps = 1;  // base steps from SENSORS to SENSORS
  Sensors sensors = Sensors::kAll;
  double from = 0.0;              // [s]
};
void write_log(const TruthRun& run, const LogSettings& settings, const std::filesystem::path& file);

std::string case_name(int number);  // case_0001

// Called from any thread, one at a time: cases done, of all, and a line about the last.
using MakeProgress = std::function<void(int done, int all, const std::string& line)>;

// Skips cases that are complete. False where `is_stopped` said so first: call again to go on. Throws
// std::invalid_argument where the seed does not serve the purpose, a period is no whole number of base steps or DIR holds
// another set, std::runtime_error,
// common::InputError.
bool make_cases(const MakeSettings& settings, const MakeProgress& progress = {},
                const std::function<bool()>& is_stopped = {});

// The same in parts, by any number of processes: the set's begin once, its cases from 1 on in any order (one that is complete stays),
// the seal when all are there. Throw as make_cases().
void begin_set(const MakeSettings& settings);
void make_one(const MakeSettings& settings, int number);
void seal_set(const MakeSettings& settings);

// The set's settings, and its crane and controller, as its about.json has them. Throws std::runtime_error, nlohmann's exceptions.
MakeSettings settings_of(const std::filesystem::path& directory);

// A case's machine drives one more manoeuvre, its times in the controller's ramps, and is recorded from rest as its other logs are, with noise of its own
// for each `purpose`. Throws as make_cases().
void measure_again(const MakeSettings& settings, int number, const Manoeuvre& in_ramps, const std::string& purpose, const std::filesystem::path& log);

}  // namespace slewlab::diagnosis::withheld
