#include "tools/fmu/unit.h"

#include <cmath>
#include <stdexcept>

#include "msgs/configuration_hash.h"

namespace slewlab::tools::fmu {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;

}  // namespace

Unit::Unit(std::shared_ptr<const std::vector<Variable>> variables) : variables_(std::move(variables)) {
  for (const Variable& variable : *variables_) values_.push_back(variable.start);
}

void Unit::need_assembled() {
  if (is_assembled_) return;
  assemble();
  is_assembled_ = true;
}

double Unit::get(std::size_t index) {
  if ((*variables_)[index].causality == Causality::output) {
    need_assembled();
    refresh(index);
  }
  return values_[index];
}

void Unit::set(std::size_t index, double value) {
  const Variable& variable = (*variables_)[index];
  if (variable.causality == Causality::output) throw std::runtime_error(variable.name + " is an output and cannot be set");
  if (variable.causality == Causality::parameter) {
    if (is_started_) throw std::runtime_error(variable.name + " is a parameter: it is set before the end of the initialization, not after");
    is_assembled_ = false;
  }
  values_[index] = value;
}

void Unit::begin(double time) {
  begin_ = time;
  time_ = 0;
}

void Unit::start() {
  need_assembled();
  is_started_ = true;
}

void Unit::step(double time, double step) {
  if (!is_started_) throw std::runtime_error("a step before the end of the initialization");
  const double nanoseconds = step * kNanosecondsPerSecond;
  if (!(nanoseconds >= 1.0 && nanoseconds < 1e18)) throw std::runtime_error("a communication step of " + std::to_string(step) + " s; it has to be above 0");
  const std::int64_t whole = std::llround(nanoseconds);
  // A master adds up steps in floating point; half a step beside the unit's own time is another time.
  if (!(std::fabs((time - begin_) * kNanosecondsPerSecond - static_cast<double>(time_)) <= 0.5 * nanoseconds)) {
    throw std::runtime_error("a step from " + std::to_string(time) + " s on; the unit stands at " +
                             std::to_string(begin_ + static_cast<double>(time_) / kNanosecondsPerSecond) + " s");
  }
  advance(time_, whole);
  time_ += whole;
}

std::string token_of(const UnitFile& file) {
  return "{slewlab-" SLEWLAB_VERSION "-" + msgs::hash_text(msgs::configuration_hash(file.text)) + "}";
}

}  // namespace slewlab::tools::fmu
