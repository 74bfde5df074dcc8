#include "diagnosis/shadow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <map>
#include <span>
#include <utility>

#include "diagnosis/recorded_drive.h"
#include "sim/effects/catalogue.h"
#include "sim/integrate/machine.h"
#include "sim/integrate/machine_batch.h"
#include "sim/model/crane.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kNanosecond = 1e-9;  // [s]
constexpr int kMostSteps = 4;         // per reading, of what acts on commands, chosen: a delay of parts of a step is then right within a sixteenth of what it is without
constexpr double kFastest = 1.0;      // speed rate times period: half of what a feedback once per period holds stable

// A place between the points of series of equal length; at their ends they stand still.
struct Place {
  std::size_t point;
  double share;  // of the way to the next point
};
Place place_at(double n, std::size_t size) {
  const double inside = std::clamp(n, 0.0, static_cast<double>(size - 1));
  const auto point = static_cast<std::size_t>(inside);
  return {point, inside - static_cast<double>(point)};
}
double value_at(const std::vector<double>& series, const Place& place) {
  const double here = series[place.point];
  return place.share == 0.0 ? here : here + place.share * (series[place.point + 1] - here);
}

// A series so many points later, or earlier, and parts of one: by the polynomial through 32 points either side (Lagrange). A line
// between two points would be their mean where it is half a point, and so half of the sensor's noise; a polynomial through eight either side would still have but two thirds of it at the highest frequency
// that encoders are judged at, 0.4 of their rate: a delay by parts of a cycle would be believed for the noise that it takes away.
class LaterReading {
 public:
  explicit LaterReading(double points) : points_(points), whole_(static_cast<std::ptrdiff_t>(std::floor(points))) {
    const double part = points - std::floor(points);
    for (std::ptrdiff_t side = kSide; side > 0 && part != 0.0; side /= 2) weights_.push_back(weights(part, side));
  }
  double points() const { return points_; }
  // What a record's first point reads so many points later.
  FirstReading first(const Record& record) const {
    FirstReading later;
    for (std::size_t g = 0; g < static_cast<std::size_t>(record.group_count); ++g) {
      read(record.shaft_position[g], 0, {&later.position[g], 1});
      read(record.position_rate[g], 0, {&later.rate[g], 1});
    }
    return later;
  }
  // Of `result.size()` points from `n` on: the sums of neighbouring points, each in its order, side by side.
  void read(const std::vector<double>& series, std::size_t n, std::span<double> result) const {
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(n) + whole_, count = static_cast<std::ptrdiff_t>(result.size());
    const auto size = static_cast<std::ptrdiff_t>(series.size());
    // Those whose points are all there; the others, near the ends, through as many as there are.
    const std::ptrdiff_t from = weights_.empty() ? count : std::clamp<std::ptrdiff_t>(kSide - 1 - first, 0, count);
    const std::ptrdiff_t to = weights_.empty() ? count : std::clamp<std::ptrdiff_t>(size - kSide - first, from, count);
    double* const sums = result.data();
    for (std::ptrdiff_t k = 0; k < count; ++k) {
      if (k < from || k >= to) sums[k] = near_the_end(series, n + static_cast<std::size_t>(k));
    }
    if (from == to) return;
    std::fill(sums + from, sums + to, 0.0);
    for (std::ptrdiff_t i = 0; i < 2 * kSide; ++i) {
      const double weight = weights_[0][static_cast<std::size_t>(i)];
      const double* const values = series.data() + first + 1 - kSide + i;
      for (std::ptrdiff_t k = from; k < to; ++k) sums[k] += weight * values[k];
    }
  }

 private:
  static constexpr std::ptrdiff_t kSide = 32;  // points; a power of 2

