#include "sim/integrate/batch.h"

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "sim/integrate/lanes.h"

namespace slewlab::sim {

namespace {

constexpr auto kAllBits = std::bit_cast<double>(~std::uint64_t{0});

// A machine out of line: its state as plant.h's step() takes it, of which only what no lane holds is kept between the steps.
struct Alone {
  const PlantModel* model = nullptr;
  PlantWorkspace workspace;
  PlantState state;
  double motors_per_group = 0.0, ratio = 1.0;
  double sensor_radius = 0.0, pivot_radius = 0.0;  // [m]
};

}  // namespace

struct PlantBatch {
  Topology topology;
  int lanes = 0;
  std::vector<Bundle> bundles;
  std::vector<unsigned> out;  // per bundle, by lane: machines that are out of line in the current step
  std::vector<Alone> alone;   // per machine
  std::int64_t steps = 0;
  std::int64_t out_of_line = 0;
  const LaneFunctions* functions = nullptr;
};

namespace {

// Calls `with(number of the state, row)` for every number of a state that lies in a lane.
template <class Number, class State>
void for_each_number(State& state, Number&& with) {
  using namespace state_row;
  with(state.house_angle, house_angle);
  with(state.house_speed, house_speed);
  with(state.modal_house_acceleration, modal_house_acceleration);
  with(state.tip_displacement, tip_displacement);
  with(state.tip_velocity, tip_velocity);
  with(state.rope_force, rope_force);
  with(state.rope_force_rate, rope_force_rate);
  with(state.rope_damping_force, rope_damping_force);
  with(state.other_house_torque, other_house_torque);
  with(state.other_tip_force, other_tip_force);
  with(state.other_uniform_force, other_uniform_force);
  with(state.house_friction, house_friction);
  with(state.supplied_work, supplied_work);
  for (int j = 0; j < 2; ++j) {
    with(state.load_q[static_cast<std::size_t>(j)], load_q + j);
    with(state.load_v[static_cast<std::size_t>(j)], load_v + j);
  }
}

void numbers_from_lane(const Topology& topology, const Bundle& bundle, int lane, PlantState& state) {
  for_each_number(state, [&](double& number, int row) { number = bundle.state.at(row, lane); });
  for (int i = 0; i < topology.groups; ++i) {
    const auto at = [&](int row) { return bundle.group_state.at(i * group_state_row::count + row, lane); };
    state.motor_angle[i] = at(group_state_row::angle);
    state.motor_speed[i] = at(group_state_row::speed);
    state.gear_torque[i] = at(group_state_row::torque);
    state.motor_friction[i] = at(group_state_row::friction);
  }
}

void from_lane(const Topology& topology, const Bundle& bundle, int lane, PlantState& state) {
  numbers_from_lane(topology, bundle, lane, state);
  for (int k = 0; k < topology.modes; ++k) {
    state.q[static_cast<std::size_t>(k)] = bundle.q.at(k, lane);
    state.v[static_cast<std::size_t>(k)] = bundle.v.at(k, lane);
  }
}

void into_lane(const Topology& topology, const PlantModel& model, Bundle& bundle, int lane, const PlantState& state) {
  for_each_number(state, [&](double number, int row) { bundle.state.at(row, lane) = number; });
  for (int i = 0; i < topology.groups; ++i) {
    const auto at = [&](int row) -> double& { return bundle.group_state.at(i * group_state_row::count + row, lane); };
    at(group_state_row::angle) = state.motor_angle[i];
    at(group_state_row::speed) = state.motor_speed[i];
    at(group_state_row::torque) = state.gear_torque[i];
    at(group_state_row::friction) = state.motor_friction[i];
    at(group_state_row::contact) = state.contact[i];
    at(group_state_row::touches) = state.contact[i] != 0 ? kAllBits : 0.0;
    at(group_state_row::edge) = state.contact[i] * model.gear[i].half_play;
  }
  const GearSystem gears = gear_system(model, state);
  for (int r = 0; r < 2; ++r) {
    for (int column = 0; column < 3; ++column) bundle.state.at(state_row::answer + 3 * r + column, lane) = gears.answer[r][column];
    for (int column = 0; column < 2; ++column) bundle.state.at(state_row::system + 2 * r + column, lane) = gears.system[r][column];
  }
  bundle.state.at(state_row::scale, lane) = gears.scale;
  for (int k = 0; k < topology.modes; ++k) {
    bundle.q.at(k, lane) = state.q[static_cast<std::size_t>(k)];
    bundle.v.at(k, lane) = state.v[static_cast<std::size_t>(k)];
  }
}

void fill_lane(const PlantModel& model, Bundle& bundle, int lane) {
  const auto machine = [&](int row) -> double& { return bundle.machines.at(row, lane); };
  machine(machine_row::step) = model.full.length;
  machine(machine_row::per_step) = 1.0 / model.full.length;
  for (int r = 0; r < 3; ++r) {
    for (int column = 0; column < 2; ++column) machine(machine_row::house + 2 * r + column) = model.full.house[r][column];
  }
  machine(machine_row::per_house_torque) = model.house_per_house_torque;
  machine(machine_row::per_tip_force) = model.house_per_tip_force;
  machine(machine_row::per_uniform_force) = model.house_per_uniform_force;
  machine(machine_row::rope_stiffness) = model.load.rope_stiffness;
  machine(machine_row::rope_damping) = model.load.damping(0, 0);
  machine(machine_row::rod_damping) = model.load.damping(0, 1);
  for (int r = 0; r < 2; ++r) {
    for (int column = 0; column < 2; ++column) machine(machine_row::load_modes + 2 * r + column) = model.load.modes(r, column);
  }
  const LoadStep& load = model.load_step;
  for (int j = 0; j < 2; ++j) {
    const auto term = [&](int n) -> double& { return machine(machine_row::load + j * machine_row::load_terms + n); };
    term(0) = load.qq[j];
    term(1) = load.qv[j];
    term(2) = load.vq[j];
    term(3) = load.vv[j];
    for (int n = 0; n < 4; ++n) {
      term(4 + n) = load.q_in[j][n];
      term(8 + n) = load.v_in[j][n];
    }
    term(12) = load.q_force[j];
    term(13) = load.v_force[j];
  }
  for (int i = 0; i < model.group_count; ++i) {
    const auto group = [&](int row) -> double& { return bundle.groups.at(i * group_row::count + row, lane); };
    const GearStep& gear = model.full.gear[static_cast<std::size_t>(i)];
    const GearContact& contact = model.gear[static_cast<std::size_t>(i)];
    group(group_row::stiffness) = contact.stiffness;
    group(group_row::damping) = contact.damping;
    group(group_row::damping_per_stiffness) = contact.damping / contact.stiffness;
    group(group_row::half_play) = contact.half_play;
    group(group_row::mobility) = gear.reciprocal_inertia;
    for (int r = 0; r < 2; ++r) {
      for (int column = 0; column < 2; ++column) group(group_row::inverse + 2 * r + column) = gear.inverse[r][column];
    }
  }
  for (int k = 0; k < model.mode_count; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const auto mode = [&](int row) -> double& { return bundle.modes.at(k * mode_row::count + row, lane); };
    const auto sensor = [&](int row) -> double& { return bundle.sensors.at(k * sensor_row::count + row, lane); };
    const auto free = [&](int term) { return model.full.free[place(k, term, free_term::count)]; };
    mode(mode_row::qq) = free(free_term::qq);
    mode(mode_row::qv) = free(free_term::qv);
    mode(mode_row::q_torque) = free(free_term::q_torque);
    mode(mode_row::q_rate) = free(free_term::q_rate);
    mode(mode_row::tip_once) = free(free_term::q_tip);
    mode(mode_row::q_tip_rate) = free(free_term::q_tip_rate);
    mode(mode_row::vq) = free(free_term::vq);
    mode(mode_row::vv) = free(free_term::vv);
    mode(mode_row::v_torque) = free(free_term::v_torque);
    mode(mode_row::v_rate) = free(free_term::v_rate);
    mode(mode_row::v_tip) = free(free_term::v_tip);
    for (int term = 0; term < end_term::count; ++term) mode(mode_row::end_q_torque + term) = model.full.end[place(k, term, end_term::count)];
    for (int term = 0; term < held_term::count; ++term) mode(mode_row::q_house + term) = model.full.held[place(k, term, held_term::count)];
    mode(mode_row::house) = sensor(sensor_row::house) = model.house[at];
    mode(mode_row::house_acceleration_q) = model.house_acceleration_q[at];
    mode(mode_row::house_acceleration_v) = model.house_acceleration_v[at];
    mode(mode_row::tip) = sensor(sensor_row::tip) = model.tip[at];
    sensor(sensor_row::square) = model.square[at];
    sensor(sensor_row::damping_rate) = model.damping_rate[at];
    sensor(sensor_row::uniform) = model.uniform[at];
    sensor(sensor_row::pivot) = model.pivot[at];
    sensor(sensor_row::middle) = model.middle[at];
    sensor(sensor_row::tip_sensor) = model.tip_sensor[at];
  }
}

// As step() of plant.cpp. True where the machine has to be taken out: friction, or a force along the boom.
bool fill_push(const Topology& topology, const Alone& alone, const PlantInput& input, Bundle& bundle, int lane) {
  bool out = input.friction.house_positive > 0.0 || input.friction.house_negative > 0.0 || input.ports.uniform_force != 0.0;
  for (int i = 0; i < topology.groups; ++i) {
    bundle.push.at(push_row::motor + i, lane) = input.motor_torque[i] * alone.motors_per_group * alone.ratio + input.ports.motor_torque[i];
    out = out || input.friction.motor[i] > 0.0;
  }
  double house = input.ports.house_torque;
  if (alone.model->has_axis_force) {
    const double angle = bundle.state.at(state_row::house_angle, lane), speed = bundle.state.at(state_row::house_speed, lane);
    house += axis_force_at(alone.model->parameters.axis_force, angle + 0.5 * alone.model->step * speed);
  }
  bundle.has_held = bundle.has_held || house != 0.0;
  bundle.push.at(push_row::house, lane) = house;
  bundle.push.at(push_row::is_held, lane) = house != 0.0 ? kAllBits : 0.0;
  bundle.push.at(push_row::tip, lane) = input.ports.tip_force;
  bundle.push.at(push_row::load, lane) = input.ports.load_force;
  bundle.push.at(push_row::rod, lane) = input.ports.rod_moment;
  return out;
}

template <class Do>
void for_each_lane(unsigned lanes, Do&& act) {
  for (; lanes != 0; lanes &= lanes - 1) act(std::countr_zero(lanes));
}

// A step of machines, from their lanes' states, which stay as they are; the ends wait in `alone`.
[[gnu::noinline]] void step_out_of_line(PlantBatch& batch, const Bundle& bundle, unsigned lanes, const PlantInput* inputs) {
  for_each_lane(lanes, [&](int lane) {
    const int machine = bundle.first + lane;
    Alone& alone = batch.alone[static_cast<std::size_t>(machine)];
    from_lane(batch.topology, bundle, lane, alone.state);
    step(*alone.model, alone.workspace, inputs[machine], alone.state);
    --alone.state.step_count;  // counted for all machines together
    ++batch.out_of_line;
  });
}

[[gnu::noinline]] void take_back(PlantBatch& batch, Bundle& bundle, unsigned lanes) {
  for_each_lane(lanes, [&](int lane) {
    const Alone& alone = batch.alone[static_cast<std::size_t>(bundle.first) + static_cast<std::size_t>(lane)];
    into_lane(batch.topology, *alone.model, bundle, lane, alone.state);
  });
}

unsigned used_lanes(const Bundle& bundle) { return (1u << bundle.used) - 1u; }

}  // namespace

bool is_supported(BatchWidth width) {
  if (width == BatchWidth::portable) return true;
#ifdef __x86_64__
  if (width == BatchWidth::four) return __builtin_cpu_supports("avx2");
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
#else
  return false;
#endif
}

BatchWidth usual_width(int machines) {
  if (machines > 4 && is_supported(BatchWidth::eight)) return BatchWidth::eight;
  return is_supported(BatchWidth::four) ? BatchWidth::four : BatchWidth::portable;
}

void FreePlantBatch::operator()(PlantBatch* batch) const { delete batch; }

PlantBatchHandle make_plant_batch(const std::vector<const PlantModel*>& models, BatchWidth width) {
  if (models.empty()) throw std::invalid_argument("a batch needs at least one machine");
  if (!is_supported(width)) throw std::invalid_argument("this processor has no vectors of the width that the batch asks for");
  const PlantModel& first = *models.front();
  for (const PlantModel* const model : models) {
    if (model->is_rigid) throw std::invalid_argument("a machine with a rigid drive is one inertia, which is not stepped in a batch");
    if (!model->luffing.empty()) throw std::invalid_argument("a boom that luffs changes its modes as it goes, which the lanes of a batch do not");
    if (model->group_count != first.group_count || model->mode_count != first.mode_count || model->has_load != first.has_load) {
      throw std::invalid_argument("the machines of a batch need the same number of motor groups and modes, and all a load or none");
    }
  }
  PlantBatchHandle batch(new PlantBatch);
  batch->topology = {first.group_count, first.mode_count, first.has_load};
  batch->lanes = width == BatchWidth::eight ? 8 : 4;
  batch->functions = width == BatchWidth::eight  ? &eight_wide_lanes()
                     : width == BatchWidth::four ? &four_wide_lanes()
                                                 : &four_portable_lanes();
  const int count = static_cast<int>(models.size()), lanes = batch->lanes;
  for (const PlantModel* const model : models) {
    batch->alone.push_back({model, make_plant_workspace(*model), make_plant_state(*model),
                            static_cast<double>(model->parameters.drive.motors_per_group), model->ratio,
                            model->parameters.house.sensor_radius, model->parameters.boom.pivot_radius});
  }
  const int whole_pairs = (first.mode_count + 1) / 2 * 2;
  for (int from = 0; from < count; from += lanes) {
    Bundle bundle;
    bundle.first = from;
    bundle.used = std::min(lanes, count - from);
    bundle.modes.size(whole_pairs * mode_row::count, lanes);
    bundle.sensors.size(whole_pairs * sensor_row::count, lanes);
    bundle.machines.size(machine_row::count, lanes);
    bundle.groups.size(first.group_count * group_row::count, lanes);
    bundle.state.size(state_row::count, lanes);
    bundle.group_state.size(first.group_count * group_state_row::count, lanes);
    for (Rows* const rows : {&bundle.q, &bundle.v, &bundle.q_end, &bundle.v_end}) rows->size(whole_pairs, lanes);
    bundle.push.size(push_row::count, lanes);
    bundle.trial.size(trial_row::count, lanes);
    for (int lane = 0; lane < lanes; ++lane) {
      const auto machine = static_cast<std::size_t>(std::min(from + lane, count - 1));
      fill_lane(*models[machine], bundle, lane);
      into_lane(batch->topology, *models[machine], bundle, lane, batch->alone[machine].state);
    }
    batch->bundles.push_back(std::move(bundle));
  }
  batch->out.resize(batch->bundles.size());
  return batch;
}

PlantBatchHandle make_plant_batch(const std::vector<const PlantModel*>& models) {
  return make_plant_batch(models, usual_width(static_cast<int>(models.size())));
}

int machine_count(const PlantBatch& batch) { return static_cast<int>(batch.alone.size()); }

void set_state(PlantBatch& batch, int machine, const PlantState& state) {
  Alone& alone = batch.alone[static_cast<std::size_t>(machine)];
  alone.state = state;
  alone.state.step_count -= batch.steps;
  into_lane(batch.topology, *alone.model, batch.bundles[static_cast<std::size_t>(machine / batch.lanes)], machine % batch.lanes, alone.state);
}

void state_of(const PlantBatch& batch, int machine, PlantState& state) {
  state = batch.alone[static_cast<std::size_t>(machine)].state;
  state.step_count += batch.steps;
  from_lane(batch.topology, batch.bundles[static_cast<std::size_t>(machine / batch.lanes)], machine % batch.lanes, state);
}

void step_batch(PlantBatch& batch, const PlantInput* inputs) {
  // All bundles' inputs first: a vector load of what was written number by number a moment ago would wait for the writes.
  for (std::size_t b = 0; b < batch.bundles.size(); ++b) {
    Bundle& bundle = batch.bundles[b];
    bundle.has_held = false;
    unsigned out = 0;
    for (int lane = 0; lane < bundle.used; ++lane) {
      const int machine = bundle.first + lane;
      if (fill_push(batch.topology, batch.alone[static_cast<std::size_t>(machine)], inputs[machine], bundle, lane)) out |= 1u << lane;
    }
    batch.out[b] = out;
  }
  for (std::size_t begin = 0; begin < batch.bundles.size(); begin += kBundlesTogether) {
    const std::size_t end = std::min(begin + kBundlesTogether, batch.bundles.size());
    const int count = static_cast<int>(end - begin);
    Bundle* const bundles = &batch.bundles[begin];
    bool has_lanes = false;
    for (std::size_t b = begin; b < end; ++b) has_lanes = has_lanes || batch.out[b] != used_lanes(batch.bundles[b]);
    if (has_lanes) {
      batch.functions->attempt(batch.topology, bundles, count);
      for (std::size_t b = begin; b < end; ++b) batch.out[b] |= batch.bundles[b].may_change & used_lanes(batch.bundles[b]);
    }
    for (std::size_t b = begin; b < end; ++b) {
      if (batch.out[b] != 0) step_out_of_line(batch, batch.bundles[b], batch.out[b], inputs);
    }
    if (has_lanes) batch.functions->accept(batch.topology, bundles, count);
    for (std::size_t b = begin; b < end; ++b) {
      if (batch.out[b] != 0) take_back(batch, batch.bundles[b], batch.out[b]);
    }
  }
  ++batch.steps;
}

std::int64_t steps_out_of_line(const PlantBatch& batch) { return batch.out_of_line; }

void read_batch(const PlantBatch& batch, PlantReadings* readings) {
  for (const Bundle& bundle : batch.bundles) {
    LaneAccelerations accelerations;
    batch.functions->accelerations(batch.topology, bundle, accelerations);
    for (int lane = 0; lane < bundle.used; ++lane) {
      const Alone& alone = batch.alone[static_cast<std::size_t>(bundle.first) + static_cast<std::size_t>(lane)];
      const auto acceleration = [&](int place) { return accelerations.rows[place].number[lane]; };
      PlantReadings& reading = readings[bundle.first + lane];
      reading = {};
      for (int i = 0; i < batch.topology.groups; ++i) {
        const auto of_group = [&](int row) { return bundle.group_state.at(i * group_state_row::count + row, lane); };
        reading.shaft_speed[i] = of_group(group_state_row::speed) * alone.ratio;
        reading.shaft_position[i] = of_group(group_state_row::angle) * alone.ratio;
      }
      reading.house_acceleration = alone.sensor_radius * acceleration(place_term::pivot);
      reading.pivot_acceleration = alone.pivot_radius * acceleration(place_term::pivot);
      reading.middle_acceleration = acceleration(place_term::middle);
      reading.tip_acceleration = acceleration(place_term::tip_sensor);
      reading.slew_angle = bundle.state.at(state_row::house_angle, lane);
    }
  }
}

void observe_batch(const PlantBatch& batch, PlantState* const* states, Accelerations* const* accelerations) {
  for (const Bundle& bundle : batch.bundles) {
    LaneAccelerations of_lanes;
    batch.functions->accelerations(batch.topology, bundle, of_lanes);
    for (int lane = 0; lane < bundle.used; ++lane) {
      const int machine = bundle.first + lane;
      const PlantState& kept = batch.alone[static_cast<std::size_t>(machine)].state;
      PlantState& state = *states[machine];
      numbers_from_lane(batch.topology, bundle, lane, state);
      state.step_count = kept.step_count + batch.steps;
      if (state.contact_changes != kept.contact_changes) {
        state.contact = kept.contact;
        state.last_flank = kept.last_flank;
        state.play_crossings = kept.play_crossings;
        state.contact_changes = kept.contact_changes;
      }
      state.unsplit_steps = kept.unsplit_steps;
      state.unsolved_frictions = kept.unsolved_frictions;
      const auto at = [&](int place) { return of_lanes.rows[place].number[lane]; };
      *accelerations[machine] = {at(place_term::house), at(place_term::tip), at(place_term::boom), at(place_term::pivot), at(place_term::middle),
                                 at(place_term::tip_sensor)};
    }
  }
}

}  // namespace slewlab::sim
