/* The slewing controller of T.A. van Vugt's thesis (3.5) in one file of plain C: a controller of one's own to start from.
 *
 *   find msgs -name '*.lcm' | xargs lcm-gen -c --c-cpath . --c-hpath .      (makes slewlab_msgs_*.c and .h)
 *   cc controller.c slewlab_msgs_*.c -llcm -lm -o controller
 *   slewlab run config/scenarios/thesis_slew.yaml --controller ./controller
 *
 * What plant and controller say to each other: docs/wire.md. Speeds are those of the slew axis [rad/s] unless they are
 * called shaft speeds (fast axis, at the motor); torques are per motor [N m]; time is in seconds. */

#include <lcm/lcm.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "slewlab_msgs_controller_state_t.h"
#include "slewlab_msgs_encoder_t.h"
#include "slewlab_msgs_operator_t.h"
#include "slewlab_msgs_torque_t.h"

/* The crane's and the controller's numbers; the same as config/controllers/thesis.yaml. */
#define GROUPS 2                     /* thesis 2.3: two groups of motors */
static const double kRatio = 2735.58;           /* thesis 2.10: gearbox 215.4, pinion 12.7 */
static const double kRatedTorque = 250.0;       /* [N m] T100; chosen */
static const double kTorqueLimit = 250.0;       /* [N m] T100; thesis 3.5 */
static const double kTorqueRate = 12500.0;      /* [N m/s] chosen: T100 in 20 ms */
static const double kTopSpeed = 0.05;           /* [rad/s] chosen; with the times the accelerations of Table 4.2 */
static const double kChangeTime = 4.4;          /* [s] from 0 to top speed and back; thesis 3.5 */
static const double kEmergencyStopTime = 1.5;   /* [s] from top speed to 0; thesis Table 4.2 */
static const double kCurvedShare = 0.3;         /* of the ramp's time, at each end; chosen */
static const double kGain = 40.0;               /* [N m s/rad] proportional, fast axis; chosen */
static const double kIntegralTime = 1.0;        /* [s] chosen */
static const double kPlayMap[][3] = {           /* average, half 1, half 2 in shares of T100; thesis Table 3.4 */
    {0.0, 0.10, -0.10},  {0.18, 0.46, -0.10}, {0.415, 0.93, -0.10},
    {0.48, 0.93, 0.03},  {0.57, 0.88, 0.24},  {1.0, 1.0, 1.0}};
/* Readings that are refused, of the motor shafts. */
static const double kSpeedLimit = 1.3 * 0.05 * 2735.58; /* [rad/s] 130 % of top speed; chosen */
static const double kAccelerationLimit = 800.0;  /* [rad/s^2] what motor, brake and gears can do to a motor; chosen */
static const double kTolerance = 0.03 * 0.05 * 2735.58; /* [rad/s] noise and counting of an encoder; chosen */
static const double kHoldTime = 0.05;            /* [s] for which a refused reading is held over; chosen */
enum { kMapPoints = sizeof kPlayMap / sizeof kPlayMap[0] };

/* CONTROLLER_STATE.mode */
enum { kStopped = 0, kRunning = 1, kEmergencyStop = 2, kWaiting = 3 };

static double clamp(double value, double lowest, double highest) { return fmax(lowest, fmin(highest, value)); }

/* From the requested to the commanded speed, with an acceleration that is a trapezoid (an S-curve of speed). A change
 * of target on the way begins a new profile from the speed and acceleration of that moment. */
struct ramp {
  double speed, acceleration, target;
  bool moving, stopping;
  double elapsed, rise, hold, fall; /* the profile: from start to peak, at peak, to zero */
  double start_speed, start_acceleration, peak, jerk;
};

static void arrive(struct ramp* ramp) {
  ramp->speed = ramp->target;
  ramp->acceleration = 0.0;
  ramp->moving = false;
}

