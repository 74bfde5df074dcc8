// The passes against sums written out here, and the widths against each other to the bit.
#include "sim/integrate/modal_pass.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "sim/integrate/plant.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

constexpr int kBlocks = 5, kModes = kBlocks * kLanes;

std::vector<double> drawn(std::mt19937_64& generator, int count) {
  std::normal_distribution<double> normal;
  std::vector<double> values(static_cast<std::size_t>(count));
  for (double& value : values) value = normal(generator);
  return values;
}

struct Case {
  explicit Case(unsigned seed) : generator(seed) {}
  std::mt19937_64 generator;
  std::vector<double> free = drawn(generator, kModes* free_term::count);
  std::vector<double> end = drawn(generator, kModes* end_term::count);
  std::vector<double> held = drawn(generator, kModes* held_term::count);
  std::vector<double> shapes = drawn(generator, kModes* shape_term::count);
  std::vector<double> sensed = drawn(generator, kModes* sense_term::count);
  std::vector<double> places = drawn(generator, kModes* place_term::count);
  std::vector<double> q0 = drawn(generator, kModes);
  std::vector<double> v0 = drawn(generator, kModes);
};

struct Passed {
  std::vector<double> numbers;
};

Passed passed(const ModalPasses& passes, const Case& one, double house, double uniform) {
  std::vector<double> q(kModes), v(kModes);
  const FreeSums free = passes.free(kBlocks, one.free.data(), one.held.data(), one.shapes.data(), {1.3, -0.7, 2.1, 0.4, house, uniform},
                                    one.q0.data(), one.v0.data(), q.data(), v.data());
  Passed result{{free.angle, free.speed, free.acceleration_q, free.acceleration_v}};
  result.numbers.insert(result.numbers.end(), q.begin(), q.end());
  result.numbers.insert(result.numbers.end(), v.begin(), v.end());
  const EndSums end = passes.end(kBlocks, one.end.data(), one.held.data(), one.shapes.data(), {-0.9, 1.7, house}, q.data(), v.data());
  for (const double number : {end.tip, end.tip_velocity, end.acceleration_q, end.acceleration_v}) result.numbers.push_back(number);
  result.numbers.insert(result.numbers.end(), q.begin(), q.end());
  result.numbers.insert(result.numbers.end(), v.begin(), v.end());
  return result;
}

std::vector<double> sensed(const ModalPasses& passes, const Case& one) {
  const Accelerations a = passes.sense(kBlocks, one.sensed.data(), one.places.data(), {1.3, -0.7, 2.1}, one.q0.data(), one.v0.data());
  return {a.house, a.tip, a.boom, a.pivot, a.middle, a.tip_sensor};
}

TEST(ModalPass, AccelerationsAreTheSumOverTheModes) {
  const Case one(1);
  const std::vector<double> result = sensed(portable_passes(), one);
  ASSERT_EQ(result.size(), std::size_t{place_term::count});
  for (std::size_t n = 0; n < result.size(); ++n) {
    double sum = 0.0;
    for (int k = 0; k < kModes; ++k) {
      const auto mode = static_cast<std::size_t>(k);
      const auto term = [&](int which) { return one.sensed[place(k, which, sense_term::count)]; };
      const double acceleration = -term(sense_term::square) * one.q0[mode] - term(sense_term::damping_rate) * one.v0[mode] +
                                  1.3 * term(sense_term::house) - 0.7 * term(sense_term::tip) + 2.1 * term(sense_term::uniform);
      sum += one.places[mode * place_term::count + n] * acceleration;
    }
    EXPECT_NEAR(result[n], sum, 1e-12) << n;
  }
}

