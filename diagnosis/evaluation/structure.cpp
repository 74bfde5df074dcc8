#include "diagnosis/evaluation/structure.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>

#include "sim/machine/description.h"
#include "sim/model/boom.h"

namespace slewlab::diagnosis::withheld {

namespace {

// Consistent geometric stiffness of a beam element of length l under 1 N of tension, order [y, phi, y, phi].
Eigen::Matrix4d geometric_stiffness(double l) {
  Eigen::Matrix4d matrix;
  matrix << 36, 3 * l, -36, 3 * l,            //
      3 * l, 4 * l * l, -3 * l, -l * l,       //
      -36, -3 * l, 36, -3 * l,                //
      3 * l, -l * l, -3 * l, 4 * l * l;
  return matrix / (30.0 * l);
}

// [y, phi] at both ends of an element from its nodes' [y, phi, psi], in its own axes: at a knuckle they are those of the part behind it.
Eigen::Matrix<double, 4, 6> ends_of_element(const sim::BoomParameters& boom, int element) {
  Eigen::Matrix<double, 4, 6> ends = Eigen::Matrix<double, 4, 6>::Zero();
  ends(0, 0) = ends(1, 1) = ends(2, 3) = ends(3, 4) = 1.0;
  if (element > 0 && element == sim::elements_before_knuckle(boom)) ends.block<1, 2>(1, 1) = sim::behind_knuckle(boom).row(0);
  return ends;
}

void compress(const sim::BoomParameters& boom, double force, Eigen::MatrixXd& stiffness) {
  const int count = boom.element_count;
  for (int e = 0; e < count; ++e) {
    const Eigen::Matrix<double, 4, 6> ends = ends_of_element(boom, e);
    stiffness.block<6, 6>(3 * e, 3 * e) -= force * ends.transpose() * geometric_stiffness(sim::length_of_element(boom, e)) * ends;
  }
  const double towards_pivot = force / boom.length;
  stiffness(0, 0) += towards_pivot;
  stiffness(3 * count, 3 * count) += towards_pivot;
  stiffness(0, 3 * count) -= towards_pivot;
  stiffness(3 * count, 0) -= towards_pivot;
}

// Where each degree of freedom stands.
struct Freedoms {
  bool has_pedestal, has_ring;
  int pedestal;  // -1: none
  int ring, house;  // the same where nothing gives between them
  int first_node;
  int tip;  // of the boom's nodes, of which the first stands on the house
  int size;
};

Freedoms freedoms_of(const StructureChange& change, int elements) {
  Freedoms at{};
  at.has_pedestal = std::isfinite(change.pedestal_stiffness);
  at.has_ring = std::isfinite(change.ring_stiffness);
  at.pedestal = at.has_pedestal ? 0 : -1;
  at.ring = at.has_pedestal ? 1 : 0;
  at.house = at.has_ring ? at.ring + 1 : at.ring;
  at.first_node = at.house + 1;
  at.tip = 3 * elements;
  at.size = at.first_node + at.tip;
  return at;
}

sim::BoomMatrices changed_boom(const sim::BoomParameters& boom, const StructureChange& change, int tip) {
  sim::BoomMatrices beam = sim::assemble_boom(boom);
  if (change.axial_force != 0.0) compress(boom, change.axial_force, beam.stiffness);
  if (change.jib_mass > 0.0) {
    const double e = change.jib_eccentricity;
    beam.mass(tip, tip) += change.jib_mass;
    beam.mass(tip, tip + 2) += change.jib_mass * e;
    beam.mass(tip + 2, tip) += change.jib_mass * e;
    beam.mass(tip + 2, tip + 2) += change.jib_mass * e * e;
  }
  return beam;
}

// Boom nodes from the degrees of freedom.
Eigen::MatrixXd nodes_of(const sim::BoomParameters& boom, const Freedoms& at) {
  Eigen::MatrixXd nodes = Eigen::MatrixXd::Zero(at.tip + 3, at.size);
  nodes.block<3, 1>(0, at.house) = sim::pivot_motion(boom);
  if (at.has_pedestal) nodes(0, at.pedestal) = 1.0;
  nodes.bottomRightCorner(at.tip, at.tip).setIdentity();
  return nodes;
}

void add_house(const sim::HouseParameters& house, const StructureChange& change, const Freedoms& at, Eigen::MatrixXd& mass,
               Eigen::MatrixXd& stiffness) {
  if (!at.has_ring) {
    mass(at.house, at.house) += house.inertia;
    return;
  }
  mass(at.ring, at.ring) += change.ring_inertia_share * house.inertia;
  mass(at.house, at.house) += (1.0 - change.ring_inertia_share) * house.inertia;
  const double k = change.ring_stiffness;
  stiffness(at.ring, at.ring) += k;
  stiffness(at.house, at.house) += k;
  stiffness(at.ring, at.house) -= k;
  stiffness(at.house, at.ring) -= k;
}

// [N s/m] of the pedestal, at its own frequency under house and boom.
double pedestal_damping_of(const sim::BoomParameters& boom, const StructureChange& change) {
  return 2.0 * change.pedestal_damping_ratio * std::sqrt(change.pedestal_stiffness * (change.pedestal_mass + boom.mass));
}

// All turns as one, of unit modal mass.
Eigen::VectorXd rigid_rotation(const sim::BoomParameters& boom, const Freedoms& at, const Eigen::MatrixXd& mass) {
  const int elements = boom.element_count;
  Eigen::VectorXd rigid = Eigen::VectorXd::Zero(at.size);
  rigid(at.ring) = rigid(at.house) = 1.0;
  for (int node = 1; node <= elements; ++node) {
    const sim::BoomPoint point = sim::point_of_node(boom, node);
    rigid.segment<3>(at.first_node + 3 * (node - 1)) = Eigen::Vector3d(point.radius, std::cos(point.angle), std::sin(point.angle));
  }
  rigid /= std::sqrt(rigid.dot(mass * rigid));
  return rigid;
}

// [y, phi] at an element's ends.
Eigen::Vector4d bent(const sim::BoomParameters& boom, const Eigen::VectorXd& nodes, int element) {
  return ends_of_element(boom, element) * nodes.segment<6>(3 * element);
}

// [m^2] under the boom's deflection, of Hermite's cubics between the nodes.
double area_under(const sim::BoomParameters& boom, const Eigen::VectorXd& nodes) {
  double integral = 0.0;
  for (int e = 0; e < boom.element_count; ++e) {
    const double h = sim::length_of_element(boom, e);
    const Eigen::Vector4d at = bent(boom, nodes, e);
    integral += h * (0.5 * (at(0) + at(2)) + h * (at(1) - at(3)) / 12.0);
  }
  return integral;
}

double shear_in(const sim::BoomParameters& boom, const Eigen::VectorXd& nodes, int e, double rigidity) {
  const double h = sim::length_of_element(boom, e);
  const Eigen::Vector4d at = bent(boom, nodes, e);
  return rigidity / (h * h * h) * (12.0 * (at(0) - at(2)) + 6.0 * h * (at(1) + at(3)));
}

// [m] Deflection halfway along the boom, of the cubic there.
double in_the_middle(const sim::BoomParameters& boom, const Eigen::VectorXd& nodes) {
  int e = 0;
  while (sim::share_of_node(boom, e + 1) < 0.5) ++e;
  const double h = sim::length_of_element(boom, e), s = (0.5 - sim::share_of_node(boom, e)) * boom.length / h, s2 = s * s, s3 = s2 * s;
  return bent(boom, nodes, e).dot(Eigen::Vector4d(1.0 - 3.0 * s2 + 2.0 * s3, h * (s - 2.0 * s2 + s3), 3.0 * s2 - 2.0 * s3, h * (s3 - s2)));
}

// A mode: its shape, the boom's nodes in it, and where the rope leaves.
struct Shape {
  Eigen::VectorXd freedoms, nodes;
  double rope;
};

// The rope's end moves the positive way; where it stands still, the ring does.
Shape turned(Eigen::VectorXd freedoms, const Eigen::MatrixXd& nodes, const StructureChange& change, const Freedoms& at) {
  Shape shape{std::move(freedoms), {}, 0.0};
  shape.nodes = nodes * shape.freedoms;
  shape.rope = shape.nodes(at.tip) + change.jib_eccentricity * shape.nodes(at.tip + 2);
  const double side = std::fabs(shape.rope) > 1e-9 * shape.freedoms.cwiseAbs().maxCoeff() ? shape.rope : shape.freedoms(at.ring);
  if (side < 0.0) {
    shape.freedoms = -shape.freedoms;
    shape.nodes = -shape.nodes;
    shape.rope = -shape.rope;
  }
  return shape;
}

// What a place feels of the mode: [m] lateral, [rad] of the house.
double felt_at(sim::SensorPlace place, const sim::CraneParameters& crane, const Shape& shape, const Freedoms& at) {
  const double sideways = at.has_pedestal ? shape.freedoms(at.pedestal) : 0.0;
  switch (place) {
    case sim::SensorPlace::house: return crane.house.sensor_radius * shape.freedoms(at.house) + sideways;
    case sim::SensorPlace::pivot: return crane.boom.pivot_radius * shape.freedoms(at.house) + sideways;
    case sim::SensorPlace::middle: return in_the_middle(crane.boom, shape.nodes);
    case sim::SensorPlace::tip: return shape.nodes(at.tip);
    default: return shape.freedoms(at.house);  // what turns
  }
}

}  // namespace

Structure make_structure(const sim::CraneParameters& crane, const StructureChange& change) {
  const sim::BoomParameters& boom = crane.boom;
  const int elements = boom.element_count;
  if (elements < 2 || elements % 2 != 0) {
    throw std::invalid_argument("a truth machine needs an even number of boom elements");
  }
  const Freedoms at = freedoms_of(change, elements);
  const sim::BoomMatrices beam = changed_boom(boom, change, at.tip);
  const Eigen::MatrixXd nodes = nodes_of(boom, at);
  Eigen::MatrixXd mass = nodes.transpose() * beam.mass * nodes;
  const Eigen::MatrixXd steel = nodes.transpose() * beam.stiffness * nodes;
  Eigen::MatrixXd stiffness = steel;
  add_house(crane.house, change, at, mass, stiffness);
  double pedestal_damping = 0.0;
  if (at.has_pedestal) {
    mass(at.pedestal, at.pedestal) += change.pedestal_mass;
    stiffness(at.pedestal, at.pedestal) += change.pedestal_stiffness;
    pedestal_damping = pedestal_damping_of(boom, change);
  }

  // The rigid rotation is known; the solver's lowest mode only approximates it.
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(stiffness, mass);
  Eigen::MatrixXd shapes = solver.eigenvectors();
  shapes.col(0) = rigid_rotation(boom, at, mass);
  if (solver.eigenvalues()(1) <= 0.0 || solver.eigenvalues()(0) < -1e-3 * solver.eigenvalues()(1)) {
    throw std::invalid_argument("the axial force buckles the boom");
  }

  const double a1 = sim::boom_damping_coefficient(boom);
  Structure result;
  sim::FreeHouseModes& modes = result.modes;
  modes.shear = Eigen::MatrixXd::Zero(elements, at.size);
  for (int k = 0; k < at.size; ++k) {
    const Shape shape = turned(shapes.col(k), nodes, change, at);
    const double frequency = std::sqrt(k == 0 ? 0.0 : solver.eigenvalues()(k));
    const double power = k == 0 ? 1.0 : std::pow(frequency / change.damping_pivot, change.damping_power);
    const double steel_square = k == 0 ? 0.0 : shape.freedoms.dot(steel * shape.freedoms);
    double damping = a1 * change.damping_factor * power * steel_square;
    if (at.has_pedestal) damping += pedestal_damping * shape.freedoms(at.pedestal) * shape.freedoms(at.pedestal);
    for (int e = 0; k > 0 && e < elements; ++e) modes.shear(e, k) = shear_in(boom, shape.nodes, e, beam.element_rigidity[static_cast<std::size_t>(e)]);
    modes.frequency.push_back(frequency);
    modes.damping_rate.push_back(damping);
    modes.house.push_back(shape.freedoms(at.ring));
    modes.pivot.push_back(shape.freedoms(at.house));
    modes.tip.push_back(shape.rope);
    modes.middle.push_back(felt_at(sim::SensorPlace::middle, crane, shape, at));
    modes.tip_twist.push_back(shape.nodes(at.tip + 2));
    modes.uniform_load.push_back(area_under(boom, shape.nodes));
    for (std::size_t s = 0; s < result.sensors.size(); ++s) {
      result.sensors[s].push_back(felt_at(sim::place_named(msgs::kSensorFields<msgs::SensorReadings>[s].place), crane, shape, at));
    }
  }
  return result;
}

}  // namespace slewlab::diagnosis::withheld
