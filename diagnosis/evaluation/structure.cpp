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

void compress(const sim::BoomParameters& boom, double force, Eigen::MatrixXd& stiffness) {
  const int count = boom.element_count;
  const Eigen::Matrix4d element = geometric_stiffness(boom.length / count);
  for (int e = 0; e < count; ++e) {
    const int at[4] = {3 * e, 3 * e + 1, 3 * e + 3, 3 * e + 4};
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) stiffness(at[i], at[j]) -= force * element(i, j);
    }
  }
  const double towards_pivot = force / boom.length;
  stiffness(0, 0) += towards_pivot;
  stiffness(3 * count, 3 * count) += towards_pivot;
  stiffness(0, 3 * count) -= towards_pivot;
  stiffness(3 * count, 0) -= towards_pivot;
}

}  // namespace

Structure make_structure(const sim::CraneParameters& crane, const StructureChange& change) {
  const sim::BoomParameters& boom = crane.boom;
  const int elements = boom.element_count;
  if (elements < 2 || elements % 2 != 0) {
    throw std::invalid_argument("a truth machine needs an even number of boom elements");
  }
  const bool has_pedestal = std::isfinite(change.pedestal_stiffness);
  const bool has_ring = std::isfinite(change.ring_stiffness);
  const int pedestal = has_pedestal ? 0 : -1;
  const int ring = has_pedestal ? 1 : 0;
  const int house = has_ring ? ring + 1 : ring;
  const int first_node = house + 1;
  const int size = first_node + 3 * elements;

  sim::BoomMatrices beam = sim::assemble_boom(boom);
  if (change.axial_force != 0.0) compress(boom, change.axial_force, beam.stiffness);
  const int tip = 3 * elements;
  if (change.jib_mass > 0.0) {
    const double e = change.jib_eccentricity;
    beam.mass(tip, tip) += change.jib_mass;
    beam.mass(tip, tip + 2) += change.jib_mass * e;
    beam.mass(tip + 2, tip) += change.jib_mass * e;
    beam.mass(tip + 2, tip + 2) += change.jib_mass * e * e;
  }

  // Boom nodes from the degrees of freedom.
  Eigen::MatrixXd nodes = Eigen::MatrixXd::Zero(tip + 3, size);
  nodes.block<3, 1>(0, house) = sim::pivot_motion(boom);
  if (has_pedestal) nodes(0, pedestal) = 1.0;
  nodes.bottomRightCorner(3 * elements, 3 * elements).setIdentity();

  Eigen::MatrixXd mass = nodes.transpose() * beam.mass * nodes;
  const Eigen::MatrixXd steel = nodes.transpose() * beam.stiffness * nodes;
  Eigen::MatrixXd stiffness = steel;
  if (has_ring) {
    mass(ring, ring) += change.ring_inertia_share * crane.house.inertia;
    mass(house, house) += (1.0 - change.ring_inertia_share) * crane.house.inertia;
    const double k = change.ring_stiffness;
    stiffness(ring, ring) += k;
    stiffness(house, house) += k;
    stiffness(ring, house) -= k;
    stiffness(house, ring) -= k;
  } else {
    mass(house, house) += crane.house.inertia;
  }
  double pedestal_damping = 0.0;
  if (has_pedestal) {
    mass(pedestal, pedestal) += change.pedestal_mass;
    stiffness(pedestal, pedestal) += change.pedestal_stiffness;
    pedestal_damping = 2.0 * change.pedestal_damping_ratio *
                       std::sqrt(change.pedestal_stiffness * (change.pedestal_mass + boom.mass));
  }

  // The rigid rotation is known; the solver's lowest mode only approximates it.
  Eigen::VectorXd rigid = Eigen::VectorXd::Zero(size);
  rigid(ring) = rigid(house) = 1.0;
  for (int node = 1; node <= elements; ++node) {
    const double x = boom.length * node / elements;
    rigid.segment<3>(first_node + 3 * (node - 1)) =
        Eigen::Vector3d(boom.pivot_radius + x * std::cos(boom.angle), std::cos(boom.angle), std::sin(boom.angle));
  }
  rigid /= std::sqrt(rigid.dot(mass * rigid));
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(stiffness, mass);
  Eigen::MatrixXd shapes = solver.eigenvectors();
  shapes.col(0) = rigid;
  if (solver.eigenvalues()(1) <= 0.0 || solver.eigenvalues()(0) < -1e-3 * solver.eigenvalues()(1)) {
    throw std::invalid_argument("the axial force buckles the boom");
  }

  const double a1 = sim::boom_damping_coefficient(boom);
  Structure result;
  sim::FreeHouseModes& modes = result.modes;
  modes.shear = Eigen::MatrixXd::Zero(elements, size);
  const double h = boom.length / elements;
  for (int k = 0; k < size; ++k) {
    const double square = k == 0 ? 0.0 : solver.eigenvalues()(k);
    Eigen::VectorXd shape = shapes.col(k);
    Eigen::VectorXd at = nodes * shape;
    double rope = at(tip) + change.jib_eccentricity * at(tip + 2);
    const double side = std::fabs(rope) > 1e-9 * shape.cwiseAbs().maxCoeff() ? rope : shape(ring);
    if (side < 0.0) {
      shape = -shape;
      at = -at;
      rope = -rope;
    }
    double integral = 0.0;
    for (int e = 0; e < elements; ++e) {
      integral += h * (0.5 * (at(3 * e) + at(3 * e + 3)) + h * (at(3 * e + 1) - at(3 * e + 4)) / 12.0);
      if (k > 0) {
        modes.shear(e, k) = beam.element_rigidity[static_cast<std::size_t>(e)] / (h * h * h) *
                            (12.0 * (at(3 * e) - at(3 * e + 3)) + 6.0 * h * (at(3 * e + 1) + at(3 * e + 4)));
      }
    }
    const double frequency = std::sqrt(square);
    const double power = k == 0 ? 1.0 : std::pow(frequency / change.damping_pivot, change.damping_power);
    const double steel_square = k == 0 ? 0.0 : shape.dot(steel * shape);
    double damping = a1 * change.damping_factor * power * steel_square;
    if (has_pedestal) damping += pedestal_damping * shape(pedestal) * shape(pedestal);
    modes.frequency.push_back(frequency);
    modes.damping_rate.push_back(damping);
    modes.house.push_back(shape(ring));
    modes.pivot.push_back(shape(house));
    modes.tip.push_back(rope);
    const int middle = 3 * (elements / 2);
    modes.middle.push_back(at(middle));
    modes.tip_twist.push_back(at(tip + 2));
    modes.uniform_load.push_back(integral);
    const double sideways = has_pedestal ? shape(pedestal) : 0.0;
    const auto felt_at = [&](sim::SensorPlace place) {
      switch (place) {
        case sim::SensorPlace::house: return crane.house.sensor_radius * shape(house) + sideways;
        case sim::SensorPlace::pivot: return boom.pivot_radius * shape(house) + sideways;
        case sim::SensorPlace::middle: return at(middle);
        case sim::SensorPlace::tip: return at(tip);
        default: return shape(house);  // what turns
      }
    };
    for (std::size_t s = 0; s < result.sensors.size(); ++s) {
      result.sensors[s].push_back(felt_at(sim::place_named(msgs::kSensorFields<msgs::SensorReadings>[s].place)));
    }
  }
  return result;
}

}  // namespace slewlab::diagnosis::withheld
