// From records and a nominal crane to ranked causes (docs/diagnosis/method.md).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "controller/controller.h"
#include "diagnosis/controller_fit.h"
#include "diagnosis/controller_replay.h"
#include "diagnosis/evidence.h"
#include "diagnosis/fit.h"
#include "diagnosis/search.h"
#include "diagnosis/shadow.h"

namespace slewlab::diagnosis {

struct DiagnosisSettings {
  WhiteningSettings whitening;
  FitSettings fit;
  EvidenceSettings evidence;
  std::vector<std::string> without;  // effects that are left out of the catalogue
  SearchSettings search;
  bool hold_out = false;             // fit the answer's sizes once more, without the last record
  int threads = 1;
};

struct Size {
  std::string parameter;
  std::string unit;
  double value = 0.0;
  double deviation = 0.0;  // one standard deviation
  double low = 0.0, high = 0.0;  // 90 % interval
};

// Another cause that the records cannot tell from one.
struct Alike {
  std::string name;
  double apart = 0.0;  // share of the one's signature by which this one's differs
};

struct Cause {
  std::vector<std::string> effects;   // one or two; none: only parameters are off
  double probability = 0.0;
  double explained = 0.0;             // share of the gap, down to what the best of all fits leaves
  double mean_square = 0.0;
  double excess = 0.0, prior = 0.0;    // as in evidence.h
  Eigen::VectorXd information;         // as in evidence.h
  std::vector<Size> sizes;            // of all effects' parameters
  Point point;                                              // the machine's part
  std::vector<common::EffectInstance> controller_effects;  // the controller's part
  std::vector<Alike> group;
};

// "a", "a with b" or "only parameters are off".
std::string name_of(const Cause& cause);

// Where the gap lies before any effect is added, as shares that sum to 1.
struct BandShare {
  std::string channel;
  double from = 0.0, to = 0.0;  // [Hz]
  double share = 0.0;           // of what the most probable cause takes away, or of what stands above the noise
  double mean_square = 0.0;     // of what parameters alone leave; 1 is the noise's
};
struct Moment {
  std::string record;
  double time = 0.0;            // [s] middle of the second
  std::string phase;            // accelerating, braking, constant speed, standing
  double missing_torque = 0.0;  // [Nm per motor] RMS in that second
};

// The first cause with sizes and parameters fitted again without some of what was measured, so that there is something to predict.
struct HeldOut {
  Point point;
  std::string record;      // that it did not see: the last one, or of a single one the second half
  double from_time = 0.0;  // [s] from which it did not
  bool is_half = false;
};

// The last record that was judged, as the nominal machine follows it and as that of the first cause does, less what comes by chance.
struct Followed {
  std::string record;
  Shadow nominal, explained;
};

struct Diagnosis {
  bool gap = false;                     // is there more than parameters and a good model's misses
  bool controller_differs = false;
  double counts = 0.0;                  // [rad] step of the encoders' positions where it is coarse, else 0
  std::vector<ControllerReplay> controller_replay;
  std::vector<ControllerCause> controller_causes;
  double mean_square_nominal = 0.0;     // with nothing fitted
  double mean_square_parameters = 0.0;  // with parameters alone fitted
  std::vector<Cause> causes;            // falling probability; the one without effects is among them
  double probability_nothing = 0.0;
  double probability_unknown = 0.0;
  bool is_unknown = false;              // nothing else is as probable: the answer is "not in the catalogue"
  std::string verdict;                  // one line
  std::vector<std::pair<std::string, double>> subsystems;  // probability by subsystem, falling
  std::vector<std::pair<std::string, double>> effects;     // probability that each acts, alone or beside another, falling
  std::vector<BandShare> bands;
  std::vector<Moment> moments;
  std::vector<std::string> remarks;
  std::vector<std::string> not_excited;  // effects of which no size that was tried, a typical one among them, changes these records enough to be named
  Followed followed;
  std::optional<HeldOut> held_out;       // nothing where it was not asked for, or the cause has no fit of the machine
  std::int64_t simulations = 0;
  double simulation_seconds = 0.0;  // in them, summed over the threads
  double total_seconds = 0.0;
};

// `progress` is told from any thread, one at a time; `is_stopped` is asked before every simulation, from any thread, and ends it all
// with Interrupted. Throws NotAdmitted, std::invalid_argument, Interrupted.
Diagnosis diagnose(const sim::MachineSettings& nominal, const std::optional<controller::ControllerSettings>& controller,
                   std::vector<Record> records, const DiagnosisSettings& settings, const Progress& progress = {},
                   const std::function<bool()>& is_stopped = {});

}  // namespace slewlab::diagnosis
