#include "tools/fmu/model_description.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>
#include <string_view>

#include "common/xml_text.h"

namespace slewlab::tools::fmu {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;

// The messages' spelling, FMI's (that of Modelica), and exponents of the SI units.
struct UnitDefinition {
  std::string_view message, fmi, exponents;
};
constexpr std::array<UnitDefinition, 10> kUnits{{
    {"s", "s", R"(s="1")"},
    {"rad", "rad", R"(rad="1")"},
    {"rad/s", "rad/s", R"(rad="1" s="-1")"},
    {"Nm", "N.m", R"(kg="1" m="2" s="-2")"},
    {"N", "N", R"(kg="1" m="1" s="-2")"},
    {"J", "J", R"(kg="1" m="2" s="-2")"},
    {"m", "m", R"(m="1")"},
    {"m/s", "m/s", R"(m="1" s="-1")"},
    {"m/s^2", "m/s2", R"(m="1" s="-2")"},
    {"-", "1", ""},
}};

const UnitDefinition& definition_of(const std::string& unit) {
  const auto found = std::find_if(kUnits.begin(), kUnits.end(), [&](const UnitDefinition& known) { return known.message == unit; });
  if (found == kUnits.end()) throw std::invalid_argument("no definition of the unit " + unit + " for an FMU");
  return *found;
}

std::string unit_definitions(const std::vector<Variable>& variables) {
  std::string text = "  <UnitDefinitions>\n";
  for (const UnitDefinition& unit : kUnits) {
    const bool is_used = unit.message == "s" || std::any_of(variables.begin(), variables.end(), [&](const Variable& variable) {
                           return variable.type == FMU_REAL && variable.unit == unit.message;
                         });
    if (!is_used) continue;
    text += fmt::format("    <Unit name=\"{}\"><BaseUnit{}{}/></Unit>\n", unit.fmi, unit.exponents.empty() ? "" : " ", unit.exponents);
  }
  return text + "  </UnitDefinitions>\n";
}

constexpr std::string_view kLogCategories =
    "  <LogCategories><Category name=\"logStatusError\" description=\"why a call was refused\"/></LogCategories>\n";

std::string default_experiment(const UnitFile& file) {
  return fmt::format("  <DefaultExperiment startTime=\"0\" stepSize=\"{}\"/>\n", static_cast<double>(file.period) / kNanosecondsPerSecond);
}

std::string_view name_of(Causality causality) {
  switch (causality) {
    case Causality::parameter: return "parameter";
    case Causality::input: return "input";
    default: return "output";
  }
}

// What a master holds over its step, and what a controller says, are steps in time.
std::string_view variability_of(const Variable& variable, UnitKind kind) {
  if (variable.causality == Causality::parameter) return "fixed";
  const bool is_smooth = variable.causality == Causality::output && kind == UnitKind::plant && variable.type == FMU_REAL;
  return is_smooth ? "continuous" : "discrete";
}

std::string start_of(const Variable& variable) {
  if (variable.causality == Causality::output) return "";
  const std::string value = variable.type == FMU_BOOLEAN ? (variable.start != 0.0 ? "true" : "false") : fmt::format("{}", variable.start);
  return fmt::format(" start=\"{}\"", value);
}

std::string unit_of(const Variable& variable) {
  return variable.type == FMU_REAL ? fmt::format(" unit=\"{}\"", definition_of(variable.unit).fmi) : "";
}

// What both versions say of a variable alike.
std::string attributes(const Variable& variable, std::size_t reference, UnitKind kind) {
  return fmt::format("name=\"{}\" valueReference=\"{}\" causality=\"{}\" variability=\"{}\" description=\"{}\"", common::xml_text(variable.name),
                     reference, name_of(variable.causality), variability_of(variable, kind), common::xml_text(variable.description));
}

std::string fmi2(const ModelDescription& model, const UnitFile& file, const Unit& unit) {
  constexpr std::array<std::string_view, 3> kTypes{"Real", "Integer", "Boolean"};
  std::string text = fmt::format(
      "<fmiModelDescription fmiVersion=\"2.0\" modelName=\"{}\" guid=\"{}\" description=\"{}\" generationTool=\"slewlab {}\" "
      "variableNamingConvention=\"structured\" numberOfEventIndicators=\"0\">\n"
      "  <CoSimulation modelIdentifier=\"{}\" canHandleVariableCommunicationStepSize=\"{}\" canNotUseMemoryManagementFunctions=\"true\" "
      "canGetAndSetFMUstate=\"true\">\n",
      common::xml_text(model.name), token_of(file), common::xml_text(model.description), SLEWLAB_VERSION, model.identifier,
      file.kind == UnitKind::plant ? "true" : "false");
  if (!model.sources.empty()) {
    text += "    <SourceFiles>\n";
    for (const std::string& source : model.sources) text += fmt::format("      <File name=\"{}\"/>\n", common::xml_text(source));
    text += "    </SourceFiles>\n";
  }
  text += "  </CoSimulation>\n" + unit_definitions(unit.variables());
  text += kLogCategories;
  text += default_experiment(file) + "  <ModelVariables>\n";
  std::string outputs;
  for (std::size_t i = 0; i < unit.variables().size(); ++i) {
    const Variable& variable = unit.variables()[i];
    text += fmt::format("    <ScalarVariable {}><{}{}{}/></ScalarVariable>\n", attributes(variable, i + 1, file.kind), kTypes[variable.type],
                        unit_of(variable), start_of(variable));
    if (variable.causality == Causality::output) outputs += fmt::format("      <Unknown index=\"{}\"/>\n", i + 1);
  }
  text += "  </ModelVariables>\n  <ModelStructure>\n    <Outputs>\n" + outputs + "    </Outputs>\n    <InitialUnknowns>\n" + outputs +
          "    </InitialUnknowns>\n  </ModelStructure>\n</fmiModelDescription>\n";
  return text;
}

std::string fmi3(const ModelDescription& model, const UnitFile& file, const Unit& unit) {
  constexpr std::array<std::string_view, 3> kTypes{"Float64", "Int64", "Boolean"};
  const bool is_plant = file.kind == UnitKind::plant;
  const double inner_step = static_cast<double>(is_plant ? file.plant_step : file.period) / kNanosecondsPerSecond;
  std::string text = fmt::format(
      "<fmiModelDescription fmiVersion=\"3.0\" modelName=\"{}\" instantiationToken=\"{}\" description=\"{}\" generationTool=\"slewlab {}\" "
      "variableNamingConvention=\"structured\">\n"
      "  <CoSimulation modelIdentifier=\"{}\" canHandleVariableCommunicationStepSize=\"{}\" fixedInternalStepSize=\"{}\" "
      "canGetAndSetFMUState=\"true\"/>\n",
      common::xml_text(model.name), token_of(file), common::xml_text(model.description), SLEWLAB_VERSION, model.identifier, is_plant ? "true" : "false",
      inner_step);
  text += unit_definitions(unit.variables());
  text += kLogCategories;
  text += default_experiment(file);
  text +=
      "  <ModelVariables>\n    <Float64 name=\"time\" valueReference=\"0\" causality=\"independent\" variability=\"continuous\" "
      "description=\"simulated time\" unit=\"s\"/>\n";
  std::string outputs, initial;
  for (std::size_t i = 0; i < unit.variables().size(); ++i) {
    const Variable& variable = unit.variables()[i];
    text += fmt::format("    <{} {}{}{}/>\n", kTypes[variable.type], attributes(variable, i + 1, file.kind), unit_of(variable), start_of(variable));
    if (variable.causality != Causality::output) continue;
    outputs += fmt::format("    <Output valueReference=\"{}\"/>\n", i + 1);
    initial += fmt::format("    <InitialUnknown valueReference=\"{}\"/>\n", i + 1);
  }
  return text + "  </ModelVariables>\n  <ModelStructure>\n" + outputs + initial + "  </ModelStructure>\n</fmiModelDescription>\n";
}

constexpr std::string_view kXml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

}  // namespace

