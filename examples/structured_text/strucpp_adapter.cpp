// Makes what STruC++ generates from a Structured Text program a controller in the loop: it gives the generated program its clock and its
// located variables, and st_program.h's two functions to slewlab-st-host.
//
//   strucpp slewing_controller.st -o generated/slewing.cpp
//   c++ -std=c++17 -shared -fPIC -I SLEWLAB -I STRUCPP_RUNTIME -o slewing.so strucpp_adapter.cpp generated/slewing.cpp
//       -include generated/slewing.hpp -DPROGRAM=Program_SLEWING -DINTERVAL_NS=10000000      (all on one line)
//   slewlab run SCENARIO.yaml --controller "exec slewlab-st-host slewing.so"
//
// A variable gets its signal by its place, as with matiec_adapter.c; a place that the program does not have is left out. What the table
// of located variables does not say is whether 64 bits are a number or a count: the places of docs/structured_text.md do.

#include <cstdint>
#include <cstdio>
#include <memory>

#include "controller/structured_text/st_program.h"
#include "examples/structured_text/places.h"

namespace {

// strucpp::LocatedVar's enumerations, in their order.
enum Area { kInput = 0, kOutput = 1 };
enum Size { kBit = 0, kDoubleWord = 3, kLongWord = 4 };

std::unique_ptr<strucpp::PROGRAM> program;

void* memory_of(Area area, Size size, int byte, int bit = 0) {
  for (std::uint32_t i = 0; i < strucpp::locatedVarsCount; ++i) {
    const strucpp::LocatedVar& each = strucpp::locatedVars[i];
    if (static_cast<int>(each.area) == area && static_cast<int>(each.size) == size && each.byte_index == byte && each.bit_index == bit) {
      return each.pointer;
    }
  }
  return nullptr;
}

// Long has 64 bits, Short has 32 and may stand in its stead.
template <typename Long, typename Short, typename Value>
void put(int byte, Value value) {
  if (void* memory = memory_of(kInput, kLongWord, byte)) *static_cast<Long*>(memory) = static_cast<Long>(value);
  else if (void* small = memory_of(kInput, kDoubleWord, byte)) *static_cast<Short*>(small) = static_cast<Short>(value);
}

template <typename Long, typename Short>
Long taken(int byte) {
  if (const void* memory = memory_of(kOutput, kLongWord, byte)) return *static_cast<const Long*>(memory);
  if (const void* small = memory_of(kOutput, kDoubleWord, byte)) return *static_cast<const Short*>(small);
  return 0;
}

void put_real(int byte, double value) { put<double, float>(byte, value); }
void put_whole(int byte, std::int64_t value) { put<std::int64_t, std::int32_t>(byte, value); }
double real(int byte) { return taken<double, float>(byte); }

void put_bit(int bit, bool value) {
  if (void* memory = memory_of(kInput, kBit, FLAGS, bit)) *static_cast<bool*>(memory) = value;
}

bool bit(int number) {
  const void* memory = memory_of(kOutput, kBit, FLAGS, number);
  return memory != nullptr && *static_cast<const bool*>(memory);
}

char problem[160];

}  // namespace

const char* slewlab_st_start(std::int64_t period) {
  if (period != INTERVAL_NS) {
    std::snprintf(problem, sizeof problem, "its task has an interval of %g ms, the run asks every %g ms; set controller_period or INTERVAL",
                  INTERVAL_NS * 1e-6, static_cast<double>(period) * 1e-6);
    return problem;
  }
  strucpp::__CURRENT_TIME_NS = 0;
  program = std::make_unique<strucpp::PROGRAM>();
  if (memory_of(kOutput, kLongWord, MOTOR_TORQUE) == nullptr && memory_of(kOutput, kDoubleWord, MOTOR_TORQUE) == nullptr) {
    return "it has no variable AT %QL0, the torque of the first motor group";
  }
  return memory_of(kOutput, kBit, FLAGS, 0) == nullptr ? "it has no variable AT %QX2000.0, which enables the drives" : nullptr;
}

void slewlab_st_cycle(const slewlab_st_inputs* inputs, slewlab_st_outputs* outputs) {
  put_real(SPEED_REQUEST, inputs->speed_request);
  for (int i = 0; i < SLEWLAB_ST_GROUPS; ++i) {
    put_real(SHAFT_SPEED + NUMBER * i, inputs->shaft_speed[i]);
    put_real(SHAFT_POSITION + NUMBER * i, inputs->shaft_position[i]);
  }
  put_whole(READING_COUNT, inputs->reading_count);
  put_whole(READING_TIME, inputs->simulated_time);
  put_whole(READING_GROUPS, inputs->group_count);
  put_bit(0, inputs->emergency_stop != 0);
  put_bit(1, inputs->acknowledge != 0);

  strucpp::__CURRENT_TIME_NS = inputs->simulated_time;
  program->run();

  for (int i = 0; i < SLEWLAB_ST_GROUPS; ++i) {
    outputs->motor_torque[i] = real(MOTOR_TORQUE + NUMBER * i);
    outputs->proportional_torque[i] = real(PROPORTIONAL + NUMBER * i);
    outputs->integral_torque[i] = real(INTEGRAL + NUMBER * i);
  }
  outputs->ramped_speed = real(RAMPED_SPEED);
  outputs->average_torque = real(AVERAGE_TORQUE);
  outputs->offset_torque = real(OFFSET_TORQUE);
  outputs->mode = taken<std::int64_t, std::int32_t>(MODE);
  outputs->enable = bit(0);
  outputs->brake = bit(1);
  outputs->acknowledge = bit(2);
}