TEST(ModalPass, IsTheSumOfItsTerms) {
  const Case one(1);
  for (const auto& [house, uniform] : {std::pair(0.0, 0.0), std::pair(0.6, -1.1)}) {
    const Passed result = passed(portable_passes(), one, house, uniform);
    double angle = 0.0, speed = 0.0, tip = 0.0;
    for (int k = 0; k < kModes; ++k) {
      const auto mode = static_cast<std::size_t>(k);
      const auto free = [&](int term) { return one.free[place(k, term, free_term::count)]; };
      const auto end = [&](int term) { return one.end[place(k, term, end_term::count)]; };
      const auto held = [&](int term) { return one.held[place(k, term, held_term::count)]; };
      const auto shape = [&](int term) { return one.shapes[place(k, term, shape_term::count)]; };
      const double q = free(free_term::qq) * one.q0[mode] + free(free_term::qv) * one.v0[mode] + free(free_term::q_torque) * 1.3 -
                       free(free_term::q_rate) * 0.7 + free(free_term::q_tip) * 2.1 + free(free_term::q_tip_rate) * 0.4 +
                       held(held_term::q_house) * house + held(held_term::q_uniform) * uniform;
      const double v = free(free_term::vq) * one.q0[mode] + free(free_term::vv) * one.v0[mode] + free(free_term::v_torque) * 1.3 -
                       free(free_term::v_rate) * 0.7 + free(free_term::v_tip) * 2.1 + free(free_term::v_tip_rate) * 0.4 +
                       held(held_term::v_house) * house + held(held_term::v_uniform) * uniform;
      EXPECT_NEAR(result.numbers[4 + mode], q, 1e-13);
      EXPECT_NEAR(result.numbers[4 + kModes + mode], v, 1e-13);
      angle += shape(shape_term::house) * q;
      speed += shape(shape_term::house) * v;
      tip += shape(shape_term::tip) * (q - 0.9 * end(end_term::q_torque) + 1.7 * end(end_term::q_rate) + held(held_term::q_house) * house);
    }
    EXPECT_NEAR(result.numbers[0], angle, 1e-12);
    EXPECT_NEAR(result.numbers[1], speed, 1e-12);
    EXPECT_NEAR(result.numbers[4 + 2 * kModes], tip, 1e-12);
  }
}

TEST(ModalPass, EveryWidthGivesTheSameBits) {
  if (wide_passes() == nullptr) GTEST_SKIP() << "this processor has no vectors of four doubles";
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Case one(seed);
    const std::vector<double> narrow_sensed = sensed(portable_passes(), one), wide_sensed = sensed(*wide_passes(), one);
    for (std::size_t n = 0; n < narrow_sensed.size(); ++n) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(narrow_sensed[n]), std::bit_cast<std::uint64_t>(wide_sensed[n])) << seed << " " << n;
    }
    for (const auto& [house, uniform] : {std::pair(0.0, 0.0), std::pair(0.6, 0.0), std::pair(0.0, -1.1)}) {
      const Passed narrow = passed(portable_passes(), one, house, uniform), wide = passed(*wide_passes(), one, house, uniform);
      for (std::size_t i = 0; i < narrow.numbers.size(); ++i) {
        ASSERT_EQ(std::bit_cast<std::uint64_t>(narrow.numbers[i]), std::bit_cast<std::uint64_t>(wide.numbers[i])) << seed << " " << i;
      }
    }
  }
}

// The same of a whole slew to and fro with its impacts, of meshes that fill their last block and of such that do not.
TEST(ModalPass, AWholeRunHasTheSameBitsInEveryWidth) {
  if (wide_passes() == nullptr) GTEST_SKIP() << "this processor has no vectors of four doubles";
  for (const int elements : {2, 5, 6, 12}) {
    PlantModel models[2] = {make_plant_model(thesis_crane(elements), 1e-3), make_plant_model(thesis_crane(elements), 1e-3)};
    models[0].passes = &portable_passes();
    models[1].passes = wide_passes();
    PlantState states[2];
    for (int m = 0; m < 2; ++m) {
      PlantWorkspace workspace = make_plant_workspace(models[m]);
      states[m] = make_plant_state(models[m]);
      PlantInput input;
      for (int n = 0; n < 12000; ++n) {
        const double torque = n / 1500 % 2 == 0 ? 60.0 : -60.0;  // [Nm] the play is crossed at each change
        input.motor_torque = {torque, torque};
        step(models[m], workspace, input, states[m]);
      }
    }
    EXPECT_GT(states[0].contact_changes, 10);
    EXPECT_EQ(states[0].contact_changes, states[1].contact_changes);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(states[0].house_angle), std::bit_cast<std::uint64_t>(states[1].house_angle)) << elements;
    EXPECT_EQ(states[0].q, states[1].q) << elements;
    EXPECT_EQ(states[0].v, states[1].v) << elements;
  }
}

}  // namespace
}  // namespace slewlab::sim