static void begin(struct ramp* ramp, double target, double peak, double rise, double hold, double fall) {
  ramp->target = target;
  ramp->peak = peak;
  ramp->rise = rise;
  ramp->hold = hold;
  ramp->fall = fall;
  ramp->start_speed = ramp->speed;
  ramp->start_acceleration = ramp->acceleration;
  ramp->elapsed = 0.0;
  ramp->moving = true;
}

/* The speed at which the acceleration would end if it were taken away at once. */
static double let_go_speed(const struct ramp* ramp, double jerk) {
  return ramp->speed + 0.5 * ramp->acceleration * fabs(ramp->acceleration) / jerk;
}

static void begin_s_curve(struct ramp* ramp, double target) {
  const double change = target - ramp->speed;
  const double a0 = ramp->acceleration;
  if (change == 0.0 && a0 == 0.0) {
    ramp->target = target;
    arrive(ramp);
    return;
  }
  double full = fabs(a0);
  double jerk = ramp->jerk;
  if (change != 0.0) {
    /* Half a change takes half the time. Through zero: the way down and the way up. */
    const double way = ramp->speed * target < 0.0 ? fabs(ramp->speed) * kChangeTime + fabs(target) * kChangeTime
                                                  : fabs(fabs(target) - fabs(ramp->speed)) * kChangeTime;
    const double time = way / kTopSpeed;
    full = fabs(change) / (time * (1.0 - kCurvedShare));
    const double from_rest = full / (kCurvedShare * time);
    if (a0 == 0.0 || ramp->jerk == 0.0) {
      jerk = from_rest;
    } else { /* gentler where the acceleration leads to the new target, else as it is */
      const double gentler = fmin(ramp->jerk, from_rest);
      jerk = (target - let_go_speed(ramp, gentler)) * a0 >= 0.0 ? gentler : ramp->jerk;
    }
  }
  const double direction = target >= let_go_speed(ramp, jerk) ? 1.0 : -1.0;
  const double peak = direction * fmin(full, sqrt(fmax(0.0, direction * jerk * change + 0.5 * a0 * a0)));
  const double rise = fabs(peak - a0) / jerk;
  const double fall = fabs(peak) / jerk;
  const double held = change - 0.5 * (a0 + peak) * rise - 0.5 * peak * fall;
  ramp->jerk = jerk;
  begin(ramp, target, peak, rise, peak == 0.0 ? 0.0 : fmax(0.0, held / peak), fall);
}

static void advance(struct ramp* ramp, double period) {
  if (!ramp->moving) return;
  ramp->elapsed += period;
  const double t = ramp->elapsed;
  const double a0 = ramp->start_acceleration;
  const double held_until = ramp->rise + ramp->hold;
  const double left = held_until + ramp->fall - t;
  if (left <= 0.0) {
    arrive(ramp);
  } else if (t < ramp->rise) {
    const double part = t / ramp->rise;
    ramp->acceleration = a0 + (ramp->peak - a0) * part;
    ramp->speed = ramp->start_speed + t * (a0 + 0.5 * (ramp->peak - a0) * part);
  } else if (t < held_until) {
    ramp->acceleration = ramp->peak;
    ramp->speed = ramp->start_speed + 0.5 * (a0 + ramp->peak) * ramp->rise + ramp->peak * (t - ramp->rise);
  } else {
    ramp->acceleration = ramp->peak * left / ramp->fall;
    ramp->speed = ramp->target - 0.5 * ramp->acceleration * left;
  }
}

static void step_ramp(struct ramp* ramp, double period, double target) {
  advance(ramp, period);
  const double allowed = clamp(target, -kTopSpeed, kTopSpeed);
  if (allowed == ramp->target && !ramp->stopping) return;
  ramp->stopping = false;
  begin_s_curve(ramp, allowed);
}

