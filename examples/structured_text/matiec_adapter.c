/* Makes what MatIEC (iec2c) generates from a Structured Text program a controller in the loop: it gives the generated code its clock
 * and its located variables, and st_program.h's two functions to slewlab-st-host.
 *
 *   iec2c -I matiec/lib -T generated slewing_controller.st
 *   cc -shared -fPIC -I SLEWLAB -I matiec/lib/C -I generated -o slewing.so matiec_adapter.c generated/Crane.c \
 *      generated/Plc.c -lm
 *   slewlab run SCENARIO.yaml --controller "slewlab-st-host slewing.so"
 *
 * A variable of the program gets its signal by its place (AT %IL8), in either size: %IL8 as LREAL or LINT, %ID8 as REAL or DINT.
 * A place that the program does not have is left out. The places are those of docs/structured_text.md. */

#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "controller/structured_text/st_program.h"
#include "examples/structured_text/places.h"
#include "iec_std_lib.h" /* MatIEC's: the types of IEC 61131-3, IEC_TIME */

/* What the generated code has. */
extern unsigned long long common_ticktime__; /* [ns] greatest common divisor of its tasks' intervals */
void config_init__(void);
void config_run__(unsigned long tick);

/* What the generated code wants: the time, and whether values are forced by a debugger. */
TIME __CURRENT_TIME;
BOOL __DEBUG = 0;

/* Memory for each located variable, and a pointer of its name to it: LREAL *__IL8. */
#define __LOCATED_VAR(type, name, ...) \
  static type memory_of##name;         \
  type* name = &memory_of##name;
#include "LOCATED_VARIABLES.h"
#undef __LOCATED_VAR

struct place {
  const char* name; /* "__IL8" */
  const char* type; /* "LREAL" */
  void* memory;
};

static const struct place places[] = {
#define __LOCATED_VAR(type, name, ...) {#name, #type, &memory_of##name},
#include "LOCATED_VARIABLES.h"
#undef __LOCATED_VAR
};
enum { PLACES = sizeof places / sizeof places[0] };

static const struct place* place_called(const char* name) {
  for (int i = 0; i < PLACES; ++i) {
    if (strcmp(places[i].name, name) == 0) return &places[i];
  }
  return 0;
}

static const struct place* place_of(char area, int byte) {
  char name[24];
  snprintf(name, sizeof name, "__%cL%d", area, byte);
  const struct place* found = place_called(name);
  if (found) return found;
  snprintf(name, sizeof name, "__%cD%d", area, byte);
  return place_called(name);
}

static const struct place* bit_at(char area, int byte, int bit) {
  char name[24];
  snprintf(name, sizeof name, "__%cX%d_%d", area, byte, bit);
  return place_called(name);
}

static void put(int byte, double number, int64_t whole) {
  const struct place* place = place_of('I', byte);
  if (!place) return;
  if (strcmp(place->type, "LREAL") == 0) *(LREAL*)place->memory = number;
  if (strcmp(place->type, "REAL") == 0) *(REAL*)place->memory = (REAL)number;
  if (strcmp(place->type, "LINT") == 0) *(LINT*)place->memory = whole;
  if (strcmp(place->type, "DINT") == 0) *(DINT*)place->memory = (DINT)whole;
}

static void put_real(int byte, double number) { put(byte, number, (int64_t)number); }
static void put_whole(int byte, int64_t number) { put(byte, (double)number, number); }

static double taken(int byte) {
  const struct place* place = place_of('Q', byte);
  if (!place) return 0.0;
  if (strcmp(place->type, "LREAL") == 0) return *(LREAL*)place->memory;
  if (strcmp(place->type, "REAL") == 0) return *(REAL*)place->memory;
  if (strcmp(place->type, "LINT") == 0) return (double)*(LINT*)place->memory;
  return strcmp(place->type, "DINT") == 0 ? *(DINT*)place->memory : 0.0;
}

static void put_bit(int byte, int bit, int value) {
  const struct place* place = bit_at('I', byte, bit);
  if (place) *(BOOL*)place->memory = value != 0;
}

static int32_t taken_bit(int byte, int bit) {
  const struct place* place = bit_at('Q', byte, bit);
  return place && *(BOOL*)place->memory != 0;
}

static char problem[160];

static unsigned long tick; /* cycles since the start */

const char* slewlab_st_start(int64_t period) {
  if ((int64_t)common_ticktime__ != period) {
    snprintf(problem, sizeof problem, "its task has an interval of %g ms, the run asks every %g ms; set controller_period or INTERVAL",
             (double)common_ticktime__ * 1e-6, (double)period * 1e-6);
    return problem;
  }
  if (!place_of('Q', MOTOR_TORQUE)) return "it has no variable AT %QL0, the torque of the first motor group";
  if (!bit_at('Q', FLAGS, 0)) return "it has no variable AT %QX2000.0, which enables the drives";
#define __LOCATED_VAR(type, name, ...) memset(&memory_of##name, 0, sizeof memory_of##name);
#include "LOCATED_VARIABLES.h"
#undef __LOCATED_VAR
  __CURRENT_TIME.tv_sec = 0;
  __CURRENT_TIME.tv_nsec = 0;
  tick = 0;
  config_init__();
  return 0;
}

void slewlab_st_cycle(const struct slewlab_st_inputs* inputs, struct slewlab_st_outputs* outputs) {
  put_real(SPEED_REQUEST, inputs->speed_request);
  for (int i = 0; i < SLEWLAB_ST_GROUPS; ++i) {
    put_real(SHAFT_SPEED + NUMBER * i, inputs->shaft_speed[i]);
    put_real(SHAFT_POSITION + NUMBER * i, inputs->shaft_position[i]);
  }
  put_whole(READING_COUNT, inputs->reading_count);
  put_whole(READING_TIME, inputs->simulated_time);
  put_whole(READING_GROUPS, inputs->group_count);
  put_bit(FLAGS, 0, inputs->emergency_stop);
  put_bit(FLAGS, 1, inputs->acknowledge);

  __CURRENT_TIME.tv_sec = (long)(inputs->simulated_time / 1000000000);
  __CURRENT_TIME.tv_nsec = (long)(inputs->simulated_time % 1000000000);
  config_run__(tick++);

  for (int i = 0; i < SLEWLAB_ST_GROUPS; ++i) {
    outputs->motor_torque[i] = taken(MOTOR_TORQUE + NUMBER * i);
    outputs->proportional_torque[i] = taken(PROPORTIONAL + NUMBER * i);
    outputs->integral_torque[i] = taken(INTEGRAL + NUMBER * i);
  }
  outputs->ramped_speed = taken(RAMPED_SPEED);
  outputs->average_torque = taken(AVERAGE_TORQUE);
  outputs->offset_torque = taken(OFFSET_TORQUE);
  outputs->mode = (int64_t)taken(MODE);
  outputs->enable = taken_bit(FLAGS, 0);
  outputs->brake = taken_bit(FLAGS, 1);
  outputs->acknowledge = taken_bit(FLAGS, 2);
}
