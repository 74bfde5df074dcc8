// The diagnosis of a plain axis: which laws close the torque balance of its records (balance_fit.h), and whether they predict data
// that were not fitted. An axis's controller is somebody else's, so two things judge a cause, on the last record without which
// the others tell the ordinary laws (least_share()), or where they do so without none, on that without which they tell most of them; of a single one on
// its second half:
//
//   torque balance        F - J q'' - laws(q', q, t), RMS
//   forward simulation    J q'' = F - laws by the recorded effort alone; RMS of measured minus simulated speed, from the first instant on or
//                         begun anew at each tenth of the record: from the first instant on, even what is right drifts where nothing
//                         brings the axis back; in a tenth, hardly anything does
//
// each against the nominal axis and against the inertia alone, fitted again. The laws are chosen without that part; a cause that is not
// better in both is not stated; the sizes of one that is are fitted to all records.
//
// What the axis's file has - loads, effects that are forces or frictions, the drive's limit of torque - is part of the nominal axis.
// Assumption: one inertia; what swings behind an elastic transmission is part of the residual. Where the file has such a transmission, the axis as
// described is simulated by the recorded efforts and led along the motion (described_axis.h). If its balance has the residual of the records' balance,
// nothing is missing. What no law predicts is unknown only where the described axis has a smaller residual. Stretches with brakes, whose torque nobody
// records, are not judged.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "common/effect.h"
#include "diagnosis/balance/balance_fit.h"
#include "msgs/run_log.h"
#include "sim/machine/machine_file.h"

namespace slewlab::diagnosis {

// A log of an axis that no balance can be drawn from; what() says why and what would help.
class NoBalance : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct NamedRun {
  std::string name;
  msgs::RunLog run;
};

// Position and effort on the axis. The effort is what the drive makes of the commands, with the loads of the axis's file.
// Throws NoBalance.
AxisRecord axis_record(const NamedRun& run, const sim::MachineFile& axis);

// RMS of the torque balance's residual, and of the forward simulation's speed error.
struct AxisError {
  double balance = 0.0;
  double forward = 0.0;  // from the record's first instant
  double tenths = 0.0;   // begun anew at each tenth
};

struct AxisValidation {
  std::string place;                 // the data that were not fitted, in words
  AxisError nominal, inertia, cause;
  double effort = 0.0, speed = 0.0, acceleration = 0.0;  // RMS of what was measured there
  double noise = 0.0;                // RMS of the balance's residual by noise of positions and efforts and by laws known no better
  double floor = 0.0;                // of this, what is not the efforts' noise
  double drift = 0.0;                // RMS of the speed error that a residual of that noise makes in a tenth, if it is a constant
  // RMS of that part of the balance's residual that is no white noise of the efforts: it goes together over more than the window.
  double nominal_together = 0.0, cause_together = 0.0;
  bool holds = false;
  bool is_other_direction = false;   // they move in a direction in which the fitted data do not
  bool is_one_direction = false;     // all data move in one direction
};

// What the page draws, of the last record: the balance's residual before and after.
struct AxisSeries {
  std::vector<double> time, position, speed, effort, nominal_residual, residual;
};

// What a diagnosis comes to; the verdict says it in words.
enum class AxisOutcome {
  nothing_missing,   // the nominal axis is as good as noise and the spread of its inertia allow
  stated,            // the best model is the answer
  not_identifiable,  // the best model does not predict data that were not fitted, or has sizes that its laws cannot have
  unknown,           // no known law explains most of the gap, or a smooth function predicts better than they
};

struct AxisDiagnosis {
  double nominal_inertia = 0.0;
  BalanceAnswer answer;          // without the part held out; the sizes of `best` from all records
  BalanceModel validated;        // `best` with the sizes that were validated
  AxisValidation validation;
  AxisOutcome outcome = AxisOutcome::nothing_missing;
  bool is_described = false;     // the axis of the file, its transmission included, has the balance residual of the records
  double transmission = 0.0;     // mean square of the described axis's residual in the balance of one inertia, by its transmission alone; 0 where rigid
  bool is_hidden_by_transmission = false;  // which makes most of what is missing, and not as the records have it: no answer
  bool is_below_record = false;  // the nominal axis's residual is below the error of a record without any noise; no law is tried
  bool is_physical = true;       // its laws fit all records with sizes that they can have
  double unexplained = 0.0;      // residual share of the gap with the stated laws, on data that were not fitted
  bool has_remainder = false;    // and that is more than noise and laws known no better make
  std::vector<AxisValidation> unseen;  // on the logs that had no part in the answer, by the sizes of `best`
  std::string verdict;
  std::string action;            // one sentence: what to do with it
  std::vector<common::EffectInstance> effects;  // of the best model, where the catalogue has its laws
  std::vector<std::string> remarks;
  std::vector<AxisSeries> series;               // per record
  std::vector<BalanceLaw> laws;                 // that were tried, in units of the axis
  std::size_t half_window = 0;                  // [samples] of the balance
  double window = 0.0;                          // [s] all of it
  std::vector<Lateness> lateness;               // that was tried
};

// `without`: names of laws (balance_law_names()) that are not tried, nor what is a detail of them. `unseen`: logs that the answer is tried on and that
// have no part in it. Throws NoBalance.
AxisDiagnosis diagnose_axis(const sim::MachineFile& axis, const std::vector<NamedRun>& runs, const std::vector<std::string>& without = {},
                            const std::vector<NamedRun>& unseen = {});

// The speed of the axis by the recorded effort alone, on the record's grid; begun where the motion is first known and anew after each `stretch`
// samples.
std::vector<double> forward_speed(const AxisRecord& record, const BalanceMotion& motion, const std::vector<BalanceLaw>& laws,
                                  const BalanceModel& model, std::size_t stretch = std::numeric_limits<std::size_t>::max());

}  // namespace slewlab::diagnosis