/* Linear to zero (thesis 4.2). */
static void step_emergency_stop(struct ramp* ramp, double period) {
  advance(ramp, period);
  if (ramp->stopping) return;
  ramp->stopping = true;
  ramp->jerk = 0.0;
  const double duration = kEmergencyStopTime * fabs(ramp->speed) / kTopSpeed;
  if (duration == 0.0) {
    ramp->target = 0.0;
    arrive(ramp);
    return;
  }
  ramp->acceleration = (0.0 - ramp->speed) / duration;
  begin(ramp, 0.0, ramp->acceleration, 0.0, duration, 0.0);
}

/* PI of one motor group, by the trapezoidal rule; the integral stops where the torque stands at its limit. */
struct speed_control {
  double integral, error;
};

static double step_speed_control(struct speed_control* control, double period, double error) {
  const double half_step = 0.5 * period * kGain / kIntegralTime;
  const double wanted = (kGain + half_step) * error + (control->integral + half_step * control->error);
  const double growth = half_step * (error + control->error);
  const bool winds_up = (wanted > kTorqueLimit && growth > 0.0) || (wanted < -kTorqueLimit && growth < 0.0);
  if (!winds_up) control->integral += growth;
  control->integral = clamp(control->integral, -kTorqueLimit, kTorqueLimit);
  control->error = error;
  return clamp(wanted, -kTorqueLimit, kTorqueLimit);
}

/* Shares of T100 of the two halves, which work against each other so that the gears stay under tension. */
static void play_map(double average, double halves[GROUPS]) {
  const double size = fabs(average);
  const double beyond = fmax(0.0, size - kPlayMap[kMapPoints - 1][0]);
  double half_1 = kPlayMap[kMapPoints - 1][1] + beyond;
  double half_2 = kPlayMap[kMapPoints - 1][2] + beyond;
  for (int i = 0; i + 1 < kMapPoints; ++i) {
    if (size >= kPlayMap[i + 1][0]) continue;
    const double share = (size - kPlayMap[i][0]) / (kPlayMap[i + 1][0] - kPlayMap[i][0]);
    half_1 = kPlayMap[i][1] + share * (kPlayMap[i + 1][1] - kPlayMap[i][1]);
    half_2 = kPlayMap[i][2] + share * (kPlayMap[i + 1][2] - kPlayMap[i][2]);
    break;
  }
  halves[0] = average >= 0.0 ? half_1 : -half_2;
  halves[1] = average >= 0.0 ? half_2 : -half_1;
}

/* Refuses readings that the machine cannot have made: a flipped bit, a frozen counter, a reading out of its time
 * (controller/plausibility.h has the equations). One alone does no harm: the speeds before it are held. */
struct monitor {
  bool known, distrusted;
  int64_t sequence, time; /* of the last plausible reading; [ns] */
  double speed[GROUPS], position[GROUPS];
  int refused, plausible; /* in a row; while distrusted */
};

static void remember(struct monitor* monitor, const slewlab_msgs_encoder_t* encoder) {
  monitor->sequence = encoder->sequence;
  monitor->time = encoder->simulated_time;
  for (int i = 0; i < GROUPS; ++i) {
    monitor->speed[i] = encoder->shaft_speed[i];
    monitor->position[i] = encoder->shaft_position[i];
  }
}

static bool can_follow(const struct monitor* monitor, double period, const slewlab_msgs_encoder_t* encoder) {
  const double cycles = (double)encoder->sequence - (double)monitor->sequence;
  const double elapsed = ((double)encoder->simulated_time - (double)monitor->time) * 1e-9;
  if (!(elapsed > 0.0 && fabs(elapsed - cycles * period) <= 0.5 * period)) return false;
  const double change = kAccelerationLimit * elapsed;
  for (int i = 0; i < GROUPS; ++i) {
    const double speed = encoder->shaft_speed[i], before = monitor->speed[i];
    const double turned = (encoder->shaft_position[i] - monitor->position[i]) / elapsed;
    if (fabs(speed - before) > change + kTolerance) return false;
    if (fabs(turned - 0.5 * (speed + before)) > 0.25 * change + kTolerance) return false;
  }
  return true;
}

