#include "sim/integrate/plant_model.h"

#include <algorithm>
#include <stdexcept>

#include "sim/model/boom.h"
#include "sim/model/cannot_be_built.h"
#include "sim/model/drive_line.h"

// Vectors are passed between functions that are all put in line.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace slewlab::sim {
namespace {

void discretise_gears(const PlantModel& model, double h, ModalStep& step) {
  for (int i = 0; i < model.group_count; ++i) {
    const double k = model.gear[i].stiffness, c = model.gear[i].damping;
    const double mobility = 1.0 / model.group_inertia[i];
    const double e00 = 1.0 + (0.15 * k * h * h + 0.5 * c * h) * mobility;
    const double e01 = -(k * h * h * h / 30.0 + c * h * h / 12.0) * mobility;
    const double e10 = (0.5 * k * h + c) * mobility;
    const double e11 = 1.0 - k * h * h / 12.0 * mobility;
    const double determinant = e00 * e11 - e01 * e10;
    GearStep& gear = step.gear[i];
    gear.reciprocal_inertia = mobility;
    gear.inverse[0][0] = e11 / determinant;
    gear.inverse[0][1] = -e01 / determinant;
    gear.inverse[1][0] = -e10 / determinant;
    gear.inverse[1][1] = e00 / determinant;
    for (int row = 0; row < 2; ++row) {
      gear.answer[row][0] = gear.inverse[row][0] * k;
      gear.answer[row][1] = gear.inverse[row][0] * c + gear.inverse[row][1] * k;
      gear.answer[row][2] = gear.inverse[row][1] * c;
    }
  }
}

using Block [[gnu::vector_size(32)]] = double;  // of modes, as in modal_pass.h
static_assert(sizeof(Block) == kLanes * sizeof(double));
struct BlockOf {
  Block value;
  explicit BlockOf(const double* from) { __builtin_memcpy(&value, from, sizeof value); }
};
void store(double* to, const Block& block) { __builtin_memcpy(to, &block, sizeof block); }

// What a block of modes adds to how the house answers the step, mode by mode: the order of these sums is that of the modes.
void add_house(const PlantModel& model, int first, const FourResponses& r, const double (*q_end)[kLanes], const double (*v_end)[kLanes],
               ModalStep& step) {
  for (int lane = 0; lane < std::min(kLanes, model.mode_count - first); ++lane) {
    const auto k = static_cast<std::size_t>(first) + static_cast<std::size_t>(lane);
    const double house = model.house[k], on_q = model.house_acceleration_q[k], on_v = model.house_acceleration_v[k];
    for (int j = 0; j < 2; ++j) {
      step.house[0][j] += house * q_end[j][lane];
      step.house[1][j] += house * v_end[j][lane];
      step.house[2][j] += on_q * q_end[j][lane] + on_v * v_end[j][lane];
    }
    step.house_angle_to_torque += house * house * r.q[0][lane];
    step.house_speed_to_torque += house * house * r.v[0][lane];
    step.house_acceleration_to_torque += house * (on_q * r.q[0][lane] + on_v * r.v[0][lane]);
  }
}

// Answers to the port `luffing`, of a boom that does.
[[gnu::noinline]] void discretise_luffing(const PlantModel& model, const StepLength& of_length, ModalStep& step) {
  for (double& answer : step.house_to_luffing) answer = 0.0;
  FourResponses r;
  for (int mode = 0; mode < model.mode_count; ++mode) {
    const auto k = static_cast<std::size_t>(mode);
    const int lane = mode % kLanes;
    if (lane == 0) four_responses(&model.square[k], &model.damping_rate[k], &model.fastest[k], of_length, r);
    const double q = step.luffing_q[k] = model.luffing[k] * r.q[0][lane];
    const double v = step.luffing_v[k] = model.luffing[k] * r.v[0][lane];
    step.house_to_luffing[0] += model.house[k] * q;
    step.house_to_luffing[1] += model.house[k] * v;
    step.house_to_luffing[2] += model.house_acceleration_q[k] * q + model.house_acceleration_v[k] * v;
  }
  step.house_to_luffing[2] += model.per_luffing.house;
}

// What the passes over the modes read, in the order in which they read it.
void put_in_blocks(PlantModel& model) {
  const auto put = [&](std::vector<double>& blocks, int terms, int term, const std::vector<double>& values) {
    blocks.resize(values.size() * static_cast<std::size_t>(terms));
    for (int k = 0; k < model.padded_count; ++k) blocks[place(k, term, terms)] = values[static_cast<std::size_t>(k)];
  };
  const auto put_shape = [&](int term, const std::vector<double>& values) { put(model.shapes, shape_term::count, term, values); };
  put_shape(shape_term::house, model.house);
  put_shape(shape_term::house_acceleration_q, model.house_acceleration_q);
  put_shape(shape_term::house_acceleration_v, model.house_acceleration_v);
  put_shape(shape_term::tip, model.tip);
  const auto put_sensed = [&](int term, const std::vector<double>& values) { put(model.sensed, sense_term::count, term, values); };
  put_sensed(sense_term::square, model.square);
  put_sensed(sense_term::damping_rate, model.damping_rate);
  put_sensed(sense_term::house, model.house);
  put_sensed(sense_term::tip, model.tip);
  put_sensed(sense_term::uniform, model.uniform);
  model.places.resize(model.house.size() * place_term::count);
  double* next = model.places.data();
  for (std::size_t k = 0; k < model.house.size(); ++k) {
    for (const double shape : {model.house[k], model.tip[k], model.uniform[k], model.pivot[k], model.middle[k], model.tip_sensor[k]}) *next++ = shape;
  }
}

// How what is measured and asked for answers the port `luffing`, of a boom that does.
void take_luffing(PlantModel& model) {
  Accelerations& per = model.per_luffing;
  per = {};
  for (std::size_t k = 0; k < model.luffing.size(); ++k) {
    const double luffing = model.luffing[k];
    per.house += model.house[k] * luffing;
    per.tip += model.tip[k] * luffing;
    per.boom += model.uniform[k] * luffing;
    per.pivot += model.pivot[k] * luffing;
    per.middle += model.middle[k] * luffing;
    per.tip_sensor += model.tip_sensor[k] * luffing;
  }
  model.full.luffing_q.resize(model.luffing.size(), 0.0);
  model.full.luffing_v.resize(model.luffing.size(), 0.0);
}

}  // namespace