  // Of so many points either side, for the place `part` behind the last one before it.
  static std::vector<double> weights(double part, std::ptrdiff_t side) {
    std::vector<double> result;
    for (std::ptrdiff_t i = 1 - side; i <= side; ++i) {
      double weight = 1.0;
      for (std::ptrdiff_t j = 1 - side; j <= side; ++j) {
        if (j != i) weight *= (part - static_cast<double>(j)) / static_cast<double>(i - j);
      }
      result.push_back(weight);
    }
    return result;
  }
  double near_the_end(const std::vector<double>& series, std::size_t n) const {
    const std::ptrdiff_t before = static_cast<std::ptrdiff_t>(n) + whole_, size = static_cast<std::ptrdiff_t>(series.size());
    for (std::size_t level = 0; level < weights_.size(); ++level) {
      const std::ptrdiff_t side = kSide >> level;
      if (before + 1 < side || before + side >= size) continue;
      double sum = 0.0;
      for (std::ptrdiff_t i = 0; i < 2 * side; ++i) sum += weights_[level][static_cast<std::size_t>(i)] * series[static_cast<std::size_t>(before + 1 - side + i)];
      return sum;
    }
    return value_at(series, place_at(static_cast<double>(n) + points_, series.size()));
  }

  double points_;
  std::ptrdiff_t whole_;
  std::vector<std::vector<double>> weights_;  // of kSide points either side, of half as many, ... of one; none: whole points later
};

// Positions of the next grid points, of each group: many at once, for each alone waits for its own additions.
constexpr std::size_t kAhead = 64;
using ReadAhead = std::array<std::array<double, kAhead>, sim::kMaximumGroupCount>;

// From what the observer's sensor says at every step to measured - observer, taken where the sensor was sampled and straight in between, as
// the record is: what sampling takes away it takes from both.
void sample_alike(const Record& record, std::size_t accelerometer, std::vector<double>& series) {
  std::vector<double> difference = record.sampled_acceleration[accelerometer];
  for (std::size_t j = 0; j < difference.size(); ++j) {
    difference[j] -= value_at(series, place_at((kNanosecond * static_cast<double>(record.sampled_at[j]) - record.start_time) / record.step, series.size()));
  }
  series = resample(record.sampled_at, difference, record, record.size());
}

// [rad/s^2] at the motors: slope of the line through the mean speed of the groups over the machine's characteristic time.
double first_acceleration(const Record& record, double time) {
  const auto count = std::min(record.size(), static_cast<std::size_t>(time / record.step) + 2);
  const double middle = 0.5 * static_cast<double>(count - 1);
  double product = 0.0, square = 0.0;
  for (std::size_t n = 0; n < count; ++n) {
    const double away = static_cast<double>(n) - middle;
    for (int g = 0; g < record.group_count; ++g) product += away * record.position_rate[static_cast<std::size_t>(g)][n] / record.group_count;
    square += away * away;
  }
  return product / (square * record.step);
}

// A load that hangs still below the tip moves with it: its modal coordinates follow V^T M [x; 0].
void move_load(sim::Machine& machine, double distance, double speed) {
  if (!machine.model.has_load) return;
  const sim::LoadOnSpring& load = machine.model.load;
  for (int j = 0; j < 2; ++j) {
    const double share = load.modes.col(j).dot(load.mass.col(0));
    machine.state.load_q[static_cast<std::size_t>(j)] += share * distance;
    machine.state.load_v[static_cast<std::size_t>(j)] += share * speed;
  }
}

// Rope and rod inclined, by their angles; V^T M [L rope; rope + rod].
void incline_load(sim::Machine& machine, const Eigen::Vector2d& rope, const Eigen::Vector2d& rod) {
  if (!machine.model.has_load) return;
  const sim::LoadOnSpring& load = machine.model.load;
  const Eigen::Matrix2d turn = load.modes.transpose() * load.mass;
  const double length = machine.model.parameters.load.rope_length;
  const Eigen::Vector2d angle = turn * Eigen::Vector2d(length * rope(0), rope(0) + rod(0));
  const Eigen::Vector2d rate = turn * Eigen::Vector2d(length * rope(1), rope(1) + rod(1));
  for (int j = 0; j < 2; ++j) {
    machine.state.load_q[static_cast<std::size_t>(j)] += angle(j);
    machine.state.load_v[static_cast<std::size_t>(j)] += rate(j);
  }
}

// A mode above that of the rigid body, bent while the house stays where it is and as fast as it is, the load below the tip.
void bend(sim::Machine& machine, std::size_t mode, double amount, double rate) {
  const sim::PlantModel& model = machine.model;
  sim::PlantState& state = machine.state;
  const double turned_back = model.house[mode] / model.house[0];
  state.q[mode] += amount;
  state.v[mode] += rate;
  state.q[0] -= turned_back * amount;
  state.v[0] -= turned_back * rate;
  const double tip = model.tip[mode] - turned_back * model.tip[0];
  move_load(machine, tip * amount, tip * rate);
}

