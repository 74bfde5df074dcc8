#include "sim/integrate/reference.h"

#include <arkode/arkode_arkstep.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_linearsolver.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include "sim/integrate/fast_vector.h"
#include "sim/model/boom.h"
#include "sim/model/drive_line.h"

namespace slewlab::sim {

namespace {

constexpr double kScaleSpeed = 0.2;           // of the top speed: the motion that tolerances are a share of; inching
constexpr double kArithmetic = 1e-14;         // relative accuracy that the arithmetic can hold
constexpr double kContactNoise = 1e-13;       // [-] what rounding alone can make of an angle: 450 times that of 1
constexpr long kMostSteps = 50'000'000;       // in one call of advance()
constexpr int kChannels = kMaximumGroupCount + 3;

using Coupling = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kChannels, kChannels>;
using Channels = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kChannels, 1>;

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

// State vector: motor angles and speeds less the held torque's share, q, v, load_q, load_v, extra states.
struct Reference {
  ReferenceMachine machine;
  ReferenceExtra extra;
  ReferenceOptions options;
  int group_count = 0;  // that move for themselves: none where the drive is rigid
  int rigid_groups = 0; // that turn with the house
  int mode_count = 0;
  int load_count = 0;  // 2 or 0
  bool has_axis_force = false;
  int size = 0;
  double ratio = 1.0;
  std::vector<double> square;
  LoadOnSpring load;
  std::array<double, 2> load_square{}, load_damping{}, load_from_tip{}, load_from_tip_velocity{};

  // The held torque: angle and speed it has given each motor up to `held_since`. A rigid drive's acts on the house.
  GroupArray held{};  // [Nm] whole group, slew axis
  GroupArray held_angle{}, held_speed{};
  double held_since = 0.0;
  double now = 0.0;
  double small_angle = 0.0;  // [rad] that the fastest speed turns in the time of the fastest vibration

  std::array<int, kMaximumGroupCount> contact{}, last_flank{};
  std::array<std::int64_t, kMaximumGroupCount> crossings{};
  ReferenceCounts count;
  std::int64_t finished_steps = 0, finished_evaluations = 0;  // of CVODE before its last restart
  std::string complaint;                                      // SUNDIALS' last error message

  std::vector<double> modal_force;  // room for an extra's forces
  std::vector<double> rates;        // room for modal_accelerations()

  // Newton's system for one gamma and one set of contacts.
  double solver_gamma = -1.0;
  std::vector<double> inverse;
  std::array<double, 2> load_inverse{};
  Eigen::PartialPivLU<Coupling> coupling;
  int closed_count = 0;
  std::array<int, kMaximumGroupCount> closed{};

  // In the order in which they may be destroyed last to first.
  Owned<SUNContext, ContextDeleter> context;
  Owned<N_Vector, VectorDeleter> state, weights;
  Owned<SUNLinearSolver, SolverDeleter> solver;
  void* integrator = nullptr;

  int speeds() const { return group_count; }
  int q() const { return 2 * group_count; }
  int v() const { return q() + mode_count; }
  int load_q() const { return v() + mode_count; }
  int load_v() const { return load_q() + load_count; }
  int extra_start() const { return load_v() + load_count; }

