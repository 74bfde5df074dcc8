#include "tools/commands/export_fmu_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "sim/machine/machine_tree.h"
#include "tools/commands/home.h"
#include "tools/commands/output_folder.h"
#include "tools/fmu/controller_unit.h"
#include "tools/fmu/model_description.h"
#include "tools/fmu/package.h"
#include "tools/fmu/plant_unit.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

constexpr double kNanosecondsPerMillisecond = 1e6;

std::string content_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path.string() + " cannot be read; the build makes it (target slewlab)");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

fmu::UnitFile unit_file(const ExportFmuOptions& options) {
  common::InputProblems problems;
  fmu::UnitFile file;
  file.root = common::load_yaml_file(options.file, options.overrides, problems);
  if (!problems.empty()) throw common::InputError(problems);
  const common::YamlNode* kind = file.root.find("kind");
  const std::string found = kind == nullptr ? "crane" : kind->scalar;
  if (found != "crane" && found != "axis" && found != "controller") {
    throw common::InputError({{kind->mark, "kind", common::excerpt(*kind), "crane or axis (the plant), or controller"}});
  }
  file.kind = found == "controller" ? fmu::UnitKind::controller : fmu::UnitKind::plant;
  if (file.kind == fmu::UnitKind::controller && !options.of_a_plant.empty()) {
    throw common::InputError({{{options.of_a_plant, 0, 0}, "", "it beside a controller", "it beside a machine: a controller has no plant"}});
  }
  file.period = std::llround(options.period_ms * kNanosecondsPerMillisecond);
  file.plant_step = std::llround(options.plant_step_ms * kNanosecondsPerMillisecond);
  file.seed = options.seed;
  if (file.kind == fmu::UnitKind::plant && (file.plant_step <= 0 || file.period % file.plant_step != 0)) {
    throw common::InputError({{{"--period", 0, 0}, "", fmt::format("{} ms", options.period_ms),
                               fmt::format("a whole multiple of --plant-step, {} ms", options.plant_step_ms)}});
  }
  file.text = fmu::unit_text(file);
  return file;
}

// The folder's files by their names in it, sorted.
std::vector<std::string> files_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) names.push_back(entry.path().lexically_relative(folder).generic_string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

// What the machine of the file does beside slewing, and its FMU does not; empty where it does nothing else.
std::string motions_left_out(const fmu::UnitFile& file) {
  const sim::MotionParameters motions = sim::machine_of(file.root).parameters.motions;
  std::string names;
  for (const auto& [name, rates] : {std::pair{"hoisting", motions.hoisting}, std::pair{"luffing", motions.luffing}, std::pair{"travelling", motions.travelling}}) {
    if (rates.top_speed > 0.0) names += (names.empty() ? "" : ", ") + std::string(name);
  }
  return names.empty() ? "" : "The FMU has no inputs for " + names + ": the machine stands still in that and slews alone.";
}

}  // namespace

int export_fmu(const ExportFmuOptions& options, std::ostream& out) {
  const fmu::UnitFile file = unit_file(options);
  const bool is_plant = file.kind == fmu::UnitKind::plant;
  const auto unit = is_plant ? fmu::make_plant_unit(file) : fmu::make_controller_unit(file);
  const fs::path parts = fmu_parts() / (is_plant ? "plant" : "controller");
  const std::vector<std::string> sources = files_in(parts / "sources");

  fmu::ModelDescription model;
  model.fmi = options.fmi;
  model.name = options.file.stem().string();
  model.identifier = fmu::identifier_of(model.name);
  const common::YamlNode* description = file.root.find("description");
  model.description = description != nullptr ? description->scalar : "";
  const std::string still = is_plant ? motions_left_out(file) : "";
  if (!still.empty()) model.description += (model.description.empty() ? "" : " ") + still;
  for (const std::string& name : sources) {
    if (name.ends_with(".c") || name.ends_with(".cpp")) model.sources.push_back(name);
  }

  const std::string folder = options.fmi == 2 ? "binaries/linux64/" : "binaries/x86_64-linux/";
  std::vector<fmu::PackedFile> files{{"modelDescription.xml", fmu::model_description(model, file, *unit)},
                                     {std::string("resources/") + fmu::kUnitFileName, file.text},
                                     {folder + model.identifier + ".so", content_of(parts / "unit.so"), true}};
  files.push_back({"documentation/licenses/license.txt", content_of(parts / "license.txt")});
  if (options.fmi == 3) files.push_back({"sources/buildDescription.xml", fmu::build_description(model)});
  for (const std::string& name : sources) files.push_back({"sources/" + name, content_of(parts / "sources" / name)});
  const fs::path path = options.out.empty() ? fs::path(model.name + ".fmu") : options.out;
  if (fs::is_directory(path)) throw common::InputError({{{"--out", 0, 0}, "", "'" + path.string() + "', a folder", "the name of the FMU to write, such as " + (path / (model.name + ".fmu")).string()}});
  make_folder_of(path);
  fmu::write_package(path, files);

  const auto count = [&](fmu::Causality causality) {
    return std::count_if(unit->variables().begin(), unit->variables().end(),
                         [&](const fmu::Variable& variable) { return variable.causality == causality; });
  };
  out << fmt::format("{}: {} as FMI {} for co-simulation, {} inputs, {} outputs, step {} ms\n", path.string(), fmu::name_of(file.kind),
                     options.fmi, count(fmu::Causality::input), count(fmu::Causality::output), options.period_ms);
  if (!still.empty()) out << "note: " << still << '\n';
  return 0;
}

}  // namespace slewlab::tools