// [m sqrt(kg)] of a mode under a torque held on the house and a force held on the tip.
double static_bend(const sim::PlantModel& model, std::size_t mode, double house_torque, double tip_force) {
  return (model.house[mode] * house_torque + model.tip[mode] * tip_force) / model.square[mode];
}

bool can_bend(const sim::PlantModel& model, std::size_t mode) {
  return !model.is_rigid && mode < static_cast<std::size_t>(model.mode_count) && model.square[mode] > 0.0;
}

// A crane that is already turning starts at the motors' mean speed, its teeth where they were.
void start_moving(sim::Machine& machine, const Record& record, const FirstReading& first) {
  const sim::PlantModel& model = machine.model;
  double speed = 0.0;
  for (int g = 0; g < record.group_count; ++g) {
    const auto i = static_cast<std::size_t>(g);
    machine.state.motor_speed[i] = first.rate[i] / model.ratio;
    speed += machine.state.motor_speed[i] / record.group_count;
  }
  if (speed == 0.0) return;
  machine.state.v[0] = speed / model.house[0];
  move_load(machine, 0.0, model.tip[0] * machine.state.v[0]);
}

// Bent as by a constant acceleration [rad/s^2] of the axis and by the load, which hangs behind and swings about that by `swing` [rad]; what
// else boom and load do is the record's own.
void bend_as_it_accelerates(sim::Machine& machine, double acceleration, double swing) {
  const sim::PlantModel& model = machine.model;
  const double radius = model.tip[0] / model.house[0];
  const double behind = -radius * acceleration / sim::kGravity;
  const double tip_force = model.has_load ? model.parameters.load.mass * sim::kGravity * (behind + swing) : 0.0;
  const double torque = acceleration * sim::driven_inertia(model.parameters) - radius * tip_force;
  for (std::size_t mode = 1; can_bend(model, mode); ++mode) bend(machine, mode, static_bend(model, mode, torque, tip_force), 0.0);
  incline_load(machine, {behind, 0.0}, Eigen::Vector2d::Zero());
}

// [kg m^2] slew axis: of all as one body.
double whole_inertia(const sim::PlantModel& model) {
  double inertia = sim::driven_inertia(model.parameters);
  for (int g = 0; g < model.group_count; ++g) inertia += model.group_inertia[static_cast<std::size_t>(g)];
  return inertia;
}

// A machine that stands, its gears pressed and so its house held, is bent by what its effects do to it all the time (a heel, steady wind, a tilt); in the middle of its play it is free, and begins
// unbent. Gives the acceleration [rad/s^2] that they would make of all as one body, which the torques of the motors hold.
double bend_under_steady_forces(sim::Machine& machine) {
  const sim::PlantModel& model = machine.model;
  const sim::PortForces& steady = machine.steady;
  const double tip_force = steady.tip_force + (model.has_load ? steady.load_force : 0.0);
  const double moment = steady.house_torque + (model.tip[0] * tip_force + model.uniform[0] * steady.uniform_force) / model.house[0];
  for (std::size_t mode = 1; can_bend(model, mode); ++mode) {
    const double along = model.uniform[mode] * steady.uniform_force / model.square[mode];
    bend(machine, mode, static_bend(model, mode, steady.house_torque - moment, tip_force) + along, 0.0);
  }
  return moment / whole_inertia(model);
}

// Turned as one body to where the encoders say that it stands: what goes with the angle (meshes, an incline) has one phase in all records.
void turn_to_first_angle(sim::Machine& machine, const Record& record, const FirstReading& first) {
  const sim::PlantModel& model = machine.model;
  double angle = 0.0;
  for (int g = 0; g < record.group_count; ++g) angle += first.position[static_cast<std::size_t>(g)] / (model.ratio * record.group_count);
  if (angle == 0.0) return;
  for (int g = 0; g < record.group_count; ++g) machine.state.motor_angle[static_cast<std::size_t>(g)] += angle;
  machine.state.q[0] += angle / model.house[0];
  move_load(machine, model.tip[0] * angle / model.house[0], 0.0);
  sim::refresh(model, machine.state);
  sim::rest_under_steady_forces(machine);
}