  ~Reference() {
    if (integrator != nullptr) {
      options.method == ReferenceMethod::kBdf ? CVodeFree(&integrator) : ARKStepFree(&integrator);
    }
  }
};

void ReferenceDeleter::operator()(Reference* reference) const { delete reference; }

namespace {

struct Motion {
  ReferenceMotion seen;
  GroupArray motor_angle{}, motor_speed{}, gear_torque{};
  ReferenceGears gears;
};

// Depth and push of one flank, both > 0 in contact; the smaller one is the contact function.
double contact_function(const GearContact& gear, int side, double deflection, double rate) {
  const double depth = side * deflection - gear.half_play;
  return std::min(depth, depth + gear.damping / gear.stiffness * side * rate);
}

void observe(const Reference& r, double t, const double* y, Motion& motion) {
  const double since = t - r.held_since;
  for (int i = 0; i < r.group_count; ++i) {
    const double acceleration = r.held[i] / r.machine.group_inertia[i];
    motion.motor_angle[i] =
        y[i] + r.held_angle[i] + since * (r.held_speed[i] + 0.5 * since * acceleration);
    motion.motor_speed[i] = y[r.speeds() + i] + r.held_speed[i] + since * acceleration;
  }
  ReferenceMotion& seen = motion.seen;
  seen.time = t;
  seen.motor_torque = r.held.data();
  seen.motor_angle = motion.motor_angle.data();
  seen.motor_speed = motion.motor_speed.data();
  seen.gear_torque = motion.gear_torque.data();
  const double* q = y + r.q();
  const double* v = y + r.v();
  const double* house = r.machine.modes.house.data();
  const double* tip = r.machine.modes.tip.data();
  double house_angle = 0.0, house_speed = 0.0, tip_displacement = 0.0, tip_velocity = 0.0;
  for (int k = 0; k < r.mode_count; ++k) {
    house_angle += house[k] * q[k];
    house_speed += house[k] * v[k];
    tip_displacement += tip[k] * q[k];
    tip_velocity += tip[k] * v[k];
  }
  seen.house_angle = house_angle;
  seen.house_speed = house_speed;
  seen.tip_displacement = tip_displacement;
  seen.tip_velocity = tip_velocity;
  for (int i = 0; i < r.rigid_groups; ++i) {
    motion.motor_angle[i] = house_angle;
    motion.motor_speed[i] = house_speed;
  }
  seen.q = q;
  seen.v = v;
  if (r.load_count > 0) {
    const double* lq = y + r.load_q();
    const double* lv = y + r.load_v();
    const Eigen::Matrix2d& modes = r.load.modes;
    seen.rope_end_displacement = modes(0, 0) * lq[0] + modes(0, 1) * lq[1];
    seen.rope_end_velocity = modes(0, 0) * lv[0] + modes(0, 1) * lv[1];
    seen.rod_angle = modes(1, 0) * lq[0] + modes(1, 1) * lq[1];
    seen.rod_rate = modes(1, 0) * lv[0] + modes(1, 1) * lv[1];
  }
  if (r.extra.gears) {
    motion.gears.stiffness_share.fill(1.0);
    motion.gears.offset.fill(0.0);
    motion.gears.offset_rate.fill(0.0);
    r.extra.gears(seen, y + r.extra_start(), motion.gears);
  }
}

GearContact gear_now(const Reference& r, const Motion& motion, int i) {
  GearContact gear = r.machine.gear[i];
  if (r.extra.gears) gear.stiffness *= motion.gears.stiffness_share[i];
  return gear;
}

double deflection_of(const Reference& r, const Motion& motion, int i) {
  const double deflection = motion.motor_angle[i] - motion.seen.house_angle;
  return r.extra.gears ? deflection + motion.gears.offset[i] : deflection;
}

double deflection_rate_of(const Reference& r, const Motion& motion, int i) {
  const double rate = motion.motor_speed[i] - motion.seen.house_speed;
  return r.extra.gears ? rate + motion.gears.offset_rate[i] : rate;
}

// Torques of the gears with the contacts as they are latched: smooth between two contact changes.
double fill_gear_torques(const Reference& r, Motion& motion) {
  double sum = 0.0;
  for (int i = 0; i < r.group_count; ++i) {
    motion.gear_torque[i] = 0.0;
    if (r.contact[i] == 0) continue;
    const GearContact gear = gear_now(r, motion, i);
    motion.gear_torque[i] = gear.stiffness * (deflection_of(r, motion, i) - r.contact[i] * gear.half_play) +
                            gear.damping * deflection_rate_of(r, motion, i);
    sum += motion.gear_torque[i];
  }
  return sum;
}

double rope_force(const Reference& r, const ReferenceMotion& seen) {
  if (r.load_count == 0) return 0.0;
  return r.load.rope_stiffness * (seen.rope_end_displacement - seen.tip_displacement) +
         r.load.damping(0, 0) * (seen.rope_end_velocity - seen.tip_velocity) +
         r.load.damping(0, 1) * seen.rod_rate;
}

// Right-hand side; leaves the accelerations of the modes at rates[v()].
void derive(Reference& r, double t, const double* y, double* rates) {
  Motion motion;
  observe(r, t, y, motion);
  double house_torque = fill_gear_torques(r, motion);
  if (r.has_axis_force) house_torque += axis_force_at(r.machine.crane.axis_force, motion.seen.house_angle);
  double tip_force = rope_force(r, motion.seen);
  ReferenceForces forces;
  const bool extra = static_cast<bool>(r.extra.forces);
  if (extra) {
    std::fill(r.modal_force.begin(), r.modal_force.end(), 0.0);
    forces.modal_force = r.modal_force.data();
    r.extra.forces(motion.seen, y + r.extra_start(), forces, rates + r.extra_start());
    house_torque += forces.house_torque;
    tip_force += forces.tip_force;
  }
  for (int i = 0; i < r.rigid_groups; ++i) house_torque += r.held[i] + forces.motor_torque[i];
  for (int i = 0; i < r.group_count; ++i) {
    rates[i] = y[r.speeds() + i];
    rates[r.speeds() + i] = (forces.motor_torque[i] - motion.gear_torque[i]) / r.machine.group_inertia[i];
  }
  const double* q = y + r.q();
  const double* v = y + r.v();
  double* q_rate = rates + r.q();
  double* v_rate = rates + r.v();
  const FreeHouseModes& modes = r.machine.modes;
  for (int k = 0; k < r.mode_count; ++k) {
    q_rate[k] = v[k];
    v_rate[k] = modes.house[k] * house_torque + modes.tip[k] * tip_force - r.square[k] * q[k] -
                modes.damping_rate[k] * v[k];
  }
  if (extra) {
    for (int k = 0; k < r.mode_count; ++k) {
      v_rate[k] += modes.uniform_load[k] * forces.uniform_force + r.modal_force[k];
    }
  }
  for (int j = 0; j < r.load_count; ++j) {
    rates[r.load_q() + j] = y[r.load_v() + j];
    rates[r.load_v() + j] = -r.load_square[j] * y[r.load_q() + j] - r.load_damping[j] * y[r.load_v() + j] +
                            r.load_from_tip[j] * motion.seen.tip_displacement +
                            r.load_from_tip_velocity[j] * motion.seen.tip_velocity +
                            r.load.modes(0, j) * forces.load_force + r.load.modes(1, j) * forces.rod_moment;
  }
}

int right_hand_side(double t, N_Vector y, N_Vector rates, void* user) {
  derive(*static_cast<Reference*>(user), t, N_VGetArrayPointer(y), N_VGetArrayPointer(rates));
  return 0;
}

int contact_functions(double t, N_Vector y, double* values, void* user) {
  const Reference& r = *static_cast<Reference*>(user);
  Motion motion;
  observe(r, t, N_VGetArrayPointer(y), motion);
  for (int i = 0; i < r.group_count; ++i) {
    const GearContact gear = gear_now(r, motion, i);
    const double deflection = deflection_of(r, motion, i), rate = deflection_rate_of(r, motion, i);
    values[2 * i] = contact_function(gear, 1, deflection, rate);
    values[2 * i + 1] = contact_function(gear, -1, deflection, rate);
  }
  return 0;
}

// (I - gamma J) is, without the forces that couple, a set of 2x2 blocks [1, -gamma; gamma w^2, 1 + gamma d].
// The couplings are few: each closed gear's torque, the rope's force, tip displacement and velocity on the load.
void prepare_solver(Reference& r, double gamma) {
  r.solver_gamma = gamma;
  const FreeHouseModes& modes = r.machine.modes;
  double house_house = 0.0, house_tip = 0.0, tip_tip = 0.0;
  for (int k = 0; k < r.mode_count; ++k) {
    r.inverse[k] = 1.0 / (1.0 + gamma * (modes.damping_rate[k] + gamma * r.square[k]));
    house_house += modes.house[k] * modes.house[k] * r.inverse[k];
    house_tip += modes.house[k] * modes.tip[k] * r.inverse[k];
    tip_tip += modes.tip[k] * modes.tip[k] * r.inverse[k];
  }
  r.closed_count = 0;
  for (int i = 0; i < r.group_count; ++i) {
    if (r.contact[i] != 0) r.closed[r.closed_count++] = i;
  }
  const int gears = r.closed_count;
  const int channels = gears + (r.load_count > 0 ? 3 : 0);
  Coupling system = Coupling::Identity(channels, channels);
  for (int row = 0; row < gears; ++row) {
    const GearContact& gear = r.machine.gear[r.closed[row]];
    const double factor = gamma * (gamma * gear.stiffness + gear.damping);
    for (int column = 0; column < gears; ++column) system(row, column) += factor * house_house;
    system(row, row) += factor / r.machine.group_inertia[r.closed[row]];
    if (r.load_count > 0) system(row, gears) += factor * house_tip;
  }
  if (r.load_count > 0) {
    const double k = r.load.rope_stiffness, c = r.load.damping(0, 0), c_rod = r.load.damping(0, 1);
    for (int column = 0; column < gears; ++column) {
      system(gears, column) += gamma * (gamma * k + c) * house_tip;
      system(gears + 1, column) -= gamma * gamma * house_tip;
      system(gears + 2, column) -= gamma * house_tip;
    }
    system(gears, gears) += gamma * (gamma * k + c) * tip_tip;
    system(gears + 1, gears) -= gamma * gamma * tip_tip;
    system(gears + 2, gears) -= gamma * tip_tip;
    for (int j = 0; j < 2; ++j) {
      r.load_inverse[j] = 1.0 / (1.0 + gamma * (r.load_damping[j] + gamma * r.load_square[j]));
      const double force_per_speed =
          r.load.modes(0, j) * (gamma * k + c) + r.load.modes(1, j) * c_rod;
      system(gears, gears + 1) -= force_per_speed * gamma * r.load_inverse[j] * r.load_from_tip[j];
      system(gears, gears + 2) -= force_per_speed * gamma * r.load_inverse[j] * r.load_from_tip_velocity[j];
    }
  }
  if (channels > 0) r.coupling.compute(system);
}

void solve(Reference& r, double gamma, const double* b, double* x) {
  if (gamma != r.solver_gamma) prepare_solver(r, gamma);
  const FreeHouseModes& modes = r.machine.modes;
  const int n = r.mode_count;
  for (int i = 0; i < r.group_count; ++i) x[r.speeds() + i] = b[r.speeds() + i];
  double house_speed = 0.0, tip_velocity = 0.0, house_angle = 0.0, tip_displacement = 0.0;
  const double* bq = b + r.q();
  const double* bv = b + r.v();
  double* xq = x + r.q();
  double* xv = x + r.v();
  for (int k = 0; k < n; ++k) {
    xv[k] = (bv[k] - gamma * r.square[k] * bq[k]) * r.inverse[k];
    house_speed += modes.house[k] * xv[k];
    tip_velocity += modes.tip[k] * xv[k];
    house_angle += modes.house[k] * bq[k];
    tip_displacement += modes.tip[k] * bq[k];
  }
  house_angle += gamma * house_speed;
  tip_displacement += gamma * tip_velocity;

  const int gears = r.closed_count;
  Channels force(gears + (r.load_count > 0 ? 3 : 0));
  for (int row = 0; row < gears; ++row) {
    const int i = r.closed[row];
    const double angle = b[i] + gamma * x[r.speeds() + i];
    force(row) = r.machine.gear[i].stiffness * (angle - house_angle) +
                 r.machine.gear[i].damping * (x[r.speeds() + i] - house_speed);
  }
  if (r.load_count > 0) {
    double end = 0.0, end_velocity = 0.0, rod_rate = 0.0;
    for (int j = 0; j < 2; ++j) {
      const double position = b[r.load_q() + j];
      double& speed = x[r.load_v() + j];
      speed = (b[r.load_v() + j] - gamma * r.load_square[j] * position) * r.load_inverse[j];
      end += r.load.modes(0, j) * (position + gamma * speed);
      end_velocity += r.load.modes(0, j) * speed;
      rod_rate += r.load.modes(1, j) * speed;
    }
    force(gears) = r.load.rope_stiffness * (end - tip_displacement) +
                   r.load.damping(0, 0) * (end_velocity - tip_velocity) + r.load.damping(0, 1) * rod_rate;
    force(gears + 1) = tip_displacement;
    force(gears + 2) = tip_velocity;
  }
  if (force.size() > 0) force = r.coupling.solve(force).eval();

  double house_torque = 0.0, tip_force = 0.0;
  for (int row = 0; row < gears; ++row) {
    const int i = r.closed[row];
    house_torque += force(row);
    x[r.speeds() + i] -= gamma * force(row) / r.machine.group_inertia[i];
  }
  if (r.load_count > 0) {
    tip_force = force(gears);
    for (int j = 0; j < 2; ++j) {
      x[r.load_v() + j] += gamma * r.load_inverse[j] *
                           (r.load_from_tip[j] * force(gears + 1) + r.load_from_tip_velocity[j] * force(gears + 2));
    }
  }
  for (int k = 0; k < n; ++k) {
    xv[k] += gamma * r.inverse[k] * (modes.house[k] * house_torque + modes.tip[k] * tip_force);
    xq[k] = bq[k] + gamma * xv[k];
  }
  for (int i = 0; i < r.group_count; ++i) x[i] = b[i] + gamma * x[r.speeds() + i];
  for (int j = 0; j < r.load_count; ++j) x[r.load_q() + j] = b[r.load_q() + j] + gamma * x[r.load_v() + j];
  // Extra states: their rates are left out of the Jacobian.
  std::copy(b + r.extra_start(), b + r.size, x + r.extra_start());
}

int solve_newton(SUNLinearSolver solver, SUNMatrix, N_Vector x, N_Vector b, double) {
  Reference& r = *static_cast<Reference*>(solver->content);
  double gamma = 0.0;
  if (r.options.method == ReferenceMethod::kBdf) {
    CVodeGetCurrentGamma(r.integrator, &gamma);
  } else {
    ARKStepGetCurrentGamma(r.integrator, &gamma);
  }
  solve(r, gamma, N_VGetArrayPointer(b), N_VGetArrayPointer(x));
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
  r.solver_gamma = -1.0;
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
double contact_noise(const Reference& r, const Motion& motion, int group, double rate) {
  const double turned = std::fabs(motion.motor_angle[group]) + std::fabs(motion.motor_angle[group] - deflection_of(r, motion, group));
  return kContactNoise * (r.small_angle + turned + std::fabs(rate) * r.now);
}

// Sets every contact that differs from the law; true when one did. Teeth that touch and approach each other count
// as closed: a root function that starts at zero would not be seen to rise.
bool put_contacts_right(Reference& r) {
  Motion motion;
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
  const int groups = machine.crane.drive.group_count;
  if (groups < 1 || groups > kMaximumGroupCount) {
    throw std::invalid_argument("the number of motor groups must be 1 ... 8");
  }
  const bool is_rigid = machine.crane.drive.is_rigid;
  if (is_rigid && (machine.modes.frequency.size() > 1 || machine.crane.load.mass > 0.0)) {
    throw std::invalid_argument("a rigid drive is one inertia: it goes with neither a boom that bends nor a load on a rope");
  }
  for (int i = 0; i < groups && !is_rigid; ++i) {
    if (!(machine.group_inertia[i] > 0.0)) throw std::invalid_argument("a motor group needs an inertia above 0");
    if (!(machine.gear[i].stiffness > 0.0)) throw std::invalid_argument("gearboxes need a stiffness above 0");
  }
  if (!(machine.crane.drive.top_speed > 0.0)) throw std::invalid_argument("the reference's tolerance needs a top speed above 0");
  if (is_rigid && !(machine.crane.drive.rated_torque > 0.0)) {
    throw std::invalid_argument("the reference's tolerance of a rigid machine needs a rated torque above 0");
  }
  if (!(options.tolerance > 0.0)) throw std::invalid_argument("the reference's tolerance must be greater than 0");
  if (extra.start.size() != extra.scale.size()) {
    throw std::invalid_argument("an extra needs a scale for each of its states");
  }

  ReferencePointer reference(new Reference);
  Reference& r = *reference;
  r.machine = std::move(machine);
  r.extra = std::move(extra);
  r.options = options;
  r.group_count = is_rigid ? 0 : groups;
  r.rigid_groups = is_rigid ? groups : 0;
  if (is_rigid) {
    double inertia = driven_inertia(r.machine.crane);
    for (int i = 0; i < groups; ++i) inertia += r.machine.group_inertia[i];
    // The modes are those of what the motors drive; with them, it turns by less for the same torque.
    const double share = std::sqrt(driven_inertia(r.machine.crane) / inertia);
    FreeHouseModes& modes = r.machine.modes;
    for (auto* shape : {&modes.house, &modes.pivot, &modes.tip, &modes.middle, &modes.tip_twist, &modes.uniform_load}) {
      shape->front() *= share;
    }
  }
  r.has_axis_force = r.machine.crane.axis_force.constant != 0.0 || r.machine.crane.axis_force.gravity != 0.0;
  r.mode_count = static_cast<int>(r.machine.modes.frequency.size());
  r.ratio = total_ratio(r.machine.crane.drive);
  for (const double frequency : r.machine.modes.frequency) r.square.push_back(frequency * frequency);
  r.modal_force.assign(r.square.size(), 0.0);
  r.inverse.assign(r.square.size(), 1.0);
  if (r.machine.crane.load.mass > 0.0) {
    r.load_count = 2;
    r.load = load_on_spring(r.machine.crane.load);
    const Eigen::Matrix2d damping = r.load.modes.transpose() * r.load.damping * r.load.modes;
    const Eigen::Vector2d from_velocity = r.load.modes.transpose() * r.load.damping.col(0);
    for (int j = 0; j < 2; ++j) {
      r.load_square[j] = r.load.frequency(j) * r.load.frequency(j);
      r.load_damping[j] = damping(j, j);
      r.load_from_tip[j] = r.load.modes(0, j) * r.load.rope_stiffness;
      r.load_from_tip_velocity[j] = from_velocity(j);
    }
  }
  r.size = r.extra_start() + static_cast<int>(r.extra.start.size());
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
    return Eigen::Vector2d(rates[static_cast<std::size_t>(r.load_v())], rates[static_cast<std::size_t>(r.load_v() + 1)]);
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
    if (flag != (bdf ? CV_ROOT_RETURN : ARK_ROOT_RETURN)) {
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

Motion motion_now(const Reference& r) {
  Motion motion;
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
  const Motion motion = motion_now(r);
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
  const Motion motion = motion_now(r);
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
  const Motion motion = motion_now(r);
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