void size_step(ModalStep& step, int padded_count) {
  const auto n = static_cast<std::size_t>(padded_count);
  step.free.assign(n * free_term::count, 0.0);
  step.end.assign(n * end_term::count, 0.0);
  step.held.assign(n * held_term::count, 0.0);
}

void discretise(const PlantModel& model, const StepLength& of_length, ModalStep& step) {
  const double h = of_length.length;
  step.length = h;
  if (!model.luffing.empty()) discretise_luffing(model, of_length, step);
  discretise_gears(model, h, step);
  for (auto& row : step.house) row[0] = row[1] = 0.0;
  step.house_angle_to_torque = step.house_speed_to_torque = 0.0;
  step.house_acceleration_to_torque = model.house_per_house_torque;
  FourResponses r;
  for (int first = 0; first < model.padded_count; first += kLanes) {
    four_responses(&model.square[first], &model.damping_rate[first], &model.fastest[first], of_length, r);
    double* const free = &step.free[place(first, 0, free_term::count)];
    double* const end = &step.end[place(first, 0, end_term::count)];
    double* const held = &step.held[place(first, 0, held_term::count)];
    const Block house = BlockOf(&model.house[first]).value, tip = BlockOf(&model.tip[first]).value,
                uniform = BlockOf(&model.uniform[first]).value;
    const auto put = [](double* terms, int term, const Block& block) { store(terms + term * kLanes, block); };
    put(free, free_term::qq, BlockOf(r.qq).value);
    put(free, free_term::qv, BlockOf(r.qv).value);
    const Block q_torque = house * BlockOf(r.q_value[0]).value;
    put(free, free_term::q_torque, q_torque);
    put(free, free_term::q_rate, house * BlockOf(r.q_rate[0]).value);
    put(free, free_term::q_tip, tip * BlockOf(r.q[0]).value);
    put(free, free_term::q_tip_rate, tip * BlockOf(r.q[1]).value);
    put(free, free_term::vq, BlockOf(r.vq).value);
    put(free, free_term::vv, BlockOf(r.vv).value);
    const Block v_torque = house * BlockOf(r.v_value[0]).value;
    put(free, free_term::v_torque, v_torque);
    put(free, free_term::v_rate, house * BlockOf(r.v_rate[0]).value);
    put(free, free_term::v_tip, tip * BlockOf(r.v[0]).value);
    put(free, free_term::v_tip_rate, tip * BlockOf(r.v[1]).value);
    double q_end[2][kLanes], v_end[2][kLanes];  // for T and T' at the end
    store(q_end[0], house * BlockOf(r.q_value[1]).value);
    store(q_end[1], house * BlockOf(r.q_rate[1]).value);
    store(v_end[0], house * BlockOf(r.v_value[1]).value);
    store(v_end[1], house * BlockOf(r.v_rate[1]).value);
    put(end, end_term::q_torque, BlockOf(q_end[0]).value);
    put(end, end_term::q_rate, BlockOf(q_end[1]).value);
    put(end, end_term::v_torque, BlockOf(v_end[0]).value);
    put(end, end_term::v_rate, BlockOf(v_end[1]).value);
    put(held, held_term::q_house, q_torque + BlockOf(q_end[0]).value);
    put(held, held_term::v_house, v_torque + BlockOf(v_end[0]).value);
    put(held, held_term::q_uniform, uniform * BlockOf(r.q[0]).value);
    put(held, held_term::v_uniform, uniform * BlockOf(r.v[0]).value);
    add_house(model, first, r, q_end, v_end, step);
  }
  step.house[2][0] += model.house_per_house_torque;
}

