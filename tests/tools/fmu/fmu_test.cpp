// The FMU's parts below what FMPy sees: unit.json against the YAML it was made of, steps without allocation, packages.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "controller/controller_file.h"
#include "sim/machine/machine_file.h"
#include "tests/common/allocation_guard.h"
#include "tools/fmu/controller_unit.h"
#include "tools/fmu/fmi/fmi2FunctionTypes.h"
#include "tools/fmu/fmi/fmi3FunctionTypes.h"
#include "tools/fmu/model_description.h"
#include "tools/fmu/package.h"
#include "tools/fmu/plant_unit.h"

namespace slewlab::tools::fmu {
namespace {

namespace fs = std::filesystem;

const fs::path kConfig = fs::path(SLEWLAB_SOURCE_DIR) / "config";

UnitFile unit_file_of(const fs::path& path, UnitKind kind) {
  common::InputProblems problems;
  UnitFile file;
  file.kind = kind;
  file.root = common::load_yaml_file(path, {}, problems);
  EXPECT_TRUE(problems.empty()) << path;
  file.text = unit_text(file);
  return file;
}

// A folder of this test alone, with unit.json in it.
fs::path resources_of(const UnitFile& file) {
  const std::string name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
  const fs::path folder = fs::path(::testing::TempDir()) / ("slewlab_fmu_" + name + "_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  std::ofstream(folder / kUnitFileName) << file.text;
  return folder;
}

TEST(UnitFile, HoldsEveryMachineAndControllerOfTheConfiguration) {
  int files = 0;
  for (const auto& [name, kind] : {std::pair{"cranes", UnitKind::plant}, {"axes", UnitKind::plant}, {"controllers", UnitKind::controller}}) {
    for (const auto& entry : fs::directory_iterator(kConfig / name)) {
      const UnitFile file = unit_file_of(entry.path(), kind);
      const fs::path folder = resources_of(file);
      const UnitFile again = read_unit_file(folder);
      EXPECT_EQ(common::canonical_text(again.root), common::canonical_text(file.root)) << entry.path();
      EXPECT_EQ(again.kind, kind);
      EXPECT_EQ(token_of(again), token_of(file));
      // Every scalar is read as the YAML reader reads it, or these would throw.
      const auto unit = kind == UnitKind::plant ? make_plant_unit(again) : make_controller_unit(again);
      EXPECT_GT(unit->variables().size(), 5u);
      fs::remove_all(folder);
      ++files;
    }
  }
  EXPECT_GT(files, 10);
}

TEST(UnitFile, ADamagedOneIsNamed) {
  UnitFile file = unit_file_of(kConfig / "cranes/thesis.yaml", UnitKind::plant);
  file.text.resize(file.text.size() / 2);
  const fs::path folder = resources_of(file);
  try {
    read_unit_file(folder);
    FAIL() << "half a file was read";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("unit.json is damaged"), std::string::npos) << error.what();
  }
  fs::remove_all(folder);
}

// The library as an FMU carries it, and a function of it.
class Library {
 public:
  explicit Library(const char* kind) : handle_(::dlopen((fs::path(SLEWLAB_BINARY_DIR) / "fmu" / kind / "unit.so").c_str(), RTLD_NOW | RTLD_LOCAL)) {
    EXPECT_NE(handle_, nullptr) << ::dlerror();
  }
  ~Library() { ::dlclose(handle_); }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  template <class Function>
  Function* function(const char* name) const {
    return reinterpret_cast<Function*>(::dlsym(handle_, name));
  }

