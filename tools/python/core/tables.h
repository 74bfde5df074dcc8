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

// What numpy.dtype() takes: names, formats, offsets and itemsize of a row.
inline nanobind::dict layout_of(const msgs::RowLayout& layout) {
  nanobind::list names, formats, offsets;
  for (const msgs::TableField& field : layout.fields) {
    const std::string type = (field.kind == 'b' ? std::string("?") : field.kind + std::to_string(field.bytes));
    names.append(std::string(field.name));
    formats.append(field.count < 0 ? nanobind::object(nanobind::str(type.c_str()))
                                   : nanobind::object(nanobind::make_tuple(type, nanobind::make_tuple(field.count))));
    offsets.append(field.offset);
  }
  nanobind::dict described;
  described["names"] = names;
  described["formats"] = formats;
  described["offsets"] = offsets;
  described["itemsize"] = layout.row_bytes;
  return described;
}

}  // namespace slewlab::tools