void work_out(const ModalStep& step, int group_count, unsigned is_in_contact, GearSystem& result) {
  result.answer = {};
  for (int i = 0; i < group_count; ++i) {
    if ((is_in_contact >> i & 1u) == 0) continue;
    for (int row = 0; row < 2; ++row) {
      for (int column = 0; column < 3; ++column) result.answer[row][column] += step.gear[i].answer[row][column];
    }
  }
  const auto& answer = result.answer;
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 2; ++column) {
      result.system[row][column] = (row == column ? 1.0 : 0.0) + answer[row][0] * step.house[0][column] +
                                   answer[row][1] * step.house[1][column] + answer[row][2] * step.house[2][column];
    }
  }
  result.scale = 1.0 / (result.system[0][0] * result.system[1][1] - result.system[0][1] * result.system[1][0]);
}

LoadStep discretise_load(const PlantModel& model, const StepLength& of_length) {
  const double h = of_length.length;
  LoadStep step{};
  if (!model.has_load) return step;
  const LoadOnSpring& load = model.load;
  FourResponses r;
  four_responses(model.load_square.data(), model.load_decay.data(), model.load_fastest.data(), of_length, r);
  for (int j = 0; j < 2; ++j) {
    step.qq[j] = r.qq[j];
    step.qv[j] = r.qv[j];
    step.vq[j] = r.vq[j];
    step.vv[j] = r.vv[j];
    const double displacement_in = load.modes(0, j) * load.rope_stiffness, damping_in = model.load_damping_in[j];
    const auto put_in = [&](double (&in)[4], double first, double second) {
      in[0] = displacement_in * (first - second / h);
      in[1] = displacement_in * second / h;
      in[2] = damping_in * (first - second / h);
      in[3] = damping_in * second / h;
    };
    put_in(step.q_in[j], r.q[0][j], r.q[1][j]);
    put_in(step.v_in[j], r.v[0][j], r.v[1][j]);
    step.q_force[j] = r.q[0][j];
    step.v_force[j] = r.v[0][j];
  }
  return step;
}

PlantModel make_plant_model(const CraneParameters& crane, double step) {
  GroupArray inertia{};
  std::array<GearContact, kMaximumGroupCount> gear{};
  inertia.fill(group_inertia(crane.drive));
  gear.fill(gear_contact(crane));
  return make_plant_model(crane, step, inertia, gear);
}

