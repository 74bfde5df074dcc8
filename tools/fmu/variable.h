// A variable of an FMU: what the model description says of it, and where it is kept.
#pragma once

#include <cstddef>
#include <slewlab_msgs/fields.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/fmu/fmu_unit.h"

namespace slewlab::tools::fmu {

enum class Causality { parameter, input, output };

struct Variable {
  std::string name;         // "motor_torque[1]"
  std::string description;
  std::string unit;         // as the messages have it, "Nm"; "-" where there is none
  FmuType type = FMU_REAL;
  Causality causality = Causality::output;
  double start = 0.0;       // of a parameter and an input
};

// What a message's field is for people. Groups and elements count from 1.
struct FieldText {
  std::string_view field;
  FmuType type = FMU_REAL;
  std::string_view text;
};

namespace detail {

inline double to_double(double value) { return value; }
template <class Whole>
double to_double(Whole value) { return static_cast<double>(value); }

const FieldText* text_of(std::span<const FieldText> texts, std::string_view field);

}  // namespace detail

// msgs::visit_fields of a message, bound to it: what the functions below call `fields`.
template <class Message>
auto fields_of(const Message& message) {
  return [&message](auto visit) { msgs::visit_fields(message, visit); };
}

// The fields of a message that `texts` names become variables, in the message's order; of an array one for each element there is.
template <class VisitFields>
void add_variables(VisitFields fields, std::span<const FieldText> texts, Causality causality, std::vector<Variable>& variables) {
  fields([&](std::string_view name, std::string_view unit, const auto& value) {
    const FieldText* text = detail::text_of(texts, name);
    if (text == nullptr) return;
    Variable variable{std::string(name), std::string(text->text), std::string(unit), text->type, causality, 0.0};
    if constexpr (requires { value.size(); }) {
      for (std::size_t i = 0; i < value.size(); ++i) {
        variable.name = std::string(name) + "[" + std::to_string(i + 1) + "]";
        variables.push_back(variable);
      }
    } else {
      variables.push_back(variable);
    }
  });
}

// Writes the values of the same fields to `to`, in the same order; `is_variable` says of each field of the message in turn whether it is
// one (field_choice). Answers with how many were written. Allocates nothing.
template <class VisitFields>
std::size_t copy_values(VisitFields fields, const std::vector<bool>& is_variable, double* to) {
  std::size_t field = 0, count = 0;
  fields([&](std::string_view, std::string_view, const auto& value) {
    if (!is_variable[field++]) return;
    if constexpr (requires { value.size(); }) {
      for (const auto& element : value) to[count++] = detail::to_double(element);
    } else {
      to[count++] = detail::to_double(value);
    }
  });
  return count;
}

template <class VisitFields>
std::vector<bool> field_choice(VisitFields fields, std::span<const FieldText> texts) {
  std::vector<bool> chosen;
  fields([&](std::string_view name, std::string_view, const auto&) { chosen.push_back(detail::text_of(texts, name) != nullptr); });
  return chosen;
}

}  // namespace slewlab::tools::fmu
