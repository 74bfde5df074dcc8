// What a truth machine may have besides the nominal crane. Each law is one physics written anew for the withheld
// cases: where the catalogue (sim/effects) has the same physics, it has another law for it (`difference` says how);
// some laws are in no catalogue at all.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/evaluation/law_scales.h"
#include "diagnosis/evaluation/random.h"
#include "diagnosis/evaluation/truth_machine.h"

namespace slewlab::diagnosis::withheld {

// A parameter of the catalogue's effect and its true value, SI.
struct TrueSize {
  std::string parameter;
  double value = 0.0;
  bool comparable = true;  // false: it shapes the effect, or this law means something else by it
};

// What a machine must have for a law to be drawn on it.
enum class Needs { nothing, boom, load, two_groups, pinion_teeth, gearbox_teeth, play_compensation };

struct Law {
  std::string name;
  std::string effect;      // the catalogue's name; empty: in no catalogue
  std::string subsystem;
  std::string difference;  // from the catalogue's law
  double low, high;        // size in `unit`, from barely visible (first) to large
  double (*unit)(const LawScales&);  // [SI per unit] what the size is a multiple of
  std::vector<TrueSize> (*apply)(TruthMachine&, double size, Random&);  // size in SI
  std::vector<std::string> own = {};  // parameters of the description (sim/machine) that the law is about: they do not spread then
  Needs needs = Needs::nothing;
  // The variable that its missing torque is a function of, as the diagnosis names it (discrepancy.h); empty: of none alone, or the law is in the catalogue.
  std::string follows = {};
};

bool suits(const Law& law, const sim::CraneParameters& nominal, const controller::ControllerSettings& controller);

// Units of sizes.
inline double pure_number(const LawScales&) { return 1.0; }
inline double of_rated_torque(const LawScales& s) { return s.machine.motor_torque; }
inline double of_axis_torque(const LawScales& s) { return s.machine.axis_torque; }
inline double of_period(const LawScales& s) { return s.period; }

// All of them, those of the catalogue first.
const std::vector<Law>& laws();

// Throws std::invalid_argument.
const Law& law_named(const std::string& name);

// The parts of laws(), one source each.
std::vector<Law> drive_laws();
std::vector<Law> house_laws();
std::vector<Law> boom_and_load_laws();
std::vector<Law> wire_laws();  // environment, sensors, wire
std::vector<Law> controller_laws();
std::vector<Law> laws_in_no_catalogue();

}  // namespace slewlab::diagnosis::withheld
