#include "tools/commands/modes_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/input_error.h"
#include "sim/analysis/bode.h"
#include "sim/analysis/eigen.h"
#include "sim/machine/machine_file.h"
#include "sim/model/cannot_be_built.h"
#include "tools/commands/output_folder.h"
#include "tools/commands/whole_file.h"

namespace slewlab::tools {

namespace {

// The fifth bending mode is the highest that the thesis looks at, and that a mesh of a few elements still has right.
constexpr int kHighestBending = 5;
constexpr double kShownAbove = 1.6;                  // times the fifth bending mode
constexpr double kBodeBelow = 0.15, kBodeAbove = 2.7;  // times the slowest mode, and the fifth bending mode
constexpr int kBodePoints = 2000;
constexpr std::array<int, 11> kMeshes{1, 2, 3, 4, 5, 6, 8, 16, 32, 64, 128};

// [Hz] The fifth bending mode, or the highest mode of a machine that has none.
double highest_of_interest(const std::vector<sim::Mode>& modes) {
  const double bending = sim::frequency_of(modes, sim::ModeKind::kBending, kHighestBending);
  return std::isnan(bending) ? modes.back().frequency : bending;
}

// An axis has a frequency and a damping, and no load and boom to share its energy with.
void print_modes(const std::vector<sim::Mode>& modes, double highest, bool is_axis, std::ostream& out) {
  if (is_axis) {
    out << fmt::format("  {:>10}  {:<14} {:>9}\n  {:>10}  {:<14} {:>9}\n", "frequency", "kind", "damping", "[Hz]", "", "[%]");
    for (const sim::Mode& mode : modes) {
      const bool rigid = mode.kind == sim::ModeKind::kRigid;
      out << fmt::format("  {:>10.3f}  {:<14} {:>9.2f}\n", rigid ? 0.0 : mode.frequency, rigid ? "rigid" : "transmission",
                         100.0 * mode.damping_ratio);
    }
    return;
  }
  out << fmt::format("  {:>10}  {:<11} {:>9}   {:>6} {:>6} {:>6}   {:>7} {:>8}\n", "frequency", "kind", "damping",
                     "gears", "load", "boom", "bending", "torsion");
  out << fmt::format("  {:>10}  {:<11} {:>9}   {:^20}   {:^16}\n", "[Hz]", "", "[%]", "elastic energy [%]",
                     "motion [%]");
  for (const sim::Mode& mode : modes) {
    if (mode.frequency > highest) break;
    const bool rigid = mode.kind == sim::ModeKind::kRigid;
    out << fmt::format("  {:>10.3f}  {:<11} {:>9.2f}   {:>6.0f} {:>6.0f} {:>6.0f}   {:>7.0f} {:>8.0f}\n",
                       rigid ? 0.0 : mode.frequency, fmt::format("{} {}", sim::name_of(mode.kind), mode.count),
                       100.0 * mode.damping_ratio, 100.0 * mode.energy.gear, 100.0 * mode.energy.load,
                       100.0 * mode.energy.boom, 100.0 * mode.energy.bending_motion,
                       100.0 * mode.energy.torsion_motion);
  }
}

void print_convergence(const sim::CraneParameters& crane, std::ostream& out) {
  constexpr int kBending = kHighestBending;
  using Frequencies = std::array<double, kBending + 1>;
  const auto frequencies = [&](int elements) {
    sim::CraneParameters meshed = crane;
    meshed.boom.element_count = elements;
    const std::vector<sim::Mode> modes = sim::crane_modes(meshed);
    Frequencies result{};
    for (int i = 0; i < kBending; ++i) {
      result[static_cast<std::size_t>(i)] = sim::frequency_of(modes, sim::ModeKind::kBending, i + 1);
    }
    result[kBending] = sim::frequency_of(modes, sim::ModeKind::kTorsion, 1);
    return result;
  };
  // Nothing where the boom has no such mesh: one with a knuckle has two elements or more.
  const auto admitted = [&](int elements) -> std::optional<Frequencies> {
    try {
      return frequencies(elements);
    } catch (const sim::CannotBeBuilt&) {
      return std::nullopt;
    }
  };
  const Frequencies reference = frequencies(kMeshes.back());
  out << fmt::format("  {:>8}", "elements");
  for (int i = 1; i <= kBending; ++i) out << fmt::format("  {:>18}", fmt::format("bending {}", i));
  out << fmt::format("  {:>18}\n", "torsion 1");
  for (const int elements : kMeshes) {
    const std::optional<Frequencies> values = admitted(elements);
    if (!values) continue;
    out << fmt::format("  {:>8}", elements);
    for (std::size_t i = 0; i < values->size(); ++i) {
      out << (std::isnan((*values)[i]) ? fmt::format("  {:>18}", "-")
                                       : fmt::format("  {:>8.3f} {:>+8.2f}%", (*values)[i],
                                                     100.0 * ((*values)[i] / reference[i] - 1.0)));
    }
    out << '\n';
  }
}

[[noreturn]] void refuse(const char* option, const std::string& found, const std::string& expected) {
  throw common::InputError({{{option, 0, 0}, "", found, expected}});
}

std::string bode_csv(const sim::CraneParameters& crane) {
  std::string text = "frequency_Hz,magnitude_dB,phase_deg,real_m_per_s_per_Nm,imaginary_m_per_s_per_Nm\n";
  const std::vector<sim::Mode> modes = sim::crane_modes(crane);
  const auto swinging = std::find_if(modes.begin(), modes.end(), [](const sim::Mode& mode) { return mode.kind != sim::ModeKind::kRigid; });
  if (swinging == modes.end()) throw std::runtime_error("nothing of this crane swings; --bode is the response of what does");
  const auto frequencies =
      sim::logarithmic_frequencies(kBodeBelow * swinging->frequency, kBodeAbove * highest_of_interest(modes), kBodePoints);
  for (const sim::BodePoint& point : sim::frequency_response(crane, frequencies)) {
    text += fmt::format("{:.6g},{:.6g},{:.6g},{:.9g},{:.9g}\n", point.frequency, sim::decibel(point.tip_velocity),
                        std::arg(point.tip_velocity) * 180.0 / std::numbers::pi, point.tip_velocity.real(),
                        point.tip_velocity.imag());
  }
  return text;
}

}  // namespace

int show_modes(const ModesOptions& options, std::ostream& out) {
  const sim::MachineFile file = sim::load_machine_file(options.crane, options.overrides);
  sim::CraneParameters crane = file.parameters;
  const bool is_axis = file.kind == sim::MachineKind::axis;
  if (is_axis && !options.bode.empty()) {
    refuse("--bode", options.bode.string(), "no response of " + options.crane.string() + ": an axis has no tip whose velocity it would be");
  }
  make_folder_of(options.bode, "--bode");
  if (options.elements > 0 && crane.boom.length == 0.0) {
    refuse("--elements", std::to_string(options.elements), "none: " + options.crane.string() + " has no boom");
  }
  if (options.elements >= 0) crane.boom.element_count = options.elements;

  std::vector<sim::Mode> modes;
  try {
    modes = sim::crane_modes(crane);
  } catch (const sim::CannotBeBuilt& error) {
    if (options.elements < 0) throw;
    refuse("--elements", std::to_string(options.elements), std::string("another number: ") + error.what());
  }
  if (is_axis) {
    out << fmt::format("{}: axis, {}\n", options.crane.string(),
                       crane.drive.is_rigid ? "rigid transmission: one inertia" : "transmission in contact");
  } else {
    out << fmt::format("{}: whole crane, gears closed, {} boom element(s)\n", options.crane.string(), crane.boom.element_count);
  }
  const double highest = kShownAbove * highest_of_interest(modes);
  print_modes(modes, highest, is_axis, out);
  if (crane.boom.element_count > 0) {
    out << "\nBoom clamped at its pivot\n";
    print_modes(sim::clamped_boom_modes(crane.boom), highest, false, out);
    out << fmt::format("\nConvergence [Hz], deviation from {} elements, whole crane\n", kMeshes.back());
    print_convergence(crane, out);
  }
  if (!options.bode.empty()) {
    write_whole_file(options.bode, bode_csv(crane));
    out << fmt::format("\nMotor torque (per motor, on every motor) to tip velocity: {}\n", options.bode.string());
  }
  return 0;
}

}  // namespace slewlab::tools
