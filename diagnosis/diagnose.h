// From records and a nominal machine to ranked causes (docs/diagnosis/method.md), along the way the data takes: admit, where the gap lies,
// fit, weigh, name, validate.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "controller/controller.h"
#include "diagnosis/accelerometer_gains.h"
#include "diagnosis/cause.h"
#include "diagnosis/controller_fit.h"
#include "diagnosis/controller_replay.h"
#include "diagnosis/discrepancy.h"
#include "diagnosis/evidence.h"
#include "diagnosis/fit.h"
#include "diagnosis/search.h"
#include "diagnosis/unseen_record.h"
#include "diagnosis/validate.h"
#include "diagnosis/where.h"

namespace slewlab::diagnosis {

struct DiagnosisSettings {
  FitSettings fit;
  EvidenceSettings evidence;
  std::vector<std::string> without;  // effects that are left out of the catalogue
  SearchSettings search;
  std::optional<double> noise_corner;  // [Hz] of the accelerometers, where their data sheet names another than the description's
  bool hold_out = true;              // a cause leads only if it predicts the last record, fitted without it
  int threads = 1;
};

struct Diagnosis {
  bool gap = false;                     // is there more than parameters and a good model's misses
  bool has_controller = false;          // some record tells what the controller knew, so that its answers were compared
  bool controller_differs = false;
  double counts = 0.0;                  // [rad] step of the encoders' positions where it is coarse, else 0
  std::vector<ControllerReplay> controller_replay;
  std::vector<ControllerCause> controller_causes;
  double mean_square_nominal = 0.0;     // with nothing fitted but how a record begins on a machine that has moved before
  double mean_square_parameters = 0.0;  // with parameters alone fitted
  double least_mean_square = 0.0;       // that a motion of the catalogue comes to, or a law that is in none
  double difference_count = 0.0, log_stretch = 0.0;  // of the whitened differences (whitening.h)
  std::vector<Cause> causes;            // falling probability; the one without effects is among them
  double probability_nothing = 0.0;
  double probability_hidden = 0.0;      // that an effect acts which is too small for these records (hidden_effects.h); where nothing missing leads
  std::vector<std::string> hidden;      // effects of which these records would hide more than a half of the sizes, most first; the same
  double probability_unknown = 0.0;
  bool is_unknown = false;              // nothing else is as probable: the answer is "outside the catalogue"
  std::string verdict;                  // one line
  std::vector<std::pair<std::string, double>> subsystems;  // probability by subsystem, falling
  std::vector<std::pair<std::string, double>> effects;     // probability that each acts, alone or beside another, falling
  double lead_acts = 0.0;               // that the effects of the first cause act, alone or beside another; of one without effects its own
  int boom_elements = 0;                 // into which the boom was cut
  int commands_per_row = 1;              // that the records are taken to have (hidden_commands.h)
  std::vector<common::EffectInstance> of_every_machine;  // what every machine does, where the fits have it
  std::vector<AccelerometerGain> gains;                  // of accelerometers that read otherwise than the machine's file has it, times what that has: the answer is of a machine with these
  std::vector<BandShare> bands;
  std::vector<Moment> moments;
  std::vector<Discrepancy> discrepancies;  // in the residual of the answer, or of parameters alone where it is unknown; empty: no more than noise
  std::vector<std::string> remarks;
  Nuisances nuisances;                   // that the points of the causes are told in
  std::vector<FarParameter> far_parameters;  // with nothing missing, where that leaves no more than noise and yet is no machine of that make
  std::vector<std::string> not_excited;  // effects of which no size that was tried, a typical one among them, changes these records enough to be named
  Followed followed;
  std::vector<UnseenRecord> unseen;      // of the records that were given to be predicted alone
  std::optional<double> refuted;         // the probability that the first cause had, which does not predict one of these, and which "unknown" has now
  std::optional<HeldOut> held_out;       // nothing where it was not asked for, or the cause has no fit of the machine
  std::int64_t simulations = 0;
  double simulation_seconds = 0.0;  // in them, summed over the threads
  double total_seconds = 0.0;
};

// The nominal machine as the fits have it: its boom cut, its accelerometers with the gains that they were taken to have, and with what every machine does.
sim::MachineSettings as_fitted(sim::MachineSettings nominal, const Diagnosis& diagnosis);

// `progress` is told from any thread, one at a time; `is_stopped` is asked before every simulation, from any thread, and ends it all
// with Interrupted. Where the records' commands leave no answer, and others may have come between their rows, the records are diagnosed once more with such. `unseen` are records that the answer is tried on and that have no part in it.
// Throws NotAdmitted, std::invalid_argument, Interrupted.
Diagnosis diagnose(const sim::MachineSettings& nominal, const std::optional<controller::ControllerSettings>& controller,
                   std::vector<Record> records, const DiagnosisSettings& settings, const Progress& progress = {},
                   const std::function<bool()>& is_stopped = {}, std::vector<Record> unseen = {});

}  // namespace slewlab::diagnosis
