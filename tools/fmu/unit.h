// A plant or a controller as an FMU holds it: variables with values, and a step over a communication period. The functions of
// fmu_unit.h are over it. A unit is made of the FMU's unit.json alone (unit_file.h).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tools/fmu/unit_file.h"
#include "tools/fmu/variable.h"

namespace slewlab::tools::fmu {

class Unit {
 public:
  virtual ~Unit() = default;
  virtual std::unique_ptr<Unit> clone() const = 0;
  // Becomes as `from` is, which is of the same FMU.
  virtual void take_over(const Unit& from) = 0;
  virtual std::unique_ptr<Unit> as_made() const = 0;

  const std::vector<Variable>& variables() const { return *variables_; }

  double time() const { return begin_ + static_cast<double>(time_) * 1e-9; }  // [s]

  // Value of variable `index`, worked out where it is not up to date.
  double get(std::size_t index);
  // Throws std::runtime_error where that cannot be set now.
  void set(std::size_t index, double value);

  void begin(double time);  // [s]
  void start();
  // Throws std::runtime_error: a time or a step that the unit cannot take, or the unit's own failure.
  void step(double time, double step);  // [s]

 protected:
  explicit Unit(std::shared_ptr<const std::vector<Variable>> variables);
  Unit(const Unit&) = default;
  Unit& operator=(const Unit&) = default;

  // Where parameters are what they are: makes what the outputs are read off. Throws std::runtime_error.
  virtual void assemble() = 0;
  // Inputs are in values_. `time` [ns] since the beginning; `step` [ns] above 0.
  virtual void advance(std::int64_t time, std::int64_t step) = 0;
  // Brings the output `index` up to date.
  virtual void refresh(std::size_t index) = 0;

  std::vector<double> values_;  // by variable

 private:
  void need_assembled();

  std::shared_ptr<const std::vector<Variable>> variables_;
  bool is_assembled_ = false;
  bool is_started_ = false;
  double begin_ = 0.0;     // [s]
  std::int64_t time_ = 0;  // [ns] since the beginning
};

// Of the kind that this FMU's library holds. Throws common::InputError or std::runtime_error.
std::unique_ptr<Unit> make_unit(const UnitFile& file);

// What the model description's GUID and instantiation token are: another configuration or another slewlab is another one.
std::string token_of(const UnitFile& file);

}  // namespace slewlab::tools::fmu