// [rad/s^2] that what pushes from outside would make of all as one body.
double pushed_acceleration(const sim::Machine& machine) {
  double torque = machine.outside.house_torque;
  for (const double at_motors : machine.outside.motor_torque) torque += at_motors;
  return torque / whole_inertia(machine.model);
}

void start(sim::Machine& machine, const Record& record, const FirstReading& first, const Beginning& beginning, double time) {
  machine.started_at = record.effects_begin();
  turn_to_first_angle(machine, record, first);
  start_moving(machine, record, first);
  double acceleration = rigid_acceleration(machine.model, record, 0);
  if (record.begins_bent) {
    acceleration = first_acceleration(record, time) / machine.model.ratio;
    bend_as_it_accelerates(machine, acceleration, beginning.swing);
  } else if (record.begins_on_flanks) {
    acceleration += bend_under_steady_forces(machine) + pushed_acceleration(machine);
  }
  if (record.begins_on_flanks) {
    const GroupAngles places = places_on_flanks(machine.model, record, 0, acceleration, machine.outside.motor_torque);
    for (std::size_t i = 0; i < places.size(); ++i) machine.state.motor_angle[i] += places[i];
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(record.group_count); ++i) machine.state.motor_angle[i] += beginning.motor_offset[i];
  incline_load(machine, {beginning.swing, beginning.swing_rate}, {beginning.rod, beginning.rod_rate});
  const sim::DriveParameters& drive = machine.model.parameters.drive;
  const double rated = drive.group_count * drive.motors_per_group * drive.rated_torque * machine.model.ratio;
  for (std::size_t k = 0; k < kBeginningBends; ++k) {
    if ((beginning.bend[k] == 0.0 && beginning.bend_rate[k] == 0.0) || !can_bend(machine.model, k + 1)) continue;
    const double unit = static_bend(machine.model, k + 1, rated, 0.0);
    bend(machine, k + 1, unit * beginning.bend[k], unit * std::sqrt(machine.model.square[k + 1]) * beginning.bend_rate[k]);
  }
  sim::refresh(machine.model, machine.state);
  sim::begin_effects(machine, beginning.outwards, beginning.outward_rate);
  sim::forget_past(machine);
}

// How the shafts turn where the encoders read so: those that read a scale or a ripple read another speed than there is.
FirstReading as_it_turns(const sim::Machine& machine, const Record& record, FirstReading first, const Beginning& beginning, double time) {
  if (machine.sensor.empty()) return first;
  sim::Machine begun = machine;
  start(begun, record, first, beginning, time);
  const sim::MachineReadings readings = sim::read(begun);
  for (std::size_t i = 0; i < static_cast<std::size_t>(record.group_count); ++i) {
    if (readings.shaft_speed[i] != 0.0) first.rate[i] *= first.rate[i] / readings.shaft_speed[i];
  }
  return first;
}

}  // namespace

namespace {

// [Nm] per motor; of torques that were measured the mean over the next ones, as far as noise alone parts them: a beginning that one reading's noise places rings for a second.
double torque_from(const Record& record, std::size_t group, std::size_t point) {
  constexpr std::size_t kReadings = 10;
  constexpr double kDeviations = 4.0;  // up to which noise alone parts two readings
  const std::vector<double>& torque = record.motor_torque[group];
  if (!record.has_measured_torque) return torque[point];
  double sum = torque[point], count = 1.0;
  for (std::size_t n = point + 1; n < std::min(torque.size(), point + kReadings); ++n, count += 1.0) {
    if (std::fabs(torque[n] - sum / count) > kDeviations * std::sqrt(record.torque_noise * (1.0 + 1.0 / count))) break;
    sum += torque[n];
  }
  return sum / count;
}

}  // namespace

double rigid_acceleration(const sim::PlantModel& model, const Record& record, std::size_t point) {
  double torque = 0.0;
  for (int g = 0; g < record.group_count; ++g) torque += model.parameters.drive.motors_per_group * model.ratio * torque_from(record, static_cast<std::size_t>(g), point);
  return torque / whole_inertia(model);
}

GroupAngles places_on_flanks(const sim::PlantModel& model, const Record& record, std::size_t point, double acceleration, const sim::GroupArray& more_torque) {
  GroupAngles places{};
  for (int g = 0; g < record.group_count; ++g) {
    const auto i = static_cast<std::size_t>(g);
    const double through =
        model.parameters.drive.motors_per_group * model.ratio * torque_from(record, i, point) + more_torque[i] - model.group_inertia[i] * acceleration;
    if (through != 0.0) places[i] = std::copysign(model.gear[i].half_play, through) + through / model.gear[i].stiffness;
  }
  return places;
}

