// Every machine of a batch against itself alone, to the bit: whatever its neighbours do, and in every width.
#include "sim/integrate/batch.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <vector>

#include "tests/common/allocation_guard.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

constexpr double kStep = 1e-3;  // [s]

std::vector<BatchWidth> widths() {
  std::vector<BatchWidth> supported;
  for (const BatchWidth width : {BatchWidth::portable, BatchWidth::four, BatchWidth::eight}) {
    if (is_supported(width)) supported.push_back(width);
  }
  return supported;
}

// What acts on a machine: held torques and forces, frictions, a force along the boom, each on or off and changed now and then.
struct Course {
  explicit Course(unsigned seed) : generator(seed) {}
  std::mt19937_64 generator;
  PlantInput input;

  double between(double low, double high) { return std::uniform_real_distribution(low, high)(generator); }
  bool chance(double share) { return between(0.0, 1.0) < share; }

  const PlantInput& at(int n, int groups) {
    if (n % 400 == 0) {
      input = {};
      const double torque = between(-90.0, 90.0);  // [Nm] of each motor
      for (int i = 0; i < groups; ++i) input.motor_torque[static_cast<std::size_t>(i)] = torque + between(-15.0, 15.0);
      if (chance(0.3)) input.ports.motor_torque[0] = between(-2e4, 2e4);
      if (chance(0.3)) input.ports.house_torque = between(-1e5, 1e5);
      if (chance(0.3)) input.ports.tip_force = between(-2e3, 2e3);
      if (chance(0.3)) input.ports.load_force = between(-2e3, 2e3);
      if (chance(0.2)) input.ports.rod_moment = between(-500.0, 500.0);
      if (chance(0.1)) input.ports.uniform_force = between(-30.0, 30.0);
      if (chance(0.1)) input.friction.motor[0] = between(0.0, 2e5);
      if (chance(0.1)) input.friction.house_positive = input.friction.house_negative = between(0.0, 1e5);
    }
    return input;
  }
};

CraneParameters varied(int elements, Course& course) {
  CraneParameters crane = thesis_crane(elements);
  const auto vary = [&](double& value) { value *= course.between(0.8, 1.2); };
  vary(crane.drive.gearbox_stiffness);
  vary(crane.drive.gearbox_play);
  vary(crane.house.inertia);
  vary(crane.boom.mass);
  vary(crane.load.mass);
  vary(crane.load.rope_length);
  return crane;
}

bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

void expect_same_bits(const PlantModel& model, const PlantState& a, const PlantState& b) {
  EXPECT_EQ(a.step_count, b.step_count);
  EXPECT_EQ(a.contact_changes, b.contact_changes);
  EXPECT_EQ(a.unsplit_steps, b.unsplit_steps);
  EXPECT_EQ(a.unsolved_frictions, b.unsolved_frictions);
  for (std::size_t i = 0; i < static_cast<std::size_t>(model.group_count); ++i) {
    EXPECT_TRUE(same(a.motor_angle[i], b.motor_angle[i])) << i;
    EXPECT_TRUE(same(a.motor_speed[i], b.motor_speed[i])) << i;
    EXPECT_TRUE(same(a.gear_torque[i], b.gear_torque[i])) << i;
    EXPECT_TRUE(same(a.motor_friction[i], b.motor_friction[i])) << i;
    EXPECT_EQ(a.contact[i], b.contact[i]);
    EXPECT_EQ(a.last_flank[i], b.last_flank[i]);
    EXPECT_EQ(a.play_crossings[i], b.play_crossings[i]);
  }
  for (std::size_t k = 0; k < a.q.size(); ++k) {
    EXPECT_TRUE(same(a.q[k], b.q[k])) << k;
    EXPECT_TRUE(same(a.v[k], b.v[k])) << k;
  }
  for (std::size_t j = 0; j < 2; ++j) {
    EXPECT_TRUE(same(a.load_q[j], b.load_q[j]));
    EXPECT_TRUE(same(a.load_v[j], b.load_v[j]));
  }
  const auto kept = [](const PlantState& s) {
    return std::vector{s.house_angle, s.house_speed, s.modal_house_acceleration, s.tip_displacement, s.tip_velocity, s.rope_force,
                       s.rope_force_rate, s.rope_damping_force, s.other_house_torque, s.other_tip_force, s.other_uniform_force,
                       s.house_friction, s.supplied_work};
  };
  const std::vector<double> of_a = kept(a), of_b = kept(b);
  for (std::size_t n = 0; n < of_a.size(); ++n) EXPECT_TRUE(same(of_a[n], of_b[n])) << n;
}

