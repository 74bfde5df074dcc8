#include "diagnosis/evaluation/law.h"

#include <stdexcept>

namespace slewlab::diagnosis::withheld {

const std::vector<Law>& laws() {
  static const std::vector<Law> kLaws = [] {
    std::vector<Law> all;
    for (auto part : {drive_laws, house_laws, boom_and_load_laws, wire_laws, controller_laws, laws_in_no_catalogue}) {
      for (Law& law : part()) all.push_back(std::move(law));
    }
    return all;
  }();
  return kLaws;
}

bool suits(const Law& law, const sim::CraneParameters& nominal, const controller::ControllerSettings& controller) {
  switch (law.needs) {
    case Needs::nothing: return true;
    case Needs::boom: return nominal.boom.length > 0.0;
    case Needs::load: return nominal.load.mass > 0.0 && nominal.boom.length > 0.0;
    case Needs::two_groups: return nominal.drive.group_count > 1;
    case Needs::pinion_teeth: return nominal.drive.pinion_teeth > 0;
    case Needs::gearbox_teeth: return nominal.drive.gearbox_ring_teeth > 0;
    case Needs::play_compensation: return nominal.drive.group_count > 1 && controller.play_compensation.enabled;
  }
  return true;
}

const Law& law_named(const std::string& name) {
  for (const Law& law : laws()) {
    if (law.name == name) return law;
  }
  throw std::invalid_argument("no law of the withheld cases is called " + name);
}

}  // namespace slewlab::diagnosis::withheld
