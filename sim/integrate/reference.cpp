#include "sim/integrate/reference.h"

#include <arkode/arkode_arkstep.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_linearsolver.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include "sim/integrate/fast_vector.h"
#include "sim/integrate/reference_equations.h"
#include "sim/integrate/reference_newton.h"
#include "sim/model/boom.h"
#include "sim/model/drive_line.h"

namespace slewlab::sim {

namespace {

constexpr double kScaleSpeed = 0.2;           // of the top speed: the motion that tolerances are a share of; inching
constexpr double kArithmetic = 1e-14;         // relative accuracy that the arithmetic can hold
constexpr double kContactNoise = 1e-13;       // [-] what rounding alone can make of an angle: 450 times that of 1
constexpr long kMostSteps = 50'000'000;       // in one call of advance()

struct VectorDeleter {
  void operator()(N_Vector vector) const { N_VDestroy(vector); }
};
struct ContextDeleter {
  void operator()(SUNContext context) const { SUNContext_Free(&context); }
};
struct SolverDeleter {
  void operator()(SUNLinearSolver solver) const { SUNLinSolFreeEmpty(solver); }
};
template <typename Handle, typename Deleter>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Deleter>;

}  // namespace

struct Reference : ReferenceEquations {
  ReferenceOptions options;
  double now = 0.0;
  double small_angle = 0.0;  // [rad] that the fastest speed turns in the time of the fastest vibration

  std::array<int, kMaximumGroupCount> last_flank{};
  std::array<std::int64_t, kMaximumGroupCount> crossings{};
  ReferenceCounts count;
  std::int64_t finished_steps = 0, finished_evaluations = 0;  // of CVODE before its last restart
  std::string complaint;                                      // SUNDIALS' last error message

  std::vector<double> rates;  // room for modal_accelerations()
  ReferenceNewton newton;

  // In the order in which they may be destroyed last to first.
  Owned<SUNContext, ContextDeleter> context;
  Owned<N_Vector, VectorDeleter> state, weights;
  Owned<SUNLinearSolver, SolverDeleter> solver;
  void* integrator = nullptr;