/* False where there is nothing to control by; otherwise `speed` gets it. */
static bool judge(struct monitor* monitor, double period, const slewlab_msgs_encoder_t* encoder, double speed[GROUPS]) {
  const double longest = kHoldTime * (1.0 + 1e-9);
  bool in_range = true;
  bool signal = encoder->group_count == GROUPS;
  for (int i = 0; signal && i < GROUPS; ++i) {
    signal = isfinite(encoder->shaft_speed[i]);
    in_range = in_range && fabs(encoder->shaft_speed[i]) <= kSpeedLimit && isfinite(encoder->shaft_position[i]);
  }
  if (!signal) { /* an encoder says so */
    memset(monitor, 0, sizeof *monitor);
    monitor->distrusted = true;
    return false;
  }
  if (in_range && (!monitor->known || can_follow(monitor, period, encoder))) {
    remember(monitor, encoder);
    monitor->known = true;
    monitor->refused = 0;
    if (monitor->distrusted && ++monitor->plausible * period <= longest) return false;
    monitor->distrusted = false;
    monitor->plausible = 0;
  } else {
    monitor->plausible = 0;
    if (monitor->distrusted || !monitor->known || ++monitor->refused * period > longest) {
      monitor->distrusted = true;
      monitor->known = in_range;
      remember(monitor, encoder);
      return false;
    }
  }
  for (int i = 0; i < GROUPS; ++i) speed[i] = monitor->speed[i];
  return true;
}

struct controller {
  double period; /* [s] between two ENCODER */
  int mode;
  bool unusable; /* there was nothing to control by; stays off until acknowledged */
  struct monitor monitor;
  struct ramp ramp;
  struct speed_control control[GROUPS];
  double commanded[GROUPS];

  /* The wire. */
  lcm_t* bus;
  bool have_run, have_candidate;
  int64_t run, candidate; /* run_identity of the run answered, and of another one heard once */
  bool have_other_operator;
  slewlab_msgs_operator_t other_operator; /* the newest of another run, whose ENCODER may follow */
  bool have_operator;
  int64_t operator_sequence;
  double speed_request;
  bool emergency_stop, acknowledge;
  int64_t answered, answered_time; /* the newest ENCODER answered; [ns] */
  int leaps;                       /* in a row: ENCODER whose sequence and time do not fit each other */
  int64_t count;
  slewlab_msgs_torque_t torque;
  slewlab_msgs_controller_state_t state;
  double motor_torque[GROUPS], proportional_torque[GROUPS], integral_torque[GROUPS];
};

/* Nothing to control by: no torque, brakes, until acknowledged. */
static void let_go(struct controller* self) {
  memset(&self->ramp, 0, sizeof self->ramp);
  memset(self->control, 0, sizeof self->control);
  memset(self->commanded, 0, sizeof self->commanded);
  memset(self->motor_torque, 0, sizeof self->motor_torque);
  memset(self->proportional_torque, 0, sizeof self->proportional_torque);
  memset(self->integral_torque, 0, sizeof self->integral_torque);
  self->mode = kWaiting;
  self->unusable = true;
  self->torque.enable = false;
  self->torque.brake = true;
  self->state.ramped_speed = self->state.average_torque = self->state.offset_torque = 0.0;
}

