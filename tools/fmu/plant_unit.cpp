#include "tools/fmu/plant_unit.h"

#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "sim/drive/crane_plant.h"
#include "sim/drive/scenario_run.h"
#include "sim/machine/machine_tree.h"

namespace slewlab::tools::fmu {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;

constexpr std::array<FieldText, 4> kTorque{{
    {"enable", FMU_BOOLEAN, "drives may deliver torque"},
    {"brake", FMU_BOOLEAN, "apply the disk brakes"},
    {"acknowledge", FMU_BOOLEAN, "clears a trip of the drive on its rising edge"},
    {"motor_torque", FMU_REAL, "command per motor of the group, on the fast axis; without enable the drives deliver none"},
}};
constexpr std::array<FieldText, 2> kEncoder{{
    {"shaft_speed", FMU_REAL, "mean of the group's motors, on the fast axis, as its encoder says it"},
    {"shaft_position", FMU_REAL, "since the start, on the fast axis, as its encoder says it"},
}};
constexpr std::array<FieldText, 5> kSensors{{
    {"house_acceleration", FMU_REAL, "lateral, at the sensor on the crane house"},
    {"pivot_acceleration", FMU_REAL, "lateral, at the boom pivot"},
    {"middle_acceleration", FMU_REAL, "lateral, at half of the boom's length"},
    {"tip_acceleration", FMU_REAL, "lateral, at the boom tip"},
    {"slew_angle", FMU_REAL, "of the crane house, or of the axis, as its encoder says it"},
}};
constexpr std::array<FieldText, 12> kTruth{{
    {"gearbox_torque", FMU_REAL, "of the whole group, on the slew axis"},
    {"gear_deflection", FMU_REAL, "motor minus house, on the slew axis, backlash (play) included"},
    {"play_crossings", FMU_INTEGER, "changes of the tooth flank in contact since the start"},
    {"house_speed", FMU_REAL, "slewing speed"},
    {"tip_displacement", FMU_REAL, "of the boom tip, lateral, rigid rotation included"},
    {"tip_velocity", FMU_REAL, "of the boom tip, lateral"},
    {"rope_angle", FMU_REAL, "sidelead: swing of the rope across the boom"},
    {"rod_angle", FMU_REAL, "swing of the load below the rope"},
    {"mechanical_energy", FMU_REAL, "kinetic, elastic and gravitational"},
    {"supplied_work", FMU_REAL, "done on the machine by motors and other outside forces since the start"},
    {"shear_force", FMU_REAL, "mean of a boom element, counted from the pivot"},
    {"modal_energy", FMU_REAL, "of a mode of the boom on its free house"},
}};
constexpr std::array<FieldText, 3> kStatus{{
    {"drive_state", FMU_INTEGER, "0 ready, 1 running, 2 tripped, 3 braked"},
    {"trip_cause", FMU_INTEGER, "why the drive tripped: 0 not, else the code of the manual's page on the wire"},
    {"stale_commands", FMU_INTEGER, "periods that began with no fresh command"},
}};

constexpr std::size_t kPlantStep = 0, kSeed = 1, kFirstInput = 2;

class PlantUnit : public Unit {
 public:
  // What is the same for all instances: settings, and which fields are variables, as the model description has them.
  struct Plan {
    sim::MachineSettings machine;
    std::int64_t period = 0;  // [ns]
    std::vector<Variable> variables;
    std::vector<bool> encoder, sensors, truth, status;             // field_choice
    std::size_t first_encoder = 0, first_sensor = 0, first_truth = 0, first_status = 0;  // index of the variable
  };

  explicit PlantUnit(std::shared_ptr<const Plan> plan)
      : Unit(std::shared_ptr<const std::vector<Variable>>(plan, &plan->variables)), plan_(std::move(plan)) {}

  std::unique_ptr<Unit> clone() const override { return std::make_unique<PlantUnit>(*this); }
  void take_over(const Unit& from) override { *this = dynamic_cast<const PlantUnit&>(from); }
  std::unique_ptr<Unit> as_made() const override { return std::make_unique<PlantUnit>(plan_); }

  static std::shared_ptr<const Plan> plan_of(const UnitFile& file);

 private:
  void assemble() override {
    sim::MachineSettings settings = plan_->machine;
    settings.step = values_[kPlantStep];
    if (!(settings.step >= 1e-9 && settings.step <= 1.0)) throw std::runtime_error("plant_step has to lie between 1e-9 s and 1 s");
    settings.seed = static_cast<std::uint64_t>(values_[kSeed]);
    step_ = std::llround(settings.step * kNanosecondsPerSecond);
    const sim::DriveRun run{settings.crane.drive.group_count, 0, plan_->period, 0};
    plant_.emplace(settings, run);
    cycle_ = 0;
    torque_ = {};
    torque_.group_count = run.group_count;
    torque_.motor_torque.assign(static_cast<std::size_t>(run.group_count), 0.0);
    is_stale_ = {true, true, true, true};
    for (std::size_t part = 0; part < is_stale_.size(); ++part) refresh_part(part);  // arrays have their memory from here on
  }

