// The thesis's numbers computed anew, section by section (`slewlab verify`, and the tests).
//
// Inputs are the files of config/ and the thesis's own tables; nothing computed is stored. The 5 % that most
// rows allow is the thesis's own tolerance (2.1); rows of closed forms allow the rounding of the print.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "controller/controller.h"
#include "diagnosis/loop/closed_loop.h"
#include "sim/model/crane_parameters.h"
#include "tools/verification/row.h"

namespace slewlab::tools {

struct VerificationInputs {
  sim::CraneParameters crane;                       // config/cranes/thesis.yaml
  sim::DriveProtectionSettings drive_protection;    // ... its drives'
  controller::ControllerSettings compensated;       // config/controllers/thesis.yaml
  controller::ControllerSettings uncompensated;     // ... thesis_without_play_compensation.yaml
  controller::ControllerSettings linear_ramp;       // ... thesis_linear_ramp.yaml
};

// Throws common::InputError when a file is wrong or missing.
VerificationInputs load_verification_inputs(const std::filesystem::path& config_directory);

// The crane's slew of thesis 4.2 to 4.5, run once each when first asked for.
class SlewRuns {
 public:
  explicit SlewRuns(const VerificationInputs& inputs) : inputs_(inputs) {}

  const diagnosis::ClosedLoopSeries& with_backlash();            // play compensation off
  const diagnosis::ClosedLoopSeries& without_backlash();         // play compensation off, no play
  const diagnosis::ClosedLoopSeries& with_compensation();
  const diagnosis::ClosedLoopSeries& with_linear_ramp();         // play compensation on
  const diagnosis::ClosedLoopSeries& with_soft_speed_loop();     // as with_backlash, gain kSoftGain
  const VerificationInputs& inputs() const { return inputs_; }

  static constexpr double kStart = 5.0;      // [s] the operator asks for full speed, thesis 3.5
  static constexpr double kStop = 30.0;      // [s] emergency stop, thesis 4.4
  static constexpr double kDuration = 60.0;  // [s]
  // [Nms/rad] per motor: a speed loop soft enough to leave the boom its frequency with free motors.
  static constexpr double kSoftGain = 3.0;

 private:
  using Series = std::unique_ptr<const diagnosis::ClosedLoopSeries>;
  VerificationInputs inputs_;
  Series with_backlash_, without_backlash_, with_compensation_, with_linear_ramp_, with_soft_speed_loop_;
};

// The manoeuvre of the runs above.
diagnosis::LoopSettings slew_run(const VerificationInputs& inputs, const sim::CraneParameters& crane,
                                 const controller::ControllerSettings& settings);

struct VerificationSection {
  std::string id;              // letters, digits and underscores: also the name of its test
  bool needs_controller = false;
  std::function<VerificationRows(SlewRuns&)> compute;
};
const std::vector<VerificationSection>& verification_sections();

// Rows of chapters 2 and 3, closed forms and single parts.
VerificationRows mesh_rows(SlewRuns& runs);
VerificationRows house_rows(SlewRuns& runs);
VerificationRows clamped_boom_rows(SlewRuns& runs);
VerificationRows inertia_rows(SlewRuns& runs);
VerificationRows drive_line_rows(SlewRuns& runs);
VerificationRows forced_motion_rows(SlewRuns& runs);
VerificationRows backlash_rows(SlewRuns& runs);
VerificationRows play_map_rows(SlewRuns& runs);
VerificationRows load_rows(SlewRuns& runs);
// Chapter 4, frequency domain.
VerificationRows crane_frequency_rows(SlewRuns& runs);
VerificationRows homogeneous_boom_rows(SlewRuns& runs);
VerificationRows bode_rows(SlewRuns& runs);
VerificationRows convergence_rows(SlewRuns& runs);
// Chapter 4, time domain.
VerificationRows shear_rows(SlewRuns& runs);
VerificationRows cost_rows(SlewRuns& runs);
VerificationRows backlash_finding_rows(SlewRuns& runs);
VerificationRows sidelead_rows(SlewRuns& runs);
VerificationRows slewing_moment_rows(SlewRuns& runs);
VerificationRows compensation_rows(SlewRuns& runs);
VerificationRows ramp_rows(SlewRuns& runs);

}  // namespace slewlab::tools