ShadowGains shadow_gains(const sim::Scales& nominal, const ShadowSettings& settings) {
  return {settings.speed_rate * nominal.motor_inertia, settings.position_rate * nominal.motor_inertia, settings.speed_window,
          settings.tip_damping_rate * nominal.boom_mass, settings.leak_time, settings.first_offset, settings.offset_time, settings.first_slope};
}

ShadowSettings not_faster_than(ShadowSettings settings, double period) {
  const double slower = std::max(1.0, settings.speed_rate * period / kFastest);
  settings.speed_rate /= slower;
  settings.position_rate /= slower * slower;
  return settings;
}

namespace {

bool acts_on_any(std::string_view effect, std::initializer_list<sim::EffectPort> ports) {
  const sim::EffectDescription* description = sim::find_effect(effect);
  return description != nullptr && std::any_of(description->ports.begin(), description->ports.end(), [&](sim::EffectPort port) {
           return std::find(ports.begin(), ports.end(), port) != ports.end();
         });
}

}  // namespace

int steps_of_the_settings(const sim::MachineSettings& machine, double step) { return std::max(1, static_cast<int>(std::lround(step / machine.step))); }

bool acts_by_force(std::string_view effect) { return acts_on_any(effect, {sim::EffectPort::force, sim::EffectPort::friction}); }

Grid grid_of(const Record& record) { return {record.step, record.recorded_per_point, record.recorded_per_point > 1 && !is_filtered(record)}; }

Follower follower_of(const sim::MachineSettings& settings, const Grid& grid, const ForceSteps& force_steps) {
  const double step = grid.step;
  const auto commands = static_cast<int>(grid.per_point);
  Follower follower;
  sim::MachineSettings with_step = settings;
  std::erase_if(with_step.effects, [&](const common::EffectInstance& effect) {
    const sim::EffectDescription* description = sim::find_effect(effect.name);
    if (description == nullptr || description->about.pure_delay != common::PureDelay::encoder) return false;
    follower.encoder_delay += effect.values[common::kSize] / step;
    return true;
  });
  const int of_the_settings = steps_of_the_settings(settings, step);
  bool takes_commands = grid.takes_each;
  for (const common::EffectInstance& effect : with_step.effects) {
    if (acts_on_any(effect.name, {sim::EffectPort::message, sim::EffectPort::actuator})) {
      takes_commands = true;
      follower.steps = std::max(follower.steps, std::min(kMostSteps, of_the_settings));
    }
    if (!acts_by_force(effect.name)) continue;
    const auto found = force_steps.find(effect.name);
    follower.steps = std::max(follower.steps, found == force_steps.end() ? of_the_settings : std::min(found->second, of_the_settings));
  }
  if (takes_commands) follower.steps = (follower.steps + commands - 1) / commands * commands;
  with_step.step = step / follower.steps;
  follower.machine = sim::make_machine(with_step);
  follower.to_slew_axis = settings.crane.drive.motors_per_group * follower.machine.model.ratio;
  return follower;
}

Shadow shadow(const sim::MachineSettings& settings, const Record& record, const ShadowGains& gains, double encoder_latency,
              const Beginning& beginning) {
  Shadow result;
  std::vector<Shadowing> alone;
  alone.push_back({follower_of(settings, grid_of(record)), encoder_latency, beginning, &result});
  shadow(std::move(alone), record, drive_course(record, settings.drive_protection), gains);
  return result;
}

FirstReading first_reading(const Record& record) {
  FirstReading first;
  for (std::size_t g = 0; g < static_cast<std::size_t>(record.group_count); ++g) {
    first.position[g] = record.shaft_position[g][0];
    first.rate[g] = record.position_rate[g][0];
  }
  return first;
}

Observer::Observer(Follower follower, const Record& record, const ShadowGains& gains, const Beginning& beginning)
    : Observer(std::move(follower), record, first_reading(record), gains, beginning) {}

