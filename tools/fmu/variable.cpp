#include "tools/fmu/variable.h"

namespace slewlab::tools::fmu::detail {

const FieldText* text_of(std::span<const FieldText> texts, std::string_view field) {
  for (const FieldText& text : texts) {
    if (text.field == field) return &text;
  }
  return nullptr;
}

}  // namespace slewlab::tools::fmu::detail
