#include "tools/fmu/controller_unit.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include "controller/controller_tree.h"
#include "controller/process/computed_answer.h"

namespace slewlab::tools::fmu {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;

constexpr std::array<FieldText, 2> kEncoder{{
    {"shaft_speed", FMU_REAL, "mean of the group's motors, on the fast axis"},
    {"shaft_position", FMU_REAL, "since the start, on the fast axis"},
}};
constexpr std::array<FieldText, 4> kTorque{{
    {"enable", FMU_BOOLEAN, "drives may deliver torque"},
    {"brake", FMU_BOOLEAN, "apply the disk brakes"},
    {"acknowledge", FMU_BOOLEAN, "clears a trip of the drive on its rising edge"},
    {"motor_torque", FMU_REAL, "command per motor of the group, on the fast axis"},
}};
constexpr std::array<FieldText, 6> kState{{
    {"mode", FMU_INTEGER, "0 stopped, 1 running, 2 emergency stop, 3 waiting for acknowledgement"},
    {"ramped_speed", FMU_REAL, "requested slewing speed behind the ramp, on the slew axis"},
    {"average_torque", FMU_REAL, "per motor, mean of the groups before the play compensation"},
    {"offset_torque", FMU_REAL, "per motor, half the difference that the play compensation adds"},
    {"proportional_torque", FMU_REAL, "per motor, of the speed controller"},
    {"integral_torque", FMU_REAL, "per motor, of the speed controller"},
}};

constexpr std::size_t kPeriod = 0, kSpeedRequest = 1, kEmergencyStop = 2, kOperatorAcknowledge = 3, kFirstSpeed = 4;

class ControllerUnit : public Unit {
 public:
  struct Plan {
    controller::ControllerSettings settings;
    std::vector<Variable> variables;
    std::vector<bool> torque, state;  // field_choice
    std::size_t first_torque = 0, first_state = 0;
  };

  explicit ControllerUnit(std::shared_ptr<const Plan> plan)
      : Unit(std::shared_ptr<const std::vector<Variable>>(plan, &plan->variables)), plan_(std::move(plan)) {}

  std::unique_ptr<Unit> clone() const override { return std::make_unique<ControllerUnit>(*this); }
  void take_over(const Unit& from) override { *this = dynamic_cast<const ControllerUnit&>(from); }
  std::unique_ptr<Unit> as_made() const override { return std::make_unique<ControllerUnit>(plan_); }

  static std::shared_ptr<const Plan> plan_of(const UnitFile& file);

 private:
  void assemble() override {
    controller::ControllerSettings settings = plan_->settings;
    settings.period = values_[kPeriod];
    if (!(settings.period >= 1e-9 && settings.period <= 1.0)) throw std::runtime_error("period has to lie between 1e-9 s and 1 s");
    period_ = std::llround(settings.period * kNanosecondsPerSecond);
    compute_ = controller::computed_answer(settings);
    const auto groups = static_cast<std::size_t>(settings.group_count);
    cycle_ = 0;
    encoder_ = {};
    encoder_.group_count = settings.group_count;
    encoder_.shaft_speed.assign(groups, 0.0);
    encoder_.shaft_position.assign(groups, 0.0);
    torque_ = {};
    torque_.motor_torque.assign(groups, 0.0);
    state_ = {};
    state_.proportional_torque.assign(groups, 0.0);
    state_.integral_torque.assign(groups, 0.0);
    show();
  }

  void advance(std::int64_t time, std::int64_t step) override {
    if (step != period_) {
      throw std::runtime_error("a communication step of " + std::to_string(static_cast<double>(step) / kNanosecondsPerSecond) +
                               " s; this controller is asked every " +
                               std::to_string(static_cast<double>(period_) / kNanosecondsPerSecond) + " s, its parameter period");
    }
    const std::size_t groups = encoder_.shaft_speed.size();
    for (std::size_t group = 0; group < groups; ++group) {
      encoder_.shaft_speed[group] = values_[kFirstSpeed + group];
      encoder_.shaft_position[group] = values_[kFirstSpeed + groups + group];
    }
    encoder_.sequence = cycle_++;
    encoder_.simulated_time = time;
    operator_.speed_request = values_[kSpeedRequest];
    operator_.emergency_stop = values_[kEmergencyStop] != 0.0;
    operator_.acknowledge = values_[kOperatorAcknowledge] != 0.0;
    compute_(encoder_, operator_, torque_, state_);
    for (std::vector<double>* per_group : {&torque_.motor_torque, &state_.proportional_torque, &state_.integral_torque}) per_group->resize(groups);
    show();
  }

  void refresh(std::size_t) override {}

  void show() {
    copy_values(fields_of(torque_), plan_->torque, values_.data() + plan_->first_torque);
    copy_values(fields_of(state_), plan_->state, values_.data() + plan_->first_state);
  }

  std::shared_ptr<const Plan> plan_;
  controller::Compute compute_;
  std::int64_t period_ = 0;  // [ns]
  std::int64_t cycle_ = 0;
  msgs::Encoder encoder_{};
  msgs::Operator operator_{};
  msgs::Torque torque_{};
  msgs::ControllerState state_{};
};

std::shared_ptr<const ControllerUnit::Plan> ControllerUnit::plan_of(const UnitFile& file) {
  auto plan = std::make_shared<Plan>();
  plan->settings = controller::controller_of(file.root).settings;
  const auto groups = static_cast<std::size_t>(plan->settings.group_count);
  std::vector<Variable>& variables = plan->variables;
  variables.push_back({"period", "time between two steps; every communication step is of this length", "s", FMU_REAL,
                       Causality::parameter, static_cast<double>(file.period) / kNanosecondsPerSecond});
  variables.push_back({"speed_request", "joystick: -1 ... 1, share of the top speed", "-", FMU_REAL, Causality::input, 0.0});
  variables.push_back({"emergency_stop", "the button is pressed", "-", FMU_BOOLEAN, Causality::input, 0.0});
  variables.push_back({"operator_acknowledge", "the operator acknowledges a trip", "-", FMU_BOOLEAN, Causality::input, 0.0});
  msgs::Encoder encoder{};
  encoder.shaft_speed.resize(groups);
  encoder.shaft_position.resize(groups);
  add_variables(fields_of(encoder), kEncoder, Causality::input, variables);

  plan->first_torque = variables.size();
  msgs::Torque torque{};
  torque.motor_torque.resize(groups);
  add_variables(fields_of(torque), kTorque, Causality::output, variables);
  plan->torque = field_choice(fields_of(torque), kTorque);

  plan->first_state = variables.size();
  msgs::ControllerState state{};
  state.proportional_torque.resize(groups);
  state.integral_torque.resize(groups);
  add_variables(fields_of(state), kState, Causality::output, variables);
  plan->state = field_choice(fields_of(state), kState);
  return plan;
}

}  // namespace

std::unique_ptr<Unit> make_controller_unit(const UnitFile& file) {
  return std::make_unique<ControllerUnit>(ControllerUnit::plan_of(file));
}

}  // namespace slewlab::tools::fmu