  void advance(std::int64_t, std::int64_t step) override {
    if (step % step_ != 0) {
      throw std::runtime_error("a communication step of " + std::to_string(static_cast<double>(step) / kNanosecondsPerSecond) +
                               " s; it has to be a whole multiple of plant_step, " +
                               std::to_string(static_cast<double>(step_) / kNanosecondsPerSecond) + " s");
    }
    const double* input = values_.data() + kFirstInput;
    torque_.sequence = torque_.answered_sequence = torque_.alive_counter = cycle_;
    torque_.enable = *input++ != 0.0;
    torque_.brake = *input++ != 0.0;
    torque_.acknowledge = *input++ != 0.0;
    for (double& torque : torque_.motor_torque) torque = *input++;
    is_stale_ = {true, true, true, true};
    plant_->set_controller_period(step);
    plant_->begin_cycle(cycle_++);
    plant_->receive(msgs::DecodeStatus::ok, torque_);
    const sim::PlantConditions conditions;
    for (std::int64_t done = 0; done < step; done += step_) plant_->step(conditions);
    if (const auto divergence = plant_->divergence()) {
      throw std::runtime_error(std::string("the plant diverged: ") + divergence->quantity + " is " + std::to_string(divergence->value) +
                               " " + divergence->unit);
    }
  }

  void refresh(std::size_t index) override {
    const Plan& plan = *plan_;
    refresh_part(index >= plan.first_status ? 3 : index >= plan.first_truth ? 2 : index >= plan.first_sensor ? 1 : 0);
  }

  void refresh_part(std::size_t part) {
    if (!is_stale_[part]) return;
    is_stale_[part] = false;
    const Plan& plan = *plan_;
    double* values = values_.data();
    switch (part) {
      case 0:
        plant_->read_encoder(encoder_);
        copy_values(fields_of(encoder_), plan.encoder, values + plan.first_encoder);
        break;
      case 1:
        plant_->read_sensors(sensors_);
        copy_values(fields_of(sensors_), plan.sensors, values + plan.first_sensor);
        break;
      case 2:
        plant_->read_truth(truth_);
        copy_values(fields_of(truth_), plan.truth, values + plan.first_truth);
        break;
      default:
        plant_->read_status(status_);
        copy_values(fields_of(status_), plan.status, values + plan.first_status);
    }
  }

  std::shared_ptr<const Plan> plan_;
  std::optional<sim::CranePlant> plant_;
  std::int64_t step_ = 0;  // [ns] of the plant
  std::int64_t cycle_ = 0;
  std::array<bool, 4> is_stale_{};  // ENCODER, SENSORS, TRUTH, PLANT_STATUS
  msgs::Torque torque_{};
  msgs::Encoder encoder_{};
  msgs::Sensors sensors_{};
  msgs::Truth truth_{};
  msgs::PlantStatus status_{};
};

// The messages' units are a crane's; a linear axis has metres and newtons in their place (docs/axis.md).
void set_units(const sim::AxisForm& form, std::vector<Variable>& variables) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kLinear{{{"rad", "m"}, {"rad/s", "m/s"}, {"Nm", "N"}}};
  for (Variable& variable : variables) {
    const bool is_shaft = variable.name.starts_with("shaft_") || variable.name.starts_with("motor_torque");
    if (!(is_shaft ? form.is_shaft_linear : form.is_linear)) continue;
    for (const auto& [rotary, linear] : kLinear) {
      if (variable.unit != rotary) continue;
      variable.unit = linear;
      break;
    }
  }
}

std::shared_ptr<const PlantUnit::Plan> PlantUnit::plan_of(const UnitFile& file) {
  auto plan = std::make_shared<Plan>();
  const sim::MachineFile machine = sim::machine_of(file.root);
  plan->machine = sim::machine_settings(machine);
  plan->machine.step = static_cast<double>(file.plant_step) / kNanosecondsPerSecond;
  plan->period = file.period;
  const int groups = plan->machine.crane.drive.group_count;
  sim::CranePlant plant(plan->machine, {groups, 0, file.period, 0});

  std::vector<Variable>& variables = plan->variables;
  variables.push_back({"plant_step", "step of the plant's own integration; every communication step is a whole multiple of it", "s",
                       FMU_REAL, Causality::parameter, plan->machine.step});
  variables.push_back({"seed", "of the machine's effects that draw numbers", "-", FMU_INTEGER, Causality::parameter,
                       static_cast<double>(file.seed)});
  msgs::Torque torque{};
  torque.motor_torque.resize(static_cast<std::size_t>(groups));
  add_variables(fields_of(torque), kTorque, Causality::input, variables);

  plan->first_encoder = variables.size();
  msgs::Encoder encoder{};
  plant.read_encoder(encoder);
  add_variables(fields_of(encoder), kEncoder, Causality::output, variables);
  plan->encoder = field_choice(fields_of(encoder), kEncoder);

  // What the machine has no place for reads as no number.
  plan->first_sensor = variables.size();
  msgs::Sensors sensors{};
  plant.read_sensors(sensors);
  std::vector<FieldText> fitted;
  for (const auto& field : msgs::kSensorFields<msgs::Sensors>) {
    const FieldText* text = detail::text_of(kSensors, field.field);
    if (text != nullptr && !std::isnan(sensors.*field.value)) fitted.push_back(*text);
  }
  add_variables(fields_of(sensors), fitted, Causality::output, variables);
  plan->sensors = field_choice(fields_of(sensors), fitted);

  plan->first_truth = variables.size();
  msgs::Truth truth{};
  plant.read_truth(truth);
  add_variables(fields_of(truth), kTruth, Causality::output, variables);
  plan->truth = field_choice(fields_of(truth), kTruth);

  plan->first_status = variables.size();
  msgs::PlantStatus status{};
  plant.read_status(status);
  add_variables(fields_of(status), kStatus, Causality::output, variables);
  plan->status = field_choice(fields_of(status), kStatus);
  set_units(machine.axis, variables);
  return plan;
}

}  // namespace

std::unique_ptr<Unit> make_plant_unit(const UnitFile& file) { return std::make_unique<PlantUnit>(PlantUnit::plan_of(file)); }

}  // namespace slewlab::tools::fmu
