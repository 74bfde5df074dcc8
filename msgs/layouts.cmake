# cmake -DFILES="a.lcm;b.lcm" -DOUTPUT=layouts.hpp -DFIELDS=fields.hpp -DSIGNALS=signals.hpp -DTABLE=signals.json -P layouts.cmake
#
# The .lcm files are the table of the wire's signals: channel, field, type and, in the field's comment, its unit in brackets
# and, of what a sensor of the machine measures, the sensor's place: "// [m/s^2] at house: ...".
# From them come
# - layouts.hpp: the byte layout of every message (struct Layout, see msgs/wire_layout.cpp): what lcm-gen's decoder takes
#   on trust is checked by it before anything is decoded, and whole tables are made of it (msgs/run_table.cpp);
# - fields.hpp: every field with its name and unit, for whoever walks over messages (visit_fields());
# - signals.hpp: what is measured, where; the numbers of SENSORS for whoever reads a machine without the wire;
# - signals.json: every field and its unit for Python (tools/python/signals.py).
# Knows what these files use: one
# struct per file, LCM's primitive types but string, and arrays of one dimension whose count is an int32_t above them.
# Anything else ends the build with the file and the line that it does not know.

set(head "sequence;simulated_time;configuration_hash;run_identity")  # what every message begins with, int64_t each

set(size_of_int8_t 1)
set(size_of_byte 1)
set(size_of_boolean 1)
set(size_of_int16_t 2)
set(size_of_int32_t 4)
set(size_of_int64_t 8)
set(size_of_float 4)
set(size_of_double 8)

# What a field's bytes are: signed, unsigned, boolean or floating point.
set(kind_of_int8_t i)
set(kind_of_byte u)
set(kind_of_boolean b)
set(kind_of_int16_t i)
set(kind_of_int32_t i)
set(kind_of_int64_t i)
set(kind_of_float f)
set(kind_of_double f)