PlantModel make_plant_model(const CraneParameters& crane, double step, const GroupArray& group_inertia,
                            const std::array<GearContact, kMaximumGroupCount>& gear) {
  const int groups = crane.drive.group_count;
  if (!(step > 0.0)) throw std::invalid_argument("the plant's step must be greater than 0 s");
  if (groups < 1 || groups > kMaximumGroupCount) {
    throw std::invalid_argument("the number of motor groups must be 1 ... 8");
  }
  for (int i = 0; i < groups; ++i) {
    if (!crane.drive.is_rigid && !(group_inertia[i] > 0.0)) throw CannotBeBuilt("a motor group needs an inertia above 0");
    if (!crane.drive.is_rigid && !(gear[i].stiffness > 0.0)) throw CannotBeBuilt("gearboxes need a stiffness above 0");
  }
  if (!(driven_inertia(crane) > 0.0)) throw CannotBeBuilt("what the motors drive has no inertia");

  PlantModel model;
  model.parameters = crane;
  model.step = step;
  model.group_count = groups;
  model.ratio = total_ratio(crane.drive);
  model.gear = gear;
  model.group_inertia = group_inertia;
  model.modes = free_house_modes(crane);
  model.mode_count = static_cast<int>(model.modes.frequency.size());
  model.padded_count = block_count(model.mode_count) * kLanes;
  model.passes = &modal_passes();
  model.has_load = crane.load.mass > 0.0;
  model.has_axis_force = crane.axis_force.constant != 0.0 || crane.axis_force.gravity != 0.0;
  model.is_rigid = crane.drive.is_rigid;
  if (model.is_rigid) {
    if (model.mode_count > 1 || model.has_load) {
      throw std::invalid_argument("a rigid drive is stepped as one inertia: it goes with neither a boom that bends nor a load on a rope");
    }
    model.rigid_inertia = driven_inertia(crane);
    for (int i = 0; i < groups; ++i) model.rigid_inertia += group_inertia[i];
  }
  if (model.has_load) {
    model.load = load_on_spring(crane.load);
    const LoadOnSpring& load = model.load;
    const Eigen::Vector2d damping_in = load.modes.transpose() * load.damping.col(0);
    const Eigen::Vector2d decay = (load.modes.transpose() * load.damping * load.modes).diagonal();
    for (int j = 0; j < 2; ++j) {
      model.load_square[j] = load.frequency(j) * load.frequency(j);
      model.load_decay[j] = decay(j);
      model.load_fastest[j] = fastest_rate(model.load_square[j], decay(j));
      model.load_damping_in[j] = damping_in(j);
    }
  }
  size_step(model.full, model.padded_count);
  if (!model.is_rigid && groups <= kTabulatedGroups) model.full.systems.resize(std::size_t{1} << groups);
  take_modes(model);
  model.load_step = discretise_load(model, StepLength(step));
  return model;
}

void take_modes(PlantModel& model) {
  const FreeHouseModes& modes = model.modes;
  const auto count = static_cast<std::size_t>(model.padded_count);
  const auto pad = [&](const std::vector<double>& values, std::vector<double>& result) {
    result.resize(count, 0.0);
    std::copy(values.begin(), values.end(), result.begin());
  };
  pad(modes.house, model.house);
  pad(modes.pivot, model.pivot);
  pad(modes.tip, model.tip);
  pad(modes.tip, model.tip_sensor);
  for (std::size_t k = 0; k < modes.tip_twist.size(); ++k) {
    model.tip_sensor[k] -= model.parameters.boom.jib_eccentricity * modes.tip_twist[k];
  }
  pad(modes.middle, model.middle);
  pad(modes.uniform_load, model.uniform);
  pad(modes.damping_rate, model.damping_rate);
  pad(modes.frequency, model.square);
  for (double& value : model.square) value *= value;
  model.fastest.resize(count);
  model.house_acceleration_q.resize(count);
  model.house_acceleration_v.resize(count);
  model.house_per_house_torque = model.house_per_tip_force = model.house_per_uniform_force = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    model.fastest[k] = fastest_rate(model.square[k], model.damping_rate[k]);
    model.house_acceleration_q[k] = -model.house[k] * model.square[k];
    model.house_acceleration_v[k] = -model.house[k] * model.damping_rate[k];
    model.house_per_house_torque += model.house[k] * model.house[k];
    model.house_per_tip_force += model.house[k] * model.tip[k];
    model.house_per_uniform_force += model.house[k] * model.uniform[k];
  }
  put_in_blocks(model);
  if (model.is_rigid) return;
  if (!model.luffing.empty()) take_luffing(model);
  discretise(model, StepLength(model.step), model.full);
  for (unsigned gears = 0; gears < model.full.systems.size(); ++gears) work_out(model.full, model.group_count, gears, model.full.systems[gears]);
}

}  // namespace slewlab::sim
