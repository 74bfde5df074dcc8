// Rows of messages as Python sees them: bytes that numpy takes as they are, and where each field stands in a row.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstdint>
#include <string>
#include <vector>

#include "msgs/row_layout.h"

namespace slewlab::tools {

using RowBytes = nanobind::ndarray<nanobind::numpy, std::uint8_t, nanobind::ndim<1>>;

// The bytes without a copy; they live as long as Python wants.
inline RowBytes row_bytes(std::vector<std::uint8_t>&& bytes) {
  auto* kept = new std::vector<std::uint8_t>(std::move(bytes));
  const nanobind::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<std::uint8_t>*>(p); });
  return RowBytes(kept->data(), {kept->size()}, owner);
}

// [(name, numpy's letter and size, number of elements or None, offset)], bytes of a row.
inline nanobind::tuple layout_of(const msgs::RowLayout& layout) {
  nanobind::list fields;
  for (const msgs::TableField& field : layout.fields) {
    const std::string type = (field.kind == 'b' ? std::string("?") : field.kind + std::to_string(field.bytes));
    const nanobind::object count = field.count < 0 ? nanobind::object(nanobind::none()) : nanobind::object(nanobind::int_(field.count));
    fields.append(nanobind::make_tuple(std::string(field.name), type, count, field.offset));
  }
  return nanobind::make_tuple(fields, layout.row_bytes);
}

}  // namespace slewlab::tools