set(layouts "")
set(includes "")
set(visits "")
set(table "")
set(signals "")
set(readings "")
set(sensor_fields "")
set(signal_count 0)
set(sensor_count 0)
foreach(file IN LISTS FILES)
  file(STRINGS ${file} lines)
  set(package "")
  set(struct "")
  set(names "")
  set(pieces "")
  set(arrays "")
  set(counts "")
  set(fixed 0)
  set(fields "")
  set(rows "")
  set(channel "")
  set(wire_fields "")
  macro(end_of_fixed_bytes)
    if(fixed GREATER 0)
      list(APPEND pieces "{Piece::fixed, ${fixed}, 0}")
      set(fixed 0)
    endif()
  endmacro()
  foreach(line IN LISTS lines)
    set(unit "-")
    set(sensor_place "")
    if(line MATCHES "//[^[]*\\[([^]]+)\\]")
      set(unit "${CMAKE_MATCH_1}")
    endif()
    if(line MATCHES "\\] at ([a-z_]+):")
      set(sensor_place "${CMAKE_MATCH_1}")
    endif()
    string(REGEX REPLACE "//.*" "" line "${line}")
    string(REGEX REPLACE "; *$" "" line "${line}")
    string(STRIP "${line}" line)
    if(line STREQUAL "" OR line STREQUAL "{" OR line STREQUAL "}")
      continue()
    elseif(line MATCHES "^package ([a-z_]+)$")
      set(package ${CMAKE_MATCH_1})
    elseif(line MATCHES "^struct ([a-z_0-9]+)$")
      set(struct ${CMAKE_MATCH_1})
      string(REGEX REPLACE "_t$" "" channel "${struct}")
      string(TOUPPER "${channel}" channel)
    elseif(line MATCHES "^([a-z0-9_]+) ([a-z0-9_]+)(\\[([a-z0-9_]+)\\])?$")
      set(type ${CMAKE_MATCH_1})
      set(name ${CMAKE_MATCH_2})
      set(count "${CMAKE_MATCH_4}")
      if(NOT DEFINED size_of_${type})
        message(FATAL_ERROR "${file}: '${line}': the type ${type} is not known to msgs/layouts.cmake")
      endif()
      list(LENGTH names place)
      list(LENGTH head head_length)
      if(place LESS head_length)
        list(GET head ${place} expected)
        if(NOT "${type} ${name}${count}" STREQUAL "int64_t ${expected}")
          message(FATAL_ERROR "${file}: found '${line}', expected 'int64_t ${expected}': every message begins with the same head")
        endif()
      endif()
      list(APPEND names ${name})
      if(sensor_place)
        string(APPEND signals "    {\"${channel}\", \"${name}\", \"${unit}\", \"${sensor_place}\"},\n")
        math(EXPR signal_count "${signal_count} + 1")
      endif()
      if(struct STREQUAL "sensors_t" AND NOT place LESS head_length)
        if(NOT type STREQUAL "double" OR count OR NOT sensor_place)
          message(FATAL_ERROR "${file}: found '${line}', expected 'double NAME;  // [UNIT] at PLACE: what it is'")
        endif()
        string(APPEND readings "  double ${name} = 0.0;  // [${unit}] at ${sensor_place}\n")
        string(APPEND sensor_fields "    {\"${name}\", \"${unit}\", \"${sensor_place}\", &Readings::${name}},\n")
        math(EXPR sensor_count "${sensor_count} + 1")
      endif()
      string(APPEND fields "  visit(\"${name}\", \"${unit}\", m.${name});\n")
      if(rows)
        string(APPEND rows ",\n")
      endif()
      string(APPEND rows "    \"${name}\": \"${unit}\"")
      set(count_index -1)
      if(count)
        list(FIND counts ${count} count_index)
      endif()
      list(APPEND wire_fields "{\"${name}\", '${kind_of_${type}}', ${size_of_${type}}, ${count_index}}")
      if(count)
        list(FIND counts ${count} index)
        if(index LESS 0)
          message(FATAL_ERROR "${file}: '${line}': there is no int32_t ${count} above it")
        endif()
        end_of_fixed_bytes()
        list(APPEND pieces "{Piece::array, ${size_of_${type}}, ${index}}")
        string(APPEND arrays "    visit(m.${count}, m.${name});\n")
      elseif(type STREQUAL "int32_t")
        end_of_fixed_bytes()
        list(LENGTH counts index)
        list(APPEND counts ${name})
        list(APPEND pieces "{Piece::count, 4, ${index}}")
      else()
        math(EXPR fixed "${fixed} + ${size_of_${type}}")
      endif()
    else()
      message(FATAL_ERROR "${file}: '${line}' is not known to msgs/layouts.cmake")
    endif()
  endforeach()
  end_of_fixed_bytes()
  list(LENGTH pieces piece_count)
  list(LENGTH counts count_count)
  list(JOIN pieces ", " pieces)
  list(LENGTH wire_fields field_count)
  list(JOIN wire_fields ", " wire_fields)
  string(APPEND includes "#include <${package}/${struct}.hpp>\n")
  if(arrays)
    set(parameters "M& m, Visit visit")
  else()
    set(parameters "M&, Visit")
  endif()
  string(APPEND visits "
template <class Visit>
void visit_fields(const ${package}::${struct}& m, Visit visit) {
${fields}}
")
  if(table)
    string(APPEND table ",\n")
  endif()
  string(APPEND table "  \"${channel}\": {\n${rows}\n  }")
  string(APPEND layouts "
template <>
struct Layout<${package}::${struct}> {
  static constexpr std::array<Piece, ${piece_count}> pieces{{${pieces}}};
  static constexpr std::array<WireField, ${field_count}> fields{{${wire_fields}}};
  static constexpr int counts = ${count_count};
  template <class M, class Visit>
  static void arrays(${parameters}) {
${arrays}  }
};
")
endforeach()

set(text "// Made by msgs/layouts.cmake from the .lcm files; do not edit.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

${includes}
namespace slewlab::msgs {

// A stretch of a message's bytes: `bytes` as they are, a 32-bit count with the number `index`, or `bytes` for each
// element that the count with the number `index` counts.
struct Piece {
  enum Kind { fixed, count, array } kind;
  std::size_t bytes;
  std::size_t index;
};

// A field as it stands on the wire, big-endian.
struct WireField {
  std::string_view name;
  char kind;          // 'i' signed, 'u' unsigned, 'b' boolean, 'f' floating point
  std::size_t bytes;  // of one element
  int count;          // number of the count that says how many there are, -1: it is no array
};

template <class Message>
struct Layout;
${layouts}
}  // namespace slewlab::msgs
")
file(WRITE ${OUTPUT} "${text}")

file(WRITE ${FIELDS} "// Made by msgs/layouts.cmake from the .lcm files; do not edit.
#pragma once

${includes}
namespace slewlab::msgs {

// visit(name, unit, value) of every field in the order of the .lcm file; a field without a unit there has \"-\".
${visits}
}  // namespace slewlab::msgs
")
file(WRITE ${SIGNALS} "// Made by msgs/layouts.cmake from the .lcm files; do not edit.
#pragma once

#include <array>
#include <string_view>

namespace slewlab::msgs {

// What a sensor of the machine measures, and at which of its places (sim/machine/description.h).
struct Signal {
  std::string_view channel, field, unit, place;
};
inline constexpr std::array<Signal, ${signal_count}> kSignals{{
${signals}}};

// What SENSORS says, without the message's head.
struct SensorReadings {
${readings}};

template <class Readings>
struct SensorField {
  std::string_view field, unit, place;
  double Readings::*value;
};
// The fields of SENSORS in `Readings`: the message, SensorReadings, or what derives from it.
template <class Readings>
inline constexpr std::array<SensorField<Readings>, ${sensor_count}> kSensorFields{{
${sensor_fields}}};

}  // namespace slewlab::msgs
")
file(WRITE ${TABLE} "{\n${table}\n}\n")