/* One step per ENCODER: fills in TORQUE and CONTROLLER_STATE. */
static void step(struct controller* self, const slewlab_msgs_encoder_t* encoder) {
  const double request = isfinite(self->speed_request) ? clamp(self->speed_request, -1.0, 1.0) : 0.0;
  self->torque.acknowledge = self->acknowledge && request == 0.0; /* with the joystick at zero alone */
  const bool acknowledged = self->torque.acknowledge && !self->emergency_stop;
  double shaft_speed[GROUPS];
  const bool usable = judge(&self->monitor, self->period, encoder, shaft_speed);
  if (!usable || (self->unusable && !acknowledged)) {
    let_go(self);
    return;
  }
  self->unusable = false;

  if (self->emergency_stop) self->mode = kEmergencyStop;
  if (self->mode == kEmergencyStop || self->mode == kWaiting) {
    /* Latched: it ends at rest, let go of, and acknowledged. */
    step_emergency_stop(&self->ramp, self->period);
    if (!self->ramp.moving && !self->emergency_stop) {
      self->mode = self->acknowledge && request == 0.0 ? kStopped : kWaiting;
    }
  } else {
    step_ramp(&self->ramp, self->period, request * kTopSpeed);
    self->mode = self->ramp.target != 0.0 || self->ramp.moving ? kRunning : kStopped;
  }

  const double reference = self->ramp.speed * kRatio;
  double controlled[GROUPS];
  double average = 0.0;
  double shared = 0.0; /* one integral for both: integrals of their own would work the compensation's offset off */
  for (int i = 0; i < GROUPS; ++i) {
    controlled[i] = step_speed_control(&self->control[i], self->period, reference - shaft_speed[i]);
    average += controlled[i];
    shared += self->control[i].integral;
  }
  average /= GROUPS;
  shared /= GROUPS;

  double halves[GROUPS];
  double added[GROUPS];
  play_map(average / kRatedTorque, halves);
  for (int i = 0; i < GROUPS; ++i) {
    self->control[i].integral = shared;
    added[i] = halves[i] * kRatedTorque - average;
    const double reach = kTorqueRate * self->period;
    const double reachable =
        clamp(controlled[i] + added[i], self->commanded[i] - reach, self->commanded[i] + reach);
    self->commanded[i] = clamp(reachable, -kTorqueLimit, kTorqueLimit);
    self->motor_torque[i] = self->commanded[i];
    self->proportional_torque[i] = kGain * self->control[i].error;
    self->integral_torque[i] = shared;
  }
  self->torque.enable = true;
  self->torque.brake = false;
  self->state.ramped_speed = self->ramp.speed;
  self->state.average_torque = average;
  self->state.offset_torque = 0.5 * (added[0] - added[1]);
}

static void take_operator(struct controller* self, const slewlab_msgs_operator_t* message) {
  self->have_operator = true;
  self->operator_sequence = message->sequence;
  self->speed_request = message->speed_request;
  self->emergency_stop = message->emergency_stop;
  self->acknowledge = message->acknowledge;
}

static void on_operator(const lcm_recv_buf_t* buffer, const char* channel, const slewlab_msgs_operator_t* message,
                        void* user) {
  (void)buffer;
  (void)channel;
  struct controller* self = user;
  if (self->have_run && message->run_identity == self->run) {
    if (!self->have_operator || message->sequence > self->operator_sequence) take_operator(self, message);
    return;
  }
  if (self->have_other_operator && message->run_identity == self->other_operator.run_identity &&
      message->sequence <= self->other_operator.sequence) {
    return;
  }
  self->have_other_operator = true;
  self->other_operator = *message;
}

/* A run begins with the controller's state anew. */
static void begin_run(struct controller* self, int64_t run) {
  self->run = run;
  self->have_run = true;
  self->have_candidate = false;
  self->mode = kStopped;
  self->unusable = false;
  memset(&self->ramp, 0, sizeof self->ramp);
  memset(self->control, 0, sizeof self->control);
  memset(self->commanded, 0, sizeof self->commanded);
  memset(&self->monitor, 0, sizeof self->monitor);
  self->answered = -1;
  self->leaps = 0;
  self->count = 0;
  self->have_operator = false;
  if (self->have_other_operator && self->other_operator.run_identity == run) {
    take_operator(self, &self->other_operator);
  }
  self->have_other_operator = false;
}