 private:
  void* handle_;
};

std::vector<unsigned> references_of(const Unit& unit, Causality causality, FmuType type) {
  std::vector<unsigned> references;
  for (std::size_t i = 0; i < unit.variables().size(); ++i) {
    if (unit.variables()[i].causality == causality && unit.variables()[i].type == type) references.push_back(static_cast<unsigned>(i + 1));
  }
  return references;
}

TEST(Fmi2, SetsStepsAndGetsWithoutAllocation) {
  const UnitFile file = unit_file_of(kConfig / "cranes/thesis.yaml", UnitKind::plant);
  const auto unit = make_plant_unit(file);
  const fs::path folder = resources_of(file);
  const Library library("plant");
  fmi2CallbackFunctions callbacks{};
  const auto instance = library.function<fmi2InstantiateTYPE>("fmi2Instantiate")(
      "one", fmi2CoSimulation, token_of(file).c_str(), ("file://" + folder.string()).c_str(), &callbacks, fmi2False, fmi2False);
  ASSERT_NE(instance, nullptr);
  library.function<fmi2EnterInitializationModeTYPE>("fmi2EnterInitializationMode")(instance);
  library.function<fmi2ExitInitializationModeTYPE>("fmi2ExitInitializationMode")(instance);
  const auto torques = references_of(*unit, Causality::input, FMU_REAL), switches = references_of(*unit, Causality::input, FMU_BOOLEAN);
  const auto outputs = references_of(*unit, Causality::output, FMU_REAL);
  auto* set_real = library.function<fmi2SetRealTYPE>("fmi2SetReal");
  auto* set_boolean = library.function<fmi2SetBooleanTYPE>("fmi2SetBoolean");
  auto* get_real = library.function<fmi2GetRealTYPE>("fmi2GetReal");
  auto* do_step = library.function<fmi2DoStepTYPE>("fmi2DoStep");
  std::vector<double> values(outputs.size());
  const fmi2Boolean on[] = {fmi2True, fmi2False, fmi2False};
  double largest = 0.0;
  const tests::AllocationGuard guard;
  for (int k = 0; k < 1000; ++k) {
    const double torque = k < 500 ? 100.0 : -100.0;  // [Nm] over the backlash and back
    const double said[] = {torque, torque};
    ASSERT_EQ(set_real(instance, torques.data(), torques.size(), said), fmi2OK);
    ASSERT_EQ(set_boolean(instance, switches.data(), switches.size(), on), fmi2OK);
    ASSERT_EQ(do_step(instance, 0.01 * k, 0.01, fmi2True), fmi2OK);
    ASSERT_EQ(get_real(instance, outputs.data(), outputs.size(), values.data()), fmi2OK);
    largest = std::max(largest, values[0]);
  }
  EXPECT_EQ(guard.count(), 0);
  EXPECT_GT(largest, 1.0) << "[rad/s] the motors must have turned to say anything";
  library.function<fmi2FreeInstanceTYPE>("fmi2FreeInstance")(instance);
  fs::remove_all(folder);
}

// By RFC 3986, 2.1: a percent sign and two hexadecimal digits. What is none stands as it is, up to the end of the text.
TEST(Fmi2, ALocationMayHoldCodedCharacters) {
  const UnitFile file = unit_file_of(kConfig / "cranes/thesis.yaml", UnitKind::plant);
  const fs::path folder = resources_of(file);
  const Library library("plant");
  fmi2CallbackFunctions callbacks{};
  const std::string token = token_of(file);
  for (const auto& [name, coded] : {std::pair{"with blank", "with%20blank"}, {"[one]", "%5bone%5D"}, {"half%5", "half%5"}, {"none% 5", "none% 5"}}) {
    fs::create_directories(folder / name);
    fs::copy_file(folder / kUnitFileName, folder / name / kUnitFileName);
    const std::string location = "file://" + (folder / coded).string();
    const auto instance = library.function<fmi2InstantiateTYPE>("fmi2Instantiate")(
        "one", fmi2CoSimulation, token.c_str(), location.c_str(), &callbacks, fmi2False, fmi2False);
    EXPECT_NE(instance, nullptr) << location;
    library.function<fmi2FreeInstanceTYPE>("fmi2FreeInstance")(instance);
  }
  fs::remove_all(folder);
}

TEST(Fmi3, TheControllerSetsStepsAndGetsWithoutAllocation) {
  const UnitFile file = unit_file_of(kConfig / "controllers/thesis.yaml", UnitKind::controller);
  const auto unit = make_controller_unit(file);
  const fs::path folder = resources_of(file);
  const Library library("controller");
  const auto instance = library.function<fmi3InstantiateCoSimulationTYPE>("fmi3InstantiateCoSimulation")(
      "one", token_of(file).c_str(), folder.c_str(), false, false, false, false, nullptr, 0, nullptr, nullptr, nullptr);
  ASSERT_NE(instance, nullptr);
  library.function<fmi3EnterInitializationModeTYPE>("fmi3EnterInitializationMode")(instance, false, 0.0, 2.0, false, 0.0);
  library.function<fmi3ExitInitializationModeTYPE>("fmi3ExitInitializationMode")(instance);
  const auto inputs = references_of(*unit, Causality::input, FMU_REAL), outputs = references_of(*unit, Causality::output, FMU_REAL);
  auto* set_real = library.function<fmi3SetFloat64TYPE>("fmi3SetFloat64");
  auto* get_real = library.function<fmi3GetFloat64TYPE>("fmi3GetFloat64");
  auto* do_step = library.function<fmi3DoStepTYPE>("fmi3DoStep");
  std::vector<double> said(inputs.size()), values(outputs.size());
  said[0] = 1.0;  // speed_request
  bool event = true, terminates = true, early = true;
  double reached = 0.0, time = 0.0;
  const fmi3ValueReference kTime = 0;
  const tests::AllocationGuard guard;
  for (int k = 0; k < 100; ++k) {
    ASSERT_EQ(set_real(instance, inputs.data(), inputs.size(), said.data(), said.size()), fmi3OK);
    ASSERT_EQ(do_step(instance, 2.0 + 0.01 * k, 0.01, true, &event, &terminates, &early, &reached), fmi3OK);
    ASSERT_EQ(get_real(instance, outputs.data(), outputs.size(), values.data(), values.size()), fmi3OK);
  }
  EXPECT_EQ(guard.count(), 0);
  EXPECT_FALSE(event || terminates || early);
  EXPECT_DOUBLE_EQ(reached, 3.0);
  EXPECT_EQ(get_real(instance, &kTime, 1, &time, 1), fmi3OK);
  EXPECT_DOUBLE_EQ(time, 3.0);
  EXPECT_GT(values[0], 1.0) << "[Nm] a speed is asked for, so a torque must be said";
  library.function<fmi3FreeInstanceTYPE>("fmi3FreeInstance")(instance);
  fs::remove_all(folder);
}

TEST(Package, IsWrittenWholeOrNotAtAll) {
  const fs::path folder = fs::path(::testing::TempDir()) / ("slewlab_package_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  write_package(folder / "a.fmu", {{"one.txt", "one"}, {"deep/two.txt", std::string(100'000, 'x')}});
  EXPECT_GT(fs::file_size(folder / "a.fmu"), 100u);
  EXPECT_LT(fs::file_size(folder / "a.fmu"), 10'000u) << "it is compressed";
  EXPECT_FALSE(fs::exists(folder / "a.fmu.partial"));
  EXPECT_THROW(write_package(folder / "none" / "a.fmu", {{"one.txt", "one"}}), std::runtime_error);
  fs::create_directory(folder / "taken.fmu");
  EXPECT_ANY_THROW(write_package(folder / "taken.fmu", {{"one.txt", "one"}}));
  EXPECT_FALSE(fs::exists(folder / "taken.fmu.partial"));
  fs::remove_all(folder);
}

TEST(ModelDescription, ANameBecomesAnIdentifier) {
  EXPECT_EQ(identifier_of("thesis"), "thesis");
  EXPECT_EQ(identifier_of("harbour 5t-b"), "harbour_5t_b");
  EXPECT_EQ(identifier_of("900t"), "_900t");
}

}  // namespace
}  // namespace slewlab::tools::fmu