void expect_same_bits(const PlantReadings& a, const PlantReadings& b) {
  for (std::size_t i = 0; i < a.shaft_speed.size(); ++i) {
    EXPECT_TRUE(same(a.shaft_speed[i], b.shaft_speed[i]));
    EXPECT_TRUE(same(a.shaft_position[i], b.shaft_position[i]));
  }
  EXPECT_TRUE(same(a.house_acceleration, b.house_acceleration));
  EXPECT_TRUE(same(a.pivot_acceleration, b.pivot_acceleration));
  EXPECT_TRUE(same(a.middle_acceleration, b.middle_acceleration));
  EXPECT_TRUE(same(a.tip_acceleration, b.tip_acceleration));
  EXPECT_TRUE(same(a.slew_angle, b.slew_angle));
}

struct Fleet {
  std::vector<PlantModel> models;
  std::vector<Course> courses;

  std::vector<const PlantModel*> pointers() const {
    std::vector<const PlantModel*> result;
    for (const PlantModel& model : models) result.push_back(&model);
    return result;
  }
};

using Change = void (*)(CraneParameters&);

Fleet fleet(int count, int elements, Change change = nullptr) {
  Fleet made;
  for (int m = 0; m < count; ++m) {
    made.courses.emplace_back(static_cast<unsigned>(100 * elements + m));
    CraneParameters crane = varied(elements, made.courses.back());
    if (change != nullptr) change(crane);
    made.models.push_back(make_plant_model(crane, kStep));
  }
  return made;
}

// Steps the fleet in a batch and each machine alone, compares all the way, and says how many steps the batch took out of line.
std::int64_t compare(Fleet fleet, BatchWidth width, int steps, std::int64_t* contact_changes = nullptr) {
  const std::size_t count = fleet.models.size();
  const PlantBatchHandle batch = make_plant_batch(fleet.pointers(), width);
  std::vector<PlantWorkspace> workspaces;
  std::vector<PlantState> alone, together;
  for (const PlantModel& model : fleet.models) {
    workspaces.push_back(make_plant_workspace(model));
    alone.push_back(make_plant_state(model));
  }
  together = alone;
  std::vector<PlantInput> inputs(count);
  std::vector<PlantReadings> readings(count);
  for (int n = 0; n < steps && !testing::Test::HasFailure(); ++n) {
    for (std::size_t m = 0; m < count; ++m) {
      inputs[m] = fleet.courses[m].at(n, fleet.models[m].group_count);
      step(fleet.models[m], workspaces[m], inputs[m], alone[m]);
    }
    step_batch(*batch, inputs.data());
    if (n % 50 != 0 && n + 1 != steps) continue;
    read_batch(*batch, readings.data());
    for (std::size_t m = 0; m < count; ++m) {
      SCOPED_TRACE(testing::Message() << "machine " << m << " after step " << n + 1);
      state_of(*batch, static_cast<int>(m), together[m]);
      expect_same_bits(fleet.models[m], alone[m], together[m]);
      expect_same_bits(read(fleet.models[m], alone[m]), readings[m]);
    }
  }
  for (const PlantState& state : alone) {
    if (contact_changes != nullptr) *contact_changes += state.contact_changes;
  }
  return steps_out_of_line(*batch);
}

