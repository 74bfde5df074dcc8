/* What a program compiled from Structured Text (or from anything else) has to offer to be a controller in the loop:
 * a shared library with the two functions below, in plain C. slewlab-st-host loads it, speaks the wire's messages for it, and tells
 * it the time: there is no other clock. docs/structured_text.md has adapters for what compilers generate.
 *
 * Speeds and positions are those of the motor shafts, torques are per motor of a group, all in SI. */
#ifndef SLEWLAB_CONTROLLER_STRUCTURED_TEXT_ST_PROGRAM_H
#define SLEWLAB_CONTROLLER_STRUCTURED_TEXT_ST_PROGRAM_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { SLEWLAB_ST_GROUPS = 8 }; /* motor groups at most */

struct slewlab_st_inputs {
  int64_t simulated_time;                    /* [ns] since the start of the run; the program's only clock */
  int64_t reading_count;                     /* controller periods since the start of the run */
  int64_t group_count;
  double shaft_speed[SLEWLAB_ST_GROUPS];     /* [rad/s] */
  double shaft_position[SLEWLAB_ST_GROUPS];  /* [rad] since the start of the run */
  double speed_request;                      /* [-] -1 ... 1 of top speed */
  int32_t emergency_stop;                    /* 0 or 1, as all flags */
  int32_t acknowledge;
};

struct slewlab_st_outputs {
  double motor_torque[SLEWLAB_ST_GROUPS];         /* [N m] per motor */
  double ramped_speed;                            /* [rad/s] on the slew axis; this and what follows is for the log */
  double average_torque;                          /* [N m] */
  double offset_torque;                           /* [N m] */
  double proportional_torque[SLEWLAB_ST_GROUPS];  /* [N m] */
  double integral_torque[SLEWLAB_ST_GROUPS];      /* [N m] */
  int64_t mode;                                   /* as CONTROLLER_STATE has it */
  int32_t enable;
  int32_t brake;
  int32_t acknowledge;
};

/* Everything as at power-up, for a cycle of `period` [ns]. Answers 0, or a text that says why this program cannot run so. Called
 * before the first cycle of every run. */
const char* slewlab_st_start(int64_t period);

/* One cycle. */
void slewlab_st_cycle(const struct slewlab_st_inputs* inputs, struct slewlab_st_outputs* outputs);

#ifdef __cplusplus
}
#endif

#endif
