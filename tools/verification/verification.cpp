#include "tools/verification/verification.h"

#include "controller/controller_file.h"
#include "sim/machine/machine_file.h"

namespace slewlab::tools {

namespace {

constexpr double kControllerPeriod = 0.01;  // [s] config/scenarios/thesis_slew.yaml
constexpr double kPlantStep = 1e-3;         // [s] the same

std::unique_ptr<const diagnosis::ClosedLoopSeries> run(const VerificationInputs& inputs, const sim::CraneParameters& crane,
                                                       const controller::ControllerSettings& settings) {
  return std::make_unique<const diagnosis::ClosedLoopSeries>(
      diagnosis::run_closed_loop(slew_run(inputs, crane, settings)));
}

constexpr std::int64_t nanoseconds(double seconds) { return static_cast<std::int64_t>(seconds * 1e9); }

}  // namespace

VerificationInputs load_verification_inputs(const std::filesystem::path& config_directory) {
  const auto controllers = config_directory / "controllers";
  const sim::MachineFile crane = sim::load_machine_file(config_directory / "cranes" / "thesis.yaml");
  return {.crane = crane.parameters,
          .drive_protection = crane.drive_protection,
          .compensated = controller::load_controller_file(controllers / "thesis.yaml").settings,
          .uncompensated =
              controller::load_controller_file(controllers / "thesis_without_play_compensation.yaml").settings,
          .linear_ramp = controller::load_controller_file(controllers / "thesis_linear_ramp.yaml").settings};
}

diagnosis::LoopSettings slew_run(const VerificationInputs& inputs, const sim::CraneParameters& crane,
                                 const controller::ControllerSettings& settings) {
  diagnosis::LoopSettings run;
  run.machine.crane = crane;
  run.machine.drive_protection = inputs.drive_protection;
  run.machine.step = kPlantStep;
  run.controller = settings;
  run.controller.period = kControllerPeriod;
  run.duration = SlewRuns::kDuration;
  run.operator_moves = {{.time = nanoseconds(SlewRuns::kStart), .speed_request = 1.0},
                        {.time = nanoseconds(SlewRuns::kStop), .emergency_stop = true}};
  return run;
}

const diagnosis::ClosedLoopSeries& SlewRuns::with_backlash() {
  if (!with_backlash_) with_backlash_ = run(inputs_, inputs_.crane, inputs_.uncompensated);
  return *with_backlash_;
}

const diagnosis::ClosedLoopSeries& SlewRuns::without_backlash() {
  if (!without_backlash_) {
    sim::CraneParameters crane = inputs_.crane;
    crane.drive.gearbox_play = crane.drive.pinion_play = 0.0;
    without_backlash_ = run(inputs_, crane, inputs_.uncompensated);
  }
  return *without_backlash_;
}

const diagnosis::ClosedLoopSeries& SlewRuns::with_compensation() {
  if (!with_compensation_) with_compensation_ = run(inputs_, inputs_.crane, inputs_.compensated);
  return *with_compensation_;
}

const diagnosis::ClosedLoopSeries& SlewRuns::with_linear_ramp() {
  if (!with_linear_ramp_) with_linear_ramp_ = run(inputs_, inputs_.crane, inputs_.linear_ramp);
  return *with_linear_ramp_;
}

const diagnosis::ClosedLoopSeries& SlewRuns::with_soft_speed_loop() {
  if (!with_soft_speed_loop_) {
    controller::ControllerSettings settings = inputs_.uncompensated;
    settings.speed_control.proportional_gain = kSoftGain;
    with_soft_speed_loop_ = run(inputs_, inputs_.crane, settings);
  }
  return *with_soft_speed_loop_;
}

const std::vector<VerificationSection>& verification_sections() {
  static const std::vector<VerificationSection> sections{
      {"T2_1_and_T2_2_gears", false, mesh_rows},
      {"T2_3_house", false, house_rows},
      {"T2_5_T3_3_clamped_boom", false, clamped_boom_rows},
      {"S2_10_inertias", false, inertia_rows},
      {"T3_2_drive_line", false, drive_line_rows},
      {"S3_4_1_forced_motion", false, forced_motion_rows},
      {"F3_12_F3_13_backlash", false, backlash_rows},
      {"T3_4_play_compensation", true, play_map_rows},
      {"S3_4_3_load", false, load_rows},
      {"T4_1_crane_frequencies", false, crane_frequency_rows},
      {"T4_1_homogeneous_boom", false, homogeneous_boom_rows},
      {"F4_2_bode", false, bode_rows},
      {"F4_3_convergence", false, convergence_rows},
      {"F4_6_F4_7_shear", true, shear_rows},
      {"F4_8_F4_9_cost", true, cost_rows},
      {"F4_11_F4_13_backlash", true, backlash_finding_rows},
      {"F4_12_sidelead", true, sidelead_rows},
      {"F4_14_slewing_moment", true, slewing_moment_rows},
      {"F4_15_F4_16_play_compensation", true, compensation_rows},
      {"F4_17_F4_18_ramp", true, ramp_rows},
  };
  return sections;
}

}  // namespace slewlab::tools