TEST(Batch, EveryMachineHasTheBitsThatItHasAlone) {
  for (const BatchWidth width : widths()) {
    for (const auto& [count, elements] : {std::pair(1, 6), std::pair(4, 2), std::pair(7, 5), std::pair(8, 6), std::pair(11, 12)}) {
      SCOPED_TRACE(testing::Message() << count << " machines of " << elements << " elements, width " << static_cast<int>(width));
      std::int64_t contact_changes = 0;
      const std::int64_t out_of_line = compare(fleet(count, elements), width, 6000, &contact_changes);
      EXPECT_GT(contact_changes, 10 * count) << "the courses must cross the play to say anything";
      EXPECT_GT(out_of_line, 0);
      EXPECT_LT(out_of_line, 3000 * count) << "most steps must stay in the lanes to say anything";
    }
  }
}

TEST(Batch, MachinesOfOtherTopologiesHaveTheirBitsToo) {
  const Change changes[] = {
      [](CraneParameters& crane) { crane.drive.group_count = 1; },
      [](CraneParameters& crane) { crane.drive.group_count = 4; },
      [](CraneParameters& crane) { crane.drive.gearbox_play = crane.drive.pinion_play = 0.0; },
      [](CraneParameters& crane) { crane.load.mass = 0.0; },
      [](CraneParameters& crane) { crane.axis_force.gravity = 5e4; },
  };
  for (const BatchWidth width : widths()) {
    for (const Change change : changes) compare(fleet(5, 3, change), width, 3000);
  }
}

TEST(Batch, AMachineMayStepByAPeriodOfItsOwn) {
  Fleet mixed = fleet(6, 4);
  for (std::size_t m = 0; m < mixed.models.size(); ++m) {
    mixed.models[m] = make_plant_model(mixed.models[m].parameters, m % 2 == 0 ? 1e-3 : 0.5e-3);
  }
  for (const BatchWidth width : widths()) compare(mixed, width, 2000);
}

TEST(Batch, AStateGoesIntoALaneAndOutOfItUnchanged) {
  Fleet machines = fleet(3, 6);
  PlantWorkspace workspace = make_plant_workspace(machines.models[1]);
  PlantState state = make_plant_state(machines.models[1]);
  for (int n = 0; n < 1000; ++n) step(machines.models[1], workspace, machines.courses[1].at(n, 2), state);
  for (const BatchWidth width : widths()) {
    const PlantBatchHandle batch = make_plant_batch(machines.pointers(), width);
    const std::vector<PlantInput> inputs(3);
    for (int n = 0; n < 10; ++n) step_batch(*batch, inputs.data());
    set_state(*batch, 1, state);
    PlantState back = make_plant_state(machines.models[1]);
    state_of(*batch, 1, back);
    expect_same_bits(machines.models[1], state, back);
  }
}

TEST(Batch, AStepAllocatesNothing) {
  for (const BatchWidth width : widths()) {
    Fleet machines = fleet(5, 6);
    const PlantBatchHandle batch = make_plant_batch(machines.pointers(), width);
    std::vector<PlantInput> inputs(5);
    std::vector<PlantReadings> readings(5);
    const tests::AllocationGuard guard;
    for (int n = 0; n < 3000; ++n) {
      for (std::size_t m = 0; m < 5; ++m) inputs[m] = machines.courses[m].at(n, 2);
      step_batch(*batch, inputs.data());
      read_batch(*batch, readings.data());
    }
    EXPECT_EQ(guard.count(), 0);
    EXPECT_GT(steps_out_of_line(*batch), 0) << "steps out of line must be among them";
  }
}

TEST(Batch, RefusesWhatIsNotOfOneTopology) {
  const PlantModel six = make_plant_model(thesis_crane(6), kStep), five = make_plant_model(thesis_crane(5), kStep);
  CraneParameters crane = thesis_crane(6);
  crane.load.mass = 0.0;
  const PlantModel unloaded = make_plant_model(crane, kStep);
  EXPECT_THROW(make_plant_batch({}), std::invalid_argument);
  EXPECT_THROW(make_plant_batch({&six, &five}), std::invalid_argument);
  EXPECT_THROW(make_plant_batch({&six, &unloaded}), std::invalid_argument);
  EXPECT_EQ(machine_count(*make_plant_batch({&six, &six})), 2);
}

}  // namespace
}  // namespace slewlab::sim
