#include "tools/fmu/fmu_unit.h"

#include <cstdio>
#include <exception>
#include <stdexcept>

#include "tools/fmu/unit.h"

struct FmuUnit {
  std::unique_ptr<slewlab::tools::fmu::Unit> unit;
  char message[1024] = "";
};

namespace {

using slewlab::tools::fmu::Variable;

void keep(char* message, std::size_t size, const char* text) {
  if (message != nullptr && size > 0) std::snprintf(message, size, "%s", text);
}

template <class Work>
int guarded(FmuUnit* unit, Work work) {
  try {
    work(*unit->unit);
    return 1;
  } catch (const std::exception& error) {
    keep(unit->message, sizeof unit->message, error.what());
  } catch (...) {
    keep(unit->message, sizeof unit->message, "an error of no known kind");
  }
  return 0;
}

// Index of the variable, whose value reference is one higher; 0 is the time.
std::size_t index_of(const slewlab::tools::fmu::Unit& unit, unsigned reference, FmuType type) {
  constexpr const char* kNames[] = {"real", "integer", "boolean"};
  if (reference == 0 || reference > unit.variables().size()) {
    throw std::runtime_error("no variable has the value reference " + std::to_string(reference));
  }
  const Variable& variable = unit.variables()[reference - 1];
  if (variable.type != type) {
    throw std::runtime_error(variable.name + " is of type " + kNames[variable.type] + ", asked for as " + kNames[type]);
  }
  return reference - 1;
}

}  // namespace

FmuUnit* fmu_unit_make(const char* resources, const char* token, char* message, size_t size) {
  try {
    const auto file = slewlab::tools::fmu::read_unit_file(resources);
    if (token == nullptr || slewlab::tools::fmu::token_of(file) != token) {
      throw std::runtime_error("unit.json is not the one that modelDescription.xml was made with; export the FMU again");
    }
    auto unit = std::make_unique<FmuUnit>();
    unit->unit = slewlab::tools::fmu::make_unit(file);
    return unit.release();
  } catch (const std::exception& error) {
    keep(message, size, error.what());
  } catch (...) {
    keep(message, size, "an error of no known kind");
  }
  return nullptr;
}

void fmu_unit_free(FmuUnit* unit) { delete unit; }

FmuUnit* fmu_unit_copy(const FmuUnit* unit) {
  try {
    auto copy = std::make_unique<FmuUnit>();
    copy->unit = unit->unit->clone();
    return copy.release();
  } catch (...) {
    return nullptr;
  }
}

int fmu_unit_get(FmuUnit* unit, unsigned reference, FmuType type, double* value) {
  return guarded(unit, [&](slewlab::tools::fmu::Unit& held) {
    const bool is_time = reference == 0 && type == FMU_REAL;
    *value = is_time ? held.time() : held.get(index_of(held, reference, type));
  });
}
int fmu_unit_set(FmuUnit* unit, unsigned reference, FmuType type, double value) {
  return guarded(unit, [&](slewlab::tools::fmu::Unit& held) { held.set(index_of(held, reference, type), value); });
}
int fmu_unit_take_over(FmuUnit* unit, const FmuUnit* from) {
  return guarded(unit, [&](slewlab::tools::fmu::Unit& held) { held.take_over(*from->unit); });
}
int fmu_unit_reset(FmuUnit* unit) {
  return guarded(unit, [&](slewlab::tools::fmu::Unit& held) { unit->unit = held.as_made(); });
}
int fmu_unit_begin(FmuUnit* unit, double time) {
  return guarded(unit, [&](slewlab::tools::fmu::Unit& held) { held.begin(time); });
}
int fmu_unit_start(FmuUnit* unit) {
  return guarded(unit, [](slewlab::tools::fmu::Unit& held) { held.start(); });
}
int fmu_unit_step(FmuUnit* unit, double time, double step) {
  return guarded(unit, [&](slewlab::tools::fmu::Unit& held) { held.step(time, step); });
}

const char* fmu_unit_message(const FmuUnit* unit) { return unit->message; }
