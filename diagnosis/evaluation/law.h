// What a truth machine may have besides the nominal crane. Each law is one physics written anew for the withheld
// cases: where the catalogue (sim/effects) has the same physics, it has another law for it (`difference` says how);
// some laws are in no catalogue at all.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/evaluation/random.h"
#include "diagnosis/evaluation/truth_machine.h"

namespace slewlab::diagnosis::withheld {

// A parameter of the catalogue's effect and its true value, SI.
struct TrueSize {
  std::string parameter;
  double value = 0.0;
  bool comparable = true;  // false: it shapes the effect, or this law means something else by it
};

struct Law {
  std::string name;
  std::string effect;      // the catalogue's name; empty: in no catalogue
  std::string subsystem;
  std::string difference;  // from the catalogue's law
  double low, high;        // size, from barely visible (first) to large
  std::vector<TrueSize> (*apply)(TruthMachine&, double size, Random&);
  std::vector<std::string> own = {};  // spread parameters (draw.h) that the law is about: they do not spread then
};

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