Observer::Observer(Follower follower, const Record& record, const FirstReading& first, const ShadowGains& gains, const Beginning& beginning)
    : machine_(std::move(follower.machine)),
      steps_(follower.steps),
      to_slew_axis_(follower.to_slew_axis),
      step_(record.step),
      gains_(gains),
      groups_(static_cast<std::size_t>(record.group_count)),
      leak_(std::exp(-record.step / gains.leak_time)),
      forget_(std::exp(-record.step / gains.offset_time)),
      first_(static_cast<std::size_t>(gains.first_offset / record.step)) {
  start(machine_, record, as_it_turns(machine_, record, first, beginning, gains.first_slope), beginning, gains.first_slope);
  const sim::MachineReadings readings = sim::read(machine_);
  for (std::size_t i = 0; i < groups_; ++i) origin_[i] = first.position[i] - readings.shaft_position[i];
  past_error_.assign(std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(gains.speed_window / record.step))), GroupAngles{});
  speed_window_ = step_ * static_cast<double>(past_error_.size());
}

Observer::Moment Observer::advance(const sim::DriveCommand& command, const Measured& measured) {
  const Moment moment = compare(measured);
  for (int n = 0; n < steps_; ++n) sim::step(machine_, command);
  return moment;
}

Observer::Moment Observer::compare(const Measured& measured) {
  Moment moment;
  const sim::MachineReadings readings = sim::read(machine_);
  for (std::size_t i = 0; i < groups_; ++i) {
    const double error = measured.position[i] - origin_[i] - readings.shaft_position[i];
    const double missing = gains_.speed * (error - past_error_[oldest_][i]) / speed_window_ + gains_.position * error;
    past_error_[oldest_][i] = error;
    moment.missing_torque[i] = missing;
    // Past the actuators: what is missing at a motor is not limited or delayed by its drive.
    machine_.outside.motor_torque[i] = missing * to_slew_axis_;
    // Gears without play touch always: they change flanks without a shock.
    const bool has_play = machine_.model.gear[i].half_play > 0.0, is_apart = has_play && machine_.state.contact[i] == 0;
    moment.contact_lost |= is_apart;
    moment.house_let_go &= is_apart;
    if (has_play) moment.holding_torque = std::min(moment.holding_torque, std::fabs(machine_.state.gear_torque[i]) / to_slew_axis_);
  }
  oldest_ = oldest_ + 1 < past_error_.size() ? oldest_ + 1 : 0;
  for (std::size_t a = 0; a < kAccelerometerCount; ++a) moment.acceleration[a] = readings.*kAccelerometers<sim::PlantReadings>[a].value;
  if (measured.tip_acceleration != nullptr) {
    const double difference = *measured.tip_acceleration - moment.acceleration[kTip];
    if (point_ < first_) {
      tip_offset_ += difference / static_cast<double>(first_);
    } else {
      tip_offset_ = forget_ * tip_offset_ + (1.0 - forget_) * difference;
      tip_error_ = leak_ * tip_error_ + step_ * (difference - tip_offset_);
    }
    machine_.outside.tip_force = gains_.tip_damping * tip_error_;
    ++point_;
  }
  return moment;
}

namespace {

void push(const MoreTorques& torques, std::size_t point, std::size_t groups, double to_slew_axis, sim::PortForces& outside) {
  double all = 0.0;
  for (std::size_t i = 0; i < groups; ++i) {
    const double torque = torques.of_group[i][point] * to_slew_axis;
    all += torque;
    if (!torques.is_on_house) outside.motor_torque[i] += torque;
  }
  if (torques.is_on_house) outside.house_torque = all;
}

}  // namespace

void Observer::push(const MoreTorques& torques, std::size_t point) { diagnosis::push(torques, point, groups_, to_slew_axis_, machine_.outside); }