/* An ENCODER of another run begins that run. One alone may be a bit that turned over; the second counts. */
static bool is_of_this_run(struct controller* self, const slewlab_msgs_encoder_t* encoder) {
  if (self->have_run && encoder->run_identity == self->run) {
    self->have_candidate = false;
    return true;
  }
  if (self->have_run && !(self->have_candidate && encoder->run_identity == self->candidate)) {
    self->candidate = encoder->run_identity;
    self->have_candidate = true;
    return false;
  }
  begin_run(self, encoder->run_identity);
  return true;
}

/* A sequence that leaps while the time does not may be a bit that turned over, and whoever believed it would take all that
 * come after it for old. The second in a row counts. */
static bool comes_in_its_time(struct controller* self, const slewlab_msgs_encoder_t* encoder) {
  const double cycles = (double)encoder->sequence - (double)self->answered;
  const double elapsed = ((double)encoder->simulated_time - (double)self->answered_time) * 1e-9;
  const bool fits =
      self->answered < 0 || cycles == 1.0 || fabs(elapsed - cycles * self->period) <= 0.5 * self->period;
  if (!fits && ++self->leaps < 2) return false;
  self->leaps = 0;
  return true;
}

/* Every ENCODER gets one answer, a repeated one the same answer again. */
static void on_encoder(const lcm_recv_buf_t* buffer, const char* channel, const slewlab_msgs_encoder_t* encoder,
                       void* user) {
  (void)buffer;
  (void)channel;
  struct controller* self = user;
  if (!is_of_this_run(self, encoder) || encoder->sequence < self->answered) return;
  if (encoder->sequence > self->answered) {
    /* That OPERATOR was lost; both will be sent again. */
    if (!self->have_operator || self->operator_sequence < encoder->operator_sequence) return;
    if (!comes_in_its_time(self, encoder)) return;
    step(self, encoder);
    self->torque.sequence = self->state.sequence = self->torque.alive_counter = self->count++;
    self->torque.simulated_time = self->state.simulated_time = encoder->simulated_time;
    self->torque.configuration_hash = self->state.configuration_hash = encoder->configuration_hash;
    self->torque.run_identity = self->state.run_identity = encoder->run_identity;
    self->torque.answered_sequence = self->state.answered_sequence = encoder->sequence;
    self->torque.state_follows = true;
    self->torque.group_count = self->state.group_count = GROUPS;
    self->torque.motor_torque = self->motor_torque;
    self->state.mode = (int8_t)self->mode;
    self->state.proportional_torque = self->proportional_torque;
    self->state.integral_torque = self->integral_torque;
    self->answered = encoder->sequence;
    self->answered_time = encoder->simulated_time;
  }
  slewlab_msgs_controller_state_t_publish(self->bus, "CONTROLLER_STATE", &self->state);
  slewlab_msgs_torque_t_publish(self->bus, "TORQUE", &self->torque);
}

int main(void) {
  const char* url = getenv("SLEWLAB_BUS");               /* slewlab run sets both */
  const char* period_ms = getenv("SLEWLAB_CONTROLLER_PERIOD_MS");
  static struct controller self;
  self.period = (period_ms != NULL ? strtod(period_ms, NULL) : 10.0) * 1e-3;
  self.bus = lcm_create(url);
  if (self.bus == NULL) {
    fprintf(stderr, "controller: no bus at %s\n", url != NULL ? url : "LCM's default address");
    return 1;
  }
  /* A capacity of 0 is unlimited; by default a queue drops the newest messages. */
  slewlab_msgs_operator_t_subscription_set_queue_capacity(
      slewlab_msgs_operator_t_subscribe(self.bus, "OPERATOR", on_operator, &self), 0);
  slewlab_msgs_encoder_t_subscription_set_queue_capacity(
      slewlab_msgs_encoder_t_subscribe(self.bus, "ENCODER", on_encoder, &self), 0);
  while (lcm_handle(self.bus) == 0) { /* until SIGTERM ends the process */
  }
  return 1;
}