  Reference(ReferenceEquations equations, const ReferenceOptions& how) : ReferenceEquations(std::move(equations)), options(how) {}
  ~Reference() {
    if (integrator != nullptr) {
      options.method == ReferenceMethod::kBdf ? CVodeFree(&integrator) : ARKStepFree(&integrator);
    }
  }
};

void ReferenceDeleter::operator()(Reference* reference) const { delete reference; }

namespace {

int right_hand_side(double t, N_Vector y, N_Vector rates, void* user) {
  derive(*static_cast<Reference*>(user), t, N_VGetArrayPointer(y), N_VGetArrayPointer(rates));
  return 0;
}

int contact_functions(double t, N_Vector y, double* values, void* user) {
  const Reference& r = *static_cast<Reference*>(user);
  ReferencePlace motion;
  observe(r, t, N_VGetArrayPointer(y), motion);
  for (int i = 0; i < r.group_count; ++i) {
    const GearContact gear = gear_now(r, motion, i);
    const double deflection = deflection_of(r, motion, i), rate = deflection_rate_of(r, motion, i);
    values[2 * i] = contact_function(gear, 1, deflection, rate);
    values[2 * i + 1] = contact_function(gear, -1, deflection, rate);
  }
  return 0;
}

int solve_newton(SUNLinearSolver solver, SUNMatrix, N_Vector x, N_Vector b, double) {
  Reference& r = *static_cast<Reference*>(solver->content);
  double gamma = 0.0;
  if (r.options.method == ReferenceMethod::kBdf) {
    CVodeGetCurrentGamma(r.integrator, &gamma);
  } else {
    ARKStepGetCurrentGamma(r.integrator, &gamma);
  }
  solve(r, r.newton, gamma, N_VGetArrayPointer(b), N_VGetArrayPointer(x));
  return SUNLS_SUCCESS;
}

void note_complaint(int, const char* module, const char* function, char* message, void* user) {
  static_cast<Reference*>(user)->complaint = std::string(module) + " " + function + ": " + message;
}

void require(const Reference& r, int flag, const char* what) {
  if (flag >= 0) return;
  throw std::runtime_error(std::string("the reference failed: ") + what + " returned " + std::to_string(flag) +
                           " at " + std::to_string(r.now) + " s; " + r.complaint);
}

// The angles of the slewing itself grow without bound: they cannot be asked for more digits than there are.
int give_weights(N_Vector state, N_Vector weights, void* user) {
  const Reference& r = *static_cast<Reference*>(user);
  N_VScale(1.0, r.weights.get(), weights);
  const double* y = N_VGetArrayPointer(state);
  double* values = N_VGetArrayPointer(weights);
  for (int i = 0; i <= r.group_count; ++i) {
    const int n = i < r.group_count ? i : r.q();
    values[n] /= 1.0 + kArithmetic * std::fabs(y[n]) * values[n];
  }
  return 0;
}

// [rad/s] that turns a tolerance in speed into one in angle where nothing vibrates faster: the motors on their gears against
// what they drive; of a rigid machine, one over its acceleration time.
double angle_frequency(const Reference& r) {
  const CraneParameters& crane = r.machine.crane;
  if (r.rigid_groups > 0) {
    const double torque = crane.drive.group_count * crane.drive.motors_per_group * crane.drive.rated_torque * r.ratio;
    return torque / (rigid_inertia(crane) * crane.drive.top_speed);
  }
  double stiffness = 0.0, inertia = 0.0;
  for (int i = 0; i < r.group_count; ++i) {
    stiffness += r.machine.gear[i].stiffness;
    inertia += r.machine.group_inertia[i];
  }
  return std::sqrt(stiffness / series_inertia(inertia, driven_inertia(crane)));
}

void fill_weights(Reference& r) {
  double* values = N_VGetArrayPointer(r.weights.get());
  const double unit = r.options.tolerance;
  const double inertia = r.rigid_groups > 0 ? rigid_inertia(r.machine.crane) : driven_inertia(r.machine.crane);
  const double speed = unit * kScaleSpeed * r.machine.crane.drive.top_speed;
  const double modal_speed = speed * std::sqrt(inertia);
  const double slowest = angle_frequency(r);
  r.small_angle = r.machine.crane.drive.top_speed / slowest;
  for (int i = 0; i < r.group_count; ++i) {
    values[i] = speed / slowest;
    values[r.speeds() + i] = speed;
  }
  for (int k = 0; k < r.mode_count; ++k) {
    values[r.q() + k] = modal_speed / std::max(r.machine.modes.frequency[k], slowest);
    values[r.v() + k] = modal_speed;
  }
  for (int j = 0; j < r.load_count; ++j) {
    // Of a crane whose rope hangs on its axis: as if it hung its own length away.
    const double radius = tip_radius(r.machine.crane.boom);
    const double arm = radius > 0.0 ? radius : r.machine.crane.load.rope_length;
    const double load_speed = speed * arm * std::sqrt(r.machine.crane.load.mass);
    values[r.load_q() + j] = load_speed;
    values[r.load_v() + j] = load_speed;
  }
  for (std::size_t j = 0; j < r.extra.start.size(); ++j) {
    values[r.extra_start() + static_cast<int>(j)] = unit * r.extra.scale[j];
  }
  for (int n = 0; n < r.size; ++n) values[n] = 1.0 / values[n];
}

void make_integrator(Reference& r) {
  SUNContext context = nullptr;
  if (SUNContext_Create(nullptr, &context) != 0) throw std::runtime_error("SUNDIALS gives no context");
  r.context.reset(context);
  r.state.reset(make_fast_vector(r.size, context));
  r.weights.reset(make_fast_vector(r.size, context));
  if (r.state == nullptr || r.weights == nullptr) throw std::bad_alloc();
  N_VConst(0.0, r.state.get());
  fill_weights(r);
  r.solver.reset(SUNLinSolNewEmpty(context));
  r.solver->content = &r;
  r.solver->ops->gettype = [](SUNLinearSolver) { return SUNLINEARSOLVER_MATRIX_EMBEDDED; };
  r.solver->ops->solve = solve_newton;
  const int roots = 2 * r.group_count;
  if (r.options.method == ReferenceMethod::kBdf) {
    r.integrator = CVodeCreate(CV_BDF, context);
    CVodeSetErrHandlerFn(r.integrator, note_complaint, &r);
    require(r, CVodeInit(r.integrator, right_hand_side, 0.0, r.state.get()), "CVodeInit");
    require(r, CVodeWFtolerances(r.integrator, give_weights), "CVodeWFtolerances");
    require(r, CVodeSetUserData(r.integrator, &r), "CVodeSetUserData");
    require(r, CVodeSetLinearSolver(r.integrator, r.solver.get(), nullptr), "CVodeSetLinearSolver");
    require(r, CVodeRootInit(r.integrator, roots, contact_functions), "CVodeRootInit");
    CVodeSetNoInactiveRootWarn(r.integrator);
    CVodeSetMaxNumSteps(r.integrator, kMostSteps);
  } else {
    r.integrator = ARKStepCreate(nullptr, right_hand_side, 0.0, r.state.get(), context);
    ARKStepSetErrHandlerFn(r.integrator, note_complaint, &r);
    require(r, ARKStepSetOrder(r.integrator, r.options.order), "ARKStepSetOrder");
    require(r, ARKStepWFtolerances(r.integrator, give_weights), "ARKStepWFtolerances");
    require(r, ARKStepSetUserData(r.integrator, &r), "ARKStepSetUserData");
    require(r, ARKStepSetLinearSolver(r.integrator, r.solver.get(), nullptr), "ARKStepSetLinearSolver");
    const bool linear = !r.extra.forces && !r.extra.gears && r.machine.crane.axis_force.gravity == 0.0;
    if (linear) require(r, ARKStepSetLinear(r.integrator, 0), "ARKStepSetLinear");
    require(r, ARKStepRootInit(r.integrator, roots, contact_functions), "ARKStepRootInit");
    ARKStepSetMaxNonlinIters(r.integrator, 10);
    ARKStepSetNoInactiveRootWarn(r.integrator);
    ARKStepSetMaxNumSteps(r.integrator, kMostSteps);
  }
}

// Brings the counts up to date; CVODE forgets its own at a restart.
void take_counts(Reference& r) {
  long steps = 0, evaluations = 0, explicit_evaluations = 0;
  if (r.options.method == ReferenceMethod::kBdf) {
    CVodeGetNumSteps(r.integrator, &steps);
    CVodeGetNumRhsEvals(r.integrator, &evaluations);
  } else {
    ARKStepGetNumSteps(r.integrator, &steps);
    ARKStepGetNumRhsEvals(r.integrator, &explicit_evaluations, &evaluations);
  }
  r.count.steps = r.finished_steps + steps;
  r.count.evaluations = r.finished_evaluations + evaluations;
}

void restart(Reference& r) {
  r.newton.gamma = -1.0;
  ++r.count.restarts;
  if (r.options.method == ReferenceMethod::kBdf) {
    take_counts(r);
    r.finished_steps = r.count.steps;
    r.finished_evaluations = r.count.evaluations;
    require(r, CVodeReInit(r.integrator, r.now, r.state.get()), "CVodeReInit");
  } else {
    require(r, ARKStepReset(r.integrator, r.now, r.state.get()), "ARKStepReset");
  }
}

void change_contact(Reference& r, int group, int contact) {
  if (r.contact[group] == contact) return;
  r.contact[group] = contact;
  ++r.count.contact_changes;
  if (contact == 0) return;
  if (r.last_flank[group] != 0 && r.last_flank[group] != contact) ++r.crossings[group];
  r.last_flank[group] = contact;
}

// [rad] Depth that rounding alone can make of the angles, and of the moment to which a root is found: 100 roundings of the time
// (CVODE's documentation, root finding).
double contact_noise(const Reference& r, const ReferencePlace& motion, int group, double rate) {
  const double turned = std::fabs(motion.motor_angle[group]) + std::fabs(motion.motor_angle[group] - deflection_of(r, motion, group));
  return kContactNoise * (r.small_angle + turned + std::fabs(rate) * r.now);
}

// Sets every contact that differs from the law; true when one did. Teeth that touch and approach each other count
// as closed: a root function that starts at zero would not be seen to rise.
bool put_contacts_right(Reference& r) {
  ReferencePlace motion;
  observe(r, r.now, N_VGetArrayPointer(r.state.get()), motion);
  bool changed = false;
  for (int i = 0; i < r.group_count; ++i) {
    const GearContact gear = gear_now(r, motion, i);
    const double deflection = deflection_of(r, motion, i), rate = deflection_rate_of(r, motion, i);
    const double noise = contact_noise(r, motion, i, rate);
    int contact = 0;
    for (const int side : {1, -1}) {
      const bool stays = r.contact[i] == side || side * rate > 0.0;
      const double value = contact_function(gear, side, deflection, rate);
      if (value > (stays ? -noise : noise)) contact = side;
    }
    if (contact == r.contact[i]) continue;
    change_contact(r, i, contact);
    changed = true;
  }
  return changed;
}

}  // namespace

ReferenceMachine reference_machine(const CraneParameters& crane) {
  ReferenceMachine machine{.crane = crane, .group_inertia = {}, .gear = {}, .modes = free_house_modes(crane)};
  machine.group_inertia.fill(group_inertia(crane.drive));
  machine.gear.fill(gear_contact(crane));
  return machine;
}

ReferencePointer make_reference(const CraneParameters& crane, const ReferenceOptions& options) {
  return make_reference(reference_machine(crane), options);
}

ReferencePointer make_reference(ReferenceMachine machine, const ReferenceOptions& options, ReferenceExtra extra) {
  if (!(options.tolerance > 0.0)) throw std::invalid_argument("the reference's tolerance must be greater than 0");
  ReferencePointer reference(new Reference(make_reference_equations(std::move(machine), std::move(extra)), options));
  Reference& r = *reference;
  make_integrator(r);
  std::copy(r.extra.start.begin(), r.extra.start.end(), N_VGetArrayPointer(r.state.get()) + r.extra_start());
  restart(r);
  r.count = {};
  return reference;
}

void set_state(Reference& r, const PlantState& state, double time) {
  if (state.q.size() < static_cast<std::size_t>(r.mode_count)) {
    throw std::invalid_argument("the state belongs to a crane with fewer modes than the reference's");
  }
  double* y = N_VGetArrayPointer(r.state.get());
  r.now = r.held_since = time;
  r.held = {};
  r.held_angle = {};
  r.held_speed = {};
  // A state of the plant: angles of the house there are per root of what the motors drive.
  if (r.rigid_groups > 0) {
    y[r.q()] = state.house_angle / r.machine.modes.house[0];
    y[r.v()] = state.house_speed / r.machine.modes.house[0];
  }
  for (int i = 0; i < r.group_count; ++i) {
    y[i] = state.motor_angle[i];
    y[r.speeds() + i] = state.motor_speed[i];
    r.contact[i] = state.contact[i];
    r.last_flank[i] = state.last_flank[i];
  }
  if (r.rigid_groups == 0) {
    std::copy_n(state.q.begin(), r.mode_count, y + r.q());
    std::copy_n(state.v.begin(), r.mode_count, y + r.v());
  }
  for (int j = 0; j < r.load_count; ++j) {
    y[r.load_q() + j] = state.load_q[j];
    y[r.load_v() + j] = state.load_v[j];
  }
  const ReferenceCounts before = r.count;
  put_contacts_right(r);
  restart(r);
  r.count.contact_changes = before.contact_changes;
  r.count.restarts = before.restarts;
}

void hang_load(Reference& r) {
  if (r.load_count == 0 || !r.extra.forces) return;
  constexpr int kMostSteps = 50;
  const double root_mass = std::sqrt(r.machine.crane.load.mass);
  // [m sqrt(kg)] of a modal coordinate, for slopes: 1e-10 of the rope's length, far below any bend of a law and far above rounding.
  const double nudge = 1e-10 * r.machine.crane.load.rope_length * root_mass;
  const double weight = kGravity * root_mass;  // [m sqrt(kg)/s^2]
  // Relative to what the rope gives where the load hangs; 1e-15 of the weight is what a force of no meaning would be.
  constexpr double kStill = 1e-12, kOfWeight = 1e-3;
  double* q = N_VGetArrayPointer(r.state.get()) + r.load_q();
  std::vector<double> rates(static_cast<std::size_t>(r.size));
  const auto acceleration = [&] {
    derive(r, r.now, N_VGetArrayPointer(r.state.get()), rates.data());
    return Eigen::Vector2d(rates[static_cast<std::size_t>(r.load_v())], rates[static_cast<std::size_t>(r.load_v()) + 1]);
  };
  // Newton's steps; of a point load the second mode does not exist.
  const int modes = r.load_square[1] > 0.0 ? 2 : 1;
  Eigen::Vector2d now = acceleration();
  for (int step = 0; step < kMostSteps; ++step) {
    const double scale = r.load_square[0] * std::fabs(q[0]) + r.load_square[1] * std::fabs(q[1]) + kOfWeight * weight;
    if (now.head(modes).cwiseAbs().maxCoeff() <= kStill * scale) {
      restart(r);
      r.count = {};
      return;
    }
    Eigen::Matrix2d slopes = Eigen::Matrix2d::Identity();
    for (int j = 0; j < modes; ++j) {
      const double stood = q[j];
      q[j] = stood + nudge;
      slopes.col(j) = (acceleration() - now) / nudge;
      q[j] = stood;
    }
    if (modes == 1) slopes.row(1) << 0.0, 1.0;
    const Eigen::Vector2d change = slopes.partialPivLu().solve(-now);
    for (int j = 0; j < modes; ++j) q[j] += change(j);
    now = acceleration();
  }
  throw std::runtime_error("the load finds no place to hang still under the forces on it");
}

void advance(Reference& r, const GroupArray& motor_torque, double until) {
  if (!(until >= r.now)) throw std::invalid_argument("the reference cannot go back in time");
  const double since = r.now - r.held_since;
  bool jumped = false;
  for (int i = 0; i < r.group_count; ++i) {
    const double acceleration = r.held[i] / r.machine.group_inertia[i];
    r.held_angle[i] += since * (r.held_speed[i] + 0.5 * since * acceleration);
    r.held_speed[i] += since * acceleration;
    const double torque = motor_torque[i] * r.machine.crane.drive.motors_per_group * r.ratio;
    jumped = jumped || torque != r.held[i];
    r.held[i] = torque;
  }
  for (int i = 0; i < r.rigid_groups; ++i) {
    const double torque = motor_torque[i] * r.machine.crane.drive.motors_per_group * r.ratio;
    jumped = jumped || torque != r.held[i];
    r.held[i] = torque;
  }
  r.held_since = r.now;
  if (until == r.now) return;
  if (jumped && (r.extra.forces || r.rigid_groups > 0)) restart(r);

  const bool bdf = r.options.method == ReferenceMethod::kBdf;
  while (r.now < until) {
    if (bdf) {
      CVodeSetStopTime(r.integrator, until);
    } else {
      ARKStepSetStopTime(r.integrator, until);
    }
    double reached = r.now;
    const int flag = bdf ? CVode(r.integrator, until, r.state.get(), &reached, CV_NORMAL)
                         : ARKStepEvolve(r.integrator, until, r.state.get(), &reached, ARK_NORMAL);
    r.now = reached;
    require(r, flag, bdf ? "CVode" : "ARKStepEvolve");
    if (flag != (bdf ? CV_ROOT_RETURN : ARK_ROOT_RETURN)) {  // NOLINT(bugprone-branch-clone): numbers of two solvers, equal by chance
      if (put_contacts_right(r)) {
        ++r.count.late_changes;
        restart(r);
      }
      continue;
    }
    int found[2 * kMaximumGroupCount] = {};
    bdf ? CVodeGetRootInfo(r.integrator, found) : ARKStepGetRootInfo(r.integrator, found);
    for (int i = 0; i < r.group_count; ++i) {
      for (const int side : {1, -1}) {
        const int direction = found[side == 1 ? 2 * i : 2 * i + 1];
        if (direction > 0) change_contact(r, i, side);
        if (direction < 0 && r.contact[i] == side) change_contact(r, i, 0);
      }
    }
    restart(r);
  }
  take_counts(r);
}

double time(const Reference& r) { return r.now; }

namespace {

ReferencePlace motion_now(const Reference& r) {
  ReferencePlace motion;
  observe(r, r.now, N_VGetArrayPointer(r.state.get()), motion);
  fill_gear_torques(r, motion);
  return motion;
}

}  // namespace

PlantReadings read(const Reference& reference) {
  // The right-hand side needs room for an extra's forces; it changes nothing else.
  Reference& r = const_cast<Reference&>(reference);
  std::vector<double> rates(static_cast<std::size_t>(r.size), 0.0);
  derive(r, r.now, N_VGetArrayPointer(r.state.get()), rates.data());
  const ReferencePlace motion = motion_now(r);
  PlantReadings readings;
  for (int i = 0; i < r.group_count + r.rigid_groups; ++i) {
    readings.shaft_speed[i] = motion.motor_speed[i] * r.ratio;
    readings.shaft_position[i] = motion.motor_angle[i] * r.ratio;
  }
  const FreeHouseModes& modes = r.machine.modes;
  double pivot = 0.0;
  for (int k = 0; k < r.mode_count; ++k) {
    const double acceleration = rates[r.v() + k];
    pivot += modes.pivot[k] * acceleration;
    readings.middle_acceleration += modes.middle[k] * acceleration;
    readings.tip_acceleration +=
        (modes.tip[k] - r.machine.crane.boom.jib_eccentricity * modes.tip_twist[k]) * acceleration;
  }
  readings.house_acceleration = r.machine.crane.house.sensor_radius * pivot;
  readings.pivot_acceleration = r.machine.crane.boom.pivot_radius * pivot;
  readings.slew_angle = motion.seen.house_angle;
  return readings;
}

GroupArray gear_torques(const Reference& reference) {
  GroupArray torque = motion_now(reference).gear_torque;
  if (reference.rigid_groups == 0) return torque;
  // What the rigid drive passes on: the motors' torque less what their own inertia takes.
  double acceleration = 0.0;
  modal_accelerations(reference, &acceleration);
  acceleration *= reference.machine.modes.house[0];
  for (int i = 0; i < reference.rigid_groups; ++i) torque[i] = reference.held[i] - reference.machine.group_inertia[i] * acceleration;
  return torque;
}

double gear_deflection(const Reference& r, int group) {
  const ReferencePlace motion = motion_now(r);
  return motion.motor_angle[group] - motion.seen.house_angle;
}

std::array<std::int64_t, kMaximumGroupCount> play_crossings(const Reference& r) { return r.crossings; }

double rope_angle(const Reference& r) {
  if (r.load_count == 0) return 0.0;
  const ReferenceMotion seen = motion_now(r).seen;
  return (seen.rope_end_displacement - seen.tip_displacement) / r.machine.crane.load.rope_length;
}

double rod_angle(const Reference& r) { return r.load_count == 0 ? 0.0 : motion_now(r).seen.rod_angle; }

double tip_displacement(const Reference& r) { return motion_now(r).seen.tip_displacement; }

void shear_forces(const Reference& r, double* shear) {
  const double* q = N_VGetArrayPointer(r.state.get()) + r.q();
  for (Eigen::Index e = 0; e < r.machine.modes.shear.rows(); ++e) {
    shear[e] = 0.0;
    for (int k = 0; k < r.mode_count; ++k) shear[e] += r.machine.modes.shear(e, k) * q[k];
  }
}

double mechanical_energy(const Reference& r) {
  const ReferencePlace motion = motion_now(r);
  const double* y = N_VGetArrayPointer(r.state.get());
  double energy = 0.0;
  for (int k = 0; k < r.mode_count; ++k) {
    const double q = y[r.q() + k], v = y[r.v() + k];
    energy += 0.5 * (v * v + r.square[k] * q * q);
  }
  for (int i = 0; i < r.group_count; ++i) {
    energy += 0.5 * r.machine.group_inertia[i] * motion.motor_speed[i] * motion.motor_speed[i];
    const double depth = std::fabs(deflection_of(r, motion, i)) - r.machine.gear[i].half_play;
    if (depth > 0.0) energy += 0.5 * gear_now(r, motion, i).stiffness * depth * depth;
  }
  if (r.load_count > 0) {
    const Eigen::Vector2d position(motion.seen.rope_end_displacement - motion.seen.tip_displacement,
                                   motion.seen.rod_angle);
    energy += 0.5 * position.dot(r.load.stiffness * position);
    for (int j = 0; j < 2; ++j) energy += 0.5 * y[r.load_v() + j] * y[r.load_v() + j];
  }
  return energy;
}

const double* extra_states(const Reference& r) {
  return N_VGetArrayPointer(r.state.get()) + r.extra_start();
}

const double* modal_coordinates(const Reference& r) { return N_VGetArrayPointer(r.state.get()) + r.q(); }

void modal_accelerations(const Reference& reference, double* acceleration) {
  // As in read().
  Reference& r = const_cast<Reference&>(reference);
  r.rates.resize(static_cast<std::size_t>(r.size));
  derive(r, r.now, N_VGetArrayPointer(r.state.get()), r.rates.data());
  std::copy_n(r.rates.begin() + r.v(), r.mode_count, acceleration);
}

ReferenceCounts counts(const Reference& r) { return r.count; }

}  // namespace slewlab::sim