std::string model_description(const ModelDescription& model, const UnitFile& file, const Unit& unit) {
  return std::string(kXml) + (model.fmi == 2 ? fmi2(model, file, unit) : fmi3(model, file, unit));
}

std::string build_description(const ModelDescription& model) {
  std::string text = std::string(kXml) + fmt::format("<fmiBuildDescription fmiVersion=\"3.0\">\n  <BuildConfiguration modelIdentifier=\"{}\" "
                                                     "description=\"CMakeLists.txt beside this file builds the same\">\n",
                                                     model.identifier);
  for (const auto& [suffix, language] : {std::pair{".c", "C11"}, std::pair{".cpp", "C++20"}}) {
    text += fmt::format("    <SourceFileSet language=\"{}\" compilerOptions=\"-O2 -ffp-contract=off\">\n", language);
    for (const std::string& source : model.sources) {
      if (source.ends_with(suffix)) text += fmt::format("      <SourceFile name=\"{}\"/>\n", common::xml_text(source));
    }
    text += fmt::format("      <PreprocessorDefinition name=\"SLEWLAB_VERSION\" value=\"&quot;{}&quot;\"/>\n", SLEWLAB_VERSION);
    text += "      <IncludeDirectory name=\".\"/>\n    </SourceFileSet>\n";
  }
  return text +
         "    <Library name=\"Eigen3\" version=\"3.4\" external=\"true\" description=\"headers\"/>\n"
         "    <Library name=\"nlohmann_json\" external=\"true\" description=\"headers\"/>\n"
         "    <Library name=\"lcm\" external=\"true\" description=\"headers\"/>\n"
         "  </BuildConfiguration>\n</fmiBuildDescription>\n";
}

std::string identifier_of(const std::string& text) {
  std::string result;
  for (const char c : text) result += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  if (result.empty() || std::isdigit(static_cast<unsigned char>(result.front())) != 0) result.insert(0, "_");
  return result;
}

}  // namespace slewlab::tools::fmu