void shadow(std::vector<Shadowing> shadowings, const Record& record, const DriveCourse& drives, const ShadowGains& gains) {
  const std::size_t count = record.size();
  const auto groups = static_cast<std::size_t>(record.group_count);
  std::vector<std::size_t> judged;  // accelerometers
  for (std::size_t a = 0; a < kAccelerometerCount; ++a) {
    if (!record.acceleration[a].empty()) judged.push_back(a);
  }
  std::vector<Observer> observers;
  std::vector<LaterReading> position;    // those that differ
  std::vector<std::size_t> reads_as;     // per machine, which of them
  observers.reserve(shadowings.size());  // machines stay where they are
  std::map<int, std::vector<sim::Machine*>> machines;  // by their steps per step of the grid
  for (Shadowing& shadowing : shadowings) {
    const double later = shadowing.encoder_latency / record.step + shadowing.follower.encoder_delay;
    const auto alike = std::find_if(position.begin(), position.end(), [&](const LaterReading& one) { return one.points() == later; });
    reads_as.push_back(static_cast<std::size_t>(alike - position.begin()));
    if (alike == position.end()) position.emplace_back(later);
    for (const MoreTorques* more : shadowing.more_torques) push(*more, 0, groups, shadowing.follower.to_slew_axis, shadowing.follower.machine.outside);
    observers.emplace_back(std::move(shadowing.follower), record, position[reads_as.back()].first(record), gains, shadowing.beginning);
    machines[observers.back().steps()].push_back(&observers.back().machine());
    Shadow& result = *shadowing.result;
    for (std::size_t g = 0; g < result.missing_torque.size(); ++g) result.missing_torque[g].resize(g < groups ? count : 0);
    for (std::size_t a = 0; a < kAccelerometerCount; ++a) result.acceleration_difference[a].resize(record.acceleration[a].empty() ? 0 : count);
    result.contact_lost.assign(count, false);
    result.house_let_go.assign(count, false);
    result.holding_torque.resize(count);
  }
  std::vector<std::pair<int, sim::MachineBatch>> batches;
  for (const auto& [steps, together] : machines) batches.emplace_back(steps, sim::make_machine_batch(together));
  const std::size_t per_point = drives.per_point;
  const DriveSeries& held = per_point > 1 ? drives.held : drives;
  const auto command_at = [&](const DriveSeries& course, std::size_t n, std::size_t command_number) {
    sim::DriveCommand command;
    command.sequence = drives.messages.sequence(command_number);
    command.enable = course.enable[n];
    for (std::size_t i = 0; i < groups; ++i) {
      command.motor_torque[i] = course.motor_torque[i][n];
      command.brake_torque[i] = course.brake_torque[i][n];
    }
    return command;
  };
  const bool has_tip = !record.acceleration[kTip].empty();
  std::vector<ReadAhead> ahead(position.size());
  Observer::Measured measured;
  for (std::size_t n = 0; n < count; ++n) {
    if (has_tip) measured.tip_acceleration = &record.acceleration[kTip][n];
    const std::size_t place = n % kAhead;
    for (std::size_t p = 0; place == 0 && p < position.size(); ++p) {
      for (std::size_t i = 0; i < groups; ++i) position[p].read(record.shaft_position[i], n, std::span(ahead[p][i]).first(std::min(kAhead, count - n)));
    }
    for (std::size_t f = 0; f < shadowings.size(); ++f) {
      for (std::size_t i = 0; i < groups; ++i) measured.position[i] = ahead[reads_as[f]][i][place];
      const Observer::Moment moment = observers[f].compare(measured);
      for (const MoreTorques* more : shadowings[f].more_torques) observers[f].push(*more, n);
      Shadow& result = *shadowings[f].result;
      for (std::size_t i = 0; i < groups; ++i) result.missing_torque[i][n] = moment.missing_torque[i];
      result.contact_lost[n] = moment.contact_lost;
      result.house_let_go[n] = moment.house_let_go;
      result.holding_torque[n] = moment.holding_torque;
      for (const std::size_t a : judged) {
        // Where sensors are not sampled on the grid, at first what the observer's would say.
        const double sensed = moment.acceleration[a];
        result.acceleration_difference[a][n] = record.sampled_at.empty() ? record.acceleration[a][n] - sensed : sensed;
      }
    }
    const sim::DriveCommand command = command_at(held, n, n * per_point);
    for (auto& [steps, batch] : batches) {
      const auto all = static_cast<std::size_t>(steps);
      const bool takes_each = per_point > 1 && all % per_point == 0;
      for (std::size_t step = 0; step < all; ++step) {
        const std::size_t one = n * per_point + step * per_point / all;
        sim::step(batch, takes_each ? command_at(drives, one, one) : command);
      }
    }
  }
  if (record.sampled_at.empty()) return;
  for (const Shadowing& shadowing : shadowings) {
    for (const std::size_t a : judged) sample_alike(record, a, shadowing.result->acceleration_difference[a]);
  }
}

}  // namespace slewlab::diagnosis
